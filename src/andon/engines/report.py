"""What is worth knowing about a frame besides its pictures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

import numpy as np

from andon.engines.measured import beyond_curves_of, curved_pixels
from andon.glass.layers import Layered
from andon.glass.report import GlassReport
from andon.quantities import CameraFrame, Illuminance, Surface
from andon.transport.baked.model import BakedSeen

if TYPE_CHECKING:
    from andon.engines.moment import Moment
    from andon.engines.prepared import Prepared

__all__ = ["Report", "report_of"]


class _Engine(Protocol):
    name: str
    adapter: str
    maps_redrawn: int


@dataclass(frozen=True)
class Report:
    """What is worth knowing about a frame besides its pictures.

    Attributes
    ----------
    engine, adapter : what drew it.
    photometry : ``absolute`` or ``relative``, of every number in the frame.
    hole_pixels, clipped_pixels : without geometry (unchanged), and at the sensor's end.
    occluder_triangles, occluder_triangles_before, occluder_error_m, occluder_lost_share : of the
        shadow geometry; the error is the 95th percentile of what decimation moved, in metres, and
        the lost share is what of the real surface has no shadow geometry where it stands.
    shadow_bias_m : shadows thinner than this are lost on the real surface, or on the GPU thinner
        than a texel of the shadow map.
    maps_redrawn : shadow maps of lamps that had moved.
    stage_seconds : wall time of each stage.
    ignored_tables : tables and keys of the scene that this version does not draw.
    glass : where the layers of glass appear and what is in focus; None without glass.
    uncovered_share : of the pixels that take baked light, those that no illuminance map sees;
        None without [baked].
    beyond_curve_share : of the real pixels whose surface has a curve, those that are brighter or
        darker than it was measured, as captured or as relit: there it goes straight on. None
        without [[surface.response]].
    """

    engine: str
    adapter: str
    photometry: str
    hole_pixels: int
    clipped_pixels: int
    occluder_triangles: int
    occluder_triangles_before: int
    occluder_error_m: float
    occluder_lost_share: float
    shadow_bias_m: float
    maps_redrawn: int
    stage_seconds: Mapping[str, float] = field(default_factory=dict[str, float])
    ignored_tables: tuple[str, ...] = ()
    glass: GlassReport | None = None
    uncovered_share: float | None = None
    beyond_curve_share: float | None = None


def report_of(
    prepared: Prepared,
    engine: _Engine,
    moment: Moment,
    captured: CameraFrame,
    surface: Surface,
    illuminance: Illuminance,
    layered: Layered | None,
    baked: BakedSeen | None,
    /,
) -> Report:
    """The report of a view that `engine` has drawn; without times."""
    model, glass = prepared.surface, prepared.glass
    clipped = 0 if captured.clipped is None else int(captured.clipped.sum())
    return Report(
        engine=engine.name,
        adapter=engine.adapter,
        photometry=prepared.photometry,
        hole_pixels=surface.holes,
        clipped_pixels=clipped,
        occluder_triangles=len(model.shadow_casters.triangles),
        occluder_triangles_before=model.occluder.triangles_before + len(model.casters.triangles),
        occluder_error_m=model.occluder.error_m,
        occluder_lost_share=model.occluder.lost_share,
        shadow_bias_m=model.bias.real_m,
        maps_redrawn=engine.maps_redrawn,
        ignored_tables=prepared.ignored,
        glass=glass.report(layered, moment.focus, moment.lamps) if glass and layered else None,
        uncovered_share=None if baked is None else baked.uncovered_share,
        beyond_curve_share=_beyond_curve_share(prepared, captured, surface, illuminance),
    )


def _beyond_curve_share(
    prepared: Prepared, captured: CameraFrame, surface: Surface, illuminance: Illuminance
) -> float | None:
    beyond = beyond_curves_of(prepared, captured, illuminance.lux)
    if beyond is None:
        return None
    own = curved_pixels(prepared.measured.get(captured.view.name)) & ~surface.is_object
    return float(np.count_nonzero(beyond & own) / max(np.count_nonzero(own), 1))
