"""The observer: age, pupil, accommodation, and where the eyes look.

::

    age ─▶ accommodation ──────────────┐
    luminance, age ─▶ pupil            ├─▶ what is in focus, and how wide a point out of focus is
    eye rays ─▶ gaze: fixation, filter ┘
    age, pigment, pupil, glasses, mist ─▶ spread: how light is scattered on its way to the retina

Stages that need an eye ask here: glass for its focus, glare and glow for what is scattered.
"""
