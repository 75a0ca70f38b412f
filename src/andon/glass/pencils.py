"""Pencils: what becomes of the rays close to a ray, and how far away an image appears by them.

A pencil is the derivative of a ray by four things: its origin moved by e1 and by e2 (the plane of
the pupil), its direction turned by e1 and by e2. Igehy 1999 carries two of them, for texture
filters; with all four the image that a pupil sees is known, astigmatism included.

A pencil is an array (n, 4, 2, 3): of n rays the four derivatives dP, dD of point and direction.

Source: Igehy 1999, section 3: transfer, mirror, refraction.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.glass.refraction import dot

__all__ = [
    "blur_radians",
    "frames_of",
    "mirrored_pencil",
    "refracted_pencil",
    "start_pencil",
    "transferred",
    "vergence",
]

Float = NDArray[np.float64]

# Along a boundary neighbouring rays part at once. Cosines below this count as this, so that after
# any number of boundaries a pencil is a number; it is far too wide for any picture by then.
GRAZING = 1e-6


def frames_of(directions: Float, /) -> tuple[Float, Float]:
    """Two unit vectors (n, 3) each, across unit `directions` (n, 3) and one another."""
    helper = np.eye(3)[np.abs(directions).argmin(axis=-1)]
    first: Float = np.cross(helper, directions)
    first /= np.linalg.norm(first, axis=-1, keepdims=True)
    second: Float = np.cross(directions, first)
    return first, second


def start_pencil(e1: Float, e2: Float, /) -> Float:
    """(n, 4, 2, 3): the pencil of rays whose origins and directions move by `e1`, `e2` (n, 3)."""
    pencil = np.zeros((len(e1), 4, 2, 3))
    for place, axis in enumerate((e1, e2)):
        pencil[:, place, 0] = axis
        pencil[:, place + 2, 1] = axis
    return pencil


def transferred(pencil: Float, distance: Float, directions: Float, normals: Float, /) -> Float:
    """(n, 4, 2, 3): `pencil` `distance` (n,) metres further, on a surface with `normals` (n, 3).

    dP′ = dP + t·dD + dt·D, dt = −((dP + t·dD)·N)/(D·N): all its points lie on the surface.
    """
    moved = pencil[:, :, 0] + distance[:, None, None] * pencil[:, :, 1]
    cosine = dot(directions, normals)
    cosine = np.copysign(np.maximum(np.abs(cosine), GRAZING), cosine)
    steps = -dot(moved, normals[:, None]) / cosine[:, None]
    return np.stack([moved + steps[..., None] * directions[:, None], pencil[:, :, 1]], axis=2)


def refracted_pencil(
    pencil: Float, directions: Float, normals: Float, turning: Float, eta: Float, /
) -> Float:
    """(n, 4, 2, 3): a pencil on a boundary, behind it.

    D′ = η·D + (η·c1 − c2)·N, so dD′ = η·dD + (η·c1 − c2)·dN + (η·dc1 − dc2)·N with
    dc1 = −(dD·N + D·dN) and dc2 = η²·(c1/c2)·dc1.

    Parameters
    ----------
    pencil : (n, 4, 2, 3) on the boundary.
    directions : (n, 3) unit, before it.
    normals : (n, 3) unit, against `directions`.
    turning : (n, 3, 3) how the normals turn along the boundary: dN = turning @ dP.
    eta : (n,) n1/n2; reflection must not be total.
    """
    moved, bent = pencil[:, :, 0], pencil[:, :, 1]
    turned = np.einsum("nij,nkj->nki", turning, moved)
    c1 = -dot(directions, normals)
    c2 = np.sqrt(np.maximum(1 - eta**2 * (1 - c1**2), GRAZING**2))
    dc1 = -(dot(bent, normals[:, None]) + dot(turned, directions[:, None]))
    dc2 = (eta**2 * c1 / c2)[:, None] * dc1
    steep = (eta * c1 - c2)[:, None, None]
    across = (eta[:, None] * dc1 - dc2)[..., None] * normals[:, None]
    return np.stack([moved, eta[:, None, None] * bent + steep * turned + across], axis=2)


def mirrored_pencil(pencil: Float, directions: Float, normals: Float, turning: Float, /) -> Float:
    """(n, 4, 2, 3): a pencil on a boundary, mirrored; see `refracted_pencil`.

    dD′ = dD − 2(D·N)·dN − 2(dD·N + D·dN)·N.
    """
    moved, bent = pencil[:, :, 0], pencil[:, :, 1]
    turned = np.einsum("nij,nkj->nki", turning, moved)
    steep = dot(directions, normals)[:, None, None]
    along = dot(bent, normals[:, None]) + dot(turned, directions[:, None])
    mirrored = bent - 2 * steep * turned - 2 * along[..., None] * normals[:, None]
    return np.stack([moved, mirrored], axis=2)


def vergence(pencil: Float, distance: Float, directions: Float, /) -> Float:
    """(n, 2, 2) vergence in dioptres of what lies `distance` metres ahead, as the pupil sees it.

    V = B_θ⁻¹·B_x, where B_x and B_θ say how a ray's point on the plane across its last direction
    moves if its origin moves and if its direction turns at the eye. If the pupil's point moves by
    p, the same point is seen in a direction that turns by −V·p: so V = I/d if there is nothing in
    between. V is symmetric; its eigenvalues are the tangential and the sagittal vergence; they
    are negative for an image behind the eye, and huge, never NaN, for one at the eye.

    Parameters
    ----------
    pencil : (n, 4, 2, 3) at the last boundary (or at the eye), see `Traced.pencil`.
    distance : (n,) metres from there along `directions`, ≥ 0.
    directions : (n, 3) unit, last ones.
    """
    moved = pencil[:, :, 0] + np.asarray(distance, np.float64)[:, None, None] * pencil[:, :, 1]
    f1, f2 = frames_of(directions)
    # Rows f1, f2; columns: the four derivatives.
    spread = np.stack([dot(moved, f1[:, None]), dot(moved, f2[:, None])], axis=1)
    by_origin, by_turn = spread[:, :, :2], spread[:, :, 2:]
    # Where rays from one point of the eye meet on the background, its image is at the eye.
    least = np.finfo(float).eps
    by_turn = by_turn + least * (by_turn == 0).all(axis=(1, 2))[:, None, None] * np.eye(2)
    a, b, c, d = np.moveaxis(by_turn.reshape(-1, 4), 1, 0)
    least = least * (a * a + b * b + c * c + d * d)
    determinant = a * d - b * c
    determinant = np.copysign(np.maximum(np.abs(determinant), least), determinant)
    adjugate = np.stack([d, -b, -c, a], axis=1).reshape(-1, 2, 2)
    return adjugate @ by_origin / determinant[:, None, None]


def blur_radians(seen: Float, focus_dioptres: Float | float, pupil_m: Float | float, /) -> Float:
    """(n,) diameter in radians of the blur of what has the vergence `seen` (n, 2, 2).

    A pupil of A metres, focused on F dioptres, spreads a point over the ellipse A·(V − F·I); the
    disc of the same second moment has the diameter A·√(½‖V − F·I‖²). Without astigmatism this is
    A·|1/d − 1/d_f|.
    """
    focus = np.asarray(focus_dioptres, np.float64)[..., None, None] * np.eye(2)
    return np.asarray(pupil_m * np.sqrt(((seen - focus) ** 2).sum(axis=(-2, -1)) / 2), np.float64)
