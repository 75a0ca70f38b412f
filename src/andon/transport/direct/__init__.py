"""Direct light of lamps, with shadows: what each lamp adds to every point it sees.

What
    ``E(P) = I(ω)·max(0, cos φ)/d²`` for lamps with a place, ``L·form factor`` for lamps with an
    area, ``E·max(0, cos φ)`` for directional ones, a dome for sky and hemisphere; each times the
    share of the lamp that is seen. E is in lux, never divided by π.
Why these shadows
    The paper looks up one *dual-paraboloid* depth map per lamp (双放物曲面): two discs see all
    directions, one read per pixel decides. Rasterising triangles straight into the curved map is
    wrong by texels, so six plane faces are drawn and resampled.

==============================  =============  ==========================  =====================
shadow                          reads a pixel  a moved lamp, 27k triangles  error
==============================  =============  ==========================  =====================
ray (the reference)             –              nothing                     float32 of Embree
cube map                        1, six ways    6 faces                     1 texel at edges
**dual paraboloid, resampled**  1 (4 blended)  6 faces + 1 pass            1–2 texels at edges
the same, exact                 16             6 faces + 1 pass            slivers below a texel
dual paraboloid, rasterised     1              2 faces                     7 texels on long edges
==============================  =============  ==========================  =====================

    The *exact* filter lets the map name triangles instead of distances, and asks those around the
    receiver whether they stand in the way: a map of 2048² then differs from rays on 0.07 % of the
    pixels, one of 1024² texels on 0.6 % (``andon verify relight.paraboloid``).

Soft shadows
    An area lamp is seen from points on it, each with a small pair of paraboloids; see `soft`.
Acne
    A shadow map knows its depth at texel *centres* only. Instead of a bias that grows with slope,
    the receiver's own plane is extended to the texel's centre and compared there: exact for plane
    receivers. Curved ones have normals that are interpolated over their facets, so the plane is not
    the facet's, and every receiver is lifted along its normal by a texel, at the place where it is
    (figures in direct.wgsl; of soft shadows a quarter). Where `ShadowBias` is larger, for what
    decimation and noise leave between surface and occluder, that is the lift. Exact shadows ask
    triangles: they need no texel.

Sources: the relighting paper, section 2.1, equation (1); Brabec, Annen & Seidel 2002 (dual
paraboloid shadow maps); glTF 2.0 KHR_lights_punctual (spot falloff).
"""
