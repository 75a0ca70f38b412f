"""Pictures: PNG and JPEG as sRGB bytes, EXR and Radiance HDR as linear light.

One question decides every detail here: which light was in front of the camera? So EXIF's
orientation and ICC profiles are applied (their absence is a silent error of 90° or of several
ΔE), 16 bits stay 16 bits, and nothing of an HDR file is clipped.

============== ============ ===================================== ==============================
format         result       decoder                               why not another
============== ============ ===================================== ==============================
PNG ≤ 8 bit    uint8 sRGB   Pillow
PNG 16 bit     uint16 sRGB  OpenCV                                Pillow reduces colour to 8 bits
JPEG           uint8 sRGB   Pillow                                OpenCV drops ICC profiles
EXR            float32      OpenEXR 3                             OpenCV's wheel has no EXR
HDR (RGBE)     float32      own, see `rgbe`                       OpenCV rejects legal headers,
                                                                  imageio returns 8 bits
============== ============ ===================================== ==============================
"""

from __future__ import annotations

from pathlib import Path

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits
from andon.files.paths import open_bounded
from andon.files.pictures.exr import read_exr
from andon.files.pictures.jpeg import JPEG_SIGNATURE, decode_jpeg
from andon.files.pictures.model import Picture
from andon.files.pictures.png import PNG_SIGNATURE, decode_png
from andon.files.pictures.rgbe import read_hdr
from andon.files.pictures.write import (
    npy_bytes,
    write_exr,
    write_exr_channels,
    write_hdr,
    write_jpeg,
    write_npy,
    write_picture,
    write_png,
)
from andon.files.reader import Reader, choose_reader

__all__ = [
    "PICTURE_READERS",
    "Picture",
    "decode_picture",
    "npy_bytes",
    "read_picture",
    "write_exr",
    "write_exr_channels",
    "write_hdr",
    "write_jpeg",
    "write_npy",
    "write_picture",
    "write_png",
]


def decode_picture(data: bytes, file: str, limits: Limits = DEFAULT_LIMITS) -> Picture:
    """A PNG or JPEG picture from bytes; the contents decide which, not the name.

    Raises
    ------
    InputError
        if the bytes are neither, damaged, or larger than `limits`.
    """
    if data.startswith(PNG_SIGNATURE):
        return decode_png(data, file, limits)
    if data.startswith(JPEG_SIGNATURE):
        return decode_jpeg(data, file, limits)
    raise InputError("must be a PNG or JPEG picture, by its first bytes", file=file)


def _read_encoded(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> Picture:
    return decode_picture(open_bounded(path, limits), str(path), limits)


PICTURE_READERS = (
    Reader("picture.png", (".png",), _read_encoded),
    Reader("picture.jpeg", (".jpg", ".jpeg", ".jpe"), _read_encoded),
    Reader("picture.exr", (".exr",), read_exr),
    Reader("picture.hdr", (".hdr", ".pic", ".rgbe"), read_hdr),
)


def read_picture(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> Picture:
    """A picture (H, W, 3), upright, Rec.709 primaries; see `Picture` for the encodings.

    Raises
    ------
    InputError
        if the suffix is unknown or the file is missing, damaged or larger than `limits`.
    """
    picture: Picture = choose_reader(path, PICTURE_READERS, "picture").read(path, limits=limits)
    return picture
