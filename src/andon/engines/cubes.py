"""Cube maps of what stands still: the light and the distances around places, on both engines.

::

    place ─six views▶ surface ─▶ direct ─▶ captured        (6, s, s, 3) cd/m², (6, s, s) m

Bodies of lamps are not seen (they light things directly), but they cast their shadows. Sky and
hemisphere lamps light no surface here: a surface is lit by as much of the sky as the probes of an
earlier bounce saw, so that rooms have no sky in them. What a photograph does not show lights no
surface either: surfaces have E0 already.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from andon.composite.per_lux import shown_reflectance
from andon.composite.reference import unlit_linear
from andon.engines.baked import lamps_in_probes
from andon.engines.moment import Moment
from andon.engines.prepared import Prepared
from andon.errors import InputError, MachineError
from andon.harmonics.cubes import face_directions
from andon.lamps import HemisphereLamp, Lamp, SkyLamp
from andon.lamps.model import LIGHT_FIELDS
from andon.quantities import CameraFrame, Geometry
from andon.spaces import View, pinhole_view
from andon.surface import reference as surface
from andon.surface.model import SurfaceModel, states_reflectance
from andon.transport.probes.capture import Lighting, Seen
from andon.transport.probes.photograph import Photograph, Picture

if TYPE_CHECKING:
    from andon.scene import Scene

__all__ = [
    "CubeEngine",
    "CubeSetting",
    "cube_engine",
    "cube_setting",
    "cube_views",
    "mirrored",
    "photograph_of",
]

Float = NDArray[np.float64]


def _poses() -> Float:
    """(6, 3, 3) right, down and forward of each face's camera, as columns.

    The faces' axes with u turned round, since a cube map is mirrored as seen from inside and a
    camera is not.
    """
    forward, along_u, along_v = np.moveaxis(
        face_directions(np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])), 1, 0
    )
    return np.stack([forward - along_u, along_v - forward, forward], axis=-1)


def cube_views(position: NDArray[Any], size: int, /) -> tuple[View, ...]:
    """The six cameras around `position` (3,) whose pictures, `mirrored`, are a cube map's faces.

    Each is a pinhole of 90° with `size` × `size` pixels; column c looks where column size − 1 − c
    of `cube_directions` does.
    """
    views: list[View] = []
    for axes in _poses():
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = axes, position
        views.append(pinhole_view(size, size, size / 2, pose, name="probe"))
    return tuple(views)


def mirrored(pictures: NDArray[Any], /) -> NDArray[Any]:
    """Pictures (6, s, s, …) of `cube_views` as the faces of a cube map, and back."""
    return pictures[:, :, ::-1]


@dataclass(frozen=True, eq=False)
class CubeSetting:
    """What captures are made of.

    Attributes
    ----------
    surface : what is seen.
    casters : a moment's bodies, which cast shadows beside what is seen.
    lamps : those that light surfaces.
    lighting : all other light.
    prepared : where it is from.
    emits : something gives light of itself: a material, or the sky.
    takes_away : some light is negative: sources of E0 that are gone, or hidden.
    """

    surface: SurfaceModel
    moment: Moment
    lamps: tuple[Lamp, ...]
    lighting: Lighting
    prepared: Prepared
    emits: bool
    takes_away: bool = False

    @property
    def geometry(self) -> tuple[Geometry, ...]:
        """All that is seen: the real surface and the virtual one."""
        parts = (self.surface.real, self.surface.objects)
        return tuple(part for part in parts if len(part.triangles))


class CubeEngine(Protocol):
    """Looks around from places."""

    name: str
    adapter: str

    def look(self, position: Float, /, *, lit: bool = True) -> tuple[Seen, Float | None]:
        """What is met around `position` (3,), and the lux (6, s, s, 3) of lamps on it.

        Without `lit` there are no lamps, and no lux.
        """
        ...


def cube_setting(scene: Scene, prepared: Prepared, /) -> CubeSetting:
    """What captures of a scene see: what stands still, at the start of the session.

    Things that move are neither seen nor cast shadows. Raises `InputError` where there are no
    positions.
    """
    model = prepared.surface
    still = model.objects_table[: len(model.objects_table) - len(model.movers)]
    model = replace(model, movers=(), objects_table=still)
    prepared = replace(prepared, surface=model)
    if model.is_distant_only:
        raise InputError(
            "has no positions, and light is captured at places",
            file=scene.file,
            field="surface.normals",
            remedy="give a depth or a mesh",
        )
    moment = prepared.at(0.0)
    lamps = lamps_in_probes(scene, moment.lamps)
    lighting = _lighting(scene, prepared, lamps)
    # A material whose light the photograph shows emits nothing beside it.
    real = model.real if lighting.photograph is None else _without_materials(model.real)
    seen = replace(model, real=real)
    materials = [m for part in (seen.real, seen.objects) for m in part.materials]
    return CubeSetting(
        seen,
        moment,
        tuple(lamp for lamp in lamps if not isinstance(lamp, SkyLamp | HemisphereLamp)),
        lighting,
        prepared,
        bool(lighting.sky) or any(any(material.emissive_cd_m2) for material in materials),
        any(_is_negative(lamp) for lamp in lamps),
    )


def _lighting(scene: Scene, prepared: Prepared, lamps: Sequence[Lamp]) -> Lighting:
    """All light but that of `lamps` that stand somewhere or are directional."""
    real, ambient = prepared.surface.real, prepared.ambient
    photograph = None
    if prepared.frames and len(real.triangles) and not states_reflectance(real):
        photograph = photograph_of(prepared)
    lux: Float = np.asarray(ambient.dimming) * ambient.mean_lux
    if scene.ambient is None:  # then what stands for E0 is no light
        lux = np.zeros(3)
    has_sky = any(table.kind in ("sky", "hemisphere") for table in scene.lamp)
    sky = tuple(lamp for lamp in lamps if isinstance(lamp, SkyLamp | HemisphereLamp))
    around = lux / np.pi if scene.has_photograph and not has_sky else None
    return Lighting(lux, photograph, sky, around)


def _is_negative(lamp: Lamp) -> bool:
    light = (getattr(lamp, key, None) for key in LIGHT_FIELDS)
    return any(bool((np.asarray(values) < 0).any()) for values in light if values is not None)


def cube_engine(setting: CubeSetting, size: int, /, engine: str = "auto") -> CubeEngine:
    """What looks around, with faces of `size` pixels; ``auto``: the GPU where there is one.

    Raises `MachineError` for ``gpu`` without an adapter.
    """
    from andon.engines.cubes_reference import ReferenceCubes

    if engine not in ("auto", "gpu", "reference"):
        raise InputError(f"must be auto, gpu or reference, got {engine!r}", field="engine")
    if engine == "reference":
        return ReferenceCubes(setting, size)
    from andon.engines.cubes_gpu import GpuCubes

    try:
        return GpuCubes(setting, size)
    except MachineError:
        if engine == "gpu":
            raise
        return ReferenceCubes(setting, size)


def _without_materials(real: Geometry) -> Geometry:
    return Geometry(real.positions, real.triangles, real.normals)


def photograph_of(prepared: Prepared, /) -> Photograph:
    """The pictures of the views of `prepared`, looked up by points of the real surface."""
    pictures: list[Picture] = []
    for frame in prepared.frames.values():
        alone = replace(prepared.surface, objects=Geometry(np.zeros((0, 3)), _NONE))
        depth = surface.see(alone, frame.view).depth
        pictures.append(Picture(frame.view, depth, _light(frame, prepared)))
    return Photograph(pictures)


_NONE = np.zeros((0, 3), np.int32)


def _light(frame: CameraFrame, prepared: Prepared) -> NDArray[np.float32]:
    """(H, W, 6) luminance left of the photograph's own light, and reflectance."""
    measured = prepared.measured.get(frame.view.name)
    left = frame.luminance_per_unit * unlit_linear(frame, prepared.ambient, measured)
    reflectance = shown_reflectance(frame, prepared.ambient, measured)
    return np.maximum(np.concatenate([left, reflectance], axis=-1), 0).astype(np.float32)
