"""A plan of suggested cameras, for people: the room from above, with what no camera sees.

::

    ┌──────────────────────────────┐   the room as cut at the height at which the cut is largest,
    │ ░░░░  ①────┐                 │   seen from above; samples of the surface as dots, those that
    │ ░░░░░░░░░░ └─ 38 %           │   no camera sees well larger and in red, whatever their height
    └──────────────────────────────┘

Drawn from the suggestion itself, so that it cannot show another coverage than was counted.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry
from andon.spaces import View
from andon.transport.baked.placement.model import Suggested

__all__ = ["plan_picture"]

Float = NDArray[np.float64]
Rgb = NDArray[np.uint8]
Colour = tuple[int, int, int]

INK, PAPER, FAINT = (32, 32, 32), (245, 243, 238), (120, 118, 112)
CAMERA, FRAME, OPEN = (24, 82, 168), (196, 106, 0), (208, 24, 40)
SEEN_LOW, SEEN_HIGH = (206, 214, 220), (150, 170, 186)
LONGER_PX = 900
MARGIN_PX, LINE_PX = 44, 24
DISC_PX, RING_PX, SIDE_PX = 11, 15, 44
# The picture is drawn larger and made smaller: lines and letters without stairs.
OVERSAMPLING = 2
# Heights at which the cut is tried.
CUTS = 9


class _Plan:
    """Where metres lie on the paper, and the pen."""

    def __init__(self, points: Float, lines: int) -> None:
        from PIL import Image, ImageDraw

        low, high = points[:, [0, 2]].min(axis=0), points[:, [0, 2]].max(axis=0)
        self.low = low
        self.scale = LONGER_PX * OVERSAMPLING / max(float((high - low).max()), 1e-9)
        across, down = np.maximum((high - low) * self.scale / OVERSAMPLING, 240).astype(int)
        self.foot_px = int(down) + 2 * MARGIN_PX
        size = int(across) + 2 * MARGIN_PX, self.foot_px + lines * LINE_PX + LINE_PX // 2
        self.image = Image.new("RGB", (size[0] * OVERSAMPLING, size[1] * OVERSAMPLING), PAPER)
        self.pen: Any = ImageDraw.Draw(self.image)
        self.discs: list[Float] = []

    def pixels(self, points: Float, /) -> Float:
        """(…, 2) of points (…, 3)."""
        return (points[..., [0, 2]] - self.low) * self.scale + MARGIN_PX * OVERSAMPLING

    def dots(self, points: Float, colours: list[Colour], radius_px: float) -> None:
        r = radius_px * OVERSAMPLING
        for (x, y), colour in zip(self.pixels(points).tolist(), colours, strict=True):
            self.pen.ellipse((x - r, y - r, x + r, y + r), fill=colour)

    def text(self, at: Float, words: str, size: int, colour: Colour, anchor: str = "mm") -> None:
        from PIL import ImageFont

        font: Any = ImageFont.load_default(size=size * OVERSAMPLING)
        self.pen.text((float(at[0]), float(at[1])), words, fill=colour, font=font, anchor=anchor)

    def beside_discs(self, at: Float) -> Float:
        """(2,) the nearest place on a spiral around a pixel that no disc covers; takes it."""
        place = at
        turn = np.arange(400) * 2.399963  # the golden angle
        steps = np.sqrt(np.arange(400))[:, None] * (5.0 * OVERSAMPLING)
        for place in at + steps * np.stack([np.cos(turn), np.sin(turn)], axis=-1):
            gaps = [float(np.hypot(*(place - disc))) for disc in self.discs]
            if not gaps or min(gaps) > 2.2 * DISC_PX * OVERSAMPLING:
                break
        self.discs.append(place)
        return place

    def finished(self) -> Rgb:
        from PIL import Image

        size = self.image.width // OVERSAMPLING, self.image.height // OVERSAMPLING
        return np.asarray(self.image.resize(size, Image.Resampling.LANCZOS), np.uint8)


def plan_picture(geometry: Geometry, suggested: Suggested, /) -> Rgb:
    """(h, w, 3) uint8 sRGB: the plan, x to the right and z downwards, about 1000 px wide."""
    places = np.array([view.position for view in suggested.views]).reshape(-1, 3)
    plan = _Plan(np.concatenate([suggested.points, places]), lines=4)
    _draw_surface(plan, suggested)
    for ends in plan.pixels(_cut(geometry, _cut_height(geometry, suggested))):
        plan.pen.line([tuple(end) for end in ends.tolist()], fill=INK, width=2 * OVERSAMPLING)
    unseen = suggested.first_seen_by < 0
    plan.dots(suggested.points[unseen], [OPEN] * int(unseen.sum()), 2.5)
    for number, view in enumerate(suggested.views):
        _draw_camera(plan, view, number, suggested.frame_count)
    _draw_words(plan, suggested)
    return plan.finished()


def _draw_surface(plan: _Plan, suggested: Suggested) -> None:
    """What is seen, as dots: the higher the darker."""
    seen = suggested.first_seen_by >= 0
    order = np.argsort(suggested.points[seen, 1], kind="stable")
    points = suggested.points[seen][order]
    height = points[:, 1:] - points[:, 1:].min(axis=0) if len(points) else points[:, 1:]
    share = height[:, :1] / max(float(height[:, 0].max(initial=0)), 1e-9)
    colours = np.array(SEEN_LOW) + share * (np.array(SEEN_HIGH) - SEEN_LOW)
    chosen: list[Colour] = [(r, g, b) for r, g, b in colours.astype(int).tolist()]
    plan.dots(points, chosen, 1.5)


def _cut_height(geometry: Geometry, suggested: Suggested) -> float:
    """Of some heights the one at which the cut through the surface is longest, metres."""
    low, high = suggested.points[:, 1].min(), suggested.points[:, 1].max()
    heights = low + (np.arange(CUTS) + 0.5) / CUTS * (high - low)
    cuts = [_cut(geometry, float(height)) for height in heights]
    lengths = [float(np.linalg.norm(cut[:, 1] - cut[:, 0], axis=1).sum()) for cut in cuts]
    return float(heights[int(np.argmax(lengths))])


def _cut(geometry: Geometry, height: float) -> Float:
    """(k, 2, 3) where triangles go through the horizontal plane at `height`, metres."""
    corners = geometry.positions[geometry.triangles]
    above = corners[:, :, 1] > height
    corners, above = (
        corners[above.any(axis=1) & ~above.all(axis=1)],
        above[above.any(axis=1) & ~above.all(axis=1)],
    )
    # The corner that is alone on its side; both edges from there are cut.
    single = np.where(above.sum(axis=1, keepdims=True) == 1, above, ~above)
    alone = single.argmax(axis=1)
    row = np.arange(len(corners))
    start = corners[row, alone]
    ends: list[Float] = []
    for step in (1, 2):
        other = corners[row, (alone + step) % 3]
        share = (height - start[:, 1]) / (other[:, 1] - start[:, 1])
        ends.append(start + share[:, None] * (other - start))
    return np.stack(ends, axis=1)


def _draw_camera(plan: _Plan, view: View, number: int, frame_count: int) -> None:
    """A numbered disc; around it a ring, or the sides of its picture."""
    colour = FRAME if number < frame_count else CAMERA
    x, y = plan.pixels(view.position)
    reach = SIDE_PX * OVERSAMPLING
    if view.projection != "latlong":
        middle = np.array([0, view.width - 1]), np.full(2, view.cy)
        ways = view.directions_at(np.stack(middle, axis=-1)) @ view.world_from_camera[:3, :3].T
        flat = ways[:, [0, 2]]
        for way in flat / np.maximum(np.hypot(flat[:, :1], flat[:, 1:]), 1e-9):
            end = (x + reach * way[0], y + reach * way[1])
            plan.pen.line([(x, y), end], fill=colour, width=2 * OVERSAMPLING)
    else:
        r = RING_PX * OVERSAMPLING
        plan.pen.ellipse((x - r, y - r, x + r, y + r), outline=colour, width=OVERSAMPLING)
    disc = plan.beside_discs(np.array([x, y]))
    plan.pen.line([(x, y), tuple(disc.tolist())], fill=colour, width=2 * OVERSAMPLING)
    r = DISC_PX * OVERSAMPLING
    plan.pen.ellipse((disc[0] - r, disc[1] - r, disc[0] + r, disc[1] + r), fill=colour)
    plan.text(disc, str(number + 1), 13, PAPER)


def _draw_words(plan: _Plan, suggested: Suggested) -> None:
    open_m2 = suggested.reachable_area_m2 - suggested.covered_area_m2
    size = np.ptp(suggested.points, axis=0)
    cameras = f"{len(suggested.views)} camera{'s' * (len(suggested.views) > 1)}"
    area = f"{suggested.reachable_area_m2:.4g} square metres"
    lines = [
        (f"{cameras}: {suggested.coverage:.1%} of {area} that can be seen at all", INK),
        (f"red: {open_m2:.3g} square metres that none sees well, at any height", OPEN),
        ("blue: looks all around; orange: camera of the frame, its sides", CAMERA),
        (f"seen from above, {size[0]:.3g} m by {size[2]:.3g} m, x to the right, z down", FAINT),
    ]
    for index, (words, colour) in enumerate(lines):
        y = (plan.foot_px + index * LINE_PX - LINE_PX // 4) * OVERSAMPLING
        plan.text(np.array([MARGIN_PX * OVERSAMPLING, y]), words, 15, colour, "lm")
