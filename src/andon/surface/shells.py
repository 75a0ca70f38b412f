"""Real shells: which pixels of a photograph show the shade of a lamp, and what else it takes up.

The shade stands in the photograph and in its geometry, unlit. What the user states of it (a drum,
a mesh) and what was measured agree within a margin only, and measured shades have holes: they are
thin, often white, and end in the air. So both have a say::

    pixel                                     its own light, w times
    ─────────────────────────────────────────────────────────────────────────────────────────
    real surface within the margin of the     1; where the stated outline crosses such a pixel
    shell                                     at the rim of all these: the share it covers
    hole in whose direction the shell is,     the same
    before the hole's cover
    beside these, surface not before the      the share that the stated outline covers, if it
    shell                                     is not the whole pixel
    anything else                             0

A stated outline that is too small thus leaves no dark ring, and one that is too large lights
nothing that the geometry knows to be something else.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.lamps.bodies import Body
from andon.quantities import Surface
from andon.rays import Hits, RayScene, face_normals
from andon.spaces import View, rotate
from andon.surface.nearest import nearest_distance

__all__ = ["ShellsInView", "find_shells"]

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int = NDArray[np.int64]

# Places within a pixel where a rim is asked how much of it the shell covers: 4 × 4.
PLACES = 4
# A hit of a pixel's ray stands for its surface up to so many margins along the ray: at a slant the
# same gap is longer. Beyond it the nearest vertex does.
ALONG_RAY = 3.0
# Only a normal that looks so far away (cosine) means that the inside is seen: near the outline it
# turns over before the surface does.
INSIDE_COSINE = 0.2
# Distances that are compared at once.
CHUNK = 1 << 22


@dataclass(frozen=True)
class _Samples:
    """Places on one shell that pixels show.

    Attributes
    ----------
    pixel : (n,) index into the flattened picture.
    weight : (n,) share of the pixel.
    vertices, shares : (n, 3) vertices of the body, and how much of each.
    outside : (n,) the outside is seen.
    """

    pixel: Int
    weight: Float
    vertices: Int
    shares: Float
    outside: Bool


@dataclass(frozen=True, eq=False)
class ShellsInView:
    """What one view sees of real shells, which stand still.

    Attributes
    ----------
    view : where the pixels look.
    shell_id : (H, W) int32, as `Surface.shell_id`.
    hole_depth : (H, W) depth of shells in holes, inf elsewhere: they hide what is behind them.
    samples : number of a body → the places that are seen of it.
    seen_share : number of a body → share of what the view should see of it that has a surface or a
        hole in its place; None where it should see nothing.
    """

    view: View
    shell_id: NDArray[np.int32]
    hole_depth: Float
    samples: dict[int, _Samples]
    seen_share: dict[int, float | None]

    def marked(self, real: Surface, /) -> Surface:
        """The real surface, which knows what of it is a shell."""
        if not np.isfinite(self.hole_depth).any():
            return replace(real, shell_id=self.shell_id)
        cover = np.full(self.view.shape, np.inf) if real.cover is None else real.cover
        return replace(real, shell_id=self.shell_id, cover=np.minimum(cover, self.hole_depth))

    def shining(self, seen: Surface, bodies: Sequence[Body], /) -> Surface:
        """What is seen, with the shells' own light where no virtual thing is before it."""
        light = np.where(seen.is_object[..., None], 0.0, self.light(bodies))
        return replace(seen, shell_cd_m2=light)

    @property
    def rectangle(self) -> tuple[int, int, int, int]:
        """(x, y, width, height) in pixels that holds all of them; empty where none is seen."""
        pixels = [seen.pixel for seen in self.samples.values()]
        rows, columns = np.divmod(np.concatenate(pixels), self.view.width)
        if not len(rows):
            return 0, 0, 0, 0
        left, top = int(columns.min()), int(rows.min())
        return left, top, int(columns.max()) + 1 - left, int(rows.max()) + 1 - top

    def light(self, bodies: Sequence[Body], /) -> Float:
        """(H, W, 3) cd/m² of the shells' own light, as bright as `bodies` are now."""
        total = np.zeros((self.shell_id.size, 3))
        for number, seen in self.samples.items():
            body = bodies[number]
            sides = body.outside_cd_m2, body.inside_cd_m2
            outside, inside = (
                np.einsum("ni,nij->nj", seen.shares, side[seen.vertices]) for side in sides
            )
            own = seen.outside[:, None]
            light = seen.weight[:, None] * (own * outside + ~own * inside)
            np.add.at(total, seen.pixel, light)
        return total.reshape(*self.view.shape, 3)


