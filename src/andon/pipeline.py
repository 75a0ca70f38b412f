"""The order of light, on one screen.

::

    capture ─CameraFrame▶ see ─Surface▶ illuminate ─Illuminance▶ compose ─Luminance▶ glass
                       DisplayImage ◀─ encode ◀─Luminance─ glow or glare ◀─Luminance─┘

One frame, one or two views: what does not depend on the eye (geometry, lamps, shadow maps) is
shared, the rest is done per view.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from time import perf_counter
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from andon.display.model import Seen
from andon.engines.prepared import Prepared, prepare
from andon.engines.report import Report, report_of
from andon.errors import InputError, MachineError, nearest_name
from andon.glass.layers import Layered
from andon.quantities import (
    CameraFrame,
    DisplayImage,
    Illuminance,
    Luminance,
    Photometry,
    Surface,
)
from andon.responses import SRGB, Response, SurfaceCurve
from andon.scene import Scene
from andon.spaces import View
from andon.transport.baked.model import BakedSeen

if TYPE_CHECKING:
    from andon.composite.confidence import Confidence
    from andon.lamps import Lamp

__all__ = ["ENGINES", "Frame", "Renderer", "Report", "relight", "render"]

EngineName = Literal["auto", "gpu", "reference"]
ENGINES = ("auto", "gpu", "reference")


@dataclass(frozen=True)
class Frame:
    """One view of one moment: every quantity that flowed, as arrays (H, W, …).

    Attributes
    ----------
    captured : the photograph as linear light.
    surface : what is where; which pixels are holes or virtual objects.
    illuminance : ΔE that the lamps add, lx.
    luminance : what leaves towards the camera, cd/m².
    image : 8-bit codes for the screen; of an optical see-through display its own.
    report : engine, times, holes and what else is worth knowing.
    bodies : luminance of luminous bodies and visible lamps alone, cd/m²; None without any.
    glow : the same as the glow filters it; None without a glow.
    glare : what the eye of [observer] adds: veil, halo and needles, cd/m²; None without glare.
    glass : the images that glass shows, sharp; None without glass.
    highlights : mirrored lamps alone, cd/m²; None where nothing mirrors.
    seen : what the eye gets through an optical see-through display; None for a video one.
    baked : what the illuminance maps give, which `illuminance` holds; None without [baked].
    prepared : what it was drawn of.
    """

    captured: CameraFrame
    surface: Surface
    illuminance: Illuminance
    luminance: Luminance
    image: DisplayImage
    report: Report
    bodies: Luminance | None = None
    glow: Luminance | None = None
    glare: Luminance | None = None
    seen: Seen | None = None
    glass: Layered | None = None
    highlights: Luminance | None = None
    baked: BakedSeen | None = None
    prepared: Prepared | None = field(default=None, repr=False)

    @cached_property
    def confidence(self) -> Confidence:
        """How far each pixel may be trusted, and why not; made when it is first asked for."""
        from andon.engines.confidence import confidence_of_frame

        return confidence_of_frame(self)


class Renderer:
    """Draws a scene as often as wanted; everything costly is made once.

    Parameters
    ----------
    scene : from `andon.load_scene` or `andon.scene_from_dict`; or what `prepare` made of one.
    engine : ``auto`` takes the GPU where an adapter is found, else the reference.

    Raises
    ------
    InputError
        for files and numbers that do not fit.
    MachineError
        for ``engine="gpu"`` without an adapter.
    """

    def __init__(self, scene: Scene | Prepared, engine: EngineName = "auto") -> None:
        start = perf_counter()
        self.prepared = scene if isinstance(scene, Prepared) else prepare(scene)
        prepared = perf_counter()
        self._engine = _make_engine(engine, self.prepared)
        self.setup_seconds = {"read": prepared - start, "set up": perf_counter() - prepared}

    @property
    def engine_name(self) -> str:
        """``gpu`` or ``reference``."""
        return self._engine.name

    @property
    def view_names(self) -> tuple[str, ...]:
        """``("mono",)`` or ``("left", "right")``."""
        return tuple(self.prepared.frames)

    def draw(
        self, time_seconds: float = 0.0, view: str | None = None, *, timed: bool = False
    ) -> tuple[Any, ...]:
        """Draws one view and waits; returns the engine's handles, for `Frame` or a screen.

        With `timed`, each stage is waited for and its seconds are put into `stage_seconds`.
        """
        engine, prepared = self._engine, self.prepared
        frame = prepared.frames[self._view_name(view)]
        clock = _Clock(engine.finish if timed else None)
        moment = prepared.at(time_seconds)
        seen = clock.time("surface", lambda: engine.see(frame.view.name, moment))
        light = clock.time("direct", lambda: engine.illuminate(seen, moment))
        luminance = clock.time("composite", lambda: engine.compose(frame, seen, light, moment))
        if prepared.glass is not None:
            behind = luminance
            luminance = clock.time("glass", lambda: engine.glass_over(frame, seen, behind, moment))
        if prepared.glow is not None:
            composed = luminance
            luminance = clock.time("glow", lambda: engine.glow(frame, seen, composed, moment))
        elif prepared.glare is not None:
            sharp = luminance
            luminance = clock.time("glare", lambda: engine.glare(frame, seen, sharp, moment))
        image = clock.time("display", lambda: engine.encode(frame, luminance))
        engine.finish()
        self.stage_seconds = clock.seconds
        self._moment = moment
        return seen, light, luminance, image

    def render(self, time_seconds: float = 0.0, view: str | None = None) -> Frame:
        """Draws one view and returns every quantity as arrays.

        Parameters
        ----------
        time_seconds : moment of the session; lamps move by it.
        view : ``mono``, ``left`` or ``right``; None is the rig's first.
        """
        handles = self.draw(time_seconds, view, timed=True)
        engine, moment = self._engine, self._moment
        surface, illuminance, luminance, image = engine.read(*handles)
        frame = self.prepared.frames[self._view_name(view)]
        layered = engine.read_glass(frame, handles[0], moment)
        baked = engine.read_baked(surface, moment)
        bodies, filtered = engine.read_bodies(frame, handles[0], moment)
        report = report_of(
            self.prepared, engine, moment, frame, surface, illuminance, layered, baked
        )
        return Frame(
            self.prepared.captured(frame.view.name),
            surface,
            illuminance,
            luminance,
            image,
            replace(report, stage_seconds=self.stage_seconds),
            bodies,
            filtered,
            engine.read_glare(frame),
            engine.read_seen(frame, *handles[2:]),
            layered,
            engine.read_highlights(frame),
            baked,
            self.prepared,
        )

    def picture(self, time_seconds: float = 0.0, view: str | None = None) -> NDArray[np.uint8]:
        """Draws one view and returns its 8-bit codes (H, W, 3) alone, which is faster."""
        return self._engine.picture(self.draw(time_seconds, view)[-1]).rgb

    def point_at(
        self, column: float, row: float, time_seconds: float, view: str | None = None
    ) -> None:
        """Tells a gaze of source ``mouse`` where the pointer is, in pixels of a view.

        On what sticks to the glass it looks at the surface, on clear glass through it, and beside
        the glass at what is there. Raises `InputError` where the scene's gaze is another.
        """
        glass = self.prepared.glass
        pointer = None if glass is None or glass.gaze is None else glass.gaze.pointer
        if glass is None or pointer is None:
            raise InputError(
                "needs a scene with glass and a gaze of source 'mouse'", field="gaze.source"
            )
        frame = self.prepared.frames[self._view_name(view)]
        pointer.point(time_seconds, glass.distance_under(frame.view, column, row))

    def close(self) -> None:
        """Lets go of what listens: a gaze over the network. Drawing goes on without it."""
        glass = self.prepared.glass
        if glass is not None and glass.gaze is not None:
            glass.gaze.close()

    def _view_name(self, view: str | None) -> str:
        if view is None:
            return self.view_names[0]
        if view not in self.view_names:
            near = nearest_name(view, list(self.view_names))
            raise InputError(
                f"there is no view {view!r}, this rig has {' and '.join(self.view_names)}",
                field="view",
                remedy=f"did you mean {near!r}?" if near else None,
            )
        return view


def render(
    scene: Scene,
    time_seconds: float = 0.0,
    view: str | None = None,
    *,
    engine: EngineName = "auto",
) -> Frame:
    """One frame of `scene`, all quantities as arrays; see `Renderer` for several.

    >>> frame = andon.render(andon.load_scene("room.toml"))       # doctest: +SKIP
    >>> frame.illuminance.lux.shape, frame.image.rgb.dtype        # doctest: +SKIP
    ((500, 741, 3), dtype('uint8'))
    """
    return Renderer(scene, engine).render(time_seconds, view)


def relight(
    photo: NDArray[Any],
    view: View,
    lamps: Sequence[Lamp],
    /,
    *,
    depth_m: NDArray[Any],
    ambient_lux: float | Sequence[float] | NDArray[Any],
    dimming: float | Sequence[float] = 1.0,
    response: Response = SRGB,
    photometry: Photometry = "absolute",
    engine: EngineName = "auto",
    reflectance_map: NDArray[Any] | None = None,
    curves: SurfaceCurve | Sequence[tuple[SurfaceCurve, NDArray[np.bool_]]] = (),
) -> Frame:
    """Relights arrays: for those who have a picture and its depth in memory already.

    Parameters
    ----------
    photo : (H, W, 3) uint8 or uint16, encoded by `response`; or float, linear.
    view : where its pixels look, without distortion.
    lamps : a list of `PointLamp`, `SpotLamp`, `GoniometricLamp`, `SphereLamp`, `DiskLamp`,
        `PolygonLamp`, `TubeLamp`, `MeshLamp`, `DirectionalLamp`, `SkyLamp`, `HemisphereLamp`.
    depth_m : (H, W) metres along the optical axis; NaN, 0 and infinity are holes.
    ambient_lux : E0 that the photograph was taken in: number, three channels or (H, W, 3), > 0.
    dimming : share of E0 that is left, ≥ 0; number or three channels.
    reflectance_map : (H, W, 3) linear ρ in [0, 1], that added light falls on where E0 is too weak
        for the photograph to tell it; None: only the photograph tells.
    curves : of the whole picture, or pairs of a surface's curve and its pixels (H, W) bool; where
        masks overlap the later one counts.

    Raises
    ------
    InputError
        where sizes do not fit or numbers are out of range.
    """
    from andon.engines.arrays import listed, prepare_arrays

    prepared = prepare_arrays(
        photo,
        view,
        listed(lamps),
        depth_m=depth_m,
        ambient_lux=ambient_lux,
        dimming=dimming,
        response=response,
        photometry=photometry,
        reflectance_map=reflectance_map,
        curves=curves,
    )
    return Renderer(prepared, engine).render()


def _make_engine(name: str, prepared: Any) -> Any:
    from andon.engines.reference import ReferenceEngine

    if name not in ENGINES:
        raise InputError(f"must be one of {', '.join(ENGINES)}, got {name!r}", field="engine")
    if name == "reference":
        return ReferenceEngine(prepared)
    from andon.engines.gpu import GpuEngine

    try:
        return GpuEngine(prepared)
    except MachineError:
        if name == "gpu":
            raise
        return ReferenceEngine(prepared)


class _Clock:
    """Wall time of named steps; `settle` is called after each so that its work is done."""

    def __init__(self, settle: Any | None) -> None:
        self.settle = settle
        self.seconds: dict[str, float] = {}

    def time(self, name: str, step: Any) -> Any:
        start = perf_counter()
        result = step()
        if self.settle is not None:
            self.settle()
        self.seconds[name] = perf_counter() - start
        return result
