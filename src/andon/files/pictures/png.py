"""PNG pictures of 1 to 16 bits. The chunks are checked first, then a library decodes.

Pillow decodes up to 8 bits. It reduces 16-bit colour to 8, so OpenCV decodes that. Both print or
guess on damaged files; a walk over the chunks and their checksums refuses those beforehand.
Format: W3C Portable Network Graphics, third edition (2025).
"""

from __future__ import annotations

import struct
import zlib
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits, check_size
from andon.files.pictures.exif import apply_orientation, hfov_degrees, parse_exif
from andon.files.pictures.icc import convert_8bit, convert_16bit, is_srgb, open_profile
from andon.files.pictures.model import Picture
from andon.files.pictures.pillow import guarded, open_image

if TYPE_CHECKING:
    from PIL import Image

__all__ = ["PNG_SIGNATURE", "decode_png", "decode_png_raw"]

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"


def decode_png(data: bytes, file: str, limits: Limits = DEFAULT_LIMITS) -> Picture:
    """A PNG picture as (H, W, 3) uint8 or uint16 sRGB, upright; `file` names it in messages.

    Palettes are expanded, gray is repeated, alpha is kept apart (PNG stores colour straight), an
    ICC profile is converted, EXIF's orientation is applied.
    """
    chunks = _check_chunks(data, file, limits)
    image = open_image(data, "PNG", file)
    profile: bytes | None = image.info.get("icc_profile")
    opened, name = open_profile(profile, file) if profile else (None, None)
    if chunks["IHDR"][8] == 16:
        stored = _decode_16bit(data, file)
        alpha = stored[..., -1] if stored.ndim == 3 and stored.shape[2] in (2, 4) else None
        values = _rgb(stored)
        if profile and not is_srgb(opened, "RGB" if chunks["IHDR"][9] & 2 else "L", file):
            values = convert_16bit(values, profile, file)
    else:
        gray = image.mode in ("1", "L", "LA")
        with guarded("PNG", file):
            alpha = _alpha_8bit(image)
            image = image.convert("L" if gray else "RGB")
        if opened is not None and not is_srgb(opened, image.mode, file):
            image = convert_8bit(image, opened, file)
        values = _rgb(np.asarray(image))
    facts = parse_exif(chunks.get("eXIf"), file)
    values = apply_orientation(values, facts.orientation)
    if alpha is not None:
        alpha = apply_orientation(alpha / np.float32(np.iinfo(alpha.dtype).max), facts.orientation)
    gamma = {"gamma": image.info["gamma"]} if "gamma" in image.info else {}
    hfov = hfov_degrees(facts, values.shape[1], values.shape[0])
    return Picture(values, "srgb", name, hfov, attributes=gamma | facts.exposure, alpha=alpha)


def decode_png_raw(data: bytes, file: str, limits: Limits = DEFAULT_LIMITS) -> NDArray[Any]:
    """The stored numbers of a gray PNG, (H, W) uint8 or uint16, for depth; colour is refused."""
    header = _check_chunks(data, file, limits)["IHDR"]
    if header[9] not in (0, 4):
        raise InputError(
            "must be a gray PNG, whose numbers are depths; this one has colour",
            file=file,
            remedy="a photograph or a false-colour picture holds no depth: export the depth "
            "itself, as 16-bit gray PNG, NPY, PFM or EXR",
        )
    if header[8] == 16:
        values = _decode_16bit(data, file)
        return values if values.ndim == 2 else values[..., 0]
    image = open_image(data, "PNG", file)
    with guarded("PNG", file):
        return np.asarray(image.convert("L"))


def _check_chunks(data: bytes, file: str, limits: Limits) -> dict[str, bytes]:
    """The first chunk of each kind except the pixels; size, checksums and the end are checked."""
    if not data.startswith(PNG_SIGNATURE):
        raise InputError("must be a PNG file", file=file)
    chunks: dict[str, bytes] = {}
    at = 8
    while at + 12 <= len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        body = data[at + 8 : at + 8 + length]
        end = at + 12 + length
        if end > len(data):
            break
        checksum = zlib.crc32(body, zlib.crc32(kind))
        if checksum != int.from_bytes(data[end - 4 : end], "big"):
            raise InputError("must be intact: a checksum does not fit", file=file)
        name = kind.decode("latin-1")
        if not chunks and (name != "IHDR" or length != 13):
            raise InputError("must begin with its header", file=file)
        if name == "IHDR":
            check_size(*struct.unpack_from(">II", body), file, limits)
        if name == "IEND":
            return chunks
        if name != "IDAT":
            chunks.setdefault(name, body)
        at = end
    raise InputError("must not be cut short: the end of the PNG is missing", file=file)


def _decode_16bit(data: bytes, file: str) -> NDArray[np.uint16]:
    """(H, W) or (H, W, 3 or 4) uint16, channels in the order red, green, blue, alpha."""
    import cv2

    try:
        values = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error as error:
        raise InputError("must be a sound PNG file", file=file) from error
    if values is None or values.dtype != np.uint16:
        raise InputError("must be a sound 16-bit PNG file", file=file)
    if values.ndim == 3 and values.shape[2] >= 3:
        values = values[..., [2, 1, 0, *range(3, values.shape[2])]]
    return values.astype(np.uint16, copy=False)


def _alpha_8bit(image: Image.Image) -> NDArray[np.uint8] | None:
    """(H, W) of a picture with an alpha channel or a transparent colour; of others None."""
    if image.mode not in ("LA", "PA", "RGBA") and "transparency" not in image.info:
        return None
    return np.asarray(image.convert("RGBA").getchannel("A"))


def _rgb(values: NDArray[Any]) -> NDArray[Any]:
    """(H, W, 3) of gray (H, W), gray and alpha, RGB or RGBA."""
    if values.ndim == 2:
        return np.repeat(values[..., None], 3, axis=-1)
    if values.shape[2] < 3:
        return np.repeat(values[..., :1], 3, axis=-1)
    return np.ascontiguousarray(values[..., :3])
