"""Mesh files as glass: closed, outside out, and what their materials say."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glass.media import Medium, medium_of_material, transmits
from andon.lamps.triangles import WELD, connected, shared_edges, welded
from andon.quantities import Geometry
from andon.rays import RayScene

__all__ = ["check_closed", "closed_geometry", "glass_parts", "moved", "one_medium"]

Float = NDArray[np.float64]
Int = NDArray[np.int64]

# Along no axis and no diagonal: rays that count what a part lies inside of.
WAY = np.array([[0.36, 0.48, 0.8]])


def glass_parts(geometry: Geometry, file: str, /) -> tuple[Geometry, tuple[Medium, ...]]:
    """The triangles that are glass, and the media that their materials state.

    If any material transmits (KHR_materials_transmission), only those are glass and have media;
    else all triangles are, and no medium is stated.
    """
    clear = [transmits(material, file) for material in geometry.materials]
    none = np.zeros(len(geometry.triangles), np.int32)
    ids = none if geometry.material_ids is None else geometry.material_ids
    keep = np.array(clear, np.bool_)[ids]
    if not keep.any():
        return geometry, ()
    used = [material for i, material in enumerate(geometry.materials) if (ids[keep] == i).any()]
    media = dict.fromkeys(medium_of_material(material, file) for material in used)
    return replace(geometry, triangles=geometry.triangles[keep], material_ids=None), tuple(media)


def moved(geometry: Geometry, linear: Float, /) -> Geometry:
    """Positions and normals under an invertible (3, 3) matrix; a mirror turns triangles round."""
    normals = geometry.normals
    if normals is not None:
        normals = normals @ np.linalg.inv(linear)
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)
    triangles = geometry.triangles
    if np.linalg.det(linear) < 0:
        triangles = triangles[:, ::-1]
    return replace(
        geometry, positions=geometry.positions @ linear.T, normals=normals, triangles=triangles
    )


def closed_geometry(geometry: Geometry, place: tuple[str, str], /) -> Geometry:
    """The same mesh without seams and without triangles that have no area; checked.

    Vertices closer than `WELD` of the size come to lie on one another; they keep their own normals
    and coordinates. `place` is file and field, for messages. Raises what `check_closed` raises.
    """
    if not (len(geometry.triangles) and np.isfinite(geometry.positions).all()):
        raise _refusal("must have triangles and finite positions", place, "export it anew")
    used = np.unique(geometry.triangles)
    size = float(np.ptp(geometry.positions[used], axis=0).max())
    points, index = welded(geometry.positions, WELD * size)
    wound = index[geometry.triangles]
    a, b, c = wound.T
    keep = (a != b) & (b != c) & (c != a)
    check_closed(points, wound[keep], place)
    return replace(
        geometry,
        positions=points[index],
        triangles=np.ascontiguousarray(geometry.triangles[keep]),
        material_ids=None,
    )


def check_closed(points: Float, triangles: Int, place: tuple[str, str], /) -> None:
    """Refuse a surface that does not part inside from outside.

    Raises `InputError` unless every edge belongs to exactly two triangles (m, 3) that run along it
    in opposite ways, and every connected part has a volume that is positive, or negative where it
    is the wall of a hollow.
    """
    low, high = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1).T
    _, counts = np.unique(low * (len(points) + 1) + high, return_counts=True)
    if not len(triangles) or (counts == 1).any():
        holes = int((counts == 1).sum())
        raise _refusal(
            f"must be closed, {holes} edges belong to one triangle only"
            if holes
            else "must have triangles with an area",
            place,
            "close its holes, give it a thickness, or use shape sphere, slab or lens",
        )
    if (counts > 2).any():
        raise _refusal(
            f"must part inside from outside, {int((counts > 2).sum())} edges belong to more than "
            "two triangles",
            place,
            "remove walls inside and double faces, or make bodies that touch their own [[glass]]",
        )
    _, sides = shared_edges(triangles)
    if (sides < 0).any():
        raise _refusal(
            "must be wound one way, neighbouring triangles run round in different ways",
            place,
            "recalculate the normals outside in a modelling program",
        )
    _check_outside(points[triangles], connected(len(triangles), sides), place)


def _check_outside(corners: Float, part: Int, place: tuple[str, str]) -> None:
    centred = corners - corners.reshape(-1, 3).mean(axis=0)
    volumes = np.einsum("ni,ni->n", centred[:, 0], np.cross(centred[:, 1], centred[:, 2])) / 6
    by_part = np.bincount(part, weights=volumes)
    for number in np.flatnonzero(by_part <= 0):
        others = corners[part != number].reshape(-1, 3)
        scene = RayScene(Geometry(others, np.arange(len(others), dtype=np.int32).reshape(-1, 3)))
        inside = scene.crossings(corners[part == number][0, 0], WAY)[0] % 2 if len(others) else 0
        if not inside or by_part[number] == 0:
            raise _refusal(
                "is inside out" if by_part[number] < 0 else "has no volume",
                place,
                "turn its triangles round, so that they run counter-clockwise seen from outside",
            )


def one_medium(media: Sequence[Medium], stated: set[str], place: tuple[str, str]) -> Medium | None:
    """The medium of all parts, where the scene does not state it; None: the file says nothing."""
    for key in ("index", "cauchy_b_um2", "absorption_per_m"):
        if key not in stated and len({getattr(medium, key) for medium in media}) > 1:
            raise _refusal(
                f"has materials of different {key}",
                place,
                f"state {key} in [[glass]], or use one file for each material",
            )
    return media[0] if media else None


def _refusal(rule: str, place: tuple[str, str], remedy: str) -> InputError:
    return InputError(rule, file=place[0], field=place[1], remedy=remedy)
