"""Truths: programs that nobody here wrote, asked the same question as our stages.

What: two oracles. Why: a closed form covers one lamp over one plane; a furnished room with shadows
has none, and a reference of our own shares our misunderstandings. Each answers what it is best at.

=============== ============================= ========================== =======================
oracle          question                      known error                cost (two cores)
=============== ============================= ========================== =======================
`radiance`      lux at a point, any lamps,    ≤ 1e-6 relative for point  ~10 µs per point, lamp
                with or without bounces       lamps; area lamps as fine
                                              as they are cut
`embree`        does the point see the lamp   float32 rays: wrong only   ~1 µs per point, lamp
                                              within 0.1 mm of an edge
=============== ============================= ========================== =======================

Alternatives: Mitsuba 3 (a path tracer: noise of 1 % needs 10⁴ paths per point, and its wheel is a
test dependency only); trimesh's ray casting (Embree again, but 2.4 s to import).

Sources: Ward 1994, "The RADIANCE lighting simulation and rendering system" (the programs come with
the `pyradiance` wheel); Wald et al. 2014, "Embree" (through `embreex`).
"""
