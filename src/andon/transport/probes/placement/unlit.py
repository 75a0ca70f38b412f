"""From places to a volume, which light is still to be put into."""

from __future__ import annotations

from andon.files.volumes.model import ProbeVolume
from andon.scene import Scene
from andon.transport.probes.placement.model import Placed
from andon.transport.probes.placement.zones import zones_of

__all__ = ["unlit_volume"]


def unlit_volume(scene: Scene, placed: Placed, /) -> ProbeVolume:
    """The volume that a bake of `scene` fills: its probes and zones, without states and cells.

    Raises `InputError` for a zone without a probe.
    """
    return ProbeVolume(
        positions=placed.positions,
        capture_positions=placed.capture_positions,
        names=placed.names,
        roles=placed.roles,
        ranges_m=placed.ranges_m,
        states={},
        zones=zones_of(scene, placed.positions),
        photometry=scene.photometry,
    )
