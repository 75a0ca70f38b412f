"""Glow: a Gaussian around luminous bodies, one filter of the picture for all of them.

What
    ``L' = L + fraction·(G∗B − B)``: B the luminance of the luminous bodies alone, G a Gaussian of
    unit sum. A share of the bodies' light is taken from where it is and put around it, so energy
    is kept; with ``fraction = 1`` a body is wholly replaced by its filtered picture, as in the
    paper. What falls beyond the picture's border is lost: nothing is mirrored back.
Why not more light instead
    Adding a blurred copy makes a lamp brighter than its candela. Scattering takes away what it
    gives.
How much, how wide
    The paper leaves σ to the artist and its automatic choice to the future. Here both follow from
    the eye (`automatic`): the fraction is what the CIE's standard observer scatters by more than
    0.1°, σ puts as much of it within 1° as that observer does.
What it is not
    A veil: the tail of the eye's scattering falls with a power of the angle and a Gaussian does
    not, so beyond about 2° there is too little light, at 0.5° too much. σ is a number of pixels,
    right near the axis of a pinhole view; on fisheye and latlong pictures it belongs to the mean
    pixel, and a latlong picture has a border at its seam.

=============================  ==========================  =======================================
way to filter (1280×720)       cost on two cores           error, share of a point's peak
=============================  ==========================  =======================================
separable, every pixel         2·(7σ + 4) ms: 320 at 20    none
powers of two, box, bilinear   20 ms                       15 %: a point jumps from cell to cell
**splines, any factor**        15 to 30 ms, falls with σ   below 1 %, energy exact
Fourier transform              no such thing in fragments  none
=============================  ==========================  =======================================

Light is spread over coarse cells by a quadratic B-spline, filtered there, and spread back over
pixels by the same spline. The spline keeps sum, mean and variance of every point wherever it lies
between cells, so what the filter between must add to σ² is known exactly.

Sources: the relighting paper, section 3 and equation 2; CIE 135/1-1999; Unser 1999 (splines).
"""
