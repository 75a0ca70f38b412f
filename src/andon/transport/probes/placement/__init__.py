"""Where light is captured: places for probes, before anything is captured.

What
    `place_probes` turns a scene's [probes] table and its still geometry into places with names,
    roles and ranges.
Why so many ways
    Few probes in the right places beat many in a grid, and the right places are known to whoever
    built the scene. The rest is for scenes that nobody looked at yet.

==========  ===============================================  ==================================
kind        places                                           what it is for
==========  ===============================================  ==================================
hand        [[probes.place]]; counts with every other kind   a dozen probes with a meaning
nodes       locators of a glTF file, ``probe_sky.001``       the same, from a modelling program
vertices    off the surface, along its normals               detail where geometry has detail
lattice     corners of equal boxes                           the baseline; what is pruned later
random      in free space, by chance                         baselines; test points
==========  ===============================================  ==================================

Terms
    *Inside a wall* is what sees mostly backs of surfaces (`walls`). Probes of an author are kept
    there and named; generated ones are moved out or left out, and counted.
    *Clear* is what no surface is nearer to than the offset (`clearance`): lattices and random
    places are, places off vertices keep the offset to their own vertex only. Probes of an author
    nearer than a centimetre are named.
    *Capture position*: where the six pictures are taken, while the light counts at the position.
    What is by hand is judged at the former.

Sources: Cook 1986 (dart throwing); Majercik et al. 2021 (backs seen, moved probes).
"""

from andon.transport.probes.placement.model import Panorama, Placed, Tally
from andon.transport.probes.placement.place import place_probes
from andon.transport.probes.placement.unlit import unlit_volume
from andon.transport.probes.placement.walls import Sight, Walls
from andon.transport.probes.placement.written import locators, nearest_distances_m, place_tables
from andon.transport.probes.placement.zones import zones_of

__all__ = [
    "Panorama",
    "Placed",
    "Sight",
    "Tally",
    "Walls",
    "locators",
    "nearest_distances_m",
    "place_probes",
    "place_tables",
    "unlit_volume",
    "zones_of",
]
