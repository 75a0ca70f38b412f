"""E0, the light in which the photograph was taken: of a scene's table, or of each pixel.

==================  ==============================================================================
[ambient] states    E0 of a pixel
==================  ==============================================================================
`illuminance_lux`   the same everywhere
`map`               its pixel in a picture
`probes`            illuminance there by the light probes
`harmonics`         illuminance of a surface that faces as its normal does, in one light from all
                    sides: no shadow, no place
`rest_lux`          this, and the direct light of every known source, shadows of the real surfaces
                    included: what is left when all of them are switched off is `rest_lux`
==================  ==============================================================================

Holes, whose pixels stay as they are, take the mean. E0 divides what lamps add, so no pixel may be
dark: what is less than `LEAST_SHARE` of the mean is raised to that, and said.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from andon.composite.model import Ambient
from andon.engines.baked import dimming_of
from andon.engines.checks import check_lamps
from andon.engines.measured_curves import one_view
from andon.engines.probes import SceneProbes
from andon.errors import InputError
from andon.files.harmonics import read_harmonics
from andon.files.pictures import read_picture
from andon.harmonics import deringed, irradiance
from andon.lamps.sources import known_sources
from andon.lenses import undistort
from andon.quantities import Surface
from andon.scene import Scene
from andon.spaces import View
from andon.surface import reference as surface
from andon.surface.model import SurfaceModel
from andon.transport.direct import reference as direct
from andon.transport.direct.casters import REAL, Casters, ShadowRays
from andon.transport.probes.light import probe_illuminance

__all__ = ["LEAST_SHARE", "ambient_of", "source_lux", "stated_ambient"]

Float = NDArray[np.float64]
Notes = tuple[str, ...]

LEAST_SHARE = 1e-3


def ambient_of(
    scene: Scene, views: Mapping[str, View], model: SurfaceModel, probes: SceneProbes | None, /
) -> tuple[Ambient, Notes]:
    """E0 of the photographs of `views` (as captured), and what is to be said of it.

    Raises `InputError` where it is not stated, does not fit the views or the surface, or is dark.
    """
    table = scene.ambient
    if table is None or table.illuminance_lux is not None:
        return stated_ambient(scene), ()
    if table.map is not None:
        return _ambient(scene, {next(iter(views)): _map_lux(scene, table.map, views)}), ()
    if table.probes:
        field, lux_on, notes = "probes", _of_probes(scene, probes, model), ()
    elif table.harmonics is not None:
        field = "harmonics"
        lux_on, notes = _of_harmonics(scene, table.harmonics)
    else:
        field, lux_on, notes = "rest_lux", _of_sources(scene, model), ()
    real = replace(model, objects=SurfaceModel().objects, objects_table=(), movers=())
    seen = {
        name: surface.see(real, replace(view.undistorted(), name=name))
        for name, view in views.items()
    }
    lux = {name: np.where(own.valid[..., None], lux_on(own), np.nan) for name, own in seen.items()}
    lux, raised = _lit(lux, scene, field)
    return _ambient(scene, lux), (*notes, *raised)


def stated_ambient(scene: Scene, /) -> Ambient:
    """E0 where it is the same everywhere. Raises `InputError` where none is stated."""
    table = scene.ambient
    if table is None or table.illuminance_lux is None:
        raise InputError(
            "is missing: without E0, the light of the photograph, added light has no scale",
            file=scene.file,
            field="ambient",
            remedy="add [ambient] with illuminance_lux",
        )
    lux = np.broadcast_to(np.asarray(table.illuminance_lux, float), 3).copy()
    return Ambient(lux, dimming_of(scene), table.dimming_mode)


def _ambient(scene: Scene, lux: Mapping[str, Float]) -> Ambient:
    """E0 of each pixel of each view; of several, virtual things stand in the mean of all."""
    assert scene.ambient is not None
    how = dimming_of(scene), scene.ambient.dimming_mode
    if len(lux) == 1:
        return Ambient(next(iter(lux.values())), *how)
    mean = np.mean([own.mean(axis=(0, 1)) for own in lux.values()], axis=0)
    return Ambient(mean, *how, views=dict(lux))


def _lit(lux: dict[str, Float], scene: Scene, field: str) -> tuple[dict[str, Float], Notes]:
    """`lux` (H, W, 3) of each view, NaN in holes, with the mean there and no pixel dark."""
    known = np.concatenate([own[np.isfinite(own).all(axis=-1)] for own in lux.values()])
    mean = known.mean(axis=0) if len(known) else np.zeros(3)
    if not (mean > 0).all():
        raise InputError(
            f"gives the surface {mean.round(3)} lx: E0 must be > 0 in each channel",
            file=scene.file,
            field=f"ambient.{field}",
            remedy="make it with the lamps of the photograph, or state illuminance_lux",
        )
    least = LEAST_SHARE * mean
    dark = int(np.count_nonzero((known < least).any(axis=-1)))
    notes = (
        f"E0 of {dark} pixels is below {LEAST_SHARE:.1%} of the mean by ambient.{field}, and was "
        "raised to that",
    )
    lit = {name: np.maximum(np.where(np.isnan(own), mean, own), least) for name, own in lux.items()}
    return lit, notes if dark else ()


def _of_probes(
    scene: Scene, probes: SceneProbes | None, model: SurfaceModel
) -> Callable[[Surface], Float]:
    problem = None
    if probes is None:
        problem = "needs [probes] with a volume"
    elif model.is_distant_only:
        problem = "needs positions, but a normals-only surface has none"
    if problem is not None or probes is None:
        raise InputError(
            problem or "", file=scene.file, field="ambient.probes", remedy="state illuminance_lux"
        )
    light = probes.light

    def lux_on(seen: Surface) -> Float:
        lux = np.full((*seen.view.shape, 3), np.nan)
        lux[seen.valid] = probe_illuminance(
            light, seen.position[seen.valid], seen.normal[seen.valid]
        )
        return lux

    return lux_on


def _of_harmonics(scene: Scene, reference: str) -> tuple[Callable[[Surface], Float], Notes]:
    """Illuminance by normals; a light that rings below zero is smoothed until it does not."""
    path = scene.path(reference, "ambient.harmonics")
    given = read_harmonics(path)
    if not (given[0] > 0).all():
        raise InputError(
            "the first coefficient, the mean light, must be > 0 in each channel, "
            f"got {given[0].tolist()}",
            file=str(path),
            field="ambient.harmonics",
            remedy="state illuminance_lux if the light is not known",
        )
    smooth = deringed(given)
    rings = "the light of ambient.harmonics would be negative on some normals: it was smoothed"
    notes = () if np.array_equal(smooth, given) else (rings,)
    return lambda seen: irradiance(smooth, seen.normal), notes


def _of_sources(scene: Scene, model: SurfaceModel) -> Callable[[Surface], Float]:
    """The rest and the direct light of known sources, hidden by the real surfaces alone."""
    assert scene.ambient is not None
    rest = np.broadcast_to(np.asarray(scene.ambient.rest_lux, float), 3)
    return lambda seen: rest + sum(source_lux(scene, model, seen).values(), np.zeros(3))


def source_lux(scene: Scene, model: SurfaceModel, seen: Surface, /) -> dict[str, Float]:
    """Name of each [[ambient.source]] → (H, W, 3) lux of its direct light on the real surface.

    Shadows are those of the real surfaces, flicker is at its mean, holes are 0. Raises `InputError`
    for a source that cannot light this surface.
    """
    table = scene.ambient
    if table is None or not table.source:
        return {}
    steady = tuple(source.model_copy(update={"flicker": None}) for source in table.source)
    still = scene.model_copy(update={"ambient": table.model_copy(update={"source": steady})})
    lamps = known_sources(still, 0.0)
    check_lamps(scene, lamps, model, seen.view.position)
    rays = ShadowRays(Casters(((REAL, model.occluder.geometry),)))
    bias_m = np.full(seen.view.shape, model.bias.real_m)
    return {
        source.name: direct.illuminate(
            seen, [lamp for lamp in lamps if lamp.owner == source.name], rays, bias_m=bias_m
        )
        for source in table.source
    }


def _map_lux(scene: Scene, reference: str, views: Mapping[str, View]) -> Float:
    path = scene.path(reference, "ambient.map")
    view = one_view(scene, views, "ambient.map")
    picture = read_picture(path)
    if picture.shape != view.shape or picture.encoding != "linear":
        height, width = picture.shape
        raise InputError(
            f"must be a linear {view.width}×{view.height} picture, got {width}×{height} "
            f"{picture.encoding}",
            file=str(path),
            field="ambient.map",
            remedy="give EXR or HDR of the photograph's own pixels",
        )
    bad = int(np.count_nonzero(~(picture.values > 0) | ~np.isfinite(picture.values)))
    if bad:
        raise InputError(
            f"E0 must be finite and > 0 everywhere, {bad} values are not",
            file=str(path),
            field="ambient.map",
            remedy="raise dark pixels to a small share of the mean",
        )
    lux = np.asarray(undistort(np.asarray(picture.values, np.float64), view), np.float64)
    # Where the lens saw nothing the photograph is black: any E0 > 0 keeps it so.
    return np.where(np.isfinite(lux), lux, np.nanmean(lux, axis=(0, 1)))
