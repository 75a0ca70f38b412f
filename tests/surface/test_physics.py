"""Normals, depth, triangles and traced surfaces, against closed forms."""

import numpy as np
import pytest

from andon.composite.reference import draw_lamps
from andon.errors import InputError
from andon.lamps import PointLamp
from andon.quantities import Geometry, Material
from andon.rays import face_normals
from andon.spaces import View, look_at, rotate
from andon.surface.depth import DepthEncoding, depth_from_raw
from andon.surface.inside import is_buried
from andon.surface.model import SurfaceModel
from andon.surface.normals import normals_from_depth, planes_of_depth
from andon.surface.reference import nearest, see, trace
from andon.surface.textures import sample_bilinear, with_linear_textures
from comparison import assert_agree
from worlds import ball, block, sheet, sphere_depth, unit

PINHOLE = View("pinhole", 60, 45, 50.0, 50.0, 29.5, 22.0)
FISHEYE = View("fisheye", 60, 45, 40.0, 41.0, 29.5, 22.0)
LATLONG = View("latlong", 96, 48)
VIEWS = [PINHOLE, FISHEYE, LATLONG]
IDS = [view.projection for view in VIEWS]


def angles(normals, expected):
    """(...) angles in radians, precise near 0."""
    return 2 * np.arcsin(np.linalg.norm(normals - expected, axis=-1) / 2)


def plane_depth(view, normal, distance):
    """Depth of the plane normal·p = −distance, and how much it changes from pixel to pixel."""
    with np.errstate(divide="ignore"):
        inverse = -(view.rays_planar() @ normal) / distance
    step = np.hypot(*np.gradient(inverse)) / np.abs(inverse)
    return np.where(inverse > 1e-3, 1 / np.maximum(inverse, 1e-3), np.nan), step


@pytest.mark.parametrize("view", VIEWS, ids=IDS)
@pytest.mark.parametrize("tilt_degrees", [0, 10, 30, 50, 65, 80])
def test_normal_of_a_plane(view, tilt_degrees):
    tilt = np.radians(tilt_degrees)
    for azimuth in np.radians([20, 110, 255]):
        normal = np.array([np.sin(tilt) * np.cos(azimuth), np.sin(tilt) * np.sin(azimuth), 0])
        normal[2] = -np.cos(tilt)
        depth, step = plane_depth(view, normal, 2.0)
        found = normals_from_depth(depth, view)
        # Towards the horizon neighbours are a jump (5 %) apart; there no plane can be fitted.
        resolved = np.isfinite(depth) & (step < 0.03)
        assert resolved.sum() > 40
        error = angles(found[resolved], rotate(view.world_from_camera, normal))
        assert np.median(error) < 1e-6
        assert error.max() < (1e-6 if view.projection != "latlong" else 3e-6)


@pytest.mark.parametrize("view", VIEWS, ids=IDS)
def test_normals_are_unit_and_face_the_camera(view):
    depth = sphere_depth(view, (0.1, -0.2, 1.5), 0.7)[0]
    pose = look_at(np.array([1.0, 2, 3]), np.array([0.5, 0, 0]))
    posed = View(**{**vars(view), "world_from_camera": pose})
    normals = normals_from_depth(depth, posed)
    seen = np.isfinite(depth)
    assert_agree(np.linalg.norm(normals[seen], axis=-1), np.ones(seen.sum()), atol=1e-12)
    rays = posed.rays_world()[1][seen]
    assert (np.einsum("ij,ij->i", normals[seen], rays) < 0).all()
    assert_agree(
        normals[seen],
        rotate(pose @ np.diag([1, -1, -1, 1]), normals_from_depth(depth, view)[seen]),
        atol=1e-9,
    )


def test_normal_of_a_sphere():
    """Curvature: over the window's σ = 1.5 px a sphere turns by 1.5/(f·r/z) rad; less by fit."""
    view = View("pinhole", 240, 240, 400.0, 400.0, 119.5, 119.5)
    depth, expected = sphere_depth(view, (0, 0, 2.0), 0.5)
    error = angles(normals_from_depth(depth, view), rotate(view.world_from_camera, expected))
    cosine = -np.einsum("...i,...i->...", expected, view.directions())
    assert np.degrees(error[cosine > 0.5].max()) < 1.0
    assert np.degrees(np.median(error[cosine > 0.5])) < 0.15


