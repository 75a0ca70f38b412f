"""What is made once and read by frames: light probes.

What
    `bake_probes` captures the light at every placed probe and gives a `ProbeVolume`; `bake_file`
    does so for a scene file and writes the volume that its [probes] names.
How the bounces go
    The first light is what emits by itself and the sky, V₀. What lamps give directly is added once,
    as they reach a surface; each bounce lights all surfaces with the probes of the one before::

        V_k = emitted + ρ/π·(E_lamps + E(V_{k−1}))            state = V_bounces + ambient

    with E(V) looked up between the probes, walls in mind. So the sky reaches a surface through the
    probes around it, and a room has no sky in it. The photograph's own light holds its reflections
    already and is never reflected again.
Who computes the bounces
    The probes themselves, as above, are quick, and wrong where light changes between them: what
    bounces add is 18 % off with 2³ probes in a box with coloured walls, 4 % with 4³ of them near
    the walls. Or Radiance (``bounces_by``), in one pass at the points that the probes see, which
    asks nothing of other probes: 2 % off in its quickest quality (`andon verify probes.bounces`).
Why two sizes of cube maps
    Light is linear: what a bounce adds can be captured alone. It has no edges of shadows in it, and
    pictures of 32² hold it as well as those of 128², at a sixteenth of the lookups.
Why a journal
    A bake takes minutes to hours and is stopped, killed or out of disk at any moment. Each probe's
    result is one file, named by all that it depends on, written under another name and renamed: a
    bake that begins again finds what is done, and gives the same bytes.

Sources: Ramamoorthi & Hanrahan 2001 (irradiance from nine coefficients); Greger et al. 1998 (the
irradiance volume, and bounces through it).
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from andon.bake.bake import Baked, bake_probes
    from andon.bake.report import BakeReport
    from andon.bake.runner import Progress
    from andon.bake.to_file import Written, bake_file, placed_in

__all__ = [
    "BakeReport",
    "Baked",
    "Progress",
    "Written",
    "bake_file",
    "bake_probes",
    "placed_in",
]

# Where each is: loaded when it is asked for, since workers that do `andon.bake.tasks` start often
# and need none of it.
_MODULES = {
    "BakeReport": "report",
    "Baked": "bake",
    "Progress": "runner",
    "Written": "to_file",
    "bake_file": "to_file",
    "bake_probes": "bake",
    "placed_in": "to_file",
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'andon.bake' has no attribute {name!r}")
    return getattr(import_module(f"andon.bake.{_MODULES[name]}"), name)
