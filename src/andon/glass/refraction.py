"""Refraction, mirroring and Fresnel's equations for many rays at once, in float64."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["against", "dot", "fresnel", "mirrored", "refracted"]

Float = NDArray[np.float64]


def dot(a: Float, b: Float, /) -> Float:
    """(...,) scalar products of vectors (..., 3)."""
    return np.einsum("...i,...i->...", a, b)


def against(directions: Float, normals: Float, /) -> Float:
    """`normals` (n, 3), turned where they point along `directions` (n, 3)."""
    return np.where(dot(directions, normals)[..., None] > 0, -normals, normals)


def mirrored(directions: Float, normals: Float, /) -> Float:
    """D − 2(D·N)N: unit `directions` (n, 3) mirrored at unit `normals` (n, 3) of either side."""
    return directions - 2 * dot(directions, normals)[..., None] * normals


def refracted(
    directions: Float, normals: Float, n1: Float | float, n2: Float | float, /
) -> tuple[Float, NDArray[np.bool_]]:
    """Directions (n, 3) behind a boundary, and where there are none.

    Snell's law. Whitted 1980 writes it as T = k_f·(N + V′) − N with V′ = V/|V·N| and
    k_f = 1/√(n²|V′|² − |V′ + N|²), n = n2/n1; T has the length 1/cos θ2. Here all are unit
    vectors, which is the same and stays finite at 90°: with s = D + c1·N along the boundary,
    D′ = η·s − c2·N, η = n1/n2, c2 = √(1 − η²|s|²).

    Parameters
    ----------
    directions : (n, 3) unit, towards the boundary.
    normals : (n, 3) unit, of either side.
    n1, n2 : refractive indices > 0 before and behind the boundary, (n,) or one number.

    Returns
    -------
    directions : (n, 3) unit; the mirrored ones where reflection is total.
    total : (n,) bool, reflection is total: sin θ1 > n2/n1.
    """
    facing = against(directions, normals)
    c1 = -dot(directions, facing)
    along = directions + c1[..., None] * facing
    eta = np.broadcast_to(np.asarray(n1, np.float64) / n2, c1.shape)
    sine = eta * np.sqrt(dot(along, along))
    total = sine > 1
    c2 = np.sqrt(np.maximum((1 - sine) * (1 + sine), 0))
    through = eta[..., None] * along - c2[..., None] * facing
    return np.where(total[..., None], along + c1[..., None] * facing, through), total


def fresnel(cos_i: Float, n1: Float | float, n2: Float | float, /) -> Float:
    """(n,) share of unpolarised light that a boundary mirrors, [0, 1]; 1 where all is.

    Fresnel's equations of two dielectrics: F = ½(r_s² + r_p²) with
    r_s = (n1·c1 − n2·c2)/(n1·c1 + n2·c2), r_p = (n1·c2 − n2·c1)/(n1·c2 + n2·c1).

    Parameters
    ----------
    cos_i : (n,) cosine of the angle of incidence, [0, 1].
    n1, n2 : refractive indices > 0 before and behind the boundary, (n,) or one number.
    """
    n1, n2 = (np.broadcast_to(np.asarray(index, np.float64), np.shape(cos_i)) for index in (n1, n2))
    c1 = np.clip(cos_i, 0, 1)
    sine = n1 / n2 * np.sqrt((1 - c1) * (1 + c1))
    c2 = np.sqrt(np.maximum((1 - sine) * (1 + sine), 0))
    # Grazing, both sums are 0 only between equal media, which are no boundary.
    across, within = n1 * c1 + n2 * c2, n1 * c2 + n2 * c1
    r_s = np.divide(n1 * c1 - n2 * c2, across, out=np.zeros_like(c1), where=across > 0)
    r_p = np.divide(n1 * c2 - n2 * c1, within, out=np.zeros_like(c1), where=within > 0)
    return np.where(sine > 1, 1.0, (r_s**2 + r_p**2) / 2)
