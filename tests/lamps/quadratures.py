"""Projected solid angles by brute force, in ways that share nothing with the closed forms."""

import numpy as np

from worlds import unit

__all__ = ["by_area", "by_nusselt", "by_rings", "by_shadow"]


def gauss(n, low=0.0, high=1.0):
    x, w = np.polynomial.legendre.leggauss(n)
    return low + (x + 1) / 2 * (high - low), w * (high - low) / 2


def cut(polygon, normal):
    """The part of a convex `polygon` (k, 3) above the horizon (Sutherland and Hodgman)."""
    kept = []
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        ha, hb = a @ normal, b @ normal
        if ha > 0:
            kept.append(a)
        if (ha > 0) != (hb > 0):
            kept.append(a + (b - a) * ha / (ha - hb))
    return np.array(kept)


def by_area(triangles, normal, n=40):
    """∫ cos φ cos θ/d² dA over the fronts of `triangles` (m, 3, 3), seen from the origin."""
    x, w = gauss(n)
    total = 0.0
    for triangle in triangles:
        whole = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
        corners = cut(triangle, normal)
        for k in range(1, len(corners) - 1):
            p, u, v = corners[0], corners[k] - corners[0], corners[k + 1] - corners[0]
            # Duffy's map of the square on the triangle
            points = p + x[:, None, None] * (u + x[:, None] * (v - u))
            weight = w[:, None] * w * x[:, None]
            square = (points**2).sum(axis=-1)
            cosines = (points @ normal) * -(points @ unit(whole)) / square**2
            total += (cosines * weight).sum() * np.linalg.norm(np.cross(u, v))
    return total


def by_rings(reach, normal, radius, n=200):
    """A sphere as a cone of rings around its axis: the azimuth in closed form, the rest by Gauss."""
    distance = np.linalg.norm(reach)
    c = reach @ normal / distance
    s = np.sqrt(max(1 - c**2, 0))
    half = np.arcsin(radius / distance)

    def ring(a):
        with np.errstate(divide="ignore", invalid="ignore"):
            edge = np.arccos(np.clip(-c * np.cos(a) / (s * np.sin(a)), -1, 1))
        edge = np.nan_to_num(edge, nan=np.pi if c > 0 else 0.0)
        return 2 * np.sin(a) * (c * np.cos(a) * edge + s * np.sin(a) * np.sin(edge))

    kink = np.arctan2(abs(c), s)  # from here on the horizon cuts the rings
    total = 0.0
    for low, high in ((0.0, min(kink, half)), (min(kink, half), half)):
        x, w = gauss(n)  # x²: the kink has a root's shape
        total += (ring(low + (high - low) * x**2) * w * 2 * x).sum() * (high - low)
    return total


def by_nusselt(inside, normal, n=400):
    """The area of the shadow on the unit disk of directions where `inside` (m, 3) → bool."""
    u = unit(np.cross(normal, [1, 0, 0] if abs(normal[0]) < 0.6 else [0, 1, 0]))
    x = (np.arange(n) + 0.5) / n * 2 - 1
    xx, yy = (v.reshape(-1) for v in np.meshgrid(x, x))
    square = xx**2 + yy**2
    xx, yy, square = (v[square < 1] for v in (xx, yy, square))
    up = np.sqrt(1 - square)
    w = xx[:, None] * u + yy[:, None] * np.cross(normal, u) + up[:, None] * normal
    return inside(w).sum() * (2 / n) ** 2


def by_shadow(outline, normal, n=200):
    """½ ∮ of a closed smooth `outline` (k, 3) of directions: as a fan of spherical triangles.

    Each chord's triangle with the middle is cut at the horizon and summed in Lambert's form.
    """
    middle = unit(outline.mean(axis=0))
    total = 0.0
    for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        corners = cut(np.array([middle, a, b]), normal)
        for p, q in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            cross = np.cross(p, q)
            size = np.linalg.norm(cross)
            if size > 0:
                total += 0.5 * np.arctan2(size, p @ q) * (cross @ normal) / size
    return abs(total)
