"""Glass truth: rays that Mitsuba intersects and its own dielectric refracts.

Only `scalar_rgb` is used: the llvm variants need a library that many machines lack. It works in
float32, about 1e-7 m on these scenes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glass.model import Backdrop, Ball, Closed, LensShape, Slab, Solid
from andon.lamps.solids import quads
from andon.quantities import Geometry
from andon.spaces import View
from andon.verify.registry import NotShown

__all__ = [
    "GlassScene",
    "Landing",
    "concentric_square",
    "lens_landing",
    "lens_mesh",
    "mitsuba",
    "rectangle",
    "sensor_of",
    "sensor_ray",
    "shape_of",
]

Float = NDArray[np.float64]

# A ray starts this far along itself: sideways it is not moved, as an offset along the normal would
# do, and nothing here is as thin.
STEP_M = 2e-6
MAX_EVENTS = 16
# Segments around a lens's axis and along each cap: chords are 1e-7 m off a cap of 0.1 m.
LENS_SEGMENTS, LENS_RINGS = 480, 100
# Components of Mitsuba's `dielectric`.
REFLECTED, TRANSMITTED = 0, 1


def mitsuba() -> Any:
    """Mitsuba, as `scalar_rgb`. Raises `NotShown` where it is not installed."""
    try:
        mi: Any = import_module("mitsuba")  # compiled; it brings no types
    except ImportError as error:
        raise NotShown("Mitsuba is missing: pip install 'andon[test]'") from error
    if mi.variant() != "scalar_rgb":
        mi.set_variant("scalar_rgb")
    return mi


@dataclass(frozen=True)
class Landing:
    """Where n rays come out on the backdrop.

    Attributes
    ----------
    points : (n, 3) metres, world; NaN where the backdrop is not met.
    glass : (n,) bool, the ray met glass.
    transmitted : (n,) share of the light that the interfaces let through, Π(1 − F).
    """

    points: Float
    glass: NDArray[np.bool_]
    transmitted: Float


class GlassScene:
    """Solids in front of a rectangle, for single rays.

    Parameters
    ----------
    solids : nested ones inside their predecessors, not touching; `index` must be the same in all
        channels. One `interfaces = 1` makes all rays go straight on after their first refraction.
    backdrop : of kind texture; default: that of the first solid.
    """

    def __init__(self, solids: Sequence[Solid], backdrop: Backdrop | None = None) -> None:
        mi = mitsuba()
        self.backdrop = backdrop or solids[0].backdrop
        self._entry_only = any(solid.interfaces == 1 for solid in solids)
        document: dict[str, Any] = {"type": "scene", "backdrop": rectangle(self.backdrop)}
        outside = 1.0
        for number, solid in enumerate(solids):
            if solid.is_dispersive:
                raise InputError("must be the same for all channels", field="index")
            glass = {"type": "dielectric", "int_ior": solid.index[0], "ext_ior": outside}
            document[f"solid{number}"] = shape_of(solid, glass)
            outside = solid.index[0]
        self.scene: Any = mi.load_dict(document)
        self._context: Any = mi.BSDFContext()

    def land(self, origins: Float, directions: Float, /) -> Landing:
        """Rays from `origins` (n, 3) along unit `directions` (n, 3), refracted, to the backdrop."""
        mi = mitsuba()
        points, glass = np.full(directions.shape, np.nan), np.zeros(len(directions), bool)
        share = np.ones(len(directions))
        for number, (start, way) in enumerate(
            zip(origins.tolist(), directions.tolist(), strict=True)
        ):
            found = self.follow(mi.Ray3f(mi.Point3f(start), mi.Vector3f(way)))
            points[number], events, share[number] = found
            glass[number] = events > 0
        return Landing(points, glass, share)

    def follow(self, ray: Any, /) -> tuple[tuple[float, float, float], int, float]:
        """Where Mitsuba's `ray` ends on the backdrop (or NaN), how many interfaces, their share."""
        mi = mitsuba()
        share, events = 1.0, 0
        while True:
            hit = self.scene.ray_intersect(ray)
            if not hit.is_valid():
                break
            if hit.shape.id() == "backdrop":
                return (hit.p.x, hit.p.y, hit.p.z), events, share
            way = ray.d
            if not (self._entry_only and events):
                if events == MAX_EVENTS:
                    break
                way, passed = self._event(hit)
                share *= passed
                events += 1
            ray = mi.Ray3f(hit.p + STEP_M * way, way)
        return (np.nan, np.nan, np.nan), events, share

    def _event(self, hit: Any) -> tuple[Any, float]:
        """The direction after an interface: the transmitted lobe, or the mirror's where it is 0."""
        mi = mitsuba()
        material = hit.bsdf()
        for component in (TRANSMITTED, REFLECTED):
            self._context.component = component
            sample, weight = material.sample(self._context, hit, 0.5, mi.Point2f(0.5, 0.5))
            if weight[0] > 0:
                # Radiance grows with the square of the index; the share is of light.
                passed = weight[0] * sample.eta**2 if component == TRANSMITTED else 1.0
                return hit.to_world(sample.wo), float(passed)
        raise ArithmeticError("the dielectric sends light nowhere")


