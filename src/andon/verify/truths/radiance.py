"""Illuminance truth: Radiance's `rtrace -I` on the same triangles and lamps.

::

    Geometry, lamps ──radiance_bundle──▶ octree ──rtrace -I──▶ W/m² per channel ──×179──▶ lux

The scene is the one that bakes use. Everything is exact where `rtrace` allows it: every lamp is
tested (``-dt 0 -dc 1``), none is jittered (``-dj 0``), numbers travel as binary doubles. Emission
of the geometry's materials is left out: give what emits as lamps.
"""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from andon.bake.tasks import write_bundle
from andon.errors import InputError, MachineError
from andon.files.radiance_programs import run_radiance
from andon.lamps import Lamp
from andon.quantities import Geometry
from andon.spaces import View
from andon.transport.baked.radiance import OCTREE, radiance_bundle
from andon.transport.baked.radiance.text import LUMENS_PER_WATT

__all__ = [
    "RadianceScene",
    "Timing",
    "irradiance",
    "time_view",
]

Float = NDArray[np.float64]

# `rtrace -I` evaluates 1e-4 m above the point it is given (measured: closed forms agree to 3e-7
# there, and the point is in its own shadow if moved back further). Points are moved back so that
# LIFT_M remains: above the rounding of float32 positions, below 0.01 % of E at 0.2 m.
RTRACE_LIFT_M = 1e-4
LIFT_M = 1e-5


@dataclass(frozen=True)
class Timing:
    """Wall time of whole `rtrace` runs, the reading of the octree included.

    Attributes
    ----------
    seconds : one per run.
    points : asked in each run.
    """

    seconds: tuple[float, ...]
    points: int


class RadianceScene:
    """An octree that is built once and asked many times; a context manager.

    Parameters
    ----------
    geometry : its triangles, with `Material.reflectance` where there are bounces.
    lamps : what emits; may be empty.
    tiles : about how many flat pieces stand for each area lamp; a mesh is never coarser.
    time_limit_seconds : for each program run; more is a `MachineError`.

    Raises
    ------
    MachineError : Radiance's programs are missing, failed or took too long.
    InputError : a lamp or material that cannot be said in Radiance's terms.
    """

    def __init__(
        self,
        geometry: Geometry,
        lamps: Sequence[Lamp],
        *,
        tiles: int = 1,
        time_limit_seconds: float = 600.0,
    ) -> None:
        self._geometry, self._lamps, self._tiles = geometry, tuple(lamps), tiles
        self._limit = time_limit_seconds
        self._folder: tempfile.TemporaryDirectory[str] | None = None

    def __enter__(self) -> Self:
        self._folder = tempfile.TemporaryDirectory(prefix="andon-radiance-")
        try:
            self._build(Path(self._folder.name))
        except BaseException:
            self._folder.cleanup()
            raise
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._folder is not None:
            self._folder.cleanup()
            self._folder = None

    def _build(self, folder: Path) -> None:
        bundle = radiance_bundle(
            [self._geometry], self._lamps, tiles=self._tiles, time_limit_seconds=self._limit
        )
        write_bundle(folder, bundle)

    def irradiance(
        self,
        points: NDArray[Any],
        normals: NDArray[Any],
        /,
        *,
        ambient_bounces: int = 0,
        ambient_divisions: int = 1024,
        ambient_accuracy: float = 0.1,
        source_subdivision: float = 0.0,
        lift_m: float = LIFT_M,
        threads: int | None = None,
    ) -> Float:
        """(n, 3) lux on surfaces at `points` (n, 3) metres that face `normals` (n, 3).

        Parameters
        ----------
        ambient_bounces : diffuse bounces (``-ab``); 0 is direct light only.
        ambient_divisions, ambient_accuracy : ``-ad`` and ``-aa``, used with bounces only.
        source_subdivision : ``-ds``, cuts area lamps down to this share of their distance;
            0 takes each triangle as one sample, right for fine meshes.
        lift_m : height above the points at which light is measured; more than their error, or
            they lie in their own shadow.
        threads : processes of `rtrace`; None takes all cores.
        """
        return self._trace(
            ["-I"],
            _rays(points, normals, lift_m),
            {
                "ab": ambient_bounces,
                "ad": ambient_divisions,
                "as": ambient_divisions // 4,
                "aa": ambient_accuracy,
                "ds": source_subdivision,
                "n": threads or os.cpu_count() or 1,
            },
        )

    def luminance(self, view: View, /, *, threads: int | None = None) -> Float:
        """(H, W, 3) cd/m² of what the view sees in direct light: one ray per pixel centre.

        Surfaces are flat and diffuse (``Material.reflectance``); lamps do not show.
        """
        return self.luminance_along(_view_rays(view), threads=threads).reshape(*view.shape, 3)

    def luminance_along(self, rays: Float, /, *, threads: int | None = None) -> Float:
        """(n, 3) cd/m² along rays (n, 6): an origin in metres and a unit direction each."""
        # -dv-: a ray that meets a lamp itself goes dark.
        return self._trace(["-dv-"], rays, {"ab": 0, "ds": 0, "n": threads or os.cpu_count() or 1})

    def _trace(self, mode: list[str], rays: Float, options: dict[str, float]) -> Float:
        """(n, 3) photometric answers of `rtrace` to rays (n, 6)."""
        if self._folder is None:
            raise InputError("must be entered before it is asked", field="RadianceScene")
        if len(rays) == 0:
            return np.empty((0, 3))
        # Every lamp is tested, at its centre; -dr 0: there are no mirrors, so no virtual lamps.
        fixed = ["-h", "-w", "-fd", "-dt", "0", "-dc", "1", "-dj", "0", "-dr", "0"]
        chosen = [word for key, value in options.items() for word in (f"-{key}", str(value))]
        answer = run_radiance(
            "rtrace",
            [*mode, *fixed, *chosen, OCTREE],
            rays.tobytes(),
            self._limit,
            cwd=Path(self._folder.name),
        )
        watts = np.frombuffer(answer, np.float64)
        if watts.size != 3 * len(rays):
            raise MachineError(
                f"rtrace answered {watts.size} numbers for {len(rays)} points",
                remedy="check that memory and disk have room",
            )
        return watts.reshape(-1, 3) * LUMENS_PER_WATT


