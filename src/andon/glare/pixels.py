"""How large a pixel is as an angle."""

from __future__ import annotations

import numpy as np

from andon.spaces import View

__all__ = ["pixel_radians"]


def pixel_radians(view: View, /) -> float:
    """Angle that no pixel of `view` is wider or higher than."""
    if view.projection == "latlong":
        return float(max(2 * np.pi / view.width, np.pi / view.height))
    return float(1 / min(view.fx, view.fy))