def rectangle(backdrop: Backdrop) -> dict[str, Any]:
    """The plane of a backdrop of kind texture, as Mitsuba's ``rectangle``, black."""
    mi = mitsuba()
    pose = np.eye(4)
    front = np.cross(backdrop.right_m, backdrop.up_m)
    pose[:3, 0], pose[:3, 1] = backdrop.right_m, backdrop.up_m
    pose[:3, 2], pose[:3, 3] = front / np.linalg.norm(front), backdrop.centre_m
    black = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}
    return {"type": "rectangle", "to_world": mi.ScalarTransform4f(pose), "bsdf": black}


def shape_of(solid: Solid, bsdf: dict[str, Any], /, *, grown_m: float = 0.0) -> Any:
    """One solid as a Mitsuba shape: balls exact, slabs as boxes, lenses and meshes as triangles.

    `grown_m` makes a ball larger.
    """
    mi = mitsuba()
    pose = mi.ScalarTransform4f(solid.world_from_glass)
    shape = solid.shape
    if isinstance(shape, Ball):
        return {
            "type": "sphere",
            "radius": shape.radius_m + grown_m,
            "to_world": pose,
            "bsdf": bsdf,
        }
    if grown_m:
        raise InputError("is for balls only", field="grown_m")
    if isinstance(shape, Slab):
        box = pose @ mi.ScalarTransform4f().scale(shape.half_m.tolist())
        return {"type": "cube", "to_world": box, "bsdf": bsdf}
    geometry = shape.geometry if isinstance(shape, Closed) else lens_mesh(shape)
    return _mesh(geometry, solid.world_from_glass, bsdf)


def lens_mesh(shape: LensShape, /) -> Geometry:
    """A lens as fine triangles whose normals are those of its caps and its rim."""
    radii, heights, slopes = _profile(shape)
    turn = np.linspace(0, 2 * np.pi, LENS_SEGMENTS + 1)[:, None]
    around = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    level = np.broadcast_to(heights, (len(turn), len(heights)))[..., None]
    positions = np.concatenate([around * radii[:, None], level], axis=-1)
    up = np.broadcast_to(slopes[:, 1], level.shape[:2])[..., None]
    normals = np.concatenate([around * slopes[:, :1], up], axis=-1)
    triangles = quads(LENS_SEGMENTS, len(radii) - 1)[:, ::-1]
    return Geometry(
        positions.reshape(-1, 3), np.ascontiguousarray(triangles), normals.reshape(-1, 3)
    )


def _profile(shape: LensShape) -> tuple[Float, Float, Float]:
    """Radii, rising heights and normals (k, 2) (outwards, up) from the back pole to the front's."""
    s = np.linspace(0, 1, LENS_RINGS + 1)
    out = shape.radius_m * s
    caps: list[tuple[Float, Float, Float]] = []
    for sign, curvature in ((-1.0, shape.curvature_m[1]), (1.0, shape.curvature_m[0])):
        drop = curvature - np.sign(curvature) * np.sqrt(curvature**2 - out**2)
        height = sign * (shape.thickness_m / 2 - drop)
        slope = np.stack([out / curvature, sign * np.sqrt(1 - (out / curvature) ** 2)], axis=1)
        caps.append((out, height, slope))
    back, front = caps
    # The rim's corners are rows twice: one with the cap's normal, one with the cylinder's.
    level = np.full(2, shape.radius_m), np.array([back[1][-1], front[1][-1]]), np.eye(2)[[0, 0]]
    parts = zip(back, level, front, strict=True)
    joined = [np.concatenate([first, middle, last[::-1]]) for first, middle, last in parts]
    return joined[0], joined[1], joined[2]


