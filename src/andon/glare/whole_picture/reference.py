"""The veil of all light of a picture in float64; `plan` says what is done and in which order."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glare.whole_picture.charts import MARGIN, Chart, block_directions
from andon.glare.whole_picture.plan import WholePlan
from andon.glare.whole_picture.splines import filters, spline_weights

__all__ = ["Scattered", "scattered", "veil"]

Float = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Scattered:
    """A picture as it is seen through the eye.

    Attributes
    ----------
    picture : (H, W, 3) cd/m², (1 − k)·L + glare.
    glare : (H, W, 3) cd/m², the veil: what is added.
    share : (H, W) k of each pixel: the share of its light that leaves it. Less than the kernel's
        where pixels are coarse and keep much in themselves, more by the core where they are fine.
    """

    picture: Float
    glare: Float
    share: Float


def scattered(luminance: NDArray[Any], plan: WholePlan, /) -> Scattered:
    """The picture with its veil, energy kept; `luminance` (H, W, 3) cd/m².

    Raises `InputError` unless `luminance` is (H, W, 3) of the plan's view, finite and ≥ 0.
    """
    light = np.asarray(luminance, np.float64)
    glare = veil(light, plan)
    share = resolved(plan)
    return Scattered((1 - share[..., None]) * light + glare, glare, share)


def veil(luminance: NDArray[Any], plan: WholePlan, /) -> Float:
    """(H, W, 3) cd/m² the light that is scattered to each pixel from elsewhere.

    Raises `InputError` unless `luminance` is (H, W, 3) of the plan's view, finite and ≥ 0.
    """
    light = np.asarray(luminance, np.float64)
    if light.shape != (*plan.view.shape, 3):
        raise InputError(f"must be {(*plan.view.shape, 3)}, got {light.shape}", field="luminance")
    if not (np.isfinite(light).all() and (light >= 0).all()):
        raise InputError("must be finite and ≥ 0", field="luminance")
    blocks = reduce_blocks(light * plan.view.solid_angles()[..., None])
    directions = block_directions(plan.view)
    lights = [_pyramid(into_chart(blocks, directions, c), plan.levels) for c in plan.charts]
    far = _far([levels[plan.far.level - 1] for levels in lights], plan)
    veils = plan.of_blocks()[..., None] * (wrapped(blocks) if plan.wraps else blocks)
    for chart, levels, coarse in zip(plan.charts, lights, far, strict=True):
        seen = _accumulated(chart, levels, coarse, plan)
        share = chart.share(directions, pair=plan.pair)[..., None]
        veils += share * _read(seen, chart.array_place(chart.place_from_direction(directions), 1))
    glare = expand_blocks(veils, plan.view.shape)
    return glare if plan.neighbours is None else glare + plan.neighbours.veil(light)


def resolved(plan: WholePlan, /) -> Float:
    """(H, W) share of each pixel's light that leaves it."""
    # As the veil is made: of blocks, and read from them.
    directions = block_directions(plan.view)
    shares = np.stack([c.share(directions, pair=plan.pair) for c in plan.charts])
    each = np.stack([plan.resolved(c.scale(directions)) for c in plan.charts])
    whole = np.sum(shares * each, 0)[..., None]
    beside = 0.0 if plan.neighbours is None else plan.neighbours.share()
    return expand_blocks(whole, plan.view.shape)[..., 0] + beside


