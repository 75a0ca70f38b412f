"""The one place where Pillow opens a picture: one named format, no surprises let through."""

from __future__ import annotations

import io
import warnings
from collections.abc import Generator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from andon.errors import InputError

if TYPE_CHECKING:
    from PIL import Image

__all__ = ["guarded", "open_image"]


def open_image(data: bytes, kind: str, file: str) -> Image.Image:
    """The picture with its header read and nothing decoded; no plugin but `kind` is asked."""
    from PIL import Image

    with guarded(kind, file):
        return Image.open(io.BytesIO(data), formats=[kind])


@contextmanager
def guarded(kind: str, file: str) -> Generator[None, None, None]:
    """Turn whatever Pillow raises on damaged data into an `InputError`.

    Pillow's own limit (about 179 Mpixel, process-wide) stays as it is; its earlier warning is
    silenced, since ours are the limits that count.
    """
    from PIL import Image

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except Image.DecompressionBombError as error:
        raise InputError(f"has too many pixels: {error}", file=file) from error
    except Exception as error:  # OSError, SyntaxError, ValueError, struct.error, zlib.error …
        line = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(
            f"must be a sound {kind} file: {line[:160]}", file=file, remedy="save it again"
        ) from error
