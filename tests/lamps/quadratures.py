"""Projected solid angles by brute force, in ways that share nothing with the closed forms."""

from functools import cache

import numpy as np

from worlds import unit

__all__ = ["by_area", "by_hull", "by_nusselt", "by_rings"]


@cache
def gauss(n):
    """Nodes and weights on 0…1."""
    x, w = np.polynomial.legendre.leggauss(n)
    return (x + 1) / 2, w / 2


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
    """A sphere as rings around its axis: the azimuth in closed form, the rest by Gauss."""
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


def by_hull(ends, radius, normal, n=3000):
    """A tube: the convex hull of its end balls' circles in a plane before the eye, as a polygon.

    Inscribed polygons of n and 2n corners, extrapolated: their error goes with 1/n².
    """
    coarse, fine = (_hull_polygon(ends, radius, normal, k) for k in (n, 2 * n))
    return fine + (fine - coarse) / 3


def _hull_polygon(ends, radius, normal, n):
    t = (np.arange(n) + 0.5) * 2 * np.pi / n
    edge = ends[1] - ends[0]
    at = np.clip(-(ends[0] @ edge) / (edge @ edge), 0, 1)
    eye = unit(ends[0] + at * edge)  # the nearest point: all of the tube is before it
    u = unit(np.cross(eye, [1, 0, 0] if abs(eye[0]) < 0.6 else [0, 1, 0]))
    v = np.cross(eye, u)
    circles = []
    for end in ends:
        axis, half = unit(end), np.arcsin(radius / np.linalg.norm(end))
        p = unit(np.cross(axis, [1, 0, 0] if abs(axis[0]) < 0.6 else [0, 1, 0]))
        ring = np.cos(t)[:, None] * p + np.sin(t)[:, None] * np.cross(axis, p)
        circles.append(np.cos(half) * axis + np.sin(half) * ring)
    rays = np.concatenate(circles)
    plane = np.c_[rays @ u, rays @ v] / (rays @ eye)[:, None]
    corners = rays[hull(plane)]
    a, b = corners, np.roll(corners, -1, axis=0)
    ha, hb = a @ normal, b @ normal
    safe = np.where(ha == hb, 1.0, ha - hb)
    crossing = a + (b - a) * (ha / safe)[:, None]
    first = np.where((ha > 0)[:, None], a, crossing)
    last = np.where((hb > 0)[:, None], b, crossing)
    kept = (ha > 0) | (hb > 0)
    cross = np.cross(first, last)[kept]
    size = np.linalg.norm(cross, axis=1)
    angle = np.arctan2(size, (first * last).sum(axis=1)[kept])
    total = 0.5 * (angle * (cross @ normal) / np.maximum(size, 1e-300)).sum()
    leaves, enters = crossing[(ha > 0) & (hb <= 0)], crossing[(ha <= 0) & (hb > 0)]
    if len(leaves):
        x, y = leaves[0], enters[0]
        total += 0.5 * np.arctan2(np.cross(x, y) @ normal, x @ y)
    return abs(total)


def hull(points):
    """Indices of the convex hull of `points` (n, 2), in order (Andrew's chain)."""
    order = np.lexsort(points.T[::-1])

    def chain(indices):
        kept = []
        for i in indices:
            while len(kept) > 1:
                p, q = points[kept[-1]] - points[kept[-2]], points[i] - points[kept[-2]]
                if p[0] * q[1] - p[1] * q[0] > 0:
                    break
                kept.pop()
            kept.append(i)
        return kept

    return np.array(chain(order)[:-1] + chain(order[::-1])[:-1])
