"""From an embedded ICC profile to sRGB.

8-bit pictures go through LittleCMS (in Pillow), which knows every kind of profile. It cannot take
16-bit pictures there, so those are converted here in float64, which covers the *matrix/TRC*
profiles that cameras and editors embed (sRGB, Adobe RGB, Display P3, ProPhoto) and gray ones.
Colours outside Rec.709 are clipped to it: the pipeline's pictures have its primaries.

Source of tags and curves: ICC.1:2022 (profile version 4.4), 7.2, 9.2, 10.6 and 10.18.
"""

from __future__ import annotations

import io
import struct
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.pictures.primaries import rec709_from_xyz
from andon.responses import srgb_encode

if TYPE_CHECKING:
    from PIL import Image

__all__ = ["convert_8bit", "convert_16bit", "is_srgb", "open_profile"]

Float = NDArray[np.float64]
Curve = Callable[[Float], Float]

# The profile connection space's white, D50 (ICC.1:2022, 7.2.16), as chromaticities.
D50_XY = (0.34570, 0.35854)
BLOCK_ROWS = 128  # at once in float64, so that a 16-bit panorama does not become five of them
PARAMETERS = {0: 1, 1: 3, 2: 4, 3: 5, 4: 7}  # parametricCurveType: function → numbers


def _broken(why: str, file: str) -> InputError:
    return InputError(
        f"the embedded ICC profile must be sound and fit the picture: {why}",
        file=file,
        remedy="convert the picture to sRGB, or strip the profile if it is sRGB already",
    )


@contextmanager
def _guarded(file: str) -> Generator[None, None, None]:
    from PIL import ImageCms

    try:
        yield
    except (OSError, ValueError, TypeError, ImageCms.PyCMSError) as error:
        raise _broken(str(error)[:120], file) from error


def open_profile(profile: bytes, file: str) -> tuple[Any, str]:
    """The profile as LittleCMS opened it, and its name; a broken one is an `InputError`."""
    from PIL import ImageCms

    with _guarded(file):
        opened = ImageCms.ImageCmsProfile(io.BytesIO(profile))
        return opened, (ImageCms.getProfileDescription(opened) or "").strip() or "unnamed"


def convert_8bit(image: Image.Image, profile: Any, file: str) -> Image.Image:
    """An sRGB picture in mode RGB, of one in mode L, RGB or CMYK with that opened profile."""
    from PIL import ImageCms

    if image.mode == "L" and profile.profile.xcolor_space.strip() == "RGB":
        image = image.convert("RGB")  # against the standards, but common
    with _guarded(file):
        target = cast("Any", ImageCms.createProfile("sRGB"))  # pyright: ignore[reportUnknownMemberType]
        # Relative colorimetric: what matters is the light, so white maps to white and nothing
        # inside the gamut is moved.
        converted = ImageCms.profileToProfile(
            image,
            profile,
            target,
            renderingIntent=ImageCms.Intent.RELATIVE_COLORIMETRIC,
            outputMode="RGB",
        )
    if converted is None:
        raise _broken("no conversion", file)
    return converted


def is_srgb(profile: Any, mode: str, file: str) -> bool:
    """Whether the profile changes no colour by more than one 8-bit step.

    Such pictures are left alone: their bytes are sRGB already, and rounding them through a colour
    engine would break the identity "no lamps: output bytes = input bytes".
    """
    from PIL import Image

    steps = np.linspace(0, 255, 9).astype(np.uint8)
    if mode == "L":
        lattice = steps[:, None]
        expected = np.repeat(steps[:, None, None], 3, axis=-1)
    else:
        lattice = expected = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 9, 3)
    converted = np.asarray(convert_8bit(Image.fromarray(lattice), profile, file), np.int16)
    return bool(np.abs(converted - expected).max() <= 1)