def one_sided_normals(depth, view):
    """What a plain cross product of differences gives."""
    points = view.rays_planar() * depth[..., None]
    normal = np.cross(np.diff(points, axis=0)[:, :-1], np.diff(points, axis=1)[:-1])
    return rotate(view.world_from_camera, unit(normal))


def test_noise_is_averaged():
    normal = unit([0.3, -0.4, -1.0])
    depth, _ = plane_depth(PINHOLE, normal, 2.0)
    noisy = depth * (1 + 0.002 * np.random.default_rng(1).normal(size=depth.shape))
    world = rotate(PINHOLE.world_from_camera, normal)
    fitted = np.sqrt((angles(normals_from_depth(noisy, PINHOLE), world) ** 2).mean())
    plain = np.sqrt((angles(one_sided_normals(noisy, PINHOLE), world) ** 2).mean())
    # Slope of a weighted fit (σ 1.5 px, 7×7): variance 1/Σw²x² of 2 of a difference: 1/5 or less.
    assert fitted < plain / 4
    assert fitted > 0


def test_depth_with_noise_is_that_of_planes():
    """Two walls that meet: far from holes and rims the error falls to a third, creases included."""
    view = PINHOLE.resized(180, 135)
    walls = [plane_depth(view, unit([side, -0.1, -1.0]), 2.0)[0] for side in (-0.6, 0.6)]
    true = np.minimum(*walls)
    noisy = true * (1 + 0.004 * np.random.default_rng(4).normal(size=true.shape))
    noisy[60:66, 40:50] = np.nan
    _, found = planes_of_depth(noisy, view)
    np.testing.assert_array_equal(np.isnan(found), np.isnan(noisy))
    before, after = (np.abs(depth / true - 1) for depth in (noisy, found))
    assert np.nanmean(after) < np.nanmean(before) / 3
    assert np.nanpercentile(after, 99) < np.nanpercentile(before, 90)


def test_depth_without_noise_stays():
    depth = np.minimum(*(plane_depth(PINHOLE, unit([x, 0.0, -1.0]), 2.0)[0] for x in (-0.5, 0.5)))
    millimetres = np.rint(1000 * depth) / 1000
    np.testing.assert_array_equal(planes_of_depth(millimetres, PINHOLE)[1], millimetres)


def kinect_noise(shape, seed):
    """Errors of depth of 0.3 % RMS, alike as a Kinect's over 1, 2, 4 px (0.86, 0.55, 0.09)."""
    import cv2

    noise = cv2.GaussianBlur(np.random.default_rng(seed).standard_normal(shape), (0, 0), 1.3)
    return 1 + 0.003 * noise / noise.std()


def test_noise_that_is_alike_over_pixels_makes_no_waves():
    """7×7 pixels take such noise for relief: the wide window does not."""
    view = PINHOLE.resized(180, 135)
    normal = unit([0.3, -0.4, -1.0])
    depth, _ = plane_depth(view, normal, 2.0)
    noisy = depth * kinect_noise(view.shape, 1)
    world = rotate(view.world_from_camera, normal)
    inside = (slice(8, -8), slice(8, -8))
    error = np.degrees(angles(normals_from_depth(noisy, view), world))[inside]
    assert np.sqrt((error**2).mean()) < 3  # the narrow window alone leaves 9°


def test_relief_in_a_calm_picture_is_no_noise():
    """A ball of 12 px is rough to a 7×7 window; where a fifth of the picture is calm it is kept."""
    depth, expected = sphere_depth(PINHOLE, (0, 0, 2.0), 0.4)
    wall = 3.0
    with_wall = np.where(np.isfinite(depth), depth, wall)
    alone = normals_from_depth(depth, PINHOLE)
    before = normals_from_depth(with_wall, PINHOLE)
    inside = np.isfinite(depth) & (depth < 1.8)
    assert inside.any()
    assert np.degrees(angles(alone, before)[inside]).max() < 1e-6
    world = rotate(PINHOLE.world_from_camera, expected)
    assert np.degrees(np.median(angles(before, world)[inside])) < 3


