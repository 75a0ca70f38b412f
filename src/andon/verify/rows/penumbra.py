"""The width of a penumbra behind a straight edge.

::

          lamp, 2 m up          The board reaches from the edge to the right; the camera looks down
            ──●──               from under it. Where 90 % of the light is left the penumbra begins,
              ╎  a              where 10 % is left it ends; in between it is lamp · b/a wide and has
              ╎                 the lamp's own form.
    ══════════╡▒▒▒▒ board
              ╎  b
    ───▒▒▒▒▒▒▒▒▒▒▒▒── floor
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from andon.lamps import AnyAreaLamp, DiskLamp, PolygonLamp, Shadow, SphereLamp
from andon.lamps.areas import SOFT_SHADOW
from andon.pipeline import EngineName, Renderer
from andon.quantities import Geometry
from andon.spaces import View, look_at, pinhole_view
from andon.transport.direct import reference
from andon.verify.registry import Row
from andon.verify.setting import prepared_of
from andon.verify.truths import cones

__all__ = ["RATIOS", "ROWS", "SHAPES", "penumbra_error", "penumbra_widths"]

Float = NDArray[np.float64]

SHAPES = ("sphere", "disk", "rectangle")
LAMP_M, RADIUS_M = 2.0, 0.1
# b/a: the board near the floor, in the middle, near the lamp.
RATIOS = (0.25, 1.0, 4.0)
BEGINS, ENDS = 0.9, 0.1
WIDTH = 400
WHITE = np.full(3, 1000.0)
# Beside what a lamp has unless told otherwise: four times the samples, maps twice as fine.
FINE_SHADOW = Shadow(map_size=1024, samples=64)


def _lamp(shape: str, shadow: Shadow) -> AnyAreaLamp:
    at, down = np.array([0.0, LAMP_M, 0.0]), np.array([0.0, -1.0, 0.0])
    if shape == "sphere":
        return SphereLamp(shape, WHITE, at, RADIUS_M, shadow=shadow, drawn=False)
    if shape == "disk":
        return DiskLamp(shape, WHITE, at, down, RADIUS_M, shadow=shadow, drawn=False)
    corners = RADIUS_M * np.array([(-1.0, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1)])
    return PolygonLamp(shape, WHITE, at + corners, shadow=shadow, drawn=False)


def _floor_and_board(height: float) -> Geometry:
    floor = np.array([(-4.0, 0, -4), (-4, 0, 4), (4, 0, 4), (4, 0, -4)])
    board = np.array([(0.0, height, -4), (0, height, 4), (4, height, 4), (4, height, -4)])
    faces = np.array([(0, 1, 2), (0, 2, 3)], np.int32)
    return Geometry(np.concatenate([floor, board]), np.concatenate([faces, faces + 4]))


def _view(height: float, reach: float) -> View:
    """Down on the floor from under the board, `reach` metres to either side of the edge."""
    eye = np.array([0.0, 0.8 * height, 0.0])
    pose = look_at(eye, np.zeros(3), (0.0, 0.0, -1.0))
    focal = 0.5 * WIDTH * eye[1] / reach
    return pinhole_view(WIDTH, 9, focal, pose)


def _width(place: Float, share: Float) -> float:
    """Metres between the first places where `share` falls to `BEGINS` and to `ENDS`."""
    ends: list[float] = []
    for level in (BEGINS, ENDS):
        after = int(np.argmax(share <= level))
        before = after - 1
        part = (share[before] - level) / (share[before] - share[after])
        ends.append(float(place[before] + part * (place[after] - place[before])))
    return ends[1] - ends[0]


@cache
def penumbra_widths(
    shape: str, ratio: float, engine: EngineName, shadow: Shadow = SOFT_SHADOW
) -> tuple[float, float]:
    """Width of the penumbra in metres: ours, and by quadrature of the lamp cut at the edge."""
    lamp, height = _lamp(shape, shadow), LAMP_M * ratio / (1 + ratio)
    view = _view(height, 2.5 * RADIUS_M * ratio)
    frame = Renderer(prepared_of(_floor_and_board(height), view, (lamp,)), engine).render()
    row = view.height // 2
    points = np.asarray(frame.surface.position[row], np.float64)
    order = np.argsort(points[:, 0])
    points = points[order]
    up = np.tile([0.0, 1.0, 0.0], (len(points), 1))
    ours = np.asarray(frame.illuminance.lux, float)[row, order, 1]
    ours = ours / reference.illuminance(lamp, points, up)[:, 1]
    # Seen is what lies on the board's open side of the plane through the receiver and the edge.
    edge = np.stack([np.full(len(points), -height), -points[:, 0], np.zeros(len(points))], axis=1)
    truth = cones.illuminance(lamp, points, up, edge=edge) / cones.illuminance(lamp, points, up)
    return _width(points[:, 0], ours), _width(points[:, 0], truth[:, 1])


def penumbra_error(shape: str, engine: EngineName, shadow: Shadow = SOFT_SHADOW) -> float:
    """The worst relative error of the width over `RATIOS`."""
    widths = [penumbra_widths(shape, ratio, engine, shadow) for ratio in RATIOS]
    return max(abs(ours / truth - 1) for ours, truth in widths)


def _row(shape: str, engine: EngineName, shadow: Shadow) -> Row:
    fine = ".fine" if shadow is FINE_SHADOW else ""
    return Row(
        f"relight.soft.penumbra.{shape}{fine}.{engine}",
        "relight",
        0.15,
        "relative",
        "quadrature of the lamp cut by a straight edge; 10 to 90 %, b/a of ¼, 1 and 4, "
        f"{shadow.samples} samples, maps of {shadow.map_size}²",
        lambda: penumbra_error(shape, engine, shadow),
    )


ROWS: tuple[Row, ...] = tuple(
    _row(shape, engine, shadow)
    for shadow in (SOFT_SHADOW, FINE_SHADOW)
    for shape in SHAPES
    for engine in ("reference", "gpu")
)
