"""The disk, tilted at will, horizon included.

The receiver is the origin; z is the disk's axis away from the receiver, u points along the part of
the centre's direction that lies in the disk's plane, so that the rim is

    x(t) = (u₀ + R cos t, R sin t, z₀)       |x|² = D + E cos t,   D = u₀² + z₀² + R²,  E = 2 R u₀

and F = ½ ∫ (α + β cos t + γ sin t)/(D + E cos t) dt. With w² = D² − E² and κ = E/(D + w) the
integral of 1/(D + E cos t) is (t − 2A)/w, A = arg(1 + κ e^{it}): true against eccentric anomaly.
The rim is above the horizon for |t − ψ| < Δ, where cos Δ = −n·centre/(R·n_⊥).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from andon.lamps.form_factors.vectors import Float, dot, frame, quotient

__all__ = ["disk_factor"]


def disk_factor(
    position: ArrayLike,
    normal: ArrayLike,
    centre: ArrayLike,
    direction: ArrayLike,
    radius: float,
    /,
) -> Float:
    """Projected solid angle (...) in sr of the front of a disk; 0 behind it and in its plane.

    `direction` (3,) is the unit normal of its front. Source: the module's docstring.
    """
    axis = -np.asarray(direction, np.float64)
    reach = np.asarray(centre, np.float64) - np.asarray(position, np.float64)
    normals = np.asarray(normal, np.float64)
    right, down = frame(axis)
    away = dot(reach, axis)
    x, y = dot(reach, right), dot(reach, down)
    beside = np.hypot(x, y)
    cosine = np.where(beside > 0, quotient(x, beside), 1.0)
    sine = quotient(y, beside)
    n_x, n_y = dot(normals, right), dot(normals, down)
    n = (n_x * cosine + n_y * sine, n_y * cosine - n_x * sine, dot(normals, axis))
    place = (beside, np.maximum(away, 0))
    factor = _whole_and_arc(place, n, radius)
    return np.where(away > 0, np.clip(factor, 0, np.pi), 0.0)


def _whole_and_arc(place: tuple[Float, Float], n: tuple[Float, Float, Float], r: float) -> Float:
    """½ ∫ over the arc above the horizon and its closure; `n` along u, v and z."""
    (u0, z0), (nu, nv, nz) = place, n
    d = u0**2 + z0**2 + r**2
    w = np.hypot(z0, u0 - r) * np.hypot(z0, u0 + r)
    e = 2 * r * u0
    kappa = e / (d + w)
    # where on the rim the horizon cuts, from its highest point
    flat = np.hypot(nu, nv)
    cos_psi, sin_psi = np.where(flat > 0, quotient(nu, flat), 1.0), quotient(nv, flat)
    height = u0 * nu + z0 * nz
    beyond = np.where(height > 0, -1.0, 1.0)
    cut = np.where(np.abs(height) < r * flat, -quotient(height, r * flat), beyond)
    sin_cut = np.sqrt((1 - cut) * (1 + cut))
    whole = np.arccos(cut) * _per_radian(u0, z0, nu, nz, r)
    # the eccentric anomaly's share: ΔA is an angle of its own, from the two ends
    real = 1 + 2 * kappa * cos_psi * cut + kappa**2 * (2 * cut**2 - 1)
    imaginary = 2 * sin_cut * (cos_psi + kappa * cut)
    # (βD − αE)/R, and ∫ γ sin t/|x|² dt
    pull = u0 * nz * (u0**2 + z0**2 - r**2) - z0 * nu * d
    swing = quotient(r * pull * _angle_over(kappa, imaginary, real), w * (d + w))
    middle = d + e * cos_psi * cut
    step = -r * z0 * nv * sin_psi * sin_cut
    slope = quotient(step * _atanh_over(-quotient(e * sin_psi * sin_cut, middle)), middle)
    # the chord on the horizon: half of it along ψ's perpendicular, its middle at `near`, `side`
    half, side = r * sin_cut, u0 * sin_psi
    near = z0 * flat - (u0 * cos_psi + r * cut) * nz
    closure = 0.5 * np.arctan2(2 * half * near, near**2 + side**2 - half**2)
    return whole + swing + slope + np.where(sin_cut > 0, closure, 0.0)


def _per_radian(u0: Float, z0: Float, nu: Float, nz: Float, r: float) -> Float:
    """What the whole disk gives, over π. Source: (α − βκ)/w with its cancellation taken out."""
    w = np.hypot(z0, u0 - r) * np.hypot(z0, u0 + r)
    k = r**2 + (z0 - u0) * (z0 + u0)
    stable = np.where(k > 0, k + w, quotient(4 * (u0 * z0) ** 2, w - k))
    return quotient(r**2 * (nz * stable + 2 * u0 * z0 * nu), w * (u0**2 + z0**2 + r**2 + w))


def _angle_over(kappa: Float, imaginary: Float, real: Float) -> Float:
    """arg(real + i·κ·imaginary)/κ, also for κ = 0."""
    y = kappa * imaginary
    small = np.abs(y) < 1e-8 * np.abs(real)
    return np.where(
        small & (real > 0), quotient(imaginary, real), quotient(np.arctan2(y, real), kappa)
    )


def _atanh_over(z: Float) -> Float:
    """atanh(z)/z, also for z = 0."""
    z = np.clip(z, -1 + 1e-16, 1 - 1e-16)
    return np.where(np.abs(z) < 1e-4, 1 + z**2 / 3, quotient(np.arctanh(z), z))
