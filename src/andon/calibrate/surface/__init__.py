"""The illuminance–RGB model of real surfaces, from photographs in known light.

For every surface and channel a rising curve f: illuminance → what the camera delivers, linear. A
surface has texture, and nobody knows it; but the *same pixels* in several lights share theirs::

    linear_c(pixel, photograph) = a_c(pixel) · f_c(E_c(pixel, photograph)),    mean of a_c = 1

==============================  ==================================================================
choice                          why not the other
==============================  ==================================================================
**texture times curve, in       a curve through all pixels takes dark texture for little light;
turn, until both stand still**  ratios of neighbours lose the absolute level
**relative errors, with a       logarithms have no zero, and shadows have
floor**
**bisquare weights**            highlights, shadows that move, people
**knots, then isotonic          a polynomial rises nowhere by itself; a power has no shoulder
regression**
==============================  ==================================================================

Limits: a surface that mirrors is no function of illuminance, and the residual says so. Photographs
whose illuminance differs by the same factor everywhere fix f at steps of that factor; between them
it is the smoothest. One photograph cannot tell texture from light: a is 1.

Sources: the paper on relighting, section 2 (the *illuminance–RGB model*); Ayer et al. 1955 for the
regression; Beaton & Tukey 1974 for the weights.
"""

from andon.calibrate.surface.fit import fit_surface
from andon.calibrate.surface.model import KnownLight, SurfaceFit

__all__ = ["KnownLight", "SurfaceFit", "fit_surface"]
