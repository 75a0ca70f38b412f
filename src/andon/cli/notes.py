"""What is worth saying after a frame that was drawn, but perhaps not as it was meant."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.cli.body_notes import notes_on_bodies, notes_on_shells
from andon.engines.prepared import Prepared
from andon.lamps import Lamp, SpotLamp
from andon.pipeline import Frame
from andon.quantities import Surface
from andon.surface.model import SurfaceModel
from andon.surface.virtual import SURFACE

__all__ = ["depth_text", "notes_on", "notes_on_time"]

# Above this, shadows at the contacts of everyday things (feet, cups, books) are gone.
LARGE_LIFT_M = 0.02
# Median depths that no room and no street has: millimetres or disparities taken for metres.
LIKELY_DEPTHS_M = (0.05, 200.0)
# Of pixels at which a lamp's light is looked for first; all of them only where there is none.
SPARSE = 7
# Of the surface: smaller gaps lie along the rims of things, and nobody finds them.
NOTABLE_UNCOVERED = 0.002
# Of the pixels with a curve: a few lie outside it by noise alone.
NOTABLE_BEYOND = 0.005
# Fields of lamps that say how much light there is.
LIGHT_UNITS = ("_cd", "_lux", "_cd_m2")


def notes_on(
    frame: Frame, prepared: Prepared, time_seconds: float, *, has_photograph: bool = True
) -> list[str]:
    """One line each: what was found, and what can be done about it."""
    surface, model = frame.surface, prepared.surface
    bodies = prepared.bodies(time_seconds)
    return [
        *model.notes,
        *_on_depth(surface, has_photograph),
        *_on_objects(surface, prepared, time_seconds, has_photograph),
        *_on_lamps(surface, prepared, time_seconds),
        *notes_on_bodies(surface, bodies, prepared.lamps(time_seconds)),
        *notes_on_shells(prepared.shells, surface.view.name, bodies),
        *_on_lift(model),
        *_on_baked(frame),
        *_on_curves(frame),
    ]


def notes_on_time(time_seconds: float, duration_seconds: float) -> list[str]:
    """A moment before the session, or after its end; a still (0 s) has no end."""
    if time_seconds >= 0 and (time_seconds <= duration_seconds or duration_seconds == 0):
        return []
    where = "before 0" if time_seconds < 0 else f"after its end, {duration_seconds:g} s"
    return [
        f"--time {time_seconds:g} is {where}: what moves stands as at its nearest key; "
        "scene.duration_seconds is the session's length"
    ]


def depth_text(surface: Surface, *, has_photograph: bool = True) -> str | None:
    """Range and median of the real surface, or without a photograph of all that is drawn.

    None where there is no depth.
    """
    depth = _depths(surface, has_photograph)
    if not len(depth):
        return None
    low, middle, high = (_metres(float(value)) for value in np.percentile(depth, [0, 50, 100]))
    word = "" if surface.view.projection == "pinhole" else ", along the rays"
    return f"{low} to {high} m, median {middle} m{word}"


def _metres(value: float) -> str:
    return f"{value:.0f}" if value >= 100 else f"{value:.2f}" if value >= 0.1 else f"{value:.2g}"


def _depths(surface: Surface, has_photograph: bool) -> NDArray[np.float64]:
    depth = surface.depth[surface.valid & ~(surface.is_object & has_photograph)]
    return depth[np.isfinite(depth)]


def _on_depth(surface: Surface, has_photograph: bool) -> list[str]:
    depth = _depths(surface, has_photograph)
    middle = float(np.median(depth)) if len(depth) else float("nan")
    low, high = LIKELY_DEPTHS_M
    if not middle < low and not middle > high:  # NaN: normals alone
        return []
    if not has_photograph:
        return [
            f"the median depth is {_metres(middle)} m: check the unit of the meshes, and the camera"
        ]
    return [
        f"the median depth is {_metres(middle)} m: check the unit of the depth or mesh "
        "(depth in millimetres: --depth-scale-to-m 0.001 or scale_to_m = 0.001)"
    ]


def _on_objects(
    surface: Surface, prepared: Prepared, time_seconds: float, has_photograph: bool
) -> list[str]:
    """Objects without a pixel; without a photograph, the mesh of the surface is the first."""
    model, movers = prepared.surface, prepared.at(time_seconds).movers
    own = surface.is_object
    if surface.body_id is not None:
        own = own & (surface.body_id < 0)
    seen = set(model.object_of_slot[surface.material_id[own]].tolist())
    notes: list[str] = []
    for index, info in enumerate(model.objects_table):
        if index not in seen:
            where = _where(model.corners_of(index, movers).reshape(-1, 3), surface)
            mesh = not has_photograph and index == 0 and info.name == SURFACE
            what = "the mesh of [surface]" if mesh else f"the object {info.name!r}"
            check = "the camera and the mesh's unit" if mesh else "position and scale"
            notes.append(f"{what} covers no pixel: {where}; check {check}")
    return notes


def _where(points: Any, surface: Surface) -> str:
    """Of points (n, 3) of which no pixel shows any."""
    view = surface.view
    local = points @ view.camera_from_world[:3, :3].T + view.camera_from_world[:3, 3]
    x, y, z = points.mean(axis=0) + 0.0005  # no −0.00
    place = f"around ({x:.2f}, {y:.2f}, {z:.2f})"
    if view.projection == "pinhole" and (local[:, 2] <= 0).all():
        return f"it stands {place}, behind the camera"
    pixels = view.project(local)
    size = (view.width - 0.5, view.height - 0.5)
    inside = ((pixels >= -0.5) & (pixels <= size)).all(axis=-1)
    if not inside.any():
        return f"it stands {place}, beside the picture"
    return f"it stands {place}, hidden by what is before it, or smaller than a pixel"


def _on_lamps(surface: Surface, prepared: Prepared, time_seconds: float) -> list[str]:
    """Lamps that add nothing to any pixel; those of E0 only change what is there, and those that
    probes have captured light what is lit by probes."""
    moment, probes = prepared.at(time_seconds), prepared.probes
    indirect: frozenset[str] = frozenset() if probes is None else probes.captured
    lamps = [lamp for lamp in moment.direct_lamps if lamp.owner not in prepared.sources]
    lamps = [lamp for lamp in lamps if lamp.name not in indirect]
    if not lamps or not surface.valid.any():
        return []
    from andon.engines.reference import ReferenceEngine

    engine = ReferenceEngine(replace(prepared, baked=None))
    rows, columns = np.indices(surface.valid.shape)
    sparse = replace(surface, valid=surface.valid & ((rows + 3 * columns) % SPARSE == 0))

    def lights(lamp: Lamp) -> bool:
        alone = replace(moment, direct_lamps=(lamp,))
        seen = (engine.illuminate(part, alone).lux for part in (sparse, surface))
        return any(bool((lux > 0).any()) for lux in seen)

    parts: dict[str, list[Lamp]] = {}
    for lamp in lamps:  # what a shell makes of a lamp is named after it
        parts.setdefault(lamp.owner or lamp.name, []).append(lamp)
    return [
        f"the lamp {name!r} adds no light: {_why_dark(lamps[0], lights)}"
        for name, lamps in parts.items()
        if not any(lights(lamp) for lamp in lamps)
    ]


def _why_dark(lamp: Lamp, lights: Any) -> str:
    values = [getattr(lamp, f.name) for f in fields(lamp) if f.name.endswith(LIGHT_UNITS)]
    if values and not np.any(np.concatenate([np.ravel(value) for value in values])):
        return "0 is stated of it"
    if getattr(lamp, "shadow", None) is not None:
        free: Any = lamp
        if lights(replace(free, shadow=None)):
            return "all that faces it lies in shadow; move it, or state shadow = false"
    cone = " within its cone" if isinstance(lamp, SpotLamp) else ""
    return f"nothing that the camera sees faces it{cone}; move or turn it"


def _on_baked(frame: Frame) -> list[str]:
    """Surface that no illuminance map sees, where it is more than a rim here and there."""
    baked = frame.baked
    if baked is None or baked.uncovered_share < NOTABLE_UNCOVERED:
        return []
    return [
        f"{baked.uncovered_share:.1%} of the surface is seen by no illuminance map; but for rims "
        "it gets no baked light: --uncovered shows where; another [[baked.camera]] sees it"
    ]


def _on_curves(frame: Frame) -> list[str]:
    """Light that no shot of a surface's curve was taken in."""
    share = frame.report.beyond_curve_share
    if share is None or share < NOTABLE_BEYOND:
        return []
    return [
        f"{share:.1%} of the pixels with a curve are darker or brighter than it was measured, as "
        "captured or as relit: there it goes straight on; --confidence shows where; more shots for "
        "andon calibrate surface widen it"
    ]


def _on_lift(model: SurfaceModel) -> list[str]:
    lift = model.bias.real_m
    if lift <= LARGE_LIFT_M:
        return []
    kept, before = len(model.occluder.geometry.triangles), model.occluder.triangles_before
    return [
        f"shadows thinner than {lift * 1e3:.0f} mm are lost, since {kept} of {before} triangles "
        "cast them; more in [surface] occluder_triangles keep them (0: all)"
    ]
