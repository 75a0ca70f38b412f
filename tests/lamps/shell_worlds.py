"""Meshes of shells, and what leaves a luminous body, summed up without its own formulas."""

import numpy as np

from andon.lamps import MeshLamp, PointLamp, PolygonLamp, SphereLamp
from andon.lamps.solids import icosphere
from andon.quantities import Geometry
from andon.rays import RayScene

CENTRE = np.array([1.0, 2.0, 3.0])


def lamp(cd=100.0, **options):
    return PointLamp("lantern", CENTRE, np.full(3, float(cd)), **options)


def tube(radius=0.1, height=0.3, sides=48, floor=False):
    """A lampshade about the y axis, open above, and below unless it has a floor."""
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([radius * np.cos(angle), 0 * angle, radius * np.sin(angle)], axis=1)
    up = np.array([0, height / 2, 0])
    points = np.concatenate([ring - up, ring + up, [-up]])
    first = np.arange(sides)
    after = (first + 1) % sides
    walls = [(first, first + sides, after + sides), (first, after + sides, after)]
    if floor:
        walls.append((first, after, np.full(sides, 2 * sides)))
    triangles = np.concatenate([np.stack(wall, axis=1) for wall in walls])
    return Geometry(points, triangles.astype(np.int32))


def box(size=(0.2, 0.3, 0.2), gap=0.0, sides="xyz"):
    """Six panes (or those of some axes), each drawn back from the edges by `gap`."""
    corners = []
    for axis in ["xyz".index(side) for side in sides]:
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for sign in (-1, 1):
            pane = np.zeros((4, 3))
            pane[:, axis] = sign * size[axis] / 2
            pane[:, u] = np.array([-1, 1, 1, -1]) * (size[u] / 2 - gap)
            pane[:, v] = np.array([-1, -1, 1, 1]) * (size[v] / 2 - gap) * sign
            corners.append(pane)
    points = np.concatenate(corners)
    quads = np.arange(len(points)).reshape(-1, 4)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return Geometry(points, triangles.astype(np.int32))


def holed_ball(opening=0.2, cuts=3):
    """A unit ball without the cap above a share `opening` of its height, and the real share."""
    ball = icosphere(cuts)
    middles = ball.positions[ball.triangles].mean(axis=1)
    kept = middles[:, 1] < 1 - 2 * opening
    return Geometry(ball.positions, ball.triangles[kept])


def moved(mesh, offset):
    return Geometry(mesh.positions + offset, mesh.triangles, mesh.normals)


def areas(corners):
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return across / 2


def directions(count=6000):
    """Unit vectors (count, 3), spread evenly over the sphere."""
    height = 1 - (2 * np.arange(count) + 1) / count
    angle = np.pi * (3 - np.sqrt(5)) * np.arange(count)
    ring = np.sqrt(1 - height**2)
    return np.stack([ring * np.cos(angle), height, ring * np.sin(angle)], axis=1)


def far_intensity(part, body, towards):
    """(n, 3) cd that a lamp sends far away; a bare lamp is hidden by the triangles of `body`."""
    if isinstance(part, SphereLamp):
        return np.broadcast_to(part.luminance_cd_m2 * np.pi * part.radius_m**2, (len(towards), 3))
    if isinstance(part, MeshLamp):
        seen = np.maximum(towards @ areas(part.positions_m[part.triangles]).T, 0)
        return seen @ part.facet_luminance_cd_m2
    if isinstance(part, PolygonLamp):
        first = np.broadcast_to(part.vertices_m[0], (len(part.vertices_m) - 2, 3))
        fan = np.stack([first, part.vertices_m[1:-1], part.vertices_m[2:]], axis=1)
        seen = np.maximum(towards @ areas(fan).sum(axis=0), 0)
        return seen[:, None] * part.luminance_cd_m2
    assert isinstance(part, PointLamp)
    free = RayScene(body.geometry).sees_infinity(
        np.broadcast_to(part.position_m, towards.shape), towards
    )
    through = part.shadow is not None and body.name in part.shadow.through
    return np.where((free | through)[:, None], part.intensity_cd, 0)


def sent_lm(parts, body):
    """(3,) lm that all lamps of a body send away."""
    towards = directions()
    total = sum(far_intensity(part, body, towards) for part in parts)
    return 4 * np.pi * total.mean(axis=0)


def drawn_lm(body):
    """(3,) lm of what the outside of the drawn body shows."""
    at = body.geometry.positions[body.geometry.triangles]
    shown = body.outside_cd_m2[body.geometry.triangles].mean(axis=1)
    return np.pi * np.linalg.norm(areas(at), axis=1) @ shown


def area_lm(part):
    """(3,) lm of a lamp with facets or of a lid, by its areas."""
    if isinstance(part, MeshLamp):
        size = np.linalg.norm(areas(part.positions_m[part.triangles]), axis=1)
        return np.pi * size @ part.facet_luminance_cd_m2
    first = np.broadcast_to(part.vertices_m[0], (len(part.vertices_m) - 2, 3))
    fan = np.stack([first, part.vertices_m[1:-1], part.vertices_m[2:]], axis=1)
    return np.pi * np.linalg.norm(areas(fan).sum(axis=0)) * part.luminance_cd_m2
