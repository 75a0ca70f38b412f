"""The polar diagram of a luminaire, as data sheets show it: two planes, rings of candela."""

from __future__ import annotations

import unicodedata
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from andon.display.dashes import dash_mask

if TYPE_CHECKING:
    from andon.lamps.goniometry import MainPlane

__all__ = ["polar_picture", "ring_values"]

Float = NDArray[np.float64]
Rgb = NDArray[np.uint8]

INK, PAPER, RING = (32, 32, 32), (250, 249, 246), (205, 203, 198)
FIRST, SECOND = (200, 60, 30), (30, 90, 170)
SIDE_PX = 720
HEAD_PX, FOOT_PX = 56, 52
# Drawn larger and scaled down: Pillow's lines have no smooth edges of their own.
OVERSAMPLING = 2
RAYS_DEGREES = 30
WIDEST_STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)


def ring_values(maximum_cd: float) -> list[float]:
    """Three to five candela values for rings, steps of 1, 2, 2.5 or 5 × 10ⁿ; the last ≥ maximum."""
    power = 10 ** np.floor(np.log10(maximum_cd / 4))
    step = next(s * power for s in WIDEST_STEPS if s * power * 5 >= maximum_cd * (1 - 1e-9))
    count = max(1, int(np.ceil(maximum_cd / step * (1 - 1e-9))))
    return [float(step * (i + 1)) for i in range(count)]


def polar_picture(
    planes: tuple[MainPlane, MainPlane], title: str, facts: str, /, *, side_px: int = SIDE_PX
) -> Rgb:
    """(H, W, 3) uint8: both planes as closed curves; the beam's axis points down.

    Parameters
    ----------
    planes : of `main_planes`; the first is solid and red, the second dashed and blue. Angles > 0
        (the side that is named first) lie on the right.
    title, facts : one line each, above the diagram; cut where they are too long.
    """
    from PIL import Image

    picture = _Diagram(planes, side_px * OVERSAMPLING)
    picture.draw_rings()
    picture.draw_plane(planes[1], SECOND, dashed=True)
    picture.draw_plane(planes[0], FIRST, dashed=False)
    picture.draw_labels()
    picture.draw_texts(title, facts, planes)
    size = (picture.image.width // OVERSAMPLING, picture.image.height // OVERSAMPLING)
    return np.asarray(picture.image.resize(size, Image.Resampling.LANCZOS), np.uint8)


class _Diagram:
    """A sheet of paper with the pole in its middle."""

    def __init__(self, planes: tuple[MainPlane, MainPlane], side: int) -> None:
        from PIL import Image, ImageDraw, ImageFont

        self.scale = side / SIDE_PX
        self.rings = ring_values(max(float(plane.candela.max()) for plane in planes))
        self.image = Image.new("RGB", (side, side + self.px(HEAD_PX + FOOT_PX)), PAPER)
        self.draw = ImageDraw.Draw(self.image)
        self.middle = (side / 2, side / 2 + self.px(HEAD_PX))
        self.radius = side / 2 - self.px(40)
        self.small: Any = ImageFont.load_default(size=self.px(14))
        self.large: Any = ImageFont.load_default(size=self.px(18))

    def px(self, pixels: float) -> int:
        return round(pixels * self.scale)

    def place(self, angle_degrees: Float | float, candela: Float | float) -> Float:
        """(..., 2) pixels; 0° is down, angles > 0 to the right."""
        angle = np.radians(angle_degrees)
        reach = np.asarray(candela) / self.rings[-1] * self.radius
        x = self.middle[0] + reach * np.sin(angle)
        return np.stack([x, self.middle[1] + reach * np.cos(angle)], axis=-1)

    def draw_rings(self) -> None:
        x, y = self.middle
        for value in self.rings:
            r = value / self.rings[-1] * self.radius
            self.draw.ellipse((x - r, y - r, x + r, y + r), outline=RING, width=self.px(1.5))
        for angle in range(0, 360, RAYS_DEGREES):
            end = self.place(float(angle), self.rings[-1])
            self.draw.line([(x, y), tuple(end.tolist())], fill=RING, width=self.px(1))

    def draw_labels(self) -> None:
        """Candela along the ray of 105°, between two spokes; angles outside the last ring."""
        for value in self.rings:
            self._text_on_paper(self.place(105.0, value), f"{value:g}")
        for angle in range(0, 360, RAYS_DEGREES):
            place = self.place(float(angle), self.rings[-1] * (1 + self.px(18) / self.radius))
            text = f"{angle if angle <= 180 else 360 - angle}°"
            self.draw.text(tuple(place.tolist()), text, fill=INK, font=self.small, anchor="mm")

    def _text_on_paper(self, place: Float, text: str) -> None:
        at = tuple(place.tolist())
        box = self.draw.textbbox(at, text, font=self.small, anchor="mm")
        margin = self.px(2)
        grown = (box[0] - margin, box[1] - margin, box[2] + margin, box[3] + margin)
        self.draw.rectangle(grown, fill=PAPER)
        self.draw.text(at, text, fill=INK, font=self.small, anchor="mm")

    def draw_plane(self, plane: MainPlane, colour: tuple[int, int, int], *, dashed: bool) -> None:
        points = self.place(plane.angles_degrees, plane.candela)
        ink = dash_mask(points, self.px(10)) if dashed else np.ones(len(points) - 1, bool)
        for index in np.flatnonzero(ink):
            ends = [tuple(points[index].tolist()), tuple(points[index + 1].tolist())]
            self.draw.line(ends, fill=colour, width=self.px(2.5), joint="curve")

    def draw_texts(self, title: str, facts: str, planes: tuple[MainPlane, MainPlane]) -> None:
        left, width = self.px(16), self.image.width - self.px(32)
        for text, font, y in ((title, self.large, 20), (facts, self.small, 44)):
            cut = _fitted(text, font, width)
            self.draw.text((left, self.px(y)), cut, fill=INK, font=font, anchor="lm")
        y = self.image.height - self.px(22)
        x = left
        for plane, colour, dashes in ((planes[0], FIRST, 1), (planes[1], SECOND, 3)):
            step = self.px(36) / (2 * dashes - 1)
            for dash in range(dashes):
                start = x + 2 * dash * step
                self.draw.line([(start, y), (start + step, y)], fill=colour, width=self.px(3))
            self.draw.text((x + self.px(44), y), plane.name, fill=INK, font=self.small, anchor="lm")
            x += self.px(44) + round(self.small.getlength(plane.name)) + self.px(28)
        note = "rings in cd; the side named first is on the right"
        end = (self.image.width - left, y)
        self.draw.text(end, note, fill=INK, font=self.small, anchor="rm")


def _fitted(text: str, font: Any, width: float) -> str:
    """`text` in letters that Pillow's own font has, cut so that it fits."""
    bare = unicodedata.normalize("NFKD", text.replace("ß", "ss"))
    bare = "".join(c for c in bare if not unicodedata.combining(c))
    text = "".join(c if c.isascii() or c in "·°" else "?" for c in bare)
    if font.getlength(text) <= width:
        return text
    while text and font.getlength(text + "…") > width:
        text = text[:-1]
    return text.rstrip() + "…"
