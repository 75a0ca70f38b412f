"""Arguments that are to be arrays, and what they are in messages."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError

__all__ = ["described", "numbers"]


def described(value: Any) -> str:
    """A value of any type for a message: what it is, and short ones as they are."""
    if hasattr(value, "dtype"):
        return f"{np.shape(value)} {value.dtype}"
    if value is None or isinstance(value, str | int | float):
        return repr(value)[:40]
    return f"a {type(value).__name__}"


def numbers(values: Any, field: str, wanted: str) -> NDArray[np.float64]:
    """`values` as float64. Raises `InputError` for what is no array of real numbers."""
    try:
        found = np.asarray(values)
    except (ValueError, TypeError):  # lists of unequal lengths
        found = np.empty(0, object)
    if found.dtype.kind not in "biuf":
        raise InputError(f"must be {wanted}, got {described(values)}", field=field)
    return found.astype(np.float64)
