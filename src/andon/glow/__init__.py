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
    A veil. The eye's scattering falls with a power of the angle and a Gaussian does not: with the
    defaults there is six times too much light at 1°, too little within 0.3° and beyond 1.8°. σ is
    a number of pixels, right near the axis of a pinhole view; on fisheye and latlong pictures it
    belongs to the mean pixel, and a latlong picture has a border at its seam.

==============================  ===========================  =====================================
way to filter (1280×720)        cost on two cores            error, share of a point's peak
==============================  ===========================  =====================================
separable, every pixel          about 2 ms a tap to a side   none
cells of 2ⁿ, box and bilinear   as below                     15 %: points jump from cell to cell
**cells of any size, splines**  24 ms at σ = 4 px, 15 at 20  below 1 %
Fourier transform               2·log₂ of the size passes    none
==============================  ===========================  =====================================

Light is spread over coarse cells by a quadratic B-spline, filtered there, and spread back over
pixels by the same spline. The spline keeps sum, mean and variance of every point wherever it lies
between cells, so what the filter between must add to σ² is known exactly.

Sources: the relighting paper, section 3 and equation 2; CIE 135/1-1999; Unser 1999 (splines).
"""
