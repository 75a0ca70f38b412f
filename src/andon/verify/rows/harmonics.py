"""Spherical harmonics: identities, the cube's grid, three.js, and what band 2 can draw.

Against three.js r187 (`fromCubeRenderTarget`) two things differ. Its basis has constants of six
digits. And it weighs a texel with 4/(1 + u² + v²)^{3/2}, the solid angle at its centre, as the
capture paper does, and not with the solid angle of its corners. Of the two the first is more
exact for a smooth light (the midpoint rule, value and weight at one place), by a factor of two;
the second is for a light that is constant in a texel. `fromCubeTexture` sees 8-bit sRGB: what is
above 1 is gone, and with it the sun.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from andon.harmonics import (
    SolidAngle,
    basis,
    convolved,
    cube_directions,
    cube_from_latlong,
    irradiance,
    irradiance_matrix,
    latlong_solid_angles,
    project_cube,
    project_latlong,
    rotated,
)
from andon.quantities import photometric
from andon.spaces import View
from andon.verify.panoramas import CC0, PANORAMAS, panorama
from andon.verify.registry import NotShown, Row
from andon.verify.truths.three_light_probe import SIZE, Recorded, recorded

__all__ = ["ROWS", "grid_error"]

Float = NDArray[np.float64]

NORMALS = 200


# ── identities ──────────────────────────────────────────────────────────────────────────────────


def _gauss_fourier(degree: int) -> tuple[Float, Float]:
    """(n, 3) directions and (n,) weights, exact for polynomials up to `degree`."""
    cosine, share = np.polynomial.legendre.leggauss(degree // 2 + 1)
    azimuth = np.arange(degree + 1) * (2 * np.pi / (degree + 1))
    sine = np.sqrt(1 - cosine * cosine)
    flat = np.outer(sine, np.cos(azimuth)), np.outer(sine, np.sin(azimuth))
    up = np.outer(cosine, np.ones(degree + 1))
    directions = np.stack([*flat, up], axis=-1).reshape(-1, 3)
    return directions, np.repeat(share * (2 * np.pi / (degree + 1)), degree + 1)


def _orthonormality() -> float:
    directions, weights = _gauss_fourier(8)
    values = basis(directions, 4)
    return float(np.abs((values.T * weights) @ values - np.eye(25)).max())


def _constant_environment() -> float:
    """Relative error of E = πL, of a constant cube map and panorama, in all directions."""
    luminance = np.array([1.0, 20.0, 300.0])
    normals = _spiral(NORMALS)
    lights = (
        project_cube(np.full((6, 16, 16, 3), luminance)),
        project_latlong(np.full((16, 32, 3), luminance)),
    )
    errors = [np.abs(irradiance(light, normals) / (np.pi * luminance) - 1) for light in lights]
    return float(np.max(errors))


def _random_lights() -> Float:
    light = np.random.default_rng(4).normal(size=(NORMALS, 9, 3))
    light[:, 0] += 5
    return light


def _matrix() -> float:
    """Largest difference of nᵀMn and Σ A_l·L_lm·Y_lm(n), of the light."""
    light, normals = _random_lights(), _spiral(NORMALS)
    extended = np.concatenate([normals, np.ones((NORMALS, 1))], axis=1)
    by_matrix = np.einsum("ni,ncij,nj->nc", extended, irradiance_matrix(light), extended)
    direct = np.einsum("nk,nkc->nc", basis(normals), convolved(light))
    return float((np.abs(by_matrix - direct) / np.abs(light).max(axis=(1, 2))[:, None]).max())


def _rotation() -> float:
    """Largest change, of the light, of irradiance when light and receivers turn; bands 0 to 4."""
    generator = np.random.default_rng(5)
    light = generator.normal(size=(NORMALS, 25, 3))
    turns = np.linalg.qr(generator.normal(size=(NORMALS, 3, 3)))[0]
    turns *= np.sign(np.linalg.det(turns))[:, None, None]
    normals = _spiral(NORMALS)
    moved = np.einsum("nij,nj->ni", turns, normals)
    change = np.abs(irradiance(rotated(light, turns), moved) - irradiance(light, normals))
    return float((change / np.abs(light).max(axis=(1, 2))[:, None]).max())


# ── the cube's grid ─────────────────────────────────────────────────────────────────────────────


def grid_error(size: int, kind: SolidAngle = "exact") -> float:
    """Largest error of a coefficient up to band 2, of lights that are harmonics themselves."""
    lights = basis(cube_directions(size))
    threes = [lights[..., first : first + 3] for first in (0, 3, 6)]
    given = np.concatenate([project_cube(f, 2, kind, signed=True) for f in threes], axis=1)
    return float(np.abs(given - np.eye(9)).max())


def _order() -> float:
    """p of error ∝ h^p, fitted to cubes of 8 to 128 pixels."""
    sizes = np.array([8, 16, 32, 64, 128])
    errors = [grid_error(size) for size in sizes.tolist()]
    return float(-np.polynomial.Polynomial.fit(np.log(sizes), np.log(errors), 1).convert().coef[1])


# ── three.js ────────────────────────────────────────────────────────────────────────────────────


@cache
def _faces(entry: Recorded) -> NDArray[np.float32]:
    faces = cube_from_latlong(panorama(entry.panorama), SIZE)
    means = faces.mean(axis=(1, 2), dtype=np.float64)
    if not np.allclose(means, entry.face_means, rtol=1e-5, atol=1e-6):
        raise NotShown(
            f"{entry.panorama} gives another cube map than three.js was shown; "
            "run tools/three_light_probe.py anew"
        )
    return faces


def _of_three(kind: SolidAngle) -> float:
    """Largest difference from three.js over all panoramas, of L00 of the same channel."""
    worst = 0.0
    for entry in recorded():
        ours = project_cube(_faces(entry), 2, kind)
        worst = max(worst, float((np.abs(ours - entry.target) / entry.target[0]).max()))
    return worst


def _eight_bits() -> float:
    """Largest share of a panorama's mean light that `fromCubeTexture`'s 8 bits lose."""
    lost = [1 - photometric(e.texture)[0] / photometric(e.target)[0] for e in recorded()]
    return float(max(lost))


# ── band 2 and irradiance ───────────────────────────────────────────────────────────────────────


def _spiral(count: int) -> Float:
    """(count, 3) unit vectors on a Fibonacci spiral about +Y, evenly over the sphere."""
    height = 1 - (2 * np.arange(count) + 1) / count
    azimuth = np.arange(count) * (np.pi * (3 - np.sqrt(5)))
    radius = np.sqrt(1 - height * height)
    return np.stack([radius * np.cos(azimuth), height, radius * np.sin(azimuth)], axis=1)


@cache
def _true_irradiance(name: str) -> Float:
    """(NORMALS,) photometric irradiance: the cosine summed over every pixel."""
    picture = panorama(name)
    height = len(picture)
    directions = View("latlong", 2 * height, height).rays_world()[1]
    power = photometric(picture) * latlong_solid_angles(height)[:, None]
    normals = _spiral(NORMALS)
    total = np.zeros(NORMALS)
    for row in range(height):
        total += np.maximum(normals @ directions[row].T, 0) @ power[row]
    return total


@cache
def _errors(name: str, order: int) -> Float:
    """(NORMALS,) error of irradiance of bands 0…order, of the mean irradiance."""
    truth = _true_irradiance(name)
    drawn = photometric(irradiance(project_latlong(panorama(name), order), _spiral(NORMALS)))
    return np.abs(drawn - truth) / truth.mean()


def _mean_error(order: int) -> float:
    return float(np.mean([_errors(name, order).mean() for name in PANORAMAS]))


def _median_error() -> float:
    return float(np.median([_errors(name, 2).mean() for name in PANORAMAS]))


def _of_the_brightest() -> float:
    """As `_mean_error`, of the irradiance that faces the light."""
    parts = [
        _errors(name, 2).mean() * _true_irradiance(name).mean() / _true_irradiance(name).max()
        for name in PANORAMAS
    ]
    return float(np.mean(parts))


def _worst_error() -> float:
    return float(max(_errors(name, 2).max() for name in PANORAMAS))


_GRID = "harmonics themselves on the cube's grid"
_THREE = f"three.js r187, LightProbeGenerator, cube maps {SIZE}² of {len(CC0)} panoramas"
_SUMS = f"the cosine over every pixel of {len(PANORAMAS)} HDR panoramas, {NORMALS} normals"

ROWS: tuple[Row, ...] = (
    Row(
        "probes.sh.orthonormal",
        "probes",
        1e-12,
        "absolute",
        "Gauss–Legendre × Fourier, bands 0 to 4",
        _orthonormality,
    ),
    Row("probes.sh.constant", "probes", 1e-12, "relative", "E = πL", _constant_environment),
    Row("probes.sh.matrix", "probes", 1e-12, "of the light", "Σ A_l·L_lm·Y_lm", _matrix),
    Row("probes.sh.rotation", "probes", 1e-12, "of the light", "the light unturned", _rotation),
    Row("probes.sh.cube_order", "probes", 1.95, "power of h", _GRID, _order, at_least=True),
    Row("probes.sh.cube_128", "probes", 3e-5, "absolute", _GRID, lambda: grid_error(128)),
    Row(
        "probes.sh.cube_128.paper",
        "probes",
        None,
        "absolute",
        f"{_GRID}, the paper's solid angles",
        lambda: grid_error(128, "paper"),
    ),
    Row("probes.sh.others.three", "probes", None, "of L00", _THREE, lambda: _of_three("exact")),
    Row(
        "probes.sh.others.three.same_weights",
        "probes",
        3e-6,
        "of L00",
        f"{_THREE}; its solid angles",
        lambda: _of_three("paper"),
    ),
    Row(
        "probes.sh.others.three.8_bit",
        "probes",
        None,
        "of the light lost",
        "three.js's fromCubeTexture beside its fromCubeRenderTarget, the worst panorama",
        _eight_bits,
    ),
    Row("probes.sh.l2.mean", "probes", None, "of the mean E", _SUMS, lambda: _mean_error(2)),
    Row("probes.sh.l2.median", "probes", None, "of the mean E", _SUMS, _median_error),
    Row("probes.sh.l2.brightest", "probes", None, "of the largest E", _SUMS, _of_the_brightest),
    Row("probes.sh.l2.worst", "probes", None, "of the mean E", _SUMS, _worst_error),
    Row("probes.sh.l4.mean", "probes", None, "of the mean E", _SUMS, lambda: _mean_error(4)),
)
