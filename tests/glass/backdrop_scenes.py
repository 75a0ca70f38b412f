"""Eyes, geometry and rays for the tests of backdrops."""

import numpy as np

from andon.glass.backdrops.model import Footprint, SceneOfView
from andon.quantities import Surface, merged
from andon.rays import RayScene, face_normals
from andon.spaces import View, pinhole_view, transform_points
from worlds import block, sheet, unit

__all__ = ["VIEWS", "WALL_AND_BOX", "eye_of", "footprint_of", "rays_from_a_ball", "surface_of"]

# As seen from the origin along −Z: a slanted wall 2 m away, a box in front of it.
SLANTED_WALL = sheet((-4, -4, -2.3), (8, 0, 0.6), (0, 8, 0.0))
WALL_AND_BOX = merged(SLANTED_WALL, block((0.3, 0.3, 0.3), (0.25, -0.1, -1.3)))

VIEWS = {
    "pinhole": pinhole_view(320, 180, 250.0),
    "fisheye": View("fisheye", 320, 180, 100.0, 90.0, 158.5, 90.5),
    "latlong": View("latlong", 320, 160),
}


def surface_of(view, geometry):
    """The G-buffer of exact rays, and the geometry to shoot more at."""
    scene = RayScene(geometry)
    eye, directions = view.rays_world()
    rays = directions.reshape(-1, 3)
    hits = scene.first_hits(np.broadcast_to(eye, rays.shape).copy(), rays)
    valid = hits.triangle >= 0
    position = eye + np.where(valid, hits.distance, np.nan)[:, None] * rays
    normal = face_normals(geometry)[hits.triangle]
    normal *= -np.sign(np.einsum("ni,ni->n", normal, rays))[:, None]
    planar = transform_points(view.camera_from_world, position)[:, 2]
    depth = planar if view.projection == "pinhole" else np.where(valid, hits.distance, np.nan)
    none = np.zeros((*view.shape, 3))
    surface = Surface(
        position.reshape(none.shape),
        np.where(valid[:, None], normal, np.nan).reshape(none.shape),
        depth.reshape(view.shape),
        valid.reshape(view.shape),
        np.zeros(view.shape, bool),
        none,
        np.zeros(view.shape, np.int32),
        none,
        view,
    )
    return surface, scene


def eye_of(view, geometry=SLANTED_WALL, luminance=None):
    """A `SceneOfView` whose frame has smooth light that is different everywhere."""
    surface, _ = surface_of(view, geometry)
    if luminance is None:
        rows, columns = np.mgrid[: view.height, : view.width]
        waves = [np.sin(columns / 17 + k) * np.cos(rows / 13 - k) for k in range(3)]
        luminance = 50 + 40 * np.stack(waves, axis=-1)
    return SceneOfView(luminance, surface, view, 100.0, (0.5, 1.0, 2.0))


def rays_from_a_ball(count, seed=1, centre=(0, 0, -0.5), radius=0.08):
    """Origins on a ball's surface and unit directions out of it, more or less away from the eye."""
    generator = np.random.default_rng(seed)
    out = unit(generator.normal(size=(count, 3)))
    origins = np.asarray(centre) + radius * out
    directions = unit(unit(generator.normal(size=(count, 3))) * 0.6 + [0, 0, -1.0])
    return origins, directions


def footprint_of(directions, angle=0.004, seed=2):
    """Pencils that differ in size and shape, as glass makes them."""
    generator = np.random.default_rng(seed)
    moves = generator.normal(size=(2, len(directions), 2, 3)) * angle
    moves[1] -= np.einsum("nki,ni->nk", moves[1], directions)[..., None] * directions[:, None]
    return Footprint(0.2 * moves[0], moves[1])
