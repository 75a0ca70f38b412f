"""Glass: its surface, what it refracts and what it mirrors, each as far away as it appears.

What
    A view ray meets the nearest boundary of all solids, is refracted, and goes on until it is out
    of them (`paths`). It so finds three images: what sticks to the first boundary, what is behind
    the last one, and what the first one mirrors. Each is a picture of its own, premultiplied by the
    share of the pixel that is glass, and carries the diameter of its blur (`layers`); `defocus`
    blurs and composes them, `backdrops` is what the rays find.
Why a distance of each image
    Eyes focus on one of the images and see the others blurred. Which one is sharp is not told by
    the way that light has gone: a ball shows what is behind it upside down in front of the eye or
    behind it. A pencil of rays through the pupil is carried along (`pencils`); it gives the
    vergence of each image as a 2×2 matrix, astigmatism included, signed, in dioptres.

=================================  ==========================  ====================================
way to see through                 costs                       what is wrong with it
=================================  ==========================  ====================================
environment map, one look-up       nothing                     no parallax, no distance
entry only, as in the paper        a ray to the first hit      a ball magnifies instead of turning
**all boundaries, one path**       up to 16 hits               no light of a second mirroring
path tracing                       64 of them and more         noise; minutes a frame
=================================  ==========================  ====================================

What it is not
    Light that is mirrored inside although it could get out is lost: at each boundary the path is
    the refracted one where there is one. Glass hides lamps from other surfaces, and focuses their
    light there, as far as `andon.transport.direct.balls` says: balls only.

Sources: the paper on glass by gaze; Whitted 1980 (refraction); Igehy 1999 (ray differentials).
"""