def test_a_crease_between_noisy_walls_is_found():
    view = PINHOLE.resized(240, 180)
    depth, left, right = crease(view)
    normals = normals_from_depth(depth * kinect_noise(view.shape, 2), view)
    column = np.arange(view.width)[None, :] * np.ones((view.height, 1))
    expected = np.where((column < view.cx)[..., None], left, right)
    error = np.degrees(angles(normals, rotate(view.world_from_camera, expected)))
    beyond = np.abs(column - view.cx)
    # 7 to 9° by the narrow window alone. Beside the crease it stays: 7 to 16°.
    assert np.median(error[beyond >= 4]) < 2
    assert np.median(error[beyond < 4]) < 16


def crease(view):
    """Two planes at 90° that meet in the middle column, like a corner of a room."""
    left, right = unit([1.0, 0, -1]), unit([-1.0, 0, -1])
    a, b = (plane_depth(view, n, np.sqrt(2))[0] for n in (left, right))
    return np.fmin(a, b), left, right


def test_a_crease_stays_sharp():
    depth, left, right = crease(PINHOLE)
    normals = normals_from_depth(depth, PINHOLE)
    column = np.arange(PINHOLE.width)[None, :] * np.ones((PINHOLE.height, 1))
    expected = np.where((column < PINHOLE.cx)[..., None], left, right)
    error = np.degrees(angles(normals, rotate(PINHOLE.world_from_camera, expected)))
    beyond = np.abs(column - PINHOLE.cx)
    assert error[beyond > 2].max() < 0.01  # the window (radius 3) reaches across, and does not mix
    assert error[beyond < 2].max() < 20  # a blend would be 45° off


def test_a_jump_is_not_crossed():
    near, far = unit([0.2, 0.1, -1]), unit([-0.4, 0.3, -1])
    depth = plane_depth(PINHOLE, far, 3.0)[0]
    front = np.zeros(PINHOLE.shape, bool)
    front[10:30, 15:40] = True
    depth[front] = plane_depth(PINHOLE, near, 1.5)[0][front]
    expected = np.where(front[..., None], near, far)
    error = angles(normals_from_depth(depth, PINHOLE), rotate(PINHOLE.world_from_camera, expected))
    assert error.max() < 1e-5


@pytest.mark.parametrize("view", VIEWS, ids=IDS)
def test_holes_stay_holes_and_hurt_no_neighbour(view):
    normal = unit([0.1, 0.2, -1])
    depth, step = plane_depth(view, normal, 2.0)
    holes = np.random.default_rng(0).random(view.shape) < 0.3
    normals = normals_from_depth(np.where(holes, np.nan, depth), view)
    assert np.isnan(normals[holes]).all()
    kept = ~holes & np.isfinite(depth) & (step < 0.02)
    assert np.isfinite(normals[kept]).all()
    error = angles(normals[kept], rotate(view.world_from_camera, normal))
    assert np.percentile(error, 99) < 1e-4


@pytest.mark.parametrize("view", VIEWS, ids=IDS)
def test_a_lonely_pixel_faces_the_camera(view):
    """Nothing measures its slopes: they are 0, on the pinhole's image plane or on the pixel's."""
    depth = np.full(view.shape, np.nan)
    depth[12, 10] = 2.0
    normal = normals_from_depth(depth, view)[12, 10]
    axis = view.rays_world()[1][12, 10] if view.projection != "pinhole" else [0, 0, -1]
    assert_agree(normal, -np.asarray(axis), atol=1e-9)


# ── depth files' numbers ──────────────────────────────────────────────────────────────────────


def test_z_and_its_scale():
    raw = np.full(PINHOLE.shape, 1500.0)
    assert_agree(depth_from_raw(raw, PINHOLE, DepthEncoding("z", 0.001)), raw / 1000)


def test_distance_along_the_ray():
    depth = depth_from_raw(np.full(PINHOLE.shape, 3.0), PINHOLE, DepthEncoding("distance"))
    points = PINHOLE.rays_planar() * depth[..., None]
    assert_agree(np.linalg.norm(points, axis=-1), np.full(PINHOLE.shape, 3.0), rtol=1e-12)


