"""Probe volumes as pictures: balls that show their light, the cells between them, the hull.

What
    `probe_picture` draws what a volume holds as `around_view` or another pinhole view sees it,
    over the scene in plain shades.
Why an own small painter
    A few hundred lines and balls over one layer of ray-cast surfaces need no GPU, no window and no
    plotting library; and each pixel of a ball is evaluated, not a mesh's corner.

=========  ====================================================================================
part       drawn as
=========  ====================================================================================
balls      luminance (or irradiance/π) in the direction of the normal, smoothed as little as
           leaves none negative: a series of nine numbers swings below 0 opposite to a lamp, and
           its clipped swings look like black holes; the ring is the role
cells      edges of the tetrahedra, fainter with distance, through surfaces very faint
hull       its edges, and a veil that is thicker at the rim
graph      lines between the middles of cells that share a face
zones      boxes
=========  ====================================================================================

Terms
    *White*: the luminance that is shown as the screen's white; chosen so that 3 % of what the
    balls show is above it, and said in the legend.
"""

from andon.display.probe_pictures.legend import STRIP_PX
from andon.display.probe_pictures.model import PARTS, Look, Part, ProbePicture
from andon.display.probe_pictures.picture import around_view, framed_points, probe_picture

__all__ = [
    "PARTS",
    "STRIP_PX",
    "Look",
    "Part",
    "ProbePicture",
    "around_view",
    "framed_points",
    "probe_picture",
]
