"""Glass: its surface, what it refracts and what it mirrors, each as far away as it appears.

::

    view ray ─▶ first boundary ─┬─ what sticks there            surface     1/distance
                                ├─ mirrored ─▶ backdrop, lamps  reflected   vergence of its pencil
                                └─ refracted ─▶ … ─▶ backdrop   refracted   vergence of its pencil
    each blurred by pupil × (vergence − focus), then  α·C_s + (1 − α)·C_b + mirrored, over the frame

What
    One ray a pixel and eye through all bodies of the scene (`paths`), with the *pencil* of rays
    around it (`pencils`). Derivatives by the eye's place and by the direction, B_x and B_θ, of
    where the ray meets its backdrop give the image's vergence V = B_θ⁻¹·B_x in dioptres: how far
    away the image appears to that eye, sign and astigmatism included. A pupil of A metres focused
    on F dioptres spreads it over A·(V − F); `defocus` draws that.
Why vergence
    In metres it breaks. In the paper's own scene the refracted image is at −2.28 D with one
    interface, behind the eye, and at +6.65 D with two, nearer than the glass. Distance through
    the glass, 0.6 m, is neither. Disparity comes by itself: each eye traces its own rays.
Why not the paper's single refraction alone
    It is cheap, and wrong by 126 px and 9 D on a ball (`andon verify glass.interfaces`). Both are
    kept: ``interfaces = 1`` with ``blur = "paper"`` is the paper's system.

=============================  ============================  ====================================
way                            cost on two cores, 720p       what it lacks
=============================  ============================  ====================================
environment map + Fresnel      a lookup                      distance: stereo and blur are wrong
screen-space refraction        two depth layers              sides, insides, total reflection
path tracing through a lens    266 times ours, 64 samples    time
**rays with pencils, layers**  `andon bench glass`           light mirrored inside (3 to 4 % of a
                                                             ball's), rough glass
=============================  ============================  ====================================

`backdrops` is what rays find: a picture on a plane, the scene's geometry with the frame on it, or
the frame at a distance. `focus` says how far away the layers are and what an eye of a stated age
can focus on.

Sources: the paper on glass by gaze; Whitted 1980; Igehy 1999; Schmidt and Budge 2002.
"""
