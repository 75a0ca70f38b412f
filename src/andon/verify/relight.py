"""Rows of relighting: lamps, shadows, the frame."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from andon.lamps import DirectionalLamp, Lamp, PointLamp, Shadow, SpotLamp
from andon.pipeline import EngineName, Frame, Renderer
from andon.quantities import Geometry
from andon.rays import RayScene
from andon.spaces import look_at
from andon.transport.direct import reference
from andon.verify.edges import shadow_edges
from andon.verify.registry import NotShown, Row

__all__ = ["ROWS"]

Float = NDArray[np.float64]

# Within this of the horizon (cos φ), errors are measured against the light that a surface at this
# angle would get: a direction's error of 3e-5 rad is any relative error at the horizon itself.
GRAZING = 0.05


def _lamp_over_the_origin(cosine: Float, distance: Float, intensity: float) -> tuple[Float, Float]:
    """Positions of lamps whose angle and distance to the origin's +Y are given, and their E."""
    sine = np.sqrt(1 - cosine**2)
    positions = np.stack([sine, cosine, np.zeros_like(cosine)], axis=-1) * distance[:, None]
    return positions, intensity * np.maximum(cosine, 0) / distance**2


def point_reference() -> float:
    """Largest relative error of point, spot and directional lamps from 0° past the horizon."""
    generator = np.random.default_rng(1)
    cosine = np.cos(np.radians(np.concatenate([np.linspace(0, 120, 241), [89.999, 90.001]])))
    distance = generator.uniform(0.05, 20, cosine.size)
    positions, expected = _lamp_over_the_origin(cosine, distance, 60.0)
    origin, up = np.zeros(3), np.array([0.0, 1, 0])
    worst = 0.0
    for position, truth in zip(positions, expected, strict=True):
        direction = -position / np.linalg.norm(position)
        inner, outer = np.radians(20), np.radians(40)
        axis = direction * np.cos(0.5) + _across(direction) * np.sin(0.5)  # 0.5 rad off the axis
        ramp = np.clip((np.cos(0.5) - np.cos(outer)) / (np.cos(inner) - np.cos(outer)), 0, 1) ** 2
        cases: list[tuple[Lamp, float]] = [
            (PointLamp("p", position, np.full(3, 60.0)), truth),
            (SpotLamp("s", position, np.full(3, 60.0), None, 0.0, axis, inner, outer), truth * ramp),
            (
                DirectionalLamp("d", direction, np.full(3, 500.0)),
                500 * max(position[1] / float(np.linalg.norm(position)), 0.0),
            ),
        ]
        for lamp, value in cases:
            got = float(reference.illuminance(lamp, origin, up)[0])
            worst = max(worst, abs(got - value) / max(value, 1e-3))
    return worst


def _across(direction: Float) -> Float:
    side = np.cross(direction, [0.0, 0.0, 1.0])
    return side / np.linalg.norm(side)


def _tilted_floor() -> tuple[Geometry, Float]:
    """A square of 6 m whose normal is no axis, and that normal."""
    normal = np.array([0.2, 0.9, 0.3])
    normal /= np.linalg.norm(normal)
    right = _across(normal)
    forward = np.cross(right, normal)
    corners = np.array([a * right + b * forward for a, b in ((-3, -3), (3, -3), (3, 3), (-3, 3))])
    return Geometry(corners, np.array([[0, 2, 1], [0, 3, 2]], np.int32)), normal


def _floor_error(engine: EngineName) -> float:
    """Largest error of three low lamps over a tilted floor, per pixel, against I·cos φ/d²."""
    from andon.spaces import View
    from andon.verify.setting import prepared_of

    floor, normal = _tilted_floor()
    pose = look_at(normal * 3.0, np.zeros(3), (0.0, 0.0, -1.0))
    view = View("pinhole", 320, 240, 200.0, 200.0, 159.5, 119.5, world_from_camera=pose)
    worst = 0.0
    for height in (0.05, 0.5, 2.0):
        lamp = PointLamp("low", normal * height + 0.3 * _across(normal), np.full(3, 40.0))
        frame = Renderer(prepared_of(floor, view, (lamp,)), engine).render()
        points = _plane_points(view, normal)
        reach = lamp.position_m - points
        distance = np.linalg.norm(reach, axis=-1)
        cosine = reach @ normal / distance
        facing = 40 / distance**2
        error = np.abs(np.asarray(frame.illuminance.lux, float)[..., 1] - facing * cosine)
        seen = frame.surface.valid
        worst = max(worst, float((error / (facing * np.maximum(cosine, GRAZING)))[seen].max()))
    return worst


