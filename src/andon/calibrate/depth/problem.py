"""All that is known as residuals of two unknowns, log a and s = b/a."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.depth.known import KnownLine, known_line
from andon.calibrate.depth.model import Knowledge, Pixel, Plane, RelativeDepth, Row
from andon.calibrate.depth.planes import FlatPixels, flat_pixels
from andon.errors import InputError

__all__ = ["ANGLE_RADIANS", "LENGTH_SHARE", "Problem", "problem_of"]

Float = NDArray[np.float64]

# A tape's end and a click beside a corner: 2 %. A floor by the pose of a hand-held camera's sensor
# of gravity, or a corner of a built room: 1°.
LENGTH_SHARE = 0.02
ANGLE_RADIANS = np.radians(1.0)


@dataclass(frozen=True)
class Problem:
    """Residuals in standard deviations.

    Attributes
    ----------
    flats : the planes, the floor last if there is one.
    line : what is known of many pixels.
    """

    relative: RelativeDepth
    knowledge: Knowledge
    flats: tuple[FlatPixels, ...]
    line: KnownLine | None

    def turned(self) -> Problem:
        """The same of −r, to see whether the kind is wrong."""
        return replace(
            self,
            relative=replace(self.relative, values=-self.relative.values),
            flats=tuple(flat.turned() for flat in self.flats),
            line=None if self.line is None else self.line.turned(),
        )

    def depth_at(self, pixel: Pixel, log_scale: float, ratio: float) -> float:
        """z in metres of a pixel; NaN where the model is behind the camera."""
        column, row = pixel
        value = self.relative.values[row, column] + ratio
        if not value > 0:
            return float("nan")
        log_z = log_scale + np.log(value)
        return float(np.exp(-log_z if self.relative.kind == "inverse" else log_z))

    def point(self, pixel: Pixel, log_scale: float, ratio: float) -> Float:
        """(3,) surface point in the camera frame, metres."""
        return self.relative.rays[pixel[1], pixel[0]] * self.depth_at(pixel, log_scale, ratio)

    def plane(self, index: int, log_scale: float, ratio: float) -> Float:
        """m (3,) of a plane, −1: the floor."""
        return self.flats[index].plane(log_scale, ratio)

    def rows(self, log_scale: float, ratio: float) -> list[Row]:
        """What was stated beside what is found there, in the order of `Knowledge`."""
        at = (log_scale, ratio)
        found: list[Row] = []
        for length in self.knowledge.lengths:
            ends = (length.first, length.second)
            metres = float(np.linalg.norm(np.subtract(*(self.point(end, *at) for end in ends))))
            found.append(_metres(_length_name(*ends), length.metres, metres, ends))
        for known in self.knowledge.points:
            name = "depth at {},{}".format(*known.pixel)
            depth = self.depth_at(known.pixel, *at)
            found.append(_metres(name, known.metres, depth, (known.pixel,)))
        return [*found, *self._rows_of_planes(log_scale, ratio)]

    def _rows_of_planes(self, log_scale: float, ratio: float) -> list[Row]:
        found: list[Row] = []
        floor = self.knowledge.floor
        if floor is not None:
            m = self.plane(-1, log_scale, ratio)
            lean = _angle(m, -self.relative.up)
            found.append(Row("floor's slope", 0.0, float(np.degrees(lean)), "degrees", lean))
            if floor.height_m is not None:
                height = float(1 / np.linalg.norm(m))
                found.append(_metres("camera over the floor", floor.height_m, height, ()))
        for first, second in self.knowledge.perpendicular:
            angle = _angle(
                self.plane(first, log_scale, ratio), self.plane(second, log_scale, ratio)
            )
            name = f"{self.flats[first].name} against {self.flats[second].name}"
            off = angle - np.pi / 2
            found.append(Row(name, 90.0, float(np.degrees(angle)), "degrees", off))
        return found

    def residuals(self, unknowns: Float) -> Float:
        """(m,) at (log a, s); NaN where a pixel of a constraint is behind the camera."""
        with np.errstate(over="ignore", invalid="ignore"):  # steps that are taken back
            return self._residuals((float(unknowns[0]), float(unknowns[1])))

    def _residuals(self, at: tuple[float, float]) -> Float:
        found = [
            np.log(row.found / row.stated) / LENGTH_SHARE
            for row in self.rows(*at)
            if row.unit == "m"
        ]
        found += self._angle_residuals(*at)
        for flat in self.flats:
            found += self._flatness_residual(flat, at[1])
        if self.line is not None:
            off = np.array([np.exp(-at[0]) - self.line.alpha, at[1] - self.line.ratio])
            found += (self.line.whiten @ off).tolist()
        return np.array(found)

    def _angle_residuals(self, log_scale: float, ratio: float) -> list[float]:
        found: list[float] = []
        if self.knowledge.floor is not None:
            m = self.plane(-1, log_scale, ratio)
            # Two components, for the derivative of an angle is undefined at 0.
            lean = np.cross(m / np.linalg.norm(m), -self.relative.up)
            behind = m @ -self.relative.up <= 0
            found += [float("nan")] * 3 if behind else (lean / ANGLE_RADIANS).tolist()
        for pair in self.knowledge.perpendicular:
            a, b = (self.plane(index, log_scale, ratio) for index in pair)
            cosine = a @ b / (np.linalg.norm(a) * np.linalg.norm(b))
            found.append(float(np.arcsin(np.clip(cosine, -1, 1)) / ANGLE_RADIANS))
        return found

    def _flatness_residual(self, flat: FlatPixels, ratio: float) -> list[float]:
        """Of kind ``depth``: how far log(r + s) in the middle of the plane is from flat."""
        if flat.shift is None:
            return []
        middle, (stated, error) = flat.middle, flat.shift
        if not np.isfinite(error) or middle + stated <= 0:
            return [0.0]
        if middle + ratio <= 0:
            return [float("nan")]
        return [float(np.log((middle + ratio) / (middle + stated)) * (middle + stated) / error)]


def problem_of(relative: RelativeDepth, knowledge: Knowledge, /) -> Problem:
    """The problem, its groups of pixels summarised. Raises `InputError` for what cannot be."""
    for length in knowledge.lengths:
        _check_pixels(relative, (length.first, length.second), length.metres, "--length")
        if length.first == length.second:
            raise InputError(
                f"both ends are the pixel {length.first[0]},{length.first[1]}: it has no length",
                field="--length",
            )
    for known in knowledge.points:
        _check_pixels(relative, (known.pixel,), known.metres, "--at")
    planes: list[Plane] = [*knowledge.planes]
    if knowledge.floor is not None:
        planes.append(knowledge.floor.plane)
        height = knowledge.floor.height_m
        if height is not None and not (np.isfinite(height) and height > 0):
            raise InputError(f"must be > 0 m, got {height:g}", field="--height")
    line = None if knowledge.known_m is None else known_line(relative, knowledge.known_m)
    flats = tuple(flat_pixels(relative, plane) for plane in planes)
    return Problem(relative, knowledge, flats, line)


def _check_pixels(
    relative: RelativeDepth, pixels: tuple[Pixel, ...], metres: float, option: str
) -> None:
    height, width = relative.values.shape
    for column, row in pixels:
        if not (0 <= column < width and 0 <= row < height):
            raise InputError(
                f"the pixel {column},{row} is outside the depth of {width}×{height} px",
                field=option,
            )
        if not np.isfinite(relative.values[row, column]):
            raise InputError(
                f"the pixel {column},{row} is a hole of the depth",
                field=option,
                remedy="choose one beside it that has a number",
            )
    if not (np.isfinite(metres) and metres > 0):
        raise InputError(f"must be > 0 m, got {metres:g}", field=option)


def _metres(name: str, stated: float, found: float, pixels: tuple[Pixel, ...]) -> Row:
    return Row(name, float(stated), found, "m", float(found / stated - 1), pixels)


def _length_name(first: Pixel, second: Pixel) -> str:
    return f"length {first[0]},{first[1]} to {second[0]},{second[1]}"


def _angle(a: Float, b: Float) -> float:
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))
