"""What is known of a scene, as it is typed after ``andon depth fit``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.depth import At, Floor, Knowledge, Length, Plane, RelativeDepth
from andon.cli.console import printable
from andon.cli.depth_options import FitOptions
from andon.errors import InputError

if TYPE_CHECKING:
    from andon.spaces import View

__all__ = ["knowledge_of"]

Pixel = tuple[int, int]


def knowledge_of(options: FitOptions, relative: RelativeDepth, view: View, /) -> Knowledge:
    """The constraints; pixels of the photograph become those of the depth, which may be fewer."""
    shape = relative.values.shape[0], relative.values.shape[1]
    lengths: list[Length] = []
    for text in options.lengths or ():
        first, second = _pixels(text, 2, "--length", view, shape)
        lengths.append(Length(first, second, _metres(text, "--length")))
    points: list[At] = []
    for text in options.points or ():
        (pixel,) = _pixels(text, 1, "--at", view, shape)
        points.append(At(pixel, _metres(text, "--at")))
    planes = [
        Plane(_mask(text, "--plane", view, shape), f"--plane {number}")
        for number, text in enumerate(options.planes or (), start=1)
    ]
    floor = None
    if options.floor is not None:
        floor = Floor(
            Plane(_mask(options.floor, "--floor", view, shape), "--floor"), options.height
        )
    elif options.height is not None:
        raise InputError("is over a floor, and none is stated", field="--height", remedy="--floor")
    pairs = [
        _pair(text, len(planes), has_floor=floor is not None)
        for text in options.perpendicular or ()
    ]
    known = None if options.known is None else _known(options, shape)
    return Knowledge(tuple(lengths), tuple(points), tuple(planes), floor, tuple(pairs), known)


def _metres(text: str, option: str) -> float:
    try:
        return float(text.partition("=")[2])
    except ValueError as error:
        raise _misspelt(text, option) from error


def _pixels(
    text: str, count: int, option: str, view: View, shape: tuple[int, int]
) -> tuple[Pixel, ...]:
    """`count` pixels of the depth. Raises `InputError` for what is no pixel of the photograph."""
    try:
        numbers = [float(word) for word in text.partition("=")[0].split(",")]
    except ValueError as error:
        raise _misspelt(text, option) from error
    if len(numbers) != 2 * count or not np.isfinite(numbers).all():
        raise _misspelt(text, option)
    found: list[Pixel] = []
    for x, y in zip(numbers[::2], numbers[1::2], strict=True):
        if not (-0.5 <= x < view.width - 0.5 and -0.5 <= y < view.height - 0.5):
            raise InputError(
                f"the pixel {x:g},{y:g} is outside the photograph of {view.width}×{view.height} px",
                field=option,
            )
        column = int((x + 0.5) * shape[1] / view.width)
        found.append((column, int((y + 0.5) * shape[0] / view.height)))
    return tuple(found)


def _misspelt(text: str, option: str) -> InputError:
    form = {"--length": "X1,Y1,X2,Y2=METRES", "--at": "X,Y=METRES"}.get(option, "X,Y,W,H")
    return InputError(f"must be {form}, got {printable(text)[:60]!r}", field=option)


def _mask(text: str, option: str, view: View, shape: tuple[int, int]) -> NDArray[np.bool_]:
    """(H, W) of the depth: a rectangle of the photograph's pixels, or where a picture is white."""
    if "," not in text:
        return _painted(Path(text), view, shape)
    try:
        x, y, width, height = (int(word) for word in text.split(","))
    except ValueError as error:
        raise _misspelt(text, option) from error
    if not (0 <= x < x + width <= view.width and 0 <= y < y + height <= view.height):
        raise InputError(
            f"the rectangle {text} must lie in the photograph of {view.width}×{view.height} px",
            field=option,
        )
    rows, columns = _places(view.height, shape[0]), _places(view.width, shape[1])
    in_rows = (rows >= y) & (rows < y + height)
    return in_rows[:, None] & ((columns >= x) & (columns < x + width))[None, :]


def _places(photo: int, depth: int) -> NDArray[np.float64]:
    """Where the pixel centres of a side of the depth lie in the photograph, half a pixel up."""
    return (np.arange(depth) + 0.5) * photo / depth


def _painted(path: Path, view: View, shape: tuple[int, int]) -> NDArray[np.bool_]:
    from andon.files.pictures import read_picture
    from andon.spaces import another_size

    picture = read_picture(path)
    if picture.shape not in (view.shape, shape):
        raise another_size(picture.shape, view, file=path, remedy="paint it on the photograph")
    rows = _places(picture.shape[0], shape[0]).astype(np.intp)
    columns = _places(picture.shape[1], shape[1]).astype(np.intp)
    return picture.is_painted[np.ix_(rows, columns)]


def _pair(text: str, planes: int, *, has_floor: bool) -> tuple[int, int]:
    """Indices of two planes; −1 is the floor, the last of them."""
    found: list[int] = []
    for word in text.split(","):
        if word.strip() == "floor" and has_floor:
            found.append(-1)
        elif word.strip().isdecimal() and 1 <= int(word) <= planes:
            found.append(int(word) - 1)
        else:
            raise InputError(
                f"there are {planes} planes{' and a floor' if has_floor else ''}, got "
                f"{printable(text)[:60]!r}",
                field="--perpendicular",
                remedy="state --plane first; --perpendicular 1,2 are the first two of them",
            )
    if len(found) != 2 or found[0] == found[1]:
        raise InputError(
            f"must be two planes, got {printable(text)[:60]!r}", field="--perpendicular"
        )
    return found[0], found[1]


def _known(options: FitOptions, shape: tuple[int, int]) -> NDArray[np.float64]:
    """(H, W) metres at the depth's pixels: the nearest sample of a file of any resolution."""
    from andon.files.depth import read_depth_array
    from andon.surface.resample import same_aspect

    assert options.known is not None
    scale = options.known_scale_to_m
    if not (np.isfinite(scale) and scale > 0):
        raise InputError(f"must be > 0, got {scale:g}", field="--known-scale-to-m")
    raw = read_depth_array(options.known)
    if not same_aspect((raw.shape[0], raw.shape[1]), shape):
        raise InputError(
            f"is {raw.shape[1]}×{raw.shape[0]} px, the relative depth {shape[1]}×{shape[0]}",
            file=options.known,
            field="--known",
        )
    rows = _places(raw.shape[0], shape[0]).astype(np.intp)
    columns = _places(raw.shape[1], shape[1]).astype(np.intp)
    metres = raw[np.ix_(rows, columns)] * scale
    with np.errstate(invalid="ignore"):
        return np.where(np.isfinite(metres) & (metres > 0), metres, np.nan)