def _plane_points(view: object, normal: Float) -> Float:
    """Where the rays of `view` meet the plane through the origin, in closed form."""
    from andon.spaces import View

    assert isinstance(view, View)
    origin, rays = view.rays_world()
    return origin + rays * (-(origin @ normal) / (rays @ normal))[..., None]


@cache
def _room_frame(engine: EngineName) -> Frame:
    from andon.verify.setting import room_setting

    return Renderer(room_setting(4, 640, 360), engine).render()


def _near_shadow_edges(visible: NDArray[np.bool_], reach: int) -> NDArray[np.bool_]:
    """(H, W): some lamp's shadow (H, W, lamps) changes within `reach` pixels."""
    near = np.zeros(visible.shape[:2], bool)
    for lamp in range(visible.shape[2]):
        near |= _near(visible[..., lamp], reach)
    return near


@cache
def _against_radiance(engine: EngineName) -> tuple[float, float, float]:
    """Median and 95th percentile of the relative error in the room, and the share left out."""
    from andon.verify.setting import room, room_lamps
    from andon.verify.truths.embree import Visibility

    try:
        from andon.verify.truths.radiance import RadianceScene
        from andon.verify.truths.sources import PointSource
    except ImportError as error:
        raise NotShown("Radiance is missing: pip install 'andon[radiance]'") from error
    frame, lamps = _room_frame(engine), room_lamps(4)
    surface = frame.surface
    mask = surface.valid
    points, normals = surface.position[mask], surface.normal[mask]
    visibility = Visibility(room())
    visible = np.zeros((*mask.shape, len(lamps)), bool)
    for index, lamp in enumerate(lamps):
        visible[mask, index] = visibility.visible(points, normals, lamp.position_m)
    kept = mask & ~_near_shadow_edges(visible, 2) & ~_near_depth_edges(surface.depth)
    chosen = np.zeros_like(kept)
    chosen[1::3, 1::3] = True  # a ninth of the pixels: 25,000 points
    kept &= chosen
    sources = [PointSource(lamp.position_m, lamp.intensity_cd) for lamp in lamps]
    with RadianceScene(room(), sources) as scene:
        truth = scene.irradiance(surface.position[kept], surface.normal[kept])
    ours = np.asarray(frame.illuminance.lux, float)[kept]
    floor = 1e-3 * float(np.median(truth))
    error = np.abs(ours - truth).max(axis=1) / np.maximum(truth.max(axis=1), floor)
    left_out = 1 - np.count_nonzero(kept) / np.count_nonzero(chosen & mask)
    return float(np.median(error)), float(np.percentile(error, 95)), left_out


def _near_depth_edges(depth: Float) -> NDArray[np.bool_]:
    """(H, W): the surface changes within a pixel; both engines may see either side there."""
    import cv2

    filled = np.nan_to_num(depth).astype(np.float32)
    kernel = np.ones((3, 3), np.uint8)
    low, high = cv2.erode(filled, kernel), cv2.dilate(filled, kernel)
    return high > 1.05 * low


