"""What is seen through glass, and in it: pictures, the frame, the scene, and what is all around.

What
    `look` follows rays that leave a body: onto a picture on a plane (`texture`), onto the frame on
    a sphere around the eye (`frame`), onto the scene's geometry with the frame on it (`surface`).
    It gives their light, how far they went (so that a vergence can be computed), and whether
    nothing was there (`missed`: `environment_light`, harmonics) or nothing that the frame shows
    (`beside`: the frame's pixel in the ray's direction, the nearest one of its border).
    `sticker_at` is what sticks to a body. The same on the GPU: which.wgsl, sticker.wgsl,
    environment.wgsl, with `BackdropBuffers` for a scene and `FrameLevels` for a view.
Why the G-buffer as geometry
    A frame knows the light of what the eye sees, and of nothing else. So a ray is followed in the
    picture (`march`), and what is hidden from the eye cannot be seen through the glass either:
    light around corners, the backs of things, what is beside the picture.
How finely
    A pixel's pencil tells what it covers (`pyramids`): two round footprints along the longer axis.

==============================  ================  ==============================================
way to filter 0.92 Mpix         ms on two cores   loss
==============================  ================  ==============================================
one footprint of the short axis 41                aliases along the other: rims of balls flicker
one of the long axis            41                blurs across
**two side by side**            55                blurs where the axes differ by more than 2
four                            80                … by more than 4
==============================  ================  ==============================================

==============================  ================  ==============================================
way to meet the scene           time of glass     hits that differ by > 2 % from triangles'
==============================  ================  ==============================================
32 steps, then planes           1                 7.7 %: spokes and rods come and go as speckles
64 steps, then planes           1.3               5.9 %
**128 steps, then planes**      1.7               4.7 %
rays against triangles          a scene of them   none; but no light where the eye sees none
==============================  ================  ==============================================

(A ball before the motorcycle of the demonstration. What is left are pixels at edges, where the
triangles between two pixels are not the pixels' planes.)

Sources: Igehy 1999 (ray differentials); Heckbert 1989 and Williams 1983 (footprints, pyramids).
"""

from __future__ import annotations

from andon.glass.backdrops.environment import environment_of
from andon.glass.backdrops.model import FAR_M, Footprint, SceneOfView, Seen
from andon.glass.backdrops.paper import blur_metres, preblurred
from andon.glass.backdrops.pyramids import Pyramid, pyramid
from andon.glass.backdrops.reference import environment_light, look, sticker_at

__all__ = [
    "FAR_M",
    "Footprint",
    "Pyramid",
    "SceneOfView",
    "Seen",
    "blur_metres",
    "environment_light",
    "environment_of",
    "look",
    "preblurred",
    "pyramid",
    "sticker_at",
]
