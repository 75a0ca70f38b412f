"""The veil of all light of a picture, in angle space.

What
    ``veil = ∫ K(θ) L dω`` for every pixel of a pinhole, fisheye or latlong picture.
Why this way
    A stereographic chart maps circles to circles, and in it the chord between two directions is
    ``|Δz|·√(a₁·a₂)``, *exactly*, with a the local scale. So a sum of Gaussians of the chord is a
    sum of Gaussians of the chart, with weights that go with √a of either end: a pyramid whose work
    does not grow with the kernel's reach, and whose circles stay round anywhere in the field.
Instead of
    a Fourier transform, which is shift-invariant in pixels, hence wrong by ``1/cos²`` off the axis,
    and slower; Gaussian blurs of the picture, wrong likewise.
Sources
    Burt and Adelson 1983 (the pyramid); Unser 1999 (B-splines and their two-scale relation).
"""