def _mesh(geometry: Geometry, world_from_glass: Float, bsdf: dict[str, Any]) -> Any:
    mi = mitsuba()
    properties = mi.Properties()
    properties["mesh_bsdf"] = mi.load_dict(bsdf)
    has_normals = geometry.normals is not None
    mesh: Any = mi.Mesh(
        "solid",
        len(geometry.positions),
        len(geometry.triangles),
        has_vertex_normals=has_normals,
        props=properties,
    )
    turn = world_from_glass[:3, :3].T
    parameters: Any = mi.traverse(mesh)
    parameters["vertex_positions"] = _flat(geometry.positions @ turn + world_from_glass[:3, 3])
    parameters["faces"] = geometry.triangles.ravel().astype(np.uint32)
    if geometry.normals is not None:
        parameters["vertex_normals"] = _flat(geometry.normals @ turn)
    parameters.update()
    return mesh


def _flat(vectors: Float) -> NDArray[np.float32]:
    return np.ascontiguousarray(vectors, np.float32).ravel()


def sensor_of(view: View, /, **lens: float) -> Any:
    """A pinhole `view` as Mitsuba's sensor; its principal point is rounded to half a pixel.

    `lens`: ``aperture_radius`` and ``focus_distance`` (along the axis) in metres make it a
    ``thinlens``. Mitsuba's camera looks along +z, too, with x to the left and y up.
    """
    mi = mitsuba()
    if view.projection != "pinhole" or view.fx != view.fy:
        raise InputError("must be a pinhole with square pixels", field="view")
    pose = view.world_from_camera @ np.diag([-1.0, -1.0, 1.0, 1.0])
    # Its principal point is in the middle of the film, of which the view is a part.
    width, left = _film(view.width, view.cx)
    height, top = _film(view.height, view.cy)
    return mi.load_dict(
        {
            "type": "thinlens" if lens else "perspective",
            **lens,
            "fov_axis": "x",
            "fov": float(np.degrees(2 * np.arctan(width / 2 / view.fx))),
            "near_clip": 1e-4,
            "to_world": mi.ScalarTransform4f(pose),
            "film": {
                "type": "hdrfilm",
                "width": width,
                "height": height,
                "crop_offset_x": left,
                "crop_offset_y": top,
                "crop_width": view.width,
                "crop_height": view.height,
                "rfilter": {"type": "box"},
            },
        }
    )


def _film(size: int, centre: float) -> tuple[int, int]:
    """Pixels of the smallest film around `centre` that holds 0…size − 1, and where they begin."""
    twice = round(2 * centre) + 1
    whole = max(twice, 2 * size - twice)
    return whole, (whole - twice) // 2


def sensor_ray(sensor: Any, film: tuple[float, float], lens: tuple[float, float], /) -> Any:
    """Mitsuba's own ray through a place of `sensor`'s film and of its lens, both in [0, 1]²."""
    mi = mitsuba()
    ray, _ = sensor.sample_ray(0.0, 0.5, mi.Point2f(*film), mi.Point2f(*lens))
    return ray


def lens_landing(scene: GlassScene, view: View, pupil_m: float, focus_m: float) -> Any:
    """A function for `point_images`: Mitsuba's thin lens of `view`, through `scene`.

    Pupil `pupil_m` metres wide, sharp at `focus_m` along the view's axis. Places on the backdrop
    are along its own right and up, metres. The lens maps a place of the square to its disc by
    itself (concentrically); the map is undone here, so that pupil places mean what they say.
    """
    sensor = sensor_of(view, aperture_radius=pupil_m / 2, focus_distance=focus_m)
    plane = scene.backdrop
    axes = np.stack([plane.right_m, plane.up_m])
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    size = np.array([view.width, view.height])

    def lands(film_px: Float, pupil: Float) -> tuple[Float, Float]:
        film, square = (film_px + 0.5) / size, concentric_square(pupil)
        points, share = np.full((len(film), 3), np.nan), np.zeros(len(film))
        for number, (place, lens) in enumerate(zip(film.tolist(), square.tolist(), strict=True)):
            points[number], _, share[number] = scene.follow(sensor_ray(sensor, place, lens))
        return (points - plane.centre_m) @ axes.T, share

    return lands


def concentric_square(disc: Float, /) -> Float:
    """[0, 1]² (n, 2) that Mitsuba's lens takes to `disc` (n, 2) in the unit disc.

    The inverse of the concentric map (Shirley & Chiu 1997).
    """
    mi = mitsuba()
    return np.array([mi.warp.uniform_disk_to_square_concentric(place) for place in disc.tolist()])
