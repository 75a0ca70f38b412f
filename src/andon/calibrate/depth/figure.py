r"""The fit as a picture: depth with what is known drawn in, and seen from above and from the side.

::

    ┌──────────────────────┬───────────┬───────────┐
    │ depth, near is bright│ above     │ side      │   a bent wall shows from above,
    │  ●────● 2.03 m       │   ───     │ │         │   a leaning floor from the side
    │  ┌──┐ plane          │  /   \    │ │____     │
    └──────────────────────┴───────────┴───────────┘
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.depth.model import DepthFit, Knowledge, Pixel, RelativeDepth, Row
from andon.display.false_colour import contact_sheet, depth_picture

__all__ = ["fit_picture"]

Float = NDArray[np.float64]
Rgb = NDArray[np.uint8]

WIDTH_PX = 900
MARGIN_PX, FONT_PX, DOT_PX = 46, 15, 5
INK, PAPER, GRID = (32, 32, 32), (245, 243, 238), (222, 218, 208)
MARK, HALO = (255, 90, 60), (20, 20, 20)
# Points that a view from above has at most: more cover each other.
MOST_POINTS = 60_000
# Where a view ends: beyond the 99th percentile there is sky.
FARTHEST_PERCENT = 99.0


def fit_picture(relative: RelativeDepth, known: Knowledge, found: DepthFit, /) -> Rgb:
    """(H, W, 3) uint8: the depth with the constraints and their residuals, from above, aside."""
    depth = relative.metric(found.scale, found.shift)
    points = relative.rays * depth[..., None]
    seen = np.isfinite(depth)
    colours = depth_picture(depth, seen)
    picture = _marked(colours, known, found.rows)
    x, y, z = np.moveaxis(points[seen], -1, 0)
    shown = colours[seen]
    size = picture.shape[1], picture.shape[0]
    above = _plan(np.stack([x, -z]), shown, ("x right, m", "z ahead, m"), size, down=-1)
    aside = _plan(np.stack([z, y]), shown, ("z ahead, m", "y down, m"), size)
    tiles = [(_title(relative, found), picture), ("from above", above), ("from the side", aside)]
    return contact_sheet(tiles, columns=3, gap_px=6)


def _title(relative: RelativeDepth, found: DepthFit) -> str:
    model = "1/z" if relative.kind == "inverse" else "z"
    near, middle, far = found.percentiles_m
    assumed = ", shift assumed" if found.shift_is_assumed else ""
    return (
        f"{model} = {found.scale:.4g} r {found.shift:+.4g}{assumed}; "
        f"{near:.2f} m, {middle:.2f} m, {far:.2f} m"
    )


def _marked(colours: Rgb, known: Knowledge, rows: tuple[Row, ...]) -> Rgb:
    """The depth picture at a legible size with lengths, points, planes and known pixels."""
    import cv2
    from PIL import Image, ImageDraw, ImageFont

    scale = WIDTH_PX / colours.shape[1]
    size = (WIDTH_PX, max(1, round(colours.shape[0] * scale)))
    large = np.asarray(cv2.resize(colours, size, interpolation=cv2.INTER_NEAREST), np.uint8)
    planes = [plane.mask for plane in known.planes]
    planes += [known.floor.plane.mask] if known.floor is not None else []
    for mask in planes:
        _outline(large, mask, size)
    image = Image.fromarray(large)
    draw, font = ImageDraw.Draw(image), ImageFont.load_default(size=FONT_PX)
    for row in rows:
        places = [_placed(pixel, scale) for pixel in row.pixels]
        if len(places) == 2:
            draw.line([*places[0], *places[1]], fill=HALO, width=5)
            draw.line([*places[0], *places[1]], fill=MARK, width=2)
        for x, y in places:
            box = (x - DOT_PX, y - DOT_PX, x + DOT_PX, y + DOT_PX)
            draw.ellipse(box, fill=MARK, outline=HALO)
        if places:
            x, y = np.mean(places, axis=0)
            text = f"{row.found:.3f} m, stated {row.stated:g}: {row.share:+.1%}"
            x = min(max(x + 8, 4), WIDTH_PX - 4 - font.getlength(text))
            at = (float(x), float(min(max(y, 12), size[1] - 12)))
            draw.text(
                at, text, fill="white", font=font, anchor="lm", stroke_width=3, stroke_fill=HALO
            )
    return np.asarray(image)


def _placed(pixel: Pixel, scale: float) -> tuple[float, float]:
    return (pixel[0] + 0.5) * scale - 0.5, (pixel[1] + 0.5) * scale - 0.5


def _outline(picture: Rgb, mask: NDArray[np.bool_], size: tuple[int, int]) -> None:
    import cv2

    large = cv2.resize(mask.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST)
    edges, _ = cv2.findContours(large, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    cv2.drawContours(picture, edges, -1, MARK, 2)


def _plan(
    points: Float, colours: Rgb, names: tuple[str, str], size: tuple[int, int], *, down: int = 1
) -> Rgb:
    """Points (2, n), right and down in metres, over a grid; the axis of sign −1 runs upwards."""
    from PIL import Image, ImageDraw, ImageFont

    image = Image.new("RGB", size, PAPER)
    draw, font = ImageDraw.Draw(image), ImageFont.load_default(size=FONT_PX)
    stride = max(1, points.shape[1] // MOST_POINTS)
    points, colours = points[:, ::stride], colours[::stride]
    low, metre = _frame(points, size)
    inner = np.array(size) - 2 * MARGIN_PX
    step = _step(float(inner.min() / metre))
    for axis in (0, 1):
        for value in np.arange(
            np.ceil(low[axis] / step) * step, low[axis] + inner[axis] / metre, step
        ):
            place = float(MARGIN_PX + (value - low[axis]) * metre)
            sign = down if axis else 1
            label = f"{sign * round(value / step) * step + 0.0:.6g}"
            if axis:
                draw.line([(MARGIN_PX, place), (size[0] - MARGIN_PX, place)], fill=GRID)
                draw.text((MARGIN_PX - 6, place), label, fill=INK, font=font, anchor="rm")
            else:
                draw.line([(place, MARGIN_PX), (place, size[1] - MARGIN_PX)], fill=GRID)
                at = (place, size[1] - MARGIN_PX + 12)
                draw.text(at, label, fill=INK, font=font, anchor="mm")
    draw.text((size[0] // 2, size[1] - 12), names[0], fill=INK, font=font, anchor="mm")
    draw.text((MARGIN_PX, 18), names[1], fill=INK, font=font, anchor="lm")
    columns, rows = np.round(MARGIN_PX + (points - low[:, None]) * metre).astype(np.int64)
    inside = (columns >= MARGIN_PX) & (columns < size[0] - MARGIN_PX)
    inside &= (rows >= MARGIN_PX) & (rows < size[1] - MARGIN_PX)
    canvas = np.asarray(image).copy()
    canvas[rows[inside], columns[inside]] = colours[inside]
    return canvas


def _frame(points: Float, size: tuple[int, int]) -> tuple[Float, float]:
    """(least right and down (2,), pixels a metre) that show all but the farthest points."""
    ends = np.percentile(points, [100 - FARTHEST_PERCENT, FARTHEST_PERCENT], axis=1)
    inner = np.array(size) - 2.0 * MARGIN_PX
    metre = float((inner / np.maximum(np.ptp(ends, axis=0) * 1.08, 1e-6)).min())
    return ends.mean(axis=0) - inner / metre / 2, metre


def _step(metres: float) -> float:
    """The 1, 2 or 5 × 10ⁿ of which four to ten fit into `metres`."""
    power = 10 ** np.floor(np.log10(metres / 4))
    return float(max(s * power for s in (1, 2, 5) if s * power <= metres / 4))
