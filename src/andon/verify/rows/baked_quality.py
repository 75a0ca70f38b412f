"""The presets of baked light against many more rays, in a small room.

::

    ┌──── 4 m ────┐    A room of 4 × 2.6 × 4 m with a red wall, a panel of 0.6 × 0.6 m below the
    │    ▁▁▁      │    ceiling that looks down, and a block of 1 × 0.7 × 1 m on the floor. A map of
    │        ┌──┐ │    64 × 48 sees it from a corner; the truth is at 48 of its points, where each
    └────────┴──┘─┘    hemisphere has as many rays as Radiance was given time for.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from andon.bake.tasks import write_bundle
from andon.lamps import PolygonLamp
from andon.quantities import Geometry, Material, photometric
from andon.rays import RayScene, face_normals
from andon.spaces import View, look_at
from andon.transport.baked.radiance.quality import FEW_POINTS, QUALITIES, Quality
from andon.transport.baked.radiance.scene import radiance_bundle
from andon.transport.baked.radiance.trace import traced_illuminance
from andon.verify.registry import Row

__all__ = ["ROWS", "errors"]

Float = NDArray[np.float64]

WIDTH, HEIGHT = 64, 48
BOUNCES = 4
TRUTH_POINTS = 48
TRUTH_RAYS = 2048
# Of the panel: more only cost time, of presets and truth alike.
TILES = 16
# As they face, six sides of a box: the corners with these bits of x, y, z.
SIDES = ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6))


def _box(size: tuple[float, ...], middle: tuple[float, ...], *, inwards: bool) -> Geometry:
    """A box of grey sides, of which that at −x is red."""
    bits = (np.arange(8)[:, None] >> np.arange(3)) & 1
    corners = np.asarray(np.array(middle) + (bits - 0.5) * np.array(size), np.float64)
    sides = np.array(SIDES)[:, ::-1] if inwards else np.array(SIDES)
    triangles = sides[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3).astype(np.int32)
    grey, red = Material(reflectance=(0.6, 0.6, 0.6)), Material(reflectance=(0.6, 0.1, 0.1))
    ids = np.repeat(np.array([1, 0, 0, 0, 0, 0], np.int32), 2)
    return Geometry(corners, triangles, material_ids=ids, materials=(grey, red))


@cache
def _parts() -> tuple[Geometry, Geometry]:
    room = _box((4, 2.6, 4), (0, 1.3, 0), inwards=True)
    return room, _box((1, 0.7, 1), (0.9, 0.351, -0.6), inwards=False)


def _panel() -> PolygonLamp:
    corners = np.array([[-0.3, 2.5, -0.3], [0.3, 2.5, -0.3], [0.3, 2.5, 0.3], [-0.3, 2.5, 0.3]])
    return PolygonLamp("panel", np.full(3, 2000.0), corners)


@cache
def _seen() -> tuple[Float, Float]:
    """(n, 3) positions and normals of what the map sees."""
    pose = look_at(np.array([-1.8, 2.0, 1.8]), np.array([0.4, 0.8, -0.6]))
    middle = ((WIDTH - 1) / 2, (HEIGHT - 1) / 2)
    view = View("pinhole", WIDTH, HEIGHT, 40.0, 40.0, *middle, world_from_camera=pose)
    origin, directions = view.rays_world()
    along = np.asarray(directions, np.float64).reshape(-1, 3)
    place, facing = np.empty_like(along), np.empty_like(along)
    nearest = np.full(len(along), np.inf)
    for part in _parts():
        hits = RayScene(part).first_hits(np.broadcast_to(origin, along.shape).copy(), along)
        nearer = hits.distance < nearest
        nearest[nearer] = hits.distance[nearer]
        facing[nearer] = face_normals(part)[hits.triangle[nearer]]
    place[:] = np.asarray(origin) + nearest[:, None] * along
    return place, facing


@cache
def _luxes(name: str) -> Float:
    """(n,) lux of a preset at all points, or of the truth at the first few of a random order."""
    place, facing = _seen()
    quality, asked = QUALITIES["fine"], _order()[:TRUTH_POINTS]
    if name == "truth":
        quality = replace(quality, alone_divisions=TRUTH_RAYS)
    else:
        quality, asked = QUALITIES[name], np.arange(len(place))
    with TemporaryDirectory(prefix="andon-verify-") as folder:
        write_bundle(Path(folder), radiance_bundle(_parts(), [_panel()], tiles=TILES))
        lux = traced_illuminance(
            Path(folder), place[asked], facing[asked], quality=quality, bounces=BOUNCES
        )
    return np.asarray(photometric(lux), np.float64)


def _order() -> NDArray[np.intp]:
    count = len(_seen()[0])
    assert count >= FEW_POINTS > TRUTH_POINTS
    return np.random.default_rng(1).permutation(count)


def errors(name: str, /) -> tuple[float, float]:
    """Median and 95th percentile of a preset's relative error where the truth is known."""
    truth = _luxes("truth")
    error = np.abs(_luxes(name)[_order()[:TRUTH_POINTS]] - truth) / truth
    return float(np.median(error)), float(np.percentile(error, 95))


def _rows(quality: Quality) -> tuple[Row, Row]:
    name = f"baked.quality.{quality.name}"
    against = f"Radiance, {TRUTH_RAYS} rays a point; a small room, {BOUNCES} bounces"
    return (
        Row(
            f"{name}.median", "baked", quality.median_error, "relative", against,
            lambda: errors(quality.name)[0],
        ),
        Row(
            f"{name}.p95", "baked", quality.p95_error, "relative", against,
            lambda: errors(quality.name)[1],
        ),
    )  # fmt: skip


ROWS: tuple[Row, ...] = tuple(row for quality in QUALITIES.values() for row in _rows(quality))