def irradiance(
    geometry: Geometry,
    lamps: Sequence[Lamp],
    points: NDArray[Any],
    normals: NDArray[Any],
    /,
    *,
    ambient_bounces: int = 0,
    threads: int | None = None,
) -> Float:
    """(n, 3) lux, see `RadianceScene.irradiance`; builds the octree anew at every call."""
    with RadianceScene(geometry, lamps) as scene:
        return scene.irradiance(points, normals, ambient_bounces=ambient_bounces, threads=threads)


def time_view(
    scene: RadianceScene, view: View, /, *, repeats: int = 1, threads: int | None = None
) -> Timing:
    """How long Radiance takes for the whole picture: surfaces, direct light, luminance."""
    rays = _view_rays(view)  # not Radiance's work, so outside its time
    return Timing(_timed(lambda: scene.luminance_along(rays, threads=threads), repeats), len(rays))


def _timed(ask: Callable[[], object], repeats: int) -> tuple[float, ...]:
    seconds: list[float] = []
    for _ in range(repeats):
        start = time.perf_counter()
        ask()
        seconds.append(time.perf_counter() - start)
    return tuple(seconds)


def _view_rays(view: View) -> Float:
    """(H·W, 6) float64: the camera's place and the unit direction of each pixel, row by row."""
    origin, directions = view.rays_world()
    rays = np.empty((view.width * view.height, 6))
    rays[:, :3], rays[:, 3:] = origin, directions.reshape(-1, 3)
    return rays


def _rays(points: NDArray[Any], normals: NDArray[Any], lift_m: float) -> Float:
    """(n, 6) float64: origins moved to where `rtrace` measures `lift_m` above, and normals."""
    origins, facing = np.asarray(points, np.float64), np.asarray(normals, np.float64)
    for field, values in (("points", origins), ("normals", facing)):
        if values.ndim != 2 or values.shape[1] != 3 or not np.isfinite(values).all():
            raise InputError(f"must be finite (n, 3), got shape {values.shape}", field=field)
    if origins.shape != facing.shape:
        raise InputError(f"must have the shape of points {origins.shape}", field="normals")
    length = np.linalg.norm(facing, axis=1, keepdims=True)
    if not (length > 0).all():
        # A zero direction tells rtrace to flush its output, it would give no number at all.
        raise InputError("must not be zero", field="normals")
    facing = facing / length
    return np.concatenate([origins - (RTRACE_LIFT_M - lift_m) * facing, facing], axis=1)