def reduce_blocks(light: Float, /) -> Float:
    """Light of pixels (H, W, 3), summed to blocks: ¾ to its own and ¼ to the nearer neighbour."""
    for axis in (0, 1):
        light = np.moveaxis(light, axis, 0)
        light = np.concatenate([light, np.zeros((len(light) % 2, *light.shape[1:]))])
        out = np.zeros((len(light) // 2 + 2, *light.shape[1:]))
        out[1:-1] = 0.75 * (light[::2] + light[1::2])
        out[:-2] += 0.25 * light[::2]
        out[2:] += 0.25 * light[1::2]
        light = np.moveaxis(out, 0, axis)
    return light


def expand_blocks(blocks: Float, shape: tuple[int, int], /) -> Float:
    """(H, W, 3) from blocks: ¾ of its own and ¼ of the nearer neighbour, along each axis."""
    for axis in (0, 1):
        blocks = np.moveaxis(blocks, axis, 0)
        out = np.empty((2 * (len(blocks) - 2), *blocks.shape[1:]))
        out[::2] = 0.75 * blocks[1:-1] + 0.25 * blocks[:-2]
        out[1::2] = 0.75 * blocks[1:-1] + 0.25 * blocks[2:]
        blocks = np.moveaxis(out, 0, axis)
    return blocks[: shape[0], : shape[1]]


def wrapped(blocks: Float, /) -> Float:
    """Blocks of a panorama (rows, columns, 3) with what is the same place at the other side."""
    out = blocks.copy()
    out[:, [0, 1, -2, -1]] += blocks[:, [-2, -1, 0, 1]]
    return out


def into_chart(blocks: Float, directions: Float, chart: Chart, /) -> Float:
    """D₁, (rows, columns, 3) with margins, of blocks' light; what lies outside is left out."""
    shape = chart.array_shape(1)
    places = chart.array_place(chart.place_from_direction(directions), 1)
    inside = ((places >= 0.5) & (places < np.array(shape[::-1]) - 1.5)).all(-1)
    (x, wx), (y, wy) = (spline_weights(places[inside][:, axis]) for axis in (0, 1))
    light = blocks[inside] / chart.cell**2
    out = np.zeros((shape[0] * shape[1], 3))
    for row in range(3):
        for column in range(3):
            cells = (y + row) * shape[1] + x + column
            weights = wy[:, row] * wx[:, column]
            for channel in range(3):
                out[:, channel] += np.bincount(cells, weights * light[:, channel], len(out))
    return out.reshape(*shape, 3)


def _pyramid(first: Float, levels: int) -> list[Float]:
    found = [first]
    while len(found) < levels:
        found.append(reduced(found[-1]))
    return found


def reduced(cells: Float, /) -> Float:
    """D of the next level, [1 3 3 1]/8 along each axis; margins in, margins out."""
    for axis in (0, 1):
        inner = np.moveaxis(cells, axis, 0)
        size = -(-(len(inner) - 2 * MARGIN) // 2)
        # Cell p of the next level lies at p + MARGIN, and its first tap at 2p − 1 + MARGIN.
        long = np.zeros((2 * (size + 2 * MARGIN) + 2, *inner.shape[1:]))
        long[MARGIN + 1 : MARGIN + 1 + len(inner)] = inner
        taken = [long[k : k + 2 * (size + 2 * MARGIN) : 2] for k in range(4)]
        out = (taken[0] + 3 * taken[1] + 3 * taken[2] + taken[3]) / 8
        cells = np.moveaxis(out, 0, axis)
    return cells


def expanded(cells: Float, shape: tuple[int, int], /) -> Float:
    """A of the level below, of `shape` with margins, [3 1]/4 along each axis."""
    for axis in (0, 1):
        inner = np.moveaxis(cells, axis, 0)
        index = np.arange(shape[axis]) - MARGIN
        own = index // 2 + MARGIN
        other = np.clip(own + np.where(index % 2 == 0, -1, 1), 0, len(inner) - 1)
        cells = np.moveaxis(0.75 * inner[own] + 0.25 * inner[other], 0, axis)
    return cells


def _filtered(cells: Float, half: tuple[float, ...]) -> Float:
    for axis in (0, 1):
        inner = np.moveaxis(cells, axis, 0)
        reach = len(half) - 1
        long = np.pad(inner, [(reach, reach), *[(0, 0)] * 2])
        out = half[0] * inner
        for k in range(1, reach + 1):
            out = out + half[k] * (
                long[reach + k :][: len(inner)] + long[reach - k :][: len(inner)]
            )
        cells = np.moveaxis(out, 0, axis)
    return cells


def _far(light: list[Float], plan: WholePlan) -> list[Float]:
    """A of the far part at level F, a picture per chart."""
    of, to = plan.far.light_cells, plan.far.receiving_cells
    sent: Float = np.stack([light[int(chart)][row, column] for chart, row, column in of])
    veils = [np.zeros_like(cells) for cells in light]
    for (chart, row, column), value in zip(to, plan.far.matrix @ sent, strict=True):
        veils[chart][row, column] = value
    return veils


def _accumulated(chart: Chart, levels: list[Float], far: Float, plan: WholePlan) -> Float:
    """A₁ of a chart."""
    above: Float | None = None
    for level in range(plan.levels, 0, -1):
        light = levels[level - 1]
        scale = chart.scale(chart.cell_directions(level))
        here = far if level == plan.far.level else np.zeros_like(light)
        for rung in (r for r in plan.ladder.rungs if r.level == level):
            root = plan.root(rung, scale)[..., None]
            here = here + root * _filtered(root * light, filters(level)[rung.which])
        above = here if above is None else here + expanded(above, light.shape[:2])
    assert above is not None
    return above


def _read(cells: Float, places: Float) -> Float:
    """Cells (rows, columns, 3) at fractional indices (..., 2) by the spline; 0 outside."""
    rows, columns = cells.shape[:2]
    (x, wx), (y, wy) = (spline_weights(places[..., axis]) for axis in (0, 1))
    inside = (x >= 0) & (y >= 0) & (x + 2 < columns) & (y + 2 < rows)
    x, y = np.where(inside, x, 0), np.where(inside, y, 0)
    out = np.zeros((*places.shape[:-1], 3))
    for row in range(3):
        for column in range(3):
            out += (wy[..., row] * wx[..., column])[..., None] * cells[y + row, x + column]
    return out * inside[..., None]