def find_shells(
    real: Surface, bodies: Sequence[Body], margins_m: Sequence[float], /
) -> ShellsInView:
    """Where `real`, the real surface alone, shows those of the `bodies` that are real.

    `margins_m` has one number for each of the bodies.
    """
    shell_id = np.full(real.view.shape, -1, np.int32)
    hole_depth = np.full(real.view.shape, np.inf)
    samples: dict[int, _Samples] = {}
    shares: dict[int, float | None] = {}
    for number, (body, margin_m) in enumerate(zip(bodies, margins_m, strict=True)):
        if not body.real:
            continue
        look = _Look(real, body, margin_m)
        members = look.on_surface | look.in_holes & (look.depth < hole_depth)
        shell_id[members] = number
        hole_depth = np.where(look.in_holes & members, look.depth, hole_depth)
        samples[number] = look.samples(members)
        hit = np.isfinite(look.depth)
        shares[number] = float(members[hit].mean()) if hit.any() else None
    return ShellsInView(real.view, shell_id, hole_depth, samples, shares)


class _Look:
    """One shell in one view.

    Attributes
    ----------
    depth : (H, W) of the shell as it is stated, along the pixels' middles; inf beside it.
    on_surface : (H, W) the real surface is the shell.
    in_holes : (H, W) nothing was measured, and the shell is there.
    """

    def __init__(self, real: Surface, body: Body, margin_m: float) -> None:
        self.real, self.body, self.margin_m = real, body, margin_m
        self.scene = RayScene(body.geometry)
        self._normals = face_normals(body.geometry)
        view = real.view
        self._along = np.linalg.norm(view.rays_planar(), axis=-1)
        self.hits = self._hits(view.rays_world()[1].reshape(-1, 3))
        self.depth = self.hits.distance.reshape(view.shape) / self._along
        self.on_surface = self._on_surface()
        cover = np.inf if real.cover is None else real.cover
        nearer = self.depth < np.broadcast_to(cover, view.shape) + margin_m
        self.in_holes = ~real.valid & np.isfinite(self.depth) & nearer

    def _hits(self, directions: Float) -> Hits:
        origins = np.broadcast_to(self.real.view.position, directions.shape)
        return self.scene.first_hits(origins, directions)

    def _on_surface(self) -> Bool:
        points = self.body.geometry.positions
        low, high = points.min(axis=0) - self.margin_m, points.max(axis=0) + self.margin_m
        with np.errstate(invalid="ignore"):
            place = self.real.position
            near = self.real.valid & ((place > low) & (place < high)).all(axis=-1)
        near[near] = nearest_distance(self.real.position[near], self.body.geometry) < self.margin_m
        return near

    def samples(self, members: Bool) -> _Samples:
        """What the pixels of `members`, and those beside them, show."""
        rim = members & _beside(~members)
        beside = ~members & _beside(members) & ~self._before()
        asked = np.flatnonzero(rim | beside)
        covered, fine = self._covered(asked)
        share = np.zeros(members.size)
        share[asked] = covered
        partly = (share > 0) & (share < 1)
        whole = np.flatnonzero(members.ravel() & ~partly)
        kept = partly[fine.pixel]
        parts = [self._at_middles(whole), _chosen(fine, kept)]
        columns = [
            np.concatenate([getattr(part, name) for part in parts])
            for name in ("pixel", "weight", "vertices", "shares", "outside")
        ]
        return _Samples(*columns)

    def _before(self) -> Bool:
        """(H, W) pixels whose surface is before the shell, by its depth there or beside."""
        nearest = _neighbours(self.depth, np.inf).min(axis=0)
        with np.errstate(invalid="ignore"):
            return self.real.valid & (self.real.depth < nearest - self.margin_m)

    def _at_middles(self, pixels: Int) -> _Samples:
        """What members show, each at its middle."""
        triangle, weights = self.hits.triangle[pixels], self.hits.barycentric[pixels]
        place = self.real.position.reshape(-1, 3)[pixels]
        rays = self.real.view.rays_world()[1].reshape(-1, 3)[pixels]
        away = np.linalg.norm(place - self.real.view.position, axis=1)
        gap = np.abs(self.hits.distance[pixels] - away)
        # Of holes there is the hit alone.
        by_ray = ~self.real.valid.ravel()[pixels] | (gap < ALONG_RAY * self.margin_m)
        vertices, shares = np.zeros((len(pixels), 3), np.int64), np.zeros((len(pixels), 3))
        outside = np.zeros(len(pixels), bool)
        triangles = self.body.geometry.triangles
        vertices[by_ray] = triangles[triangle[by_ray]]
        shares[by_ray] = weights[by_ray]
        facing = np.einsum("ij,ij->i", self._normals[triangle], rays)
        outside[by_ray] = facing[by_ray] < 0
        others = np.flatnonzero(~by_ray)
        nearest, normal = self._nearest_vertex(place[others])
        vertices[others] = nearest[:, None]
        shares[others] = 1 / 3
        outside[others] = np.einsum("ij,ij->i", normal, rays[others]) < INSIDE_COSINE
        return _Samples(pixels, np.ones(len(pixels)), vertices, shares, outside)

    def _nearest_vertex(self, points: Float) -> tuple[Int, Float]:
        """(n,) the vertex nearest to each of `points` (n, 3), and its outward normal (n, 3)."""
        geometry = self.body.geometry
        normals = np.zeros_like(geometry.positions)
        np.add.at(normals, geometry.triangles.ravel(), np.repeat(self._normals, 3, axis=0))
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        step = max(1, CHUNK // len(geometry.positions))
        found = [
            np.linalg.norm(points[i : i + step, None] - geometry.positions, axis=2).argmin(axis=1)
            for i in range(0, len(points), step)
        ]
        nearest = np.concatenate(found) if found else np.zeros(0, np.int64)
        return nearest, normals[nearest]

    def _covered(self, pixels: Int) -> tuple[Float, _Samples]:
        """Share of each pixel (n,) that the stated shell covers, and the places that do."""
        rays = _rays_within(self.real.view, pixels)
        hits = self._hits(rays.reshape(-1, 3))
        met = hits.triangle >= 0
        share = met.reshape(len(pixels), -1).mean(axis=1)
        facing = np.einsum("ij,ij->i", self._normals[hits.triangle[met]], rays.reshape(-1, 3)[met])
        seen = _Samples(
            np.repeat(pixels, PLACES**2)[met],
            np.full(np.count_nonzero(met), PLACES**-2.0),
            self.body.geometry.triangles[hits.triangle[met]].astype(np.int64),
            hits.barycentric[met],
            facing < 0,
        )
        return share, seen


def _chosen(samples: _Samples, kept: Bool) -> _Samples:
    return _Samples(
        samples.pixel[kept],
        samples.weight[kept],
        samples.vertices[kept],
        samples.shares[kept],
        samples.outside[kept],
    )


def _beside(mask: Bool) -> Bool:
    """(H, W) pixels that are in `mask`, or one of whose eight neighbours is."""
    return np.logical_or.reduce(_neighbours(mask, False), axis=0)


def _neighbours(values: NDArray[Any], beyond: Any) -> NDArray[Any]:
    """(9, H, W) the 3 × 3 values around each pixel; `beyond` the picture's border."""
    padded = np.pad(values, 1, constant_values=beyond)
    height, width = values.shape
    places = np.ndindex(3, 3)
    return np.stack([padded[row : row + height, column : column + width] for row, column in places])


def _rays_within(view: View, pixels: Int) -> Float:
    """(n, PLACES², 3) unit directions, world, evenly spread over each pixel."""
    offset = (np.arange(PLACES) + 0.5) / PLACES - 0.5
    row, column = np.divmod(pixels, view.width)
    columns = column[:, None, None] + offset[None, None, :]
    rows = row[:, None, None] + offset[None, :, None]
    columns, rows = np.broadcast_arrays(columns, rows)
    directions = view.directions_at(np.stack([columns, rows], axis=-1).reshape(-1, 2))
    return rotate(view.world_from_camera, directions).reshape(len(pixels), PLACES**2, 3)
