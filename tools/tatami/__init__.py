"""How the tatami room of examples/tatami is made: its things, its textures, its photograph.

::

    textures ─┐
    building ─┼─ parts ─▶ room.glb ─▶ light (Radiance) ─▶ photograph, E0
    things   ─┘

All is laid out by hand in metres, +Y up, the mats' upper side at y = 0.
"""
