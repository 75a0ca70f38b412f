"""Peers: well-known programs that draw the same picture, for times beside ours.

What: each peer takes the same triangles, camera and lamps, in our units, and gives luminance back.
Why: a time means nothing until the pictures agree, so a peer comes with the means to compare
(`pygfx_room.agreement`), and the bench asserts that before it prints a time.

============== ================================== =============================================
peer           what it shares with ours           what it does differently
============== ================================== =============================================
`pygfx_room`   the adapter, WebGPU, shadow maps   forward shading, 8-bit sRGB target, cube maps
                                                  drawn anew in every frame
Radiance       nothing                            traces rays; lives with the truths, since it is
                                                  one (`andon.verify.truths.radiance`)
============== ================================== =============================================

Alternatives: three.js (a browser between us and the clock), Filament and Blender (no wheel that
draws without a display on a software driver).
"""
