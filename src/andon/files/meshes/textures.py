"""Textures of one mesh file: each read once, all of them within one budget of pixels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.files.limits import Limits, check_at_most
from andon.files.paths import confined
from andon.files.pictures import Picture, decode_picture, read_picture
from andon.responses import srgb_decode

__all__ = ["TextureStore"]


class TextureStore:
    """Reads textures for the mesh `file`, confined to the file's own folder."""

    def __init__(self, file: Path, limits: Limits) -> None:
        self._file, self._limits = file, limits
        self._pixels_left = limits.max_total_pixels
        self._known: dict[str, NDArray[Any]] = {}

    def from_reference(self, reference: str, *, percent_encoded: bool = False) -> NDArray[Any]:
        """The texture in another file: (h, w, 3) uint8 sRGB or float32 linear."""
        path = confined(
            reference, self._file.parent, file=self._file, percent_encoded=percent_encoded
        )
        key = str(path)
        if key not in self._known:
            self._keep(key, read_picture(path, limits=self._remaining()))
        return self._known[key]

    def from_bytes(self, load: Callable[[], bytes], place: str) -> NDArray[Any]:
        """The texture embedded at `place` ("images[2]"): (h, w, 3) uint8 sRGB or float32."""
        if place not in self._known:
            name = f"{self._file}: {place}"
            self._keep(place, decode_picture(load(), name, self._remaining()))
        return self._known[place]

    def _remaining(self) -> Limits:
        check_at_most(len(self._known) + 1, self._limits.max_references, "textures", self._file)
        most = min(self._limits.max_pixels, max(self._pixels_left, 0))
        return replace(self._limits, max_pixels=most)

    def _keep(self, key: str, picture: Picture) -> None:
        values = picture.values
        self._pixels_left -= values.shape[0] * values.shape[1]
        if values.dtype == np.uint16:
            values = srgb_decode(values / np.float32(65535)).astype(np.float32)
        values = np.ascontiguousarray(values)
        values.flags.writeable = False  # shared by all materials that name it
        self._known[key] = values
