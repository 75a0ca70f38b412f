"""What both engines work on: a scene with its files read."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from andon.capture.still import frame_from_picture
from andon.composite.model import Ambient
from andon.display.model import Exposure
from andon.errors import InputError
from andon.files.cameras import read_camera
from andon.files.pictures import Picture, read_picture
from andon.glow.automatic import glow_from_table
from andon.glow.model import Glow
from andon.lamps import AreaLamp, Body, Lamp, PointLamp, resolve_bodies, resolve_lamps
from andon.lamps.sources import resolve_sources
from andon.quantities import CameraFrame, Photometry, photometric
from andon.responses import LINEAR, SRGB, Response
from andon.scene import Scene
from andon.spaces import View
from andon.surface.inside import is_buried
from andon.surface.load import load_surface
from andon.surface.model import SurfaceModel
from andon.transport.direct.casters import OBJECTS, REAL, Casters

__all__ = ["Prepared", "prepare"]

# Tables and keys that the schema has and this version does not draw; a frame says so.
LATER_TABLES = ("baked", "probes", "glass", "gaze")

LATER_KEYS = {
    "surface": ("response", "reflectance_map"),
    "capture": ("clipped_luminance_cd_m2", "depth", "pose", "gaze", "noise"),
    "atmosphere": ("mist",),
    "observer": ("age", "pigment", "pupil_mm", "glasses"),
    "glare": ("renderer", "highlights", "halo", "needles", "adaptation"),
    "display": ("peak_luminance_cd_m2", "transmittance"),
}


def nobody(time_seconds: float, /) -> tuple[Body, ...]:
    """No luminous bodies at any time."""
    return ()


@dataclass(frozen=True)
class Prepared:
    """A scene with its files read, or arrays in their place: ready to be drawn.

    Attributes
    ----------
    frames : view name → captured light; one or two views.
    surface : geometry of the scene.
    ambient : the light of the photograph.
    lamps : time in seconds → the lamps of that moment; always the same names and kinds.
    bodies : time in seconds → the luminous bodies of that moment; always the same names and
        triangles.
    exposure : settings of the display.
    glow : of luminous bodies, or None.
    photometry : the word that every number carries.
    ignored : tables of the scene that this version does not draw.
    sources : names of the known lamps of E0, which `lamps` has with positive and negative light.
    """

    frames: Mapping[str, CameraFrame]
    surface: SurfaceModel
    ambient: Ambient
    lamps: Callable[[float], tuple[Lamp, ...]]
    bodies: Callable[[float], tuple[Body, ...]] = nobody
    exposure: Exposure = field(default_factory=Exposure)
    glow: Glow | None = None
    photometry: Photometry = "absolute"
    ignored: tuple[str, ...] = ()
    sources: tuple[str, ...] = ()

    def casters(self, bodies: Sequence[Body]) -> Casters:
        """What casts shadows while the luminous bodies are where they are."""
        groups = [(REAL, self.surface.occluder.geometry), (OBJECTS, self.surface.casters)]
        groups += [(body.name, body.geometry) for body in bodies]
        return Casters(tuple(groups))


def prepare(scene: Scene, /) -> Prepared:
    """Reads all that `scene` names. Raises `InputError` for whatever does not fit."""
    pictures = _pictures(scene)
    views = {name: _view(scene, name, picture) for name, picture in pictures.items()}
    ambient = _ambient(scene, views)
    surface = load_surface(scene, views)
    per_unit = _luminance_per_unit(scene, ambient)
    frames = {
        name: frame_from_picture(
            picture,
            views[name],
            _response(scene, picture),
            luminance_per_unit=per_unit,
            file=_source(scene, name)[0],
        )
        for name, picture in pictures.items()
    }
    eye = next(iter(frames.values())).view.position
    virtual = _virtual_groups(scene)
    lamps = (*resolve_lamps(scene, 0.0), *resolve_sources(scene, 0.0, virtual))
    _check_lamps(scene, lamps, surface, eye)
    return Prepared(
        frames=frames,
        surface=surface,
        ambient=ambient,
        lamps=lambda time_seconds: (
            *resolve_lamps(scene, time_seconds),
            *resolve_sources(scene, time_seconds, virtual),
        ),
        bodies=lambda time_seconds: resolve_bodies(scene, time_seconds),
        exposure=_exposure(scene),
        glow=_glow(scene),
        photometry=scene.photometry,
        ignored=_ignored(scene),
        sources=tuple(table.name for table in scene.ambient.source) if scene.ambient else (),
    )


def _virtual_groups(scene: Scene) -> frozenset[str]:
    """Caster groups that the photograph did not have: virtual objects, and bodies of lamps."""
    bodies = [body.name for body in resolve_bodies(scene, 0.0)]
    casting = any(table.casts_shadow for table in scene.object)
    return frozenset([*bodies, *([OBJECTS] if casting else [])])


def _ignored(scene: Scene) -> tuple[str, ...]:
    """Tables and keys that the scene states and this version does not draw."""
    tables = [name for name in LATER_TABLES if getattr(scene, name)]
    keys: list[str] = []
    for table, names in LATER_KEYS.items():
        stated = getattr(scene, table)
        keys += [f"{table}.{n}" for n in names if stated and n in stated.model_fields_set]
    return (*tables, *keys)


def _source(scene: Scene, name: str) -> tuple[str, str]:
    """The path of a view's picture, and the field that names it."""
    source = scene.capture.source if scene.capture else None
    if source is None:
        raise InputError(
            "is missing: there is no picture to relight",
            file=scene.file,
            field="capture.source",
            remedy='add [capture] with source = "photo.png"',
        )
    if isinstance(source, str):
        return str(scene.path(source, "capture.source")), "capture.source"
    field = f"capture.source.{name}"
    return str(scene.path(getattr(source, name), field)), field


