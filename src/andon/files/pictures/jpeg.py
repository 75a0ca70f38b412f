"""JPEG photographs: upright, in sRGB, with the field of view that the camera wrote down."""

from __future__ import annotations

import numpy as np

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits, check_size
from andon.files.pictures.exif import apply_orientation, hfov_degrees, parse_exif
from andon.files.pictures.icc import convert_8bit, is_srgb, open_profile
from andon.files.pictures.model import Picture
from andon.files.pictures.pillow import guarded, open_image

__all__ = ["JPEG_SIGNATURE", "decode_jpeg"]

JPEG_SIGNATURE = b"\xff\xd8\xff"


def decode_jpeg(data: bytes, file: str, limits: Limits = DEFAULT_LIMITS) -> Picture:
    """A JPEG picture as (H, W, 3) uint8 sRGB, upright (EXIF), its ICC profile converted."""
    if not data.startswith(JPEG_SIGNATURE):
        raise InputError("must be a JPEG file", file=file)
    image = open_image(data, "JPEG", file)
    check_size(image.width, image.height, file, limits)
    facts = parse_exif(image.info.get("exif"), file)
    profile: bytes | None = image.info.get("icc_profile")
    opened, name = open_profile(profile, file) if profile else (None, None)
    with guarded("JPEG", file):
        image.load()
    if image.mode == "CMYK" and opened is None:
        raise InputError(
            "a CMYK picture must have an ICC profile", file=file, remedy="save it as RGB"
        )
    if opened is not None and (image.mode == "CMYK" or not is_srgb(opened, image.mode, file)):
        image = convert_8bit(image, opened, file)
    values = apply_orientation(np.asarray(image.convert("RGB")), facts.orientation)
    hfov = hfov_degrees(facts, values.shape[1], values.shape[0])
    return Picture(values, "srgb", icc=name, hfov_degrees=hfov, attributes=dict(facts.exposure))
