"""The observer: age, pupil, accommodation, and where the eyes look.

::

    age ─▶ accommodation ──────────────┐
    luminance, age ─▶ pupil            ├─▶ what is in focus, and how wide a point out of focus is
    eye rays ─▶ gaze: fixation, filter ┘

Stages that need an eye ask here: glass for its focus. What is scattered in the eye is the glow's
(`andon.glow.automatic`).
"""
