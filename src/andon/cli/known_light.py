"""Photographs whose illuminance is known, as typed: ``PHOTO=LUX``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.responses import LINEAR, SRGB, Response

if TYPE_CHECKING:
    from andon.calibrate.surface import KnownLight
    from andon.files.pictures import Picture

__all__ = ["ReadLight", "read_known_light", "read_masks"]

Float = NDArray[np.float64]

FIELD = "PHOTO=LUX"
SRGB_ASSUMED = "{} is taken for sRGB; --response states another camera"
EXAMPLE = "e.g. dim.png=55 full.png=640, or room.png=room_lux.exr"


@dataclass(frozen=True)
class ReadLight:
    """The photographs in linear light, every file that was read, and what is taken for granted."""

    photographs: list[KnownLight]
    inputs: list[Path]
    assumed: list[str]


def read_known_light(words: Sequence[str], response: str | None) -> ReadLight:
    """What was typed, read. Raises `InputError`."""
    from andon.calibrate.surface import KnownLight
    from andon.capture.still import CLIPPED_CODES, linear_from_picture
    from andon.files.pictures import read_picture

    typed = [_split(word) for word in words]
    inputs = [path for photo, lux in typed for path in (photo, *_map_of(lux))]
    stated = _response(response)
    found: list[KnownLight] = []
    encoded: list[str] = []
    for photo, lux in typed:
        picture = read_picture(photo)
        clipped = np.zeros(picture.values.shape, bool)
        if picture.encoding == "srgb":
            encoded.append(photo.name)
            clipped = picture.values >= np.iinfo(picture.values.dtype).max - CLIPPED_CODES
        linear = linear_from_picture(picture, _of(picture, stated, photo))
        found.append(KnownLight(str(photo), linear, clipped, _illuminance(lux)))
    if response and response.endswith(".csv"):
        inputs.append(Path(response))
    is_assumed = stated is None and bool(encoded)
    return ReadLight(found, inputs, [SRGB_ASSUMED.format(encoded[0])] if is_assumed else [])


def _split(word: str) -> tuple[Path, str]:
    photo, equals, lux = word.rpartition("=")
    if not (equals and photo and lux):
        raise InputError(f"must be PHOTO=LUX, got {word[:60]!r}", field=FIELD, remedy=EXAMPLE)
    return Path(photo), lux


def _map_of(lux: str) -> list[Path]:
    return [Path(lux)] if lux.lower().endswith(".exr") else []


def _illuminance(text: str) -> Float:
    """(3,) or (H, W, 3) in lx, NaN where a map knows none. Raises `InputError`."""
    if _map_of(text):
        return _read_map(Path(text))
    parts = text.split(",")
    try:
        values = np.array([float(part) for part in parts])
    except ValueError:
        values = np.array([np.nan])
    if len(values) not in (1, 3) or not np.isfinite(values).all() or (values < 0).any():
        raise InputError(
            f"illuminance must be one or three numbers ≥ 0 in lx, or an EXR map, got {text[:40]!r}",
            field=FIELD,
            remedy=EXAMPLE,
        )
    return np.broadcast_to(values, 3).copy()


def _read_map(path: Path) -> Float:
    from andon.files.pictures import read_picture

    picture = read_picture(path)
    unit = str(picture.attributes.get("andon:unit", "lx"))
    if unit != "lx":
        raise InputError(
            f"must be illuminance in lx, is in {unit[:40]!r}", file=path, field="andon:unit"
        )
    lux = np.asarray(picture.values, np.float64)
    if (lux < 0).any():
        raise InputError("illuminance must be ≥ 0 lx, or NaN where it is not known", file=path)
    return np.where(np.isfinite(lux), lux, np.nan)


def _response(text: str | None) -> Response | None:
    """As typed. Raises `InputError`."""
    if text is None:
        return None
    if text.endswith(".csv"):
        from andon.files.responses import read_response

        return read_response(text)
    kind, _, gamma = text.partition(":")
    if text in ("srgb", "linear"):
        return SRGB if text == "srgb" else LINEAR
    try:
        if kind == "gamma":
            return Response("gamma", gamma=float(gamma))
    except (ValueError, InputError):
        pass
    raise InputError(
        f"must be a CSV file, srgb, linear or gamma:G with G > 0, got {text[:40]!r}",
        field="--response",
    )


def _of(picture: Picture, stated: Response | None, photo: Path) -> Response:
    if picture.encoding == "linear":
        if stated not in (None, LINEAR):
            raise InputError(
                "is linear light, and has no response",
                file=photo,
                field="--response",
                remedy="leave --response out",
            )
        return LINEAR
    return stated or SRGB


def read_masks(paths: Mapping[str, Path]) -> dict[str, NDArray[np.bool_]]:
    """Masks (H, W) by the names of their surfaces: true where the picture is brighter than half."""
    from andon.files.pictures import read_picture

    found: dict[str, NDArray[np.bool_]] = {}
    for name, path in paths.items():
        values = read_picture(path).values
        top = np.iinfo(values.dtype).max if values.dtype.kind == "u" else 1.0
        found[name] = np.asarray(values.max(axis=-1) > top / 2, bool)
    return found
