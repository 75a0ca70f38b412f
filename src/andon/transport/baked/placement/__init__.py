"""Where illuminance maps are seen from, so that together they cover the surface.

What
    `suggested_views` finds cameras; `check_view_sees` refuses a stated one that sees nothing;
    `plan_picture` shows people what was found, and what no camera sees.
Why so
    The frame's own cameras come first: what they show is sampled best by maps from the same
    place. The rest is a set cover: of hundreds of places in free space, looked around from, the one
    that adds most is taken until the stated share is seen.

=========  ====================================================================================
module     does
=========  ====================================================================================
samples    points of the surface that stand for equal areas, each with two sides
space      places in free space
sight      which sides an eye sees, and how long texels are there
greedy     the place that adds most
frames     maps from the frame's cameras
choose     takes cameras until enough is seen
suggest    all of it
check      a camera that sees nothing
plan       a picture of it
=========  ====================================================================================

Terms
    *Reachable*: a side of the surface that is seen from at least one place in free space. Backs
    of walls and the inside of solids never are, and do not count.
    *Seen well*: in the picture, not hidden, and in texels that are not longer on the surface than
    the limit (`sight`, `suggest`).
"""

from andon.transport.baked.placement.check import check_view_sees
from andon.transport.baked.placement.model import Ended, Suggested
from andon.transport.baked.placement.plan import plan_picture
from andon.transport.baked.placement.suggest import suggested_views

__all__ = ["Ended", "Suggested", "check_view_sees", "plan_picture", "suggested_views"]
