"""Camera response g: scene-linear light → encoded sensor value, and back.

The *response* belongs to the camera; capture applies g⁻¹, a video see-through display applies g
again, so that light which was not changed leaves with the bytes it came with. Values are
normalised: linear 1.0 and encoded 1.0 are the same white.

============ ===================================== =======================
kind         g(x)                                  source
============ ===================================== =======================
``linear``   x                                     raw, HDR and EXR files
``srgb``     piecewise, 1/2.4 with linear toe      IEC 61966-2-1:1999
``gamma``    x^(1/γ)                               older cameras, renderers
``curve``    monotone table, per channel           `andon` response files
============ ===================================== =======================
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError

__all__ = ["LINEAR", "SRGB", "Response", "SurfaceCurve", "srgb_decode", "srgb_encode"]

Float = NDArray[np.floating[Any]]


def srgb_decode(encoded: Float, /) -> Float:
    """Linear light from sRGB-encoded values in [0, 1] (IEC 61966-2-1); any shape."""
    return np.where(
        encoded <= 0.04045, encoded / 12.92, ((np.maximum(encoded, 0) + 0.055) / 1.055) ** 2.4
    )


def srgb_encode(linear: Float, /) -> Float:
    """sRGB-encoded values from linear light in [0, 1] (IEC 61966-2-1); any shape."""
    # 0.0031308 is the standard's own rounded knee; the two branches differ there by 3e-8.
    return np.where(
        linear <= 0.0031308, linear * 12.92, 1.055 * np.maximum(linear, 1e-12) ** (1 / 2.4) - 0.055
    )


@dataclass(frozen=True)
class Response:
    """How a camera encodes light.

    Attributes
    ----------
    kind : the family, see the module's table.
    gamma : γ of the gamma response, > 0; only with ``kind="gamma"``.
    linear, encoded : (n, 3) float64, both strictly increasing per channel; only with
        ``kind="curve"``. The curve is linear between its knots and clamped outside.
    """

    kind: Literal["linear", "srgb", "gamma", "curve"] = "srgb"
    gamma: float = 2.2
    linear: NDArray[np.float64] | None = None
    encoded: NDArray[np.float64] | None = None

    def __post_init__(self) -> None:
        if self.kind == "gamma" and not (np.isfinite(self.gamma) and self.gamma > 0):
            raise InputError(f"must be > 0, got {self.gamma:g}", field="response.gamma")
        if self.kind == "curve":
            self._check_curve()

    def _check_curve(self) -> None:
        rows: list[int] = []
        for name, table in (("linear", self.linear), ("encoded", self.encoded)):
            if table is None or table.ndim != 2 or table.shape[1] != 3 or len(table) < 2:
                shape = None if table is None else table.shape
                raise InputError(
                    f"must be at least 2 rows of 3 channels, got {shape}", field=f"response.{name}"
                )
            if not np.isfinite(table).all() or (np.diff(table, axis=0) <= 0).any():
                raise InputError("must be finite and strictly increasing", field=f"response.{name}")
            rows.append(len(table))
        if rows[0] != rows[1]:
            raise InputError(
                f"must have as many rows as response.linear, {rows[0]}, got {rows[1]}",
                field="response.encoded",
            )

    def decode(self, encoded: Float, /) -> Float:
        """g⁻¹: linear light (..., 3) from encoded values (..., 3) in [0, 1]."""
        if self.kind == "linear":
            return encoded
        if self.kind == "srgb":
            return srgb_decode(encoded)
        if self.kind == "gamma":
            return np.maximum(encoded, 0) ** self.gamma
        return self._interpolate(encoded, self.encoded, self.linear)

    def encode(self, linear: Float, /) -> Float:
        """g: encoded values (..., 3), not clipped above 1, from linear light (..., 3)."""
        if self.kind == "linear":
            return linear
        if self.kind == "srgb":
            return srgb_encode(linear)
        if self.kind == "gamma":
            return np.maximum(linear, 0) ** (1 / self.gamma)
        return self._interpolate(linear, self.linear, self.encoded)

    @staticmethod
    def _interpolate(
        values: Float, knots: NDArray[np.float64] | None, ordinates: NDArray[np.float64] | None
    ) -> Float:
        assert knots is not None
        assert ordinates is not None
        channels = [np.interp(values[..., c], knots[:, c], ordinates[:, c]) for c in range(3)]
        return np.stack(channels, axis=-1)


LINEAR = Response("linear")
SRGB = Response("srgb")


@dataclass(frozen=True)
class SurfaceCurve:
    """The illuminance–RGB model of one surface: f, what the camera delivers of it in E lux.

    Piecewise linear per channel, and straight on beyond both ends, so that f⁻¹ undoes f
    everywhere. The captured pixel carries the texture: f is applied to it, not instead of it.
    Source: the paper on relighting, section 2 (the *illuminance–RGB model*).

    Attributes
    ----------
    illuminance_lux : (n,) float64 ≥ 0, strictly increasing, n ≥ 2.
    linear : (n, 3) float64 ≥ 0, linear camera values, strictly increasing per channel.

    Raises `InputError` for other arrays.
    """

    illuminance_lux: NDArray[np.float64]
    linear: NDArray[np.float64]

    def __post_init__(self) -> None:
        lux, linear = np.asarray(self.illuminance_lux), np.asarray(self.linear)
        if lux.ndim != 1 or len(lux) < 2 or linear.shape != (len(lux), 3):
            raise InputError(
                "must be at least 2 illuminances (n,) and as many rows of 3 channels, got "
                f"{lux.shape} and {linear.shape}",
                field="surface response",
            )
        for name, table in (("illuminance_lux", lux), ("linear", linear)):
            if not np.isfinite(table).all() or (table < 0).any():
                raise InputError("must be finite and ≥ 0", field=name)
            if (np.diff(table, axis=0) <= 0).any():
                row = int(np.argmax((np.diff(table, axis=0) <= 0).reshape(len(lux) - 1, -1).any(1)))
                raise InputError(
                    f"must rise strictly from row to row, rows {row + 1} and {row + 2} do not",
                    field=name,
                )

    def linear_of(self, lux: Float, /) -> Float:
        """f: linear camera values (..., 3) in `lux` (..., 3)."""
        return _straight_on(lux, np.repeat(self.illuminance_lux[:, None], 3, axis=1), self.linear)

    def lux_of(self, linear: Float, /) -> Float:
        """f⁻¹: illuminance (..., 3) in lx at which the camera delivers `linear` (..., 3)."""
        knots = np.repeat(self.illuminance_lux[:, None], 3, axis=1)
        return _straight_on(linear, self.linear, knots)


def _straight_on(values: Float, knots: Float, ordinates: Float) -> Float:
    """Piecewise linear through (knots, ordinates) (n, 3) per channel, ends prolonged."""
    channels: list[Float] = []
    for c in range(3):
        x, y = knots[:, c], ordinates[:, c]
        part = np.clip(np.searchsorted(x, values[..., c], side="right") - 1, 0, len(x) - 2)
        slope = (y[part + 1] - y[part]) / (x[part + 1] - x[part])
        channels.append(y[part] + slope * (values[..., c] - x[part]))
    return np.stack(channels, axis=-1)