def test_disparity_with_offset_and_scale():
    raw = np.full(PINHOLE.shape, 20.0)
    encoding = DepthEncoding("disparity", baseline_m=0.1, doffs_px=5.0)
    assert_agree(depth_from_raw(raw, PINHOLE, encoding), np.full(raw.shape, 0.1 * 50 / 25))
    # A 16-bit file that stores 256ths of a pixel.
    encoding = DepthEncoding("disparity", scale_to_m=1 / 256, baseline_m=0.1)
    assert_agree(depth_from_raw(raw * 256, PINHOLE, encoding), np.full(raw.shape, 0.1 * 50 / 20))


def test_planar_depth_of_a_fisheye_becomes_distance():
    raw = np.ones(FISHEYE.shape)
    depth = depth_from_raw(raw, FISHEYE, DepthEncoding("z"))
    ahead = FISHEYE.directions()[..., 2] > 0
    points = FISHEYE.rays_planar() * depth[..., None]
    assert_agree(points[ahead][:, 2], raw[ahead], rtol=1e-12)
    assert np.isnan(depth[~ahead]).all()


@pytest.mark.parametrize("hole", [np.nan, np.inf, -np.inf, 0.0, -2.0, 65535.0])
def test_what_is_no_measurement_is_a_hole(hole):
    raw = np.full(PINHOLE.shape, 2.0)
    raw[3, 4] = hole
    depth = depth_from_raw(raw, PINHOLE, DepthEncoding(invalid=(65535.0,)))
    assert np.isnan(depth[3, 4])
    assert np.isnan(depth).sum() == 1


def test_disparity_that_reaches_infinity_is_a_hole():
    raw = np.full(PINHOLE.shape, 20.0)
    raw[0, 0], raw[0, 1] = -5.0, -9.0
    depth = depth_from_raw(raw, PINHOLE, DepthEncoding("disparity", baseline_m=1, doffs_px=5.0))
    assert np.isnan(depth[0, :2]).all()
    assert np.isfinite(depth[0, 2:]).all()


def test_depth_that_cannot_be_is_refused():
    good = np.ones(PINHOLE.shape)
    with pytest.raises(InputError, match=r"d\.npy: surface\.depth: is 45×60 px but .* 60×45"):
        depth_from_raw(good.T, PINHOLE, DepthEncoding(), file="d.npy")
    for bad in (good * np.nan, good * 0, -good):
        with pytest.raises(InputError, match="no pixel with a depth above 0"):
            depth_from_raw(bad, PINHOLE, DepthEncoding())
    with pytest.raises(InputError, match="baseline_m"):
        depth_from_raw(good, PINHOLE, DepthEncoding("disparity"))
    with pytest.raises(InputError, match="pinhole"):
        depth_from_raw(good, FISHEYE, DepthEncoding("disparity", baseline_m=1))


# ── textures ──────────────────────────────────────────────────────────────────────────────────

PICTURE = np.random.default_rng(0).random((4, 6, 3))


def test_texel_centres_are_exact_and_half_way_is_the_mean():
    columns, rows = np.meshgrid(np.arange(6), np.arange(4))
    uv = np.stack([(columns + 0.5) / 6, (rows + 0.5) / 4], axis=-1).reshape(-1, 2)
    assert_agree(sample_bilinear(PICTURE, uv), PICTURE.reshape(-1, 3), atol=1e-14)
    between = sample_bilinear(PICTURE, np.array([[2 / 6, 1.5 / 4]]))
    assert_agree(between, PICTURE[1:2, 1:3].mean(axis=1), atol=1e-14)


def test_textures_repeat():
    uv = np.random.default_rng(1).random((50, 2))
    for shift in ((1, 0), (0, 1), (-3, 2)):
        assert_agree(sample_bilinear(PICTURE, uv + shift), sample_bilinear(PICTURE, uv), atol=1e-12)
    # Across the border the last texel blends into the first.
    seam = sample_bilinear(PICTURE, np.array([[0.0, 0.5 / 4]]))
    assert_agree(seam[0], (PICTURE[0, 0] + PICTURE[0, -1]) / 2, atol=1e-14)


def test_textures_are_decoded_to_linear_light():
    square = sheet((0, 0, 0), (1, 0, 0), (0, 1, 0))
    for texture in (np.full((3, 5, 3), 128, np.uint8), np.full((2000, 1500, 3), 128, np.uint8)):
        textured = Geometry(
            square.positions, square.triangles, materials=(Material(texture=texture), Material())
        )
        linear = with_linear_textures(textured).materials[0].texture
        assert linear.shape == (1024, 1024, 3)
        assert_agree(linear, np.full(linear.shape, 0.2158605), atol=1e-6)
    assert with_linear_textures(square) is square