@cache
def _paraboloids() -> tuple[float, float, float]:
    """Share of pixels whose shadow differs from rays; those far from an edge; on the seam."""
    from andon.verify.rooms import camera_in
    from andon.verify.setting import prepared_of, room, room_lamps
    from andon.verify.truths.embree import Visibility

    visibility, casters = Visibility(room()), RayScene(room())
    view = camera_in(room(), 1280, 720)
    differing = facing = far = seam = 0
    shadow = Shadow(SHADOW_MAP_SIZE, SHADOW_FILTER)
    for lamp in room_lamps(4, shadow):
        frame = Renderer(prepared_of(room(), view, (lamp,)), "gpu").render()
        surface = frame.surface
        mask = surface.valid
        points, normals = surface.position[mask], surface.normal[mask]
        reach = lamp.position_m - points
        cosine = np.einsum("ij,ij->i", reach, normals) / np.linalg.norm(reach, axis=1)
        ours = np.asarray(frame.illuminance.lux)[mask].max(axis=1) > 0
        truth = visibility.visible(points, normals, lamp.position_m)
        counted = cosine > GRAZING
        wrong = counted & (ours != truth)
        differing += int(wrong.sum())
        facing += int(counted.sum())
        away = ~shadow_edges(
            points[wrong],
            normals[wrong],
            lamp,
            visibility.visible,
            casters,
            SHADOW_MAP_SIZE,
            steps=9,
        )
        far += int(away.sum())
        seam += int((away & _on_seam(points[wrong] - lamp.position_m)).sum())
    return differing / facing * 100, float(far), float(seam)


SHADOW_MAP_SIZE = 1024
SHADOW_FILTER = "none"


def _on_seam(reach: Float) -> NDArray[np.bool_]:
    """(n,) within two texels of the circle where one paraboloid ends and the other begins."""
    distance = np.linalg.norm(reach, axis=1)
    radius = np.linalg.norm(reach[:, :2], axis=1) / (distance + np.abs(reach[:, 2]))
    return np.abs(radius - 1) < 2 * 2 / SHADOW_MAP_SIZE


@dataclass(frozen=True)
class _Shown:
    renderer: Renderer
    frame: Frame


def _demonstration(engine: EngineName) -> _Shown:
    from importlib import resources

    from andon.scene import load_scene

    with resources.as_file(resources.files("andon") / "data" / "motorcycle") as folder:
        renderer = Renderer(load_scene(folder / "scene.toml"), engine)
    return _Shown(renderer, renderer.render())


@cache
def _parity() -> tuple[float, float, float, float]:
    """On the motorcycle: % within 5/255, mean difference, both away from edges; % left out; all."""
    gpu, slow = _demonstration("gpu"), _demonstration("reference")
    difference = np.abs(gpu.frame.image.rgb.astype(int) - slow.frame.image.rgb.astype(int))
    worst = difference.max(axis=-1)
    surface, prepared = slow.frame.surface, slow.renderer.prepared
    mask = surface.valid
    edges = np.zeros(mask.shape, bool)
    points, normals = surface.position[mask], surface.normal[mask]
    bias = np.where(
        surface.is_object[mask], prepared.surface.bias.object_m, prepared.surface.bias.real_m
    )
    casters = RayScene(prepared.surface.shadow_casters)

    def visible(at: Float, normals: Float, lamp_position: Float) -> NDArray[np.bool_]:
        return casters.is_visible(at + normals * bias[:, None], lamp_position)

    for lamp in prepared.lamps(0.0):
        assert isinstance(lamp, PointLamp)
        assert lamp.shadow is not None
        size = lamp.shadow.map_size
        edges[mask] |= shadow_edges(points, normals, lamp, visible, casters, size, steps=9)
    # An object's outline is drawn by two rasterisers: they may choose either side of it.
    edges |= _near(surface.is_object, 1)
    kept = ~edges
    within = float((worst[kept] <= 5).mean() * 100)
    mean = float(difference[kept].mean())
    return within, mean, float(edges.mean() * 100), float((worst <= 5).mean() * 100)


def _near(mask: NDArray[np.bool_], reach: int) -> NDArray[np.bool_]:
    """(H, W): `mask` changes within `reach` pixels."""
    import cv2

    kernel = np.ones((2 * reach + 1,) * 2, np.uint8)
    codes = mask.astype(np.uint8)
    return cv2.dilate(codes, kernel) != cv2.erode(codes, kernel)


def identity_bytes(engine: EngineName) -> float:
    """Bytes of the demonstration's photograph that change with no lamps and no dimming."""
    from dataclasses import replace
    from importlib import resources

    from andon.engines.prepared import prepare
    from andon.files.pictures import read_picture
    from andon.scene import load_scene

    with resources.as_file(resources.files("andon") / "data" / "motorcycle") as folder:
        scene = load_scene(folder / "scene.toml").model_copy(update={"lamp": (), "object": ()})
        prepared = replace(prepare(scene), lamps=lambda _: ())
        photo = read_picture(folder / "photo.png").values
    out = Renderer(prepared, engine).render().image.rgb
    return float(np.count_nonzero(out != photo))