def _pictures(scene: Scene) -> dict[str, Picture]:
    if scene.rig is None or not scene.rig.cameras:
        raise InputError(
            "is missing: nothing says where the pixels look",
            file=scene.file,
            field="rig.camera",
            remedy="add [rig.camera] with file, fx or hfov_degrees",
        )
    if scene.rig.trajectory is not None:
        raise InputError(
            "is in the schema but not rendered yet",
            file=scene.file,
            field="rig.trajectory",
            remedy="state rig.camera.world_from_camera",
        )
    names = [name for name, _ in scene.rig.cameras]
    shared = scene.capture is not None and isinstance(scene.capture.source, str)
    if len(names) > 1 and shared:
        raise InputError(
            "is one picture for two eyes",
            file=scene.file,
            field="capture.source",
            remedy="give { left = …, right = … }",
        )
    return {name: read_picture(_source(scene, name)[0]) for name in names}


def _view(scene: Scene, name: str, picture: Picture) -> View:
    assert scene.rig is not None
    camera = dict(scene.rig.cameras)[name]
    height, width = picture.shape
    if camera.file is None:
        try:
            view = camera.view(name, width=width, height=height)
        except InputError as error:
            raise InputError(
                error.rule, file=scene.file, field=error.field, remedy=error.remedy
            ) from error
    else:
        field = f"rig.{'camera' if name == 'mono' else name}.file"
        view = read_camera(scene.path(camera.file, field), size=(width, height))
        view = replace(view, name=name)
        if camera.has_pose:
            view = replace(view, world_from_camera=camera.pose())
    undistort = scene.capture is None or scene.capture.undistort
    if view.distortion and not undistort:
        raise InputError(
            "false is in the schema but not rendered yet",
            file=scene.file,
            field="capture.undistort",
            remedy="leave it out: pictures are undistorted",
        )
    return view


def _response(scene: Scene, picture: Picture) -> Response:
    table = scene.capture.response if scene.capture else None
    if picture.encoding == "linear":
        if table is not None and table.kind != "linear":
            raise InputError(
                f"must be linear for an HDR picture, got {table.kind!r}",
                file=scene.file,
                field="capture.response",
                remedy="leave it out",
            )
        # HDR light is shown as sRGB: g is what a display needs, g⁻¹ was never applied.
        return SRGB
    if table is None:
        return SRGB
    if table.kind == "gamma":
        return Response("gamma", gamma=table.gamma or 2.2)
    if table.kind == "curve":
        from andon.files.responses import read_response

        return read_response(scene.path(table.file or "", "capture.response.file"))
    return LINEAR if table.kind == "linear" else SRGB


def _ambient(scene: Scene, views: Mapping[str, View]) -> Ambient:
    table = scene.ambient
    if table is None:
        raise InputError(
            "is missing: without E0, the light of the photograph, added light has no scale",
            file=scene.file,
            field="ambient",
            remedy="add [ambient] with illuminance_lux",
        )
    if table.probes:
        raise InputError(
            "is in the schema but not rendered yet",
            file=scene.file,
            field="ambient.probes",
            remedy="state ambient.illuminance_lux",
        )
    if table.map is not None:
        lux = _ambient_map(scene, table.map, views)
    else:
        lux = np.broadcast_to(np.asarray(table.illuminance_lux, float), 3).copy()
    dimming = np.broadcast_to(np.asarray(table.dimming, float), 3)
    return Ambient(lux, (dimming[0], dimming[1], dimming[2]), table.dimming_mode)


