"""Truths: programs that nobody here wrote, asked the same question as our stages.

What: two oracles, and a quadrature that is ours but shares nothing with what it judges. Why: a
closed form covers one lamp over one plane; a furnished room with shadows has none, and a reference
of our own shares our misunderstandings. Each answers what it is best at.

=============== ============================= ========================== =======================
oracle          question                      known error                cost (two cores)
=============== ============================= ========================== =======================
`radiance`      lux at a point, any lamps,    ≤ 5e-5 relative for point  1 µs per point and lamp
                with or without bounces       lamps at ≥ 0.5 m; area
                                              lamps as fine as cut
`embree`        does the point see the lamp   float32 rays from 0.1 mm   0.2 µs per point and
                                              above the surface          lamp
`cones`         light of an area lamp,        1e-8 relative              5 ms per point; polygons
                unshadowed or past one edge                              and disks 1 ms
=============== ============================= ========================== =======================

`lampshade` asks Radiance for light that goes round in paper, with rays that are aimed at it.

Radiance and Embree agree: over the furnished room's picture with four lamps, Radiance and the
closed form with Embree's shadows differ by more than 0.1 % in 0.02 % of pixels, all at edges of
shadows.

Alternatives: Mitsuba 3 (a path tracer: noise of 1 % needs 10⁴ paths per point, and its wheel is a
test dependency only); trimesh's ray casting (Embree again, but 2.4 s to import).

Sources: Ward 1994, "The RADIANCE lighting simulation and rendering system" (the programs come with
the `pyradiance` wheel); Wald et al. 2014, "Embree" (through `embreex`).
"""
