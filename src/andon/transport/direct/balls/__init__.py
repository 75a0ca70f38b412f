"""Shadow and caustic of glass balls in the light of small lamps.

What
    A ball takes from a lamp's light what falls on it, and gives it back refracted: a shadow with a
    bright cusp in it. Both are one thing, so that light is neither lost nor made.

::

                        ╭─────╮            A ray that passes the centre at the distance b (in
     lamp      i ╲ ╱────│──── │            radii) leaves the ball at the same distance from it,
       ●─────────╱──────│─ ● ─│─▶ axis     turned by twice what one surface turns it, 2·(i − r),
        ╲  θ    ╱ ╲     │   ╲ │ρ           sin i = b, sin r = b/n. So it meets the sphere of
              1/v_l     ╰────ψ╯            radius ρ around the centre at the angle

    ``ψ(b) = asin(b/ρ_lamp) + asin(b/ρ) − 2·asin(b) + 2·asin(b/n)``

    from the axis: a closed form, the same with lamp and receiver exchanged. What has the impact
    parameter b … b + db carries ``(1 − F)²·exp(−2a·√(1 − b²/n²))·2πb·db/cos θ`` of the light of a
    unit disk, F Fresnel's reflectance for unpolarised light.
Why a table
    ψ(b) turns back where the caustic is, and E = dΦ/dA is infinite there. Inverting it in each
    pixel needs up to three roots for each channel, and gives fireflies. The table has *means over
    cells* of 1/ρ and a function of ψ instead: each holds exactly the flux that falls into it. Every
    ray that leaves the ball crosses every concentric sphere once, also those that are turned by
    more than a right angle, so every row holds all of the flux.

==============================  ===============  =============  ==================================
table over                      reads a pixel    to make        what it misses
==============================  ===============  =============  ==================================
distance and height of planes   4                the same       rays turned past 90° and planes
                                                                that cut the ball
exit rays, inverted per pixel   some 100         < 1 ms         infinite on the caustic
**concentric spheres**          4                see `table`    nothing; the mean direction stands
                                                                for up to three
photons                         4                seconds        noise
==============================  ===============  =============  ==================================

    A cell is 2.6 mrad wide at the axis and 4 mrad at ψ = 0.2: what a lamp of 3 or 4 mm does at a
    metre. The fourth channel leads to where the light of a cell goes in the mean, and so to its
    impact parameter b and to where it comes from (asin(b/ρ_lamp) off the axis): the cosine at the
    receiver, and the intensity of a spot or luminaire, are those of the refracted ray.
    Seen closer than that (pixels below 1/200 of the radius) the caustic's rim has steps of a cell.
Not served
    Lamps with an area, and `visible_radius_m`: all lamps here are points (or far away). What the
    ball *reflects* (4 % and the second rainbow), and light that lamps send through the ball onto
    another ball's light: of two balls in a row the one nearer to the receiver bends the light, the
    other one only dims it. Other things hide refracted light where they hide the straight line to
    the lamp; nothing hides it where the lamp does not shine straight (from behind, or beside its
    cone). A lamp inside a ball shines as if the ball were not there.

Sources: van de Hulst 1957, section 12.2 (rays through a sphere); the journal article of the glass
paper has the caustic as an illusion, without a formula.
"""

from andon.transport.direct.balls.model import GLASS, GlassBall

__all__ = ["GLASS", "GlassBall"]
