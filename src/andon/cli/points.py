"""Points of the world, as they are typed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from andon.cli.console import printable
from andon.errors import InputError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["point_of"]


def point_of(typed: str | None, field: str) -> NDArray[np.float64] | None:
    """(3,) metres of three numbers with commas, or None. Raises `InputError` for `field`."""
    import numpy as np

    if typed is None:
        return None
    try:
        values = np.array([float(word) for word in typed.split(",")])
    except ValueError:
        values = np.array([np.nan])
    if values.shape != (3,) or not np.isfinite(values).all():
        raise InputError(
            f"must be three numbers x,y,z in metres, got {printable(typed[:40])!r}",
            field=field,
            remedy=f"for example {field} 0,1.6,3",
        )
    return values