# ── seen surfaces ─────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("view", VIEWS, ids=IDS)
def test_a_ball_is_seen_where_the_closed_form_has_it(view):
    frequency, radius = 24, 0.6
    centre = np.array([0.2, 0.1, -2.0])
    surface = trace(ball(radius, centre, frequency), view, is_object=True)
    camera = rotate(view.camera_from_world, centre)
    depth, normal = sphere_depth(view, camera, radius)
    # A facet's middle lies below the sphere by r·(1 − cos β), β the angle from its middle to a
    # corner: 63.4°/24/√3, and up to 1.25 times that in the middle of an icosahedron's face.
    tilt = 1.25 * np.radians(63.43 / frequency) / np.sqrt(3)
    sagitta = radius * (1 - np.cos(tilt))
    assert (surface.valid != np.isfinite(depth)).mean() < 0.02
    both = surface.valid & (-np.einsum("...i,...i->...", normal, view.directions()) > 0.3)
    assert both.sum() > 30
    assert (surface.depth - depth)[both].min() >= 0
    assert (surface.depth - depth)[both].max() < sagitta / 0.3
    off = np.linalg.norm(surface.position[both] - centre, axis=-1) - radius
    assert np.abs(off).max() < sagitta
    world = rotate(view.world_from_camera, normal)
    assert angles(surface.normal[both], world[both]).max() < tilt
    assert surface.is_object[both].all()


@pytest.mark.parametrize("view", VIEWS, ids=IDS)
def test_a_wall_is_exact_and_its_back_is_turned_round(view):
    for geometry in (
        sheet((-9, -9, -2), (18, 0, 0), (0, 18, 0)),
        sheet((-9, -9, -2), (0, 18, 0), (18, 0, 0)),
    ):
        surface = trace(geometry, view, is_object=False)
        assert_agree(
            surface.position[surface.valid][:, 2], np.full(surface.valid.sum(), -2.0), atol=1e-9
        )
        facing = np.broadcast_to([0, 0, 1.0], (surface.valid.sum(), 3))
        assert_agree(surface.normal[surface.valid], facing, atol=1e-12)
        expected = 2.0 / view.directions()[..., 2]
        if view.projection == "pinhole":
            expected = np.full(view.shape, 2.0)
        assert_agree(surface.depth[surface.valid], expected[surface.valid], rtol=1e-9)


def test_whatever_is_nearer_is_seen():
    wall = trace(sheet((-1, -9, -2), (18, 0, 0), (0, 18, 0)), PINHOLE, is_object=False)
    near = trace(ball(0.3, (0.2, 0, -1.5)), PINHOLE, is_object=True)
    hidden = trace(ball(0.3, (0.2, 0, -3.5)), PINHOLE, is_object=True)
    both = nearest(wall, near)
    assert (both.is_object == near.valid).all()
    assert_agree(both.depth[near.valid], near.depth[near.valid])
    assert_agree(both.normal[near.valid], near.normal[near.valid])
    rest = wall.valid & ~near.valid
    assert_agree(both.depth[rest], wall.depth[rest])
    behind = nearest(wall, hidden)
    assert not behind.is_object[wall.valid].any()
    # Left of the wall there is nothing: the object stands in front of the hole.
    beside = trace(ball(0.3, (-1.4, 0, -2)), PINHOLE, is_object=True)
    assert (~wall.valid & beside.valid).any()
    assert nearest(wall, beside).is_object[~wall.valid & beside.valid].all()


