"""What is seen beside the glass, blurred by its own depth."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glass.defocus.kernels import kernel

__all__ = ["frame_blurred"]

Float = NDArray[np.float64]


def frame_blurred(luminance: Float, diameter_px: Float, vergence: Float, /) -> Float:
    """(H, W, 3): the picture with uniform discs of `diameter_px` (H, W), nearer over farther.

    Of two pixels the nearer one's disc decides (`vergence` (H, W), 1/m, larger is nearer): what is
    in front and out of focus spreads over what is behind; what is behind does not spread over a
    sharp edge in front, and is seen through the soft one. Each disc weighs one pixel in sum.

    What it cannot do: show what a blurred thing in front hides. There what is seen beside it is
    spread, so a blurred foreground is a little too opaque, and behind its rim light is invented.

    Raises `InputError` for shapes that differ and diameters that are negative or not finite.
    """
    shape, size = kernel("optical"), luminance.shape[:2]
    for name, values in (("diameter_px", diameter_px), ("vergence", vergence)):
        if values.shape != size:
            raise InputError(f"must be {size}, got {values.shape}", field=f"frame.{name}")
    if not (np.isfinite(diameter_px).all() and (diameter_px >= 0).all()):
        raise InputError("must be finite and ≥ 0", field="frame.diameter_px")
    own = np.maximum(shape.sizes(diameter_px), 0.5)
    far = int(np.ceil(shape.reach(own.max(keepdims=True)).max()))
    rows, columns = np.mgrid[: size[0], : size[1]]
    total, light = np.zeros(size), np.zeros(luminance.shape)
    for dy in range(-far, far + 1):
        for dx in range(-far, far + 1):
            if np.hypot(dy, dx) >= far:
                continue
            at = np.clip(rows + dy, 0, size[0] - 1), np.clip(columns + dx, 0, size[1] - 1)
            disc = np.where(vergence[at] > vergence, own[at], own)
            weight = shape.weights(dy, dx, disc.ravel()).reshape(size) / (np.pi * disc**2)
            total += weight
            light += weight[..., None] * luminance[at]
    return light / total[..., None]
