"""The illuminated-surface model (被照面モデル): the real geometry that receives virtual light.

What
    Per pixel of a view: position, normal, whether there is geometry at all, and which of it is a
    virtual object. From a depth or disparity image, from a mesh, or from a picture of normals
    alone (for distant lamps).
Why this way
    A still photograph's depth image *is* the G-buffer of its own view: nothing is rendered, holes
    stay holes. A mesh, or another view, is rasterised on the GPU and traced by Embree in the
    reference. The same depth image is triangulated once more, cut at jumps and decimated, to cast
    shadows.

=========================  =========================================  =========================
normals from depth         cost (741×500, NumPy)                      at an edge
=========================  =========================================  =========================
central differences        10 ms                                      smeared over 2 px
one-sided, smaller jump    30 ms                                      right, but noisy
**plane fit, reweighted**  ~1 s, once per photograph                  right, noise averaged
=========================  =========================================  =========================

The fit uses that 1/depth is linear in the ray over a plane: q·ray = 1/depth with q = normal /
plane distance, so the weighted least squares is linear and holds for every projection.
"""
