"""What an area lamp gives without shadows: projected solid angles, horizon included.

The illuminance of a receiver by a Lambertian lamp of one luminance L is E = L·F, where F is the
lamp's *projected solid angle*, ∫ cos φ dω over what is seen of the lamp above the receiver's
horizon, in sr, 0…π. It is pure geometry, and by Stokes's theorem an integral along the lamp's
outline alone (Lambert 1760; Arvo 1995):

    F = ½ · n · ∮ (x × dx) / |x|²        x runs from the receiver along the outline

An outline that dips below the horizon is cut there, and closed along the horizon circle, where
the integrand is the azimuth's differential: the closure is half an angle.

========== ============================================ =====================================
lamp       outline as the receiver sees it              closed form
========== ============================================ =====================================
polygon    straight edges                               an angle each (Lambert 1760;
                                                        Baum, Rushmeier & Winget 1989)
mesh       those of its facets; shared edges cancel     the same
sphere     a small circle                               Lagarde & de Rousiers 2014
tube       two small-circle arcs and two straight edges arcs and edges, one closure
disk       an *elliptic* cone unless it faces the       Kepler's: true against eccentric
           receiver                                     anomaly, and one logarithm
========== ============================================ =====================================

The disk needs no ellipse fit: along the rim, |x|² = D + E cos t is an orbit's equation, so that
∫ dt/|x|² is elementary for every arc, and the horizon cuts the rim where n·x = 0, a cosine.

=============================== ========================= =====================================
instead of                      costs                     why not
=============================== ========================= =====================================
a most representative point     one evaluation            no horizon: −62 % at 88° for a sphere
linearly transformed cosines    a table, then a polygon   exact for polygons only, and those
                                                          need no table with a diffuse receiver
samples on the lamp             64 and more               noise or bands, 1 % at best
a fine polygon for a round lamp 100 edges for 10⁻³        an arc is cheaper than its chords
=============================== ========================= =====================================

All functions: `position`, `normal` (..., 3) in metres and unit vectors, vectorised over leading
axes; results (...) in sr. One-sided lamps give 0 behind their plane and in it. At or inside the
surface of a sphere or a tube the receiver gets what it would get *on* it, π·(1 + cos φ)/2 with φ
the angle between its normal and the way inwards, so that results are finite everywhere. Accuracy:
10⁻⁶ of truth, near the horizon of what the lamp gives at cos φ = 0.05, for lamps of 10⁻⁴ of
their distance to contact; the tests hold them against quadratures.
"""

from andon.lamps.form_factors.disks import disk_factor
from andon.lamps.form_factors.polygons import edge_factor, edges_factor, mesh_factor, polygon_factor
from andon.lamps.form_factors.spheres import sphere_factor
from andon.lamps.form_factors.tubes import tube_factor

__all__ = [
    "disk_factor",
    "edge_factor",
    "edges_factor",
    "mesh_factor",
    "polygon_factor",
    "sphere_factor",
    "tube_factor",
]
