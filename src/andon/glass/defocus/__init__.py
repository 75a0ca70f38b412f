"""Defocus: each layer of the glass blurred by how far it is from where the eye is focused.

What
    A gather: each pixel is the mean of a layer over that pixel's own disc, whose diameter is the
    defocus in dioptres times the pupil. What is refracted and what is mirrored are images that go
    on behind the rim; the rim itself is as near as the surface and is blurred with it, together
    with what sticks there. Then the layers are composed as sharp ones are.
Discs
    A pupil is round, so its image of a point is a uniform disc, of second moment D²/16 along each
    axis. ``gaussian`` has the same moment, σ = D/4; ``paper`` is the paper's σ² = K/2 within ±K/2
    of weights that sum to 1, on the surface and the mirror image only (its backdrop is blurred
    before it is refracted). On the grid of pixels the size of each is such that the moment is met
    for every D; below one pixel nothing is blurred.
Beyond the rim
    A blurred rim shows glass where no ray met glass. What is seen there is the nearest glass, by
    a pyramid of means (`reference.extended`); a sharp image behind a blurred rim needs it, too,
    where an average normalised by coverage would be nought by nought.

===============================  =====================  ==========================================
way to draw three layers         20 px       60 px      what is wrong with it
===============================  =====================  ==========================================
every pixel of every disc        0.7 s       6.6 s      nothing
**pyramid, discs of 3 to 12      45 ms       45 ms      0.25 to 0.6/255 in the mean on a photograph;
texels, sharpened**                                     a lone point's disc is softer at its rim
the same, not sharpened          not timed   not timed  about twice that error; discs are bells
running sums along rows          0.1 s       0.3 s      float32; ends between texels cost double
Fourier transform                                       one diameter for the whole picture
polygons in two or three passes                         one diameter, or corners
===============================  =====================  ==========================================

Times are of a ball of 670 px on two cores of software Vulkan. The pyramid's is measured by the
bench rows (one eye, wall clock, on a machine with other work; the caller says which discs there are
not); those of the first and fourth row are computed from their taps, at 450 million a second.

Reducing (weights 1 3 3 1, by which a point stays exactly where it is) and enlarging (3 1) each add
a second moment of ¾ of a texel² of the finer level. A five-point sharpening of each level's discs
takes it away again, so the moment of a point's image is D²/16 wherever it lies between texels. The
price is seen on lone points only: within, such a disc is up to 1.3 of its height where a level
begins, and around it there is down to −0.09 of it, cut where the composed sum would be negative.

Levels, from 6, 15 and 48 px on, are chosen so that discs have 3 to 12 texels; smaller ones are
gathered at full size. Each level is drawn only where discs are its own, and not at all where the
caller says that none is.
"""
