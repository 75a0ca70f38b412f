"""A picture in linear light with a depth for every pixel, and lines drawn into it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.spaces import View, transform_points

__all__ = ["Canvas", "Colour"]

Float = NDArray[np.float64]
Colour = tuple[float, float, float]

# Lines that come nearer to the eye than this are cut, metres.
NEAR_M = 0.05
# What lies behind a surface by less than this share of its distance lies in it.
IN_SURFACE = 2e-3
# Of what is behind a surface this share still shows.
SEEN_THROUGH = 0.16
# Lines farther away are fainter: the farthest has this share of the nearest one's ink.
FAR_INK = 0.3
# Fragments of lines that are held at once.
CHUNK = 1 << 21


class Canvas:
    """Linear display values (H, W, 3), and depth (H, W) along the axis of a pinhole view."""

    def __init__(self, view: View, background: Float) -> None:
        self.view = view
        self.colour = np.broadcast_to(background, (*view.shape, 3)).copy()
        self.depth = np.full(view.shape, np.inf)

    def blend(self, rows: slice, columns: slice, colour: Float, alpha: Float) -> None:
        """Lays `colour` (h, w, 3) with coverage `alpha` (h, w) over a part of the picture."""
        here = self.colour[rows, columns]
        self.colour[rows, columns] = here + alpha[..., None] * (colour - here)

    def lines(self, ends: Float, colour: Colour, /, *, width_px: float, ink: float = 1.0) -> None:
        """Straight lines between `ends` (n, 2, 3), metres, world.

        Where they cross they do not add up; what is nearer has more ink.
        """
        ends = _clipped(transform_points(self.view.camera_from_world, ends))
        if len(ends) == 0:
            return
        pixels = self.view.project(ends)
        alpha = np.zeros(self.depth.size)
        depths = ends[..., 2]
        cue = float(depths.min()), float(depths.max())
        for start, stop in _chunks(pixels, self.view):
            flat, cover, depth = _fragments(
                pixels[start:stop], depths[start:stop], self.view, width_px
            )
            share = (depth - cue[0]) / max(cue[1] - cue[0], 1e-9)
            cover = cover * (1 - (1 - FAR_INK) * share)
            hidden = depth > self.depth.ravel()[flat] * (1 + IN_SURFACE)
            np.maximum.at(alpha, flat, np.where(hidden, SEEN_THROUGH, 1.0) * cover)
        layer = np.broadcast_to(np.array(colour), self.colour.shape)
        self.blend(slice(None), slice(None), layer, ink * alpha.reshape(self.depth.shape))


def _clipped(ends: Float) -> Float:
    """Lines (n, 2, 3) of the camera's frame, cut at the near plane; none behind it."""
    a, b = ends[:, 0], ends[:, 1]
    ahead = (a[:, 2] > NEAR_M) | (b[:, 2] > NEAR_M)
    a, b = a[ahead].copy(), b[ahead].copy()
    for here, there in ((a, b), (b, a)):
        behind = here[:, 2] < NEAR_M
        step = (NEAR_M - here[behind, 2]) / (there[behind, 2] - here[behind, 2])
        here[behind] += step[:, None] * (there[behind] - here[behind])
    return np.stack([a, b], axis=1)


def _steps(pixels: Float, view: View) -> NDArray[np.int64]:
    """(n,) pixels that each line takes along its longer side; no more than the picture has."""
    length = np.abs(pixels[:, 1] - pixels[:, 0]).max(axis=1)
    return np.ceil(np.minimum(length, 4 * max(view.shape))).astype(np.int64) + 1


def _chunks(pixels: Float, view: View) -> list[tuple[int, int]]:
    """(start, stop) of groups of lines with a bounded number of fragments."""
    total = np.cumsum(_steps(pixels, view) * 8)
    group = total // CHUNK
    starts = np.flatnonzero(np.diff(group, prepend=-1))
    return list(zip(starts.tolist(), [*starts[1:].tolist(), len(pixels)], strict=True))


def _fragments(
    pixels: Float, depths: Float, view: View, width_px: float
) -> tuple[NDArray[np.int64], Float, Float]:
    """Numbers of the pixels that lines touch, how far they cover them, and the lines' depths.

    `pixels` (n, 2, 2) and `depths` (n, 2) of their ends. Each line is followed along its longer
    side, a few pixels across at a time; coverage falls from 1 to 0 within one pixel of its edge.
    """
    steps = _steps(pixels, view)
    line = np.repeat(np.arange(len(steps)), steps)
    first = np.repeat(np.cumsum(steps) - steps, steps)
    along = (np.arange(len(line)) - first) / np.maximum(steps - 1, 1)[line]
    delta = pixels[:, 1] - pixels[:, 0]
    steep = np.abs(delta[:, 1]) > np.abs(delta[:, 0])
    point = pixels[line, 0] + along[:, None] * delta[line]
    # 1/depth is linear on the screen.
    inverse = 1 / depths
    depth = 1 / (inverse[line, 0] + along * (inverse[line, 1] - inverse[line, 0]))
    reach = int(np.ceil(width_px / 2 * 1.5 + 0.5))
    offsets = np.arange(-reach, reach + 1)
    base = np.round(point).astype(np.int64)
    column = base[:, 0, None] + np.where(steep[line, None], offsets, 0)
    row = base[:, 1, None] + np.where(steep[line, None], 0, offsets)
    length = np.maximum(np.linalg.norm(delta, axis=1), 1e-9)[line, None]
    away = (column - pixels[line, 0, 0, None]) * delta[line, 1, None]
    away = np.abs(away - (row - pixels[line, 0, 1, None]) * delta[line, 0, None]) / length
    cover = np.clip(width_px / 2 + 0.5 - away, 0, 1)
    height, width = view.shape
    seen = (cover > 0) & (column >= 0) & (column < width) & (row >= 0) & (row < height)
    return (
        (row * width + column)[seen],
        cover[seen],
        np.broadcast_to(depth[:, None], seen.shape)[seen],
    )
