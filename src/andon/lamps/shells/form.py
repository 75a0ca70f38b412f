"""The form of a shell, made ready: facets that emit, lids, and the triangles that are drawn."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.lamps.coarse import coarse_corners
from andon.lamps.polygons import vector_area
from andon.lamps.shells.beams import solid_angles
from andon.lamps.shells.cutting import cut_long, widest_edge
from andon.lamps.shells.drum import drum_mesh, rim_loop
from andon.lamps.shells.layer import FIELD, Layer, clean_layer, rims
from andon.lamps.shells.lids import fan, flat_lid
from andon.lamps.shells.model import KEPT, Drum, Shell
from andon.lamps.shells.pairs import flat_pairs
from andon.lamps.solids import icosphere
from andon.lamps.triangles import area_vectors, triangle_areas
from andon.quantities import Geometry

__all__ = ["Form", "form_of"]

Float = NDArray[np.float64]

# Triangles that emit: every one is a loop iteration of a shader, for every pixel.
MAX_FACETS = 64
# Rims beyond this are a perforated sheet, not openings that deserve an area lamp each.
MAX_LIDS = 8
# A rim that spans less than this share of the shell is a seam that was not closed, not an opening.
SEAM = 1e-4
IN_PLANE = 1e-6
# How often the shell may cover a direction twice before it is no single layer any more.
MAX_OVERLAP = 0.05
# The lamp sees edges of the drawn shell under this at most, unless that took too many triangles,
# and of its facets under the other. On a flat wall luminance falls as cos³ of the angle: halfway
# along an edge of δ it differs from the mean of both ends by up to ⅜ δ² (1.5 %).
DRAWN_RADIANS, MAX_DRAWN = 0.2, 40_000
FACET_RADIANS = 1.2
# Of their area, facets that are cut across may lose so much more.
CUT_LOSS = 0.1
SPHERE_CUTS_DRAWN, SPHERE_CUTS_LIGHT = 4, 1
# Panels around and along a drum: seen within 0.1 % of its radius, and as many emit as may.
DRUM_DRAWN, DRUM_LIGHT = (72, 12), (16, 2)


@dataclass(frozen=True, eq=False)
class Form:
    """A shell's triangles relative to its lamp, outside counter-clockwise.

    Attributes
    ----------
    drawn : geometry of the body, with normals where the mesh has them.
    corners : (m, 3, 3) all triangles as given.
    facets : (n, 3, 3) the triangles that stand for them as emitters.
    covers : (k, 3, 3) triangles that close it; none if `has_gaps` or nothing is open.
    lids : flat polygons (k, 3), one for each opening, counter-clockwise from outside.
    has_gaps : several parts, or too many openings: what is open is what the parts leave free.
    """

    drawn: Geometry
    corners: Float
    facets: Float
    covers: Float
    lids: tuple[Float, ...] = ()
    has_gaps: bool = False

    @property
    def is_open(self) -> bool:
        """Some light gets out without meeting the shell."""
        return bool(self.lids) or self.has_gaps

    @cached_property
    def facet_groups(self) -> NDArray[np.int32]:
        """(n,) facets of one number shine alike, whatever shines inside."""
        return flat_pairs(self.facets)


@lru_cache(maxsize=KEPT)
def form_of(shell: Shell, /) -> Form:
    """The form of `shell`; kept for as long as there are few others.

    Raises `InputError` for a mesh that is no shell: see `clean_layer`; the lamp is outside; it
    covers itself.
    """
    if shell.drum is not None:
        return _drum(shell.drum)
    if shell.mesh is None:
        return _sphere(shell.radius_m or 0.0)
    layer = clean_layer(shell.mesh.positions, shell.mesh.triangles)
    loops = _openings(layer)
    if int(layer.part.max()) == 0 and len(loops) <= MAX_LIDS:
        layer, loops = _around_lamp(layer, loops)
        lids = tuple(flat_lid(loop) for loop in loops)
        gaps = False
    else:
        layer, gaps = _outwards(layer)
        loops, lids = [], ()
    covers = [fan(loop) for loop in loops]
    return Form(
        _drawn(shell.mesh, layer),
        layer.corners,
        _facets(layer),
        np.concatenate(covers) if covers else np.empty((0, 3, 3)),
        lids,
        gaps,
    )


def _sphere(radius_m: float) -> Form:
    fine, coarse = icosphere(SPHERE_CUTS_DRAWN), icosphere(SPHERE_CUTS_LIGHT)
    corners = coarse.positions[coarse.triangles]
    flat = triangle_areas(corners).sum()
    facets = corners * radius_m * np.sqrt(4 * np.pi / flat)  # the area of the ball itself
    drawn = Geometry(fine.positions * radius_m, fine.triangles, fine.normals)
    whole = drawn.positions[drawn.triangles]
    return Form(drawn, whole, facets, np.empty((0, 3, 3)))


def _drum(drum: Drum) -> Form:
    drawn, (around, along) = drum_mesh(drum, *DRUM_DRAWN), DRUM_LIGHT
    corners = drawn.positions[drawn.triangles]
    # Polygons with the area of the circles they stand for: walls and lids alike.
    wider = np.sqrt(2 * np.pi / around / np.sin(2 * np.pi / around))
    coarse = drum_mesh(drum, around, along, wider)
    lids = tuple(rim_loop(drum, around, wider, above=above) for above in (True, False))
    covers = [fan(rim_loop(drum, DRUM_DRAWN[0], 1.0, above=above)) for above in (True, False)]
    facets = coarse.positions[coarse.triangles]
    return Form(drawn, corners, facets, np.concatenate(covers), lids)


def _openings(layer: Layer) -> list[Float]:
    size = float(np.ptp(layer.positions, axis=0).max())
    loops = rims(layer)
    return [loop for loop in loops if np.linalg.norm(vector_area(loop)) > (SEAM * size) ** 2]


def _around_lamp(layer: Layer, loops: list[Float]) -> tuple[Layer, list[Float]]:
    """One part, turned outwards. Closed by its lids it goes round the lamp once, or not at all."""
    open_sr = [float(solid_angles(fan(loop)).sum()) for loop in loops]
    turns = (float(solid_angles(layer.corners).sum()) + sum(open_sr)) / (4 * np.pi)
    # In the plane of an opening rounding decides on which side of it the lamp is.
    widest = max(map(abs, open_sr), default=0.0) / (2 * np.pi)
    if abs(abs(turns) - 1) > 0.25 or abs(widest - 1) < IN_PLANE:
        raise _outside()
    if turns < 0:
        layer = layer.turned(np.ones(len(layer.triangles), np.bool_))
        loops = [loop[::-1] for loop in loops]
    _check_overlap(layer, float(solid_angles(layer.corners).sum()))
    return layer, loops


def _outwards(layer: Layer) -> tuple[Layer, bool]:
    """Several parts, each turned so that the lamp sees its inside; and whether gaps remain."""
    seen = np.bincount(layer.part, solid_angles(layer.corners))
    layer = layer.turned((seen < 0)[layer.part])
    covered = float(np.abs(seen).sum())
    if covered < 1e-6:
        raise _outside()
    _check_overlap(layer, min(covered, 4 * np.pi))
    return layer, covered < 4 * np.pi * (1 - SEAM)


def _check_overlap(layer: Layer, covered: float) -> None:
    hit = float(np.maximum(solid_angles(layer.corners), 0).sum())
    if hit > covered + 4 * np.pi * MAX_OVERLAP:
        raise InputError(
            f"covers itself as seen from its lamp: {hit / (4 * np.pi):.0%} of all directions "
            f"instead of {covered / (4 * np.pi):.0%}",
            field=FIELD,
            remedy="a shell is one layer of triangles around the lamp, without thickness",
        )


def _outside() -> InputError:
    return InputError(
        "the lamp is outside its shell, or on it",
        field=FIELD,
        remedy="the mesh's origin is where the lamp is: move the mesh around it; a shell is one "
        "layer, without thickness",
    )


def _facets(layer: Layer) -> Float:
    """Few triangles for many, none of which spans bright and dark parts if that can be helped."""
    facets = coarse_corners(layer.positions, layer.triangles, MAX_FACETS)
    if widest_edge(facets) <= FACET_RADIANS:
        return facets
    # Long slivers, as modellers make cylinders: fewer of them leave room to cut them across.
    fewer = coarse_corners(layer.positions, layer.triangles, MAX_FACETS // 4)
    cut = cut_long(fewer, radians=FACET_RADIANS / 2, most=MAX_FACETS)
    lost = abs(triangle_areas(fewer).sum() / triangle_areas(facets).sum() - 1)
    return cut if lost < CUT_LOSS and widest_edge(cut) < widest_edge(facets) else facets


def _drawn(mesh: Geometry, layer: Layer) -> Geometry:
    """The mesh as given, turned outwards, with corners of its own where it is flat-shaded."""
    triangles = mesh.triangles[layer.source].astype(np.int64)
    corners = np.where(layer.flipped[:, None], triangles[:, ::-1], triangles)
    at = mesh.positions[corners]
    normals = None if mesh.normals is None else mesh.normals[corners].copy()
    if normals is not None:
        # A file's normals may look in while its triangles look out: each joins its triangle.
        normals *= np.where(np.einsum("tki,ti->tk", normals, area_vectors(at)) < 0, -1, 1)[
            ..., None
        ]
    both = at if normals is None else np.concatenate([at, normals], axis=2)
    both = cut_long(both, radians=DRAWN_RADIANS, most=MAX_DRAWN)
    at, normals = both[..., :3], None if normals is None else both[..., 3:]
    return Geometry(
        at.reshape(-1, 3),
        np.arange(3 * len(at), dtype=np.int32).reshape(-1, 3),
        None if normals is None else _unit(normals.reshape(-1, 3)),
    )


def _unit(vectors: Float) -> Float:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.maximum(length, np.finfo(float).tiny)
