"""From [[surface.response]] to curves of pixels: by masks, and by the materials of the mesh."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from andon.composite.model import MeasuredSurface
from andon.errors import InputError, nearest_name
from andon.files.pictures import read_picture
from andon.files.responses import read_surface_response
from andon.lenses import undistort
from andon.quantities import Geometry
from andon.responses import SurfaceCurve
from andon.scene import Scene
from andon.scene.surface import SurfaceResponse
from andon.spaces import View, another_size
from andon.surface import reference as surface
from andon.surface.model import EMPTY_GEOMETRY, SurfaceModel

__all__ = ["OTHERS", "check_paper", "curves_of", "one_view"]

Mask = NDArray[np.bool_]

# The name for all materials, and pixels, that have no curve of their own.
OTHERS = "*"


def curves_of(
    scene: Scene, views: Mapping[str, View], model: SurfaceModel, /
) -> dict[str, MeasuredSurface]:
    """For each of `views` (as captured) the curves of its pixels, as [[surface.response]] has them.

    A mask goes before a material, a later mask before an earlier one. ``*`` are all other pixels,
    holes too: dimming needs no geometry. Raises `InputError` for materials that the mesh does not
    have, and masks that do not fit or select nothing.
    """
    tables = scene.surface.response if scene.surface is not None else ()
    if not tables:
        return {}
    check_paper(scene)
    curves = tuple(_curve(scene, index, table) for index, table in enumerate(tables))
    by_material = _by_material(scene, model.real)
    found: dict[str, MeasuredSurface] = {}
    for name, view in views.items():
        curve_of = _of_materials(by_material, model, view)
        for index, table in enumerate(tables):
            if table.mask is not None:
                curve_of[_mask(scene, index, table, views)] = index
        found[name] = MeasuredSurface(curves=curves, curve_of=curve_of)
    return found


def check_paper(scene: Scene, /) -> None:
    """Raises `InputError` where encoded values are scaled *and* surfaces have curves."""
    if scene.ambient is not None and scene.ambient.dimming_mode == "paper":
        raise InputError(
            "'paper' scales encoded values, and [[surface.response]] scales light: one excludes "
            "the other",
            file=scene.file,
            field="ambient.dimming_mode",
            remedy="leave it out, or leave out [[surface.response]]",
        )


def _curve(scene: Scene, index: int, table: SurfaceResponse) -> SurfaceCurve:
    if table.file is not None:
        return read_surface_response(scene.path(table.file, f"surface.response[{index}].file"))
    return SurfaceCurve(np.array(table.illuminance_lux, float), np.array(table.rgb, float))


def _by_material(scene: Scene, real: Geometry) -> dict[str, int]:
    """Name of a material, or `OTHERS` → number of its curve."""
    assert scene.surface is not None
    names = [material.name for material in real.materials if material.name]
    found: dict[str, int] = {}
    for index, table in enumerate(scene.surface.response):
        if table.mask is not None:
            continue
        field, name = f"surface.response[{index}].material", table.material
        if name != OTHERS and name not in names:
            raise _no_such_material(scene, field, name, names)
        found[name] = index
    return found


def _no_such_material(scene: Scene, field: str, name: str, names: list[str]) -> InputError:
    if not names:
        return InputError(
            f"names {name!r}, and the surface has no materials",
            file=scene.file,
            field=field,
            remedy="state mask, a picture that is white where the surface is, or leave it out",
        )
    near = nearest_name(name, names)
    return InputError(
        f"there is no material {name!r} in the mesh, it has {', '.join(names[:8])}",
        file=scene.file,
        field=field,
        remedy=f"did you mean {near!r}?" if near else None,
    )


def _of_materials(
    by_material: Mapping[str, int], model: SurfaceModel, view: View
) -> NDArray[np.int16]:
    """(H, W) number of the curve of each pixel's material, −1 for none."""
    others = by_material.get(OTHERS, -1)
    curve_of = np.full(view.shape, others, np.int16)
    if set(by_material) <= {OTHERS}:
        return curve_of
    # What is real behind virtual objects, too: they may move.
    alone = replace(model, objects=EMPTY_GEOMETRY)
    material = surface.see(alone, view.undistorted()).material_id
    numbers = [by_material.get(part.name, others) for part in model.real.materials]
    return np.where(material >= 0, np.array(numbers, np.int16)[material], curve_of)


def _mask(scene: Scene, index: int, table: SurfaceResponse, views: Mapping[str, View]) -> Mask:
    """(H, W) pixels that a mask selects."""
    assert table.mask is not None
    field = f"surface.response[{index}].mask"
    view = one_view(scene, views, field)
    path = scene.path(table.mask, field)
    picture = read_picture(path)
    if picture.shape != view.shape:
        remedy = "draw it on the photograph"
        raise another_size(picture.shape, view, file=path, field=field, remedy=remedy)
    own = undistort(picture.is_painted.astype(np.uint8), view, method="nearest") > 0
    if not own.any():
        raise InputError(
            f"selects no pixel, so the curve of {table.material!r} has none",
            file=str(path),
            field=field,
            remedy="paint the surface white, all else black",
        )
    return own


def one_view(scene: Scene, views: Mapping[str, View], field: str) -> View:
    """The view of a rig that has one. Raises `InputError` for two: a picture belongs to one."""
    if len(views) > 1:
        raise InputError(
            "is one picture for two eyes",
            file=scene.file,
            field=field,
            remedy="leave it out, or relight one eye",
        )
    return next(iter(views.values()))
