"""How the eye spreads the light of a point: one family of functions of the angle.

What
    ``f(θ)`` in sr⁻¹: luminance that is seen θ away from a point source, per lux of it at the eye.
Parts
    *Bloom* is neutral and falls with the angle; *halo* is a coloured ring. Flare needles are not a
    function of θ alone; `andon.glare.needles` has them.
"""