def convert_16bit(values: NDArray[np.uint16], profile: bytes, file: str) -> NDArray[np.uint16]:
    """(H, W, 3) uint16 sRGB of (H, W, 3) uint16 in a matrix/TRC or gray profile."""
    tags = _tags(profile, file)
    ramp = np.linspace(0.0, 1.0, 65536)
    if "kTRC" in tags:
        curves = [_curve(tags["kTRC"], file)] * 3
        matrix = np.eye(3)
    elif {"rXYZ", "gXYZ", "bXYZ", "rTRC", "gTRC", "bTRC"} <= tags.keys():
        curves = [_curve(tags[f"{letter}TRC"], file) for letter in "rgb"]
        columns = np.stack([_xyz(tags[f"{letter}XYZ"], file) for letter in "rgb"], axis=-1)
        matrix = rec709_from_xyz(D50_XY) @ columns
    else:
        raise _broken("a 16-bit picture needs a matrix or gray profile, this is a table", file)
    tables = [curve(ramp) for curve in curves]
    out = np.empty_like(values)
    for top in range(0, len(values), BLOCK_ROWS):
        rows = values[top : top + BLOCK_ROWS]
        linear = np.stack([table[rows[..., i]] for i, table in enumerate(tables)], axis=-1)
        encoded = srgb_encode(np.clip(linear @ matrix.T, 0.0, 1.0))
        out[top : top + BLOCK_ROWS] = np.rint(encoded * 65535)
    return out


def _tags(profile: bytes, file: str) -> dict[str, bytes]:
    """Tag data by signature; the header is 128 bytes, an entry is 12 (7.3)."""
    try:
        (count,) = struct.unpack_from(">I", profile, 128)
        tags: dict[str, bytes] = {}
        for index in range(min(count, 100)):
            name, offset, size = struct.unpack_from(">4sII", profile, 132 + 12 * index)
            tags[name.decode("latin-1")] = profile[offset : offset + size]
    except struct.error as error:
        raise _broken("cut short", file) from error
    return tags


def _xyz(tag: bytes, file: str) -> Float:
    if len(tag) < 20 or tag[:4] != b"XYZ ":
        raise _broken("an XYZ tag is damaged", file)
    return np.array(struct.unpack_from(">3i", tag, 8)) / 65536


def _curve(tag: bytes, file: str) -> Curve:
    """A function [0, 1] → [0, 1] from a curveType or parametricCurveType tag."""
    try:
        if tag[:4] == b"curv":
            return _sampled_curve(tag)
        if tag[:4] == b"para":
            return _parametric_curve(tag)
    except (struct.error, ValueError) as error:
        raise _broken("a tone curve is damaged", file) from error
    raise _broken("a tone curve is of an unknown kind", file)


def _sampled_curve(tag: bytes) -> Curve:
    (count,) = struct.unpack_from(">I", tag, 8)
    if count == 0:
        return _power(1.0)
    if count == 1:
        return _power(struct.unpack_from(">H", tag, 12)[0] / 256)
    table = np.frombuffer(tag, ">u2", count=count, offset=12) / 65535
    knots = np.linspace(0, 1, count)

    def curve(x: Float) -> Float:
        return np.interp(x, knots, table)

    return curve


def _power(gamma: float) -> Curve:
    def curve(x: Float) -> Float:
        return x**gamma

    return curve


def _parametric_curve(tag: bytes) -> Curve:
    """Y = (aX + b)^g + above from the knee on, slope·X + below under it (10.18, table 68)."""
    (kind,) = struct.unpack_from(">H", tag, 8)
    if kind not in PARAMETERS:
        raise ValueError(kind)
    g, *rest = (v / 65536 for v in struct.unpack_from(f">{PARAMETERS[kind]}i", tag, 12))
    a, b, *rest = rest if kind else (1.0, 0.0)
    slope = above = below = 0.0
    knee = -b / a if a else -np.inf
    if kind == 2:
        above = below = rest[0]
    elif kind >= 3:
        slope, knee, above, below = (*rest, 0.0, 0.0)[:4]

    def curve(x: Float) -> Float:
        with np.errstate(all="ignore"):
            power = np.maximum(a * x + b, 0.0) ** g + above
        return np.clip(np.nan_to_num(np.where(x >= knee, power, slope * x + below)), 0.0, 1.0)

    return curve
