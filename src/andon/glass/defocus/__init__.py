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

============================  ==========  ====================================================
way to draw discs of 60 px    taps/pixel  what is wrong with it
============================  ==========  ====================================================
every pixel of every disc     2827        2 s a layer on two cores
**pyramid, discs of 3 to 12   10 to 25    soft rims: 0.3/255 in the mean on photographs, up to
texels, sharpened**                       12 % of a disc's height at the rim of a lone highlight
the same, not sharpened       9 to 24     twice that error; discs of 4 texels are bells
running sums along rows       120         needs float32; four times the cost at 20 px
complex separable discs       240         rings of 10 % with one component; Gaussian window
three passes, hexagon         180         hexagons; discs may not vary
Fourier transform             2·log₂ n    one diameter for the whole picture
============================  ==========  ====================================================

Reducing (weights 1 3 3 1, by which a point stays exactly where it is) and enlarging (3 1) each add
a second moment of ¾ of a texel² of the finer level. A five-point sharpening of each level's discs
takes it away again, so the moment of a point's image is D²/16 wherever it lies between texels. A
point's image so has a rim that falls up to 9 % of its height below 0, which is cut where it would
make the sum negative.

Levels, from 6, 15 and 48 px on, are chosen so that discs have 3 to 12 texels; smaller ones are
gathered at full size. Each level is drawn only where discs are its own, and not at all where the
caller says that none is.
"""