def decimation() -> float:
    """% of the motorcycle's lit pixels whose shadow 30,000 triangles decide otherwise than all."""
    from dataclasses import replace
    from importlib import resources

    from andon.engines.prepared import prepare
    from andon.scene import load_scene
    from andon.surface.occluder import Occluder

    with resources.as_file(resources.files("andon") / "data" / "motorcycle") as folder:
        prepared = prepare(load_scene(folder / "scene.toml"))
    full = Occluder(prepared.surface.real, len(prepared.surface.real.triangles), 0.0)
    exact = replace(prepared, surface=replace(prepared.surface, occluder=full))
    shadows = [
        np.asarray(Renderer(p, "reference").render().illuminance.lux).sum(axis=-1)
        for p in (prepared, exact)
    ]
    valid = shadows[1] > 0
    return float((np.abs(shadows[0] - shadows[1])[valid] > 0.01 * shadows[1][valid]).mean() * 100)


def _rows(engine: EngineName) -> tuple[Row, ...]:
    return (
        Row(
            f"relight.identity.{engine}",
            "relight",
            0,
            "bytes",
            "the photograph's own bytes",
            lambda: identity_bytes(engine),
        ),
        Row(
            f"relight.scene.median.{engine}",
            "relight",
            0.01,
            "relative",
            "Radiance rtrace -I -ab 0, furnished room, 4 lamps",
            lambda: _against_radiance(engine)[0],
        ),
        Row(
            f"relight.scene.p95.{engine}",
            "relight",
            0.03,
            "relative",
            "Radiance rtrace -I -ab 0, furnished room, 4 lamps",
            lambda: _against_radiance(engine)[1],
        ),
        Row(
            f"relight.scene.left_out.{engine}",
            "relight",
            None,
            "share",
            "pixels within 2 px of a shadow's or 1 px of an object's edge",
            lambda: _against_radiance(engine)[2],
        ),
    )


CLOSED_FORM = "closed forms, horizon included"
RAYS = "Embree shadow rays, room of 13,150 triangles, |cos φ| > 0.05"
TOLERANCE = "the reference engine on the motorcycle, away from shadow edges"

ROWS: tuple[Row, ...] = (
    Row("relight.point.reference", "relight", 1e-6, "relative", CLOSED_FORM, point_reference),
    Row(
        "relight.point.gpu", "relight", 1e-3, "relative", CLOSED_FORM, lambda: _floor_error("gpu")
    ),
    *_rows("reference"),
    *_rows("gpu"),
    Row(
        "relight.paraboloid.differ",
        "relight",
        0.1,
        "% of pixels",
        RAYS,
        lambda: _paraboloids()[0],
    ),
    Row(
        "relight.paraboloid.beyond_two_texels",
        "relight",
        0,
        "pixels",
        f"{RAYS}; pixels that differ farther than 2 map texels from a true edge",
        lambda: _paraboloids()[1],
    ),
    Row(
        "relight.paraboloid.seam",
        "relight",
        0,
        "pixels",
        f"{RAYS}; those of them on the seam",
        lambda: _paraboloids()[2],
    ),
    Row(
        "relight.parity.within_5",
        "relight",
        99.9,
        "% of pixels",
        TOLERANCE,
        lambda: _parity()[0],
        at_least=True,
    ),
    Row("relight.parity.mean", "relight", 0.5, "codes of 255", TOLERANCE, lambda: _parity()[1]),
    Row(
        "relight.parity.left_out",
        "relight",
        None,
        "% of pixels",
        "pixels within 2 map texels of a true shadow's edge, or 1 px of an object's",
        lambda: _parity()[2],
    ),
    Row(
        "relight.parity.all_pixels",
        "relight",
        None,
        "% within 5/255",
        "the reference engine on the motorcycle, every pixel",
        lambda: _parity()[3],
    ),
    Row(
        "relight.decimation",
        "relight",
        None,
        "% of lit pixels",
        "the same shadows from all 640,000 triangles",
        decimation,
    ),
)