def _ambient_map(scene: Scene, reference: str, views: Mapping[str, View]) -> NDArray[np.float64]:
    path = scene.path(reference, "ambient.map")
    if len(views) > 1:
        raise InputError("one map for two eyes", file=scene.file, field="ambient.map")
    picture = read_picture(path)
    view = next(iter(views.values()))
    if picture.shape != view.shape or picture.encoding != "linear":
        height, width = picture.shape
        raise InputError(
            f"must be a linear {view.width}×{view.height} picture, got {width}×{height} "
            f"{picture.encoding}",
            file=str(path),
            field="ambient.map",
        )
    bad = int(np.count_nonzero(~(picture.values > 0) | ~np.isfinite(picture.values)))
    if bad:
        raise InputError(
            f"E0 must be finite and > 0 everywhere, {bad} values are not",
            file=str(path),
            field="ambient.map",
        )
    from andon.lenses import undistort

    lux = np.asarray(undistort(np.asarray(picture.values, np.float64), view), np.float64)
    # Where the lens saw nothing the photograph is black: any E0 > 0 keeps it so.
    return np.where(np.isfinite(lux), lux, np.nanmean(lux, axis=(0, 1)))


def _luminance_per_unit(scene: Scene, ambient: Ambient) -> float:
    if scene.capture and scene.capture.luminance_per_unit:
        return scene.capture.luminance_per_unit
    # A white diffuser (ρ = 1) in the light of the photograph is the picture's white.
    return float(photometric(ambient.mean_lux)) / np.pi


def _exposure(scene: Scene) -> Exposure:
    display = scene.display
    for key, bad in (("mode", "ost"), ("tone", "fusion"), ("dither", True)):
        if getattr(display, key) == bad:
            raise InputError(
                f"{bad!r} is in the schema but not rendered yet",
                file=scene.file,
                field=f"display.{key}",
            )
    return Exposure(display.exposure, display.tone)  # type: ignore[arg-type]


def _glow(scene: Scene) -> Glow | None:
    if scene.glare is not None and scene.glare.model != "glow":
        raise InputError(
            f"{scene.glare.model!r} is in the schema but not rendered yet",
            file=scene.file,
            field="glare.model",
            remedy="use 'glow', or leave [glare] out",
        )
    try:
        return glow_from_table(scene.glare, scene.observer)
    except InputError as error:
        raise InputError(
            error.rule, file=scene.file, field=error.field, remedy=error.remedy
        ) from error


def _check_lamps(
    scene: Scene, lamps: tuple[Lamp, ...], surface: SurfaceModel, eye: NDArray[np.float64]
) -> None:
    """Refuses lamps that cannot light this surface."""
    is_mesh = scene.surface is not None and scene.surface.mesh is not None
    for lamp in lamps:
        if not isinstance(lamp, PointLamp | AreaLamp):
            continue
        if surface.is_distant_only:
            raise InputError(
                f"the lamp {lamp.name!r} has a place, but a normals-only surface has none",
                file=scene.file,
                field=f"{_place(scene, lamp)}.kind",
                remedy="use directional, sky or hemisphere, or give a depth or a mesh",
            )
        # Areas may be let into a wall; points may not.
        if (
            is_mesh
            and isinstance(lamp, PointLamp)
            and is_buried(lamp.position_m, eye, surface.real)
        ):
            x, y, z = lamp.position_m
            raise InputError(
                f"the lamp {lamp.name!r} at ({x:g}, {y:g}, {z:g}) is inside a wall",
                file=scene.file,
                field=f"{_place(scene, lamp)}.position",
                remedy="move it into the space that the camera sees",
            )


def _place(scene: Scene, lamp: Lamp) -> str:
    """Where the scene file states the lamp that `lamp` is, or is a part of."""
    sources = scene.ambient.source if scene.ambient else ()
    for where, tables in (("lamp", scene.lamp), ("ambient.source", sources)):
        for index, table in enumerate(tables):
            if table.name == lamp.owner:
                return f"{where}[{index}]"
    return "surface.lamps"  # imported from a mesh, the surface's or an object's