def test_smooth_normals_and_textures_are_interpolated():
    positions = np.array([[-1.0, -1, -2], [1, -1, -2], [0, 1, -2]])
    normals = unit([[-0.5, -0.5, 1], [0.5, -0.5, 1], [0, 0.5, 1]])
    texture = np.zeros((2, 2, 3), np.float32)
    texture[0] = 0.25
    geometry = Geometry(
        positions,
        np.array([[0, 1, 2]], np.int32),
        normals=normals,
        uvs=np.array([[0.0, 0.25], [1, 0.25], [0.5, 0.25]]),
        materials=(Material(reflectance=(0.8, 0.4, 1.0), texture=texture),),
    )
    surface = trace(geometry, PINHOLE, is_object=True)
    height = (surface.position[..., 1] + 1) / 2
    x = surface.position[..., 0]
    weights = np.stack([(1 - height - x) / 2, (1 - height + x) / 2, height], axis=-1)
    seen = surface.valid
    assert seen.sum() > 200
    assert_agree(surface.normal[seen], unit(weights[seen] @ normals), atol=1e-6)
    assert_agree(
        surface.reflectance[seen], np.broadcast_to([0.2, 0.1, 0.25], (seen.sum(), 3)), atol=1e-12
    )


def test_a_depth_image_is_its_own_surface():
    depth = sphere_depth(PINHOLE, (0, 0, 2.0), 0.8)[0]
    normals = normals_from_depth(depth, PINHOLE)
    surface = see(SurfaceModel(depth={"mono": depth}, normals={"mono": normals}), PINHOLE)
    assert surface.holes == np.isnan(depth).sum()
    away = np.linalg.norm(surface.position[surface.valid] - (0, 0, -2), axis=-1)
    assert_agree(away, np.full(len(away), 0.8), rtol=1e-12)


# ── inside ────────────────────────────────────────────────────────────────────────────────────

ROOM = block((4, 3, 5), (0, 0, 0))
EYE = np.array([0.3, 0.2, 1.0])


def test_a_lamp_in_the_room_is_free_and_one_beyond_its_wall_is_buried():
    assert not is_buried(np.array([-1.0, 0.5, -2]), EYE, ROOM)
    assert is_buried(np.array([5.0, 0.5, -2]), EYE, ROOM)


def test_a_lamp_in_a_closed_body_is_buried():
    body = ball(0.5, (3, 0, 0))
    assert is_buried(np.array([3.1, 0, 0.1]), EYE, body)
    assert not is_buried(np.array([3.9, 0, 0.1]), EYE, body)


def test_a_lamp_before_an_opening_is_free():
    """A doll's house: what shines in through the missing wall lights what the camera sees."""
    opened = Geometry(ROOM.positions, ROOM.triangles[2:])
    middle = opened.positions[opened.triangles].mean(axis=(0, 1))
    assert middle[0] > 0.1  # the wall at x = −2 is gone
    assert not is_buried(np.array([-5.0, 0.5, 0.2]), EYE, opened)
    assert not is_buried(EYE, np.array([-5.0, 0.5, 0.2]), opened)


def test_nothing_is_claimed_of_an_open_mesh():
    assert not is_buried(np.array([0.0, 0, -9]), EYE, sheet((-1, -1, -2), (2, 0, 0), (0, 2, 0)))


def test_blocks_of_these_tests_face_outwards():
    for geometry, sign in ((ROOM, 1), (block((4, 3, 5), (0, 0, 0), inwards=True), -1)):
        middle = geometry.positions[geometry.triangles].mean(axis=1)
        assert (np.einsum("ij,ij->i", face_normals(geometry), middle) * sign > 0).all()


def test_small_holes_hide_what_is_behind_both_their_rims():
    """A slit in a near surface is closed, the open side of a silhouette is not."""
    from andon.surface.reference import from_depth

    view = View("pinhole", 40, 30, 30.0, 30.0, 19.5, 14.5)
    depth = np.full((30, 40), np.nan)
    depth[:, :20] = 1.0  # a near thing; to its right the sky
    depth[10:20, 5:9] = np.nan  # a slit in it
    depth[3, 12] = 5.0  # and a far speck
    surface = from_depth(depth, np.broadcast_to([0.0, 0, 1], (30, 40, 3)), view)
    assert (surface.cover[10:20, 5:9] == 1.0).all()
    assert np.isinf(surface.cover[:, 20:]).all()
    assert np.isinf(surface.cover[surface.valid]).all()
    places = {"behind": np.array([-0.9, 0, -2.0]), "sky": np.array([0.6, 0, -2.0])}
    lamps = [PointLamp(k, at, np.ones(3), visible_radius_m=0.2) for k, at in places.items()]
    picture = draw_lamps(np.zeros((30, 40, 3)), surface, lamps)
    assert not picture[:, :20].any()
    assert picture[:, 20:].any()
