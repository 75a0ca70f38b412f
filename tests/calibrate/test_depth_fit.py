"""Scale and shift of relative depth: exact where nothing errs, honest where something does."""

from dataclasses import replace

import numpy as np
import pytest

from andon.calibrate.depth import At, Floor, Knowledge, Plane, fit_depth, relative_depth
from andon.errors import InputError
from andon.lenses import captured_rays
from andon.spaces import WORLD_FROM_CAMERA_DEFAULT
from comparison import assert_agree

from .rooms import HEIGHT_M, PARTS, POINTS, VIEW, Z, affine, length

KINDS = ("inverse", "depth")
BACK, FLOOR, ACROSS = (
    length((10, 20), (70, 20)),
    length((30, 110), (100, 110)),
    length((150, 40), (20, 100)),
)
AT = At((10, 20), 4.0), At((80, 115), float(Z[115, 80]))
ROOM = (PARTS["back"], PARTS["right"], PARTS["floor"])
ENOUGH = {
    "two lengths": Knowledge((BACK, FLOOR)),
    "three lengths": Knowledge((BACK, FLOOR, ACROSS)),
    "two depths": Knowledge(points=AT),
    "a depth and a length": Knowledge((FLOOR,), AT[:1]),
    "the floor and its height": Knowledge(floor=Floor(PARTS["floor"], HEIGHT_M)),
    "a length and the floor": Knowledge((BACK,), floor=Floor(PARTS["floor"])),
    "a length and right angles": Knowledge((BACK,), planes=ROOM, perpendicular=((0, 1), (1, 2))),
    "metric depth": Knowledge(known_m=np.where(np.arange(160) % 7 == 0, Z, np.nan)),
}


@pytest.mark.parametrize("known", ENOUGH.values(), ids=ENOUGH)
@pytest.mark.parametrize("kind", KINDS)
def test_what_determines_both_finds_both_exactly(kind, known):
    relative, a, b = affine(kind)
    found = fit_depth(relative, known)
    assert not found.shift_is_assumed
    assert_agree([found.scale, found.shift], [a, b], rtol=1e-8, atol=1e-9)
    assert_agree(relative.metric(found.scale, found.shift), Z, rtol=1e-7)
    assert all(abs(row.share) < 1e-8 for row in found.rows)
    assert found.behind_pixels == 0


def test_flat_pixels_give_the_shift_of_depth_and_none_of_inverse_depth():
    """Adding to 1/z is a collineation: planes stay planes, so they say nothing of it."""
    known = Knowledge((BACK,), planes=(PARTS["floor"],))
    relative, a, b = affine("depth")
    found = fit_depth(relative, known)
    assert_agree([found.scale, found.shift], [a, b], rtol=1e-8)
    relative, a, b = affine("inverse")
    assert fit_depth(relative, known).shift_is_assumed
    # The floor is flat under every shift, and leans otherwise.
    for shift in (0.0, 0.02, 0.11):
        points = relative.rays * relative.metric(a, shift)[..., None]
        floor = points[PARTS["floor"].mask]
        spread = np.linalg.svd(floor - floor.mean(axis=0), compute_uv=False)
        assert spread[2] < 1e-9 * spread[0]


def test_a_wall_that_faces_the_camera_says_nothing_of_the_shift():
    relative, _, _ = affine("depth")
    assert fit_depth(relative, Knowledge((BACK,), planes=(PARTS["back"],))).shift_is_assumed


@pytest.mark.parametrize("kind", KINDS)
def test_one_length_gives_the_scale_and_the_shift_is_taken_as_zero(kind):
    relative, a, _ = affine(kind)
    found = fit_depth(relative, Knowledge((BACK,)))
    assert found.shift_is_assumed
    assert found.shift == 0
    assert abs(found.rows[0].share) < 1e-10
    assert abs(found.scale / a - 1) > 0.05  # b is not 0, so the scale is not a


def test_what_has_no_size_gives_no_scale():
    relative, _, _ = affine("inverse")
    for known in (Knowledge(), Knowledge(planes=ROOM, perpendicular=((0, 1),)),
                  Knowledge(floor=Floor(PARTS["floor"]))):  # fmt: skip
        with pytest.raises(InputError, match="the scale is undetermined; add --length"):
            fit_depth(relative, known)


def test_a_tilted_camera_knows_which_way_is_down():
    turn = np.radians(25)
    pitch = np.eye(4)
    pitch[1:3, 1:3] = [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]
    view = replace(VIEW, world_from_camera=WORLD_FROM_CAMERA_DEFAULT @ pitch)
    down = -view.camera_from_world[:3, 1]
    assert down[2] > 0.4  # it looks at the floor
    along = view.rays_planar() @ down
    z = np.where(along > 0.05, HEIGHT_M / np.where(along > 0.05, along, 1), np.nan)
    r = (1 / z - 0.05) / 0.013
    known = Knowledge(floor=Floor(Plane(np.isfinite(z), "--floor"), HEIGHT_M))
    found = fit_depth(relative_depth(r, view, "inverse"), known)
    assert_agree([found.scale, found.shift], [0.013, 0.05], rtol=1e-8)
    level = relative_depth(r, VIEW, "inverse")
    with pytest.raises(InputError, match=r"floor's slope is 2.*°, stated 0°"):
        fit_depth(level, known)


def test_the_lens_is_taken_out():
    view = replace(VIEW, distortion=(-0.2, 0.05, 0.001, -0.001))
    rays = captured_rays(view)
    with np.errstate(divide="ignore"):
        z = np.minimum(np.where(rays[..., 1] > 0, HEIGHT_M / rays[..., 1], np.inf), 4.0)
    relative = relative_depth((1 / z - 0.05) / 0.013, view, "inverse")
    floor = Plane(z < 3.99, "--floor")
    found = fit_depth(relative, Knowledge(floor=Floor(floor, HEIGHT_M)))
    assert_agree([found.scale, found.shift], [0.013, 0.05], rtol=1e-8)
    assert found.flatness[0][0] < 1e-9


# ── errors of estimators and of tapes ─────────────────────────────────────────────────────────

NOISY = ("three lengths", "the floor and its height", "a length and right angles", "metric depth")


@pytest.mark.parametrize("name", NOISY)
@pytest.mark.parametrize("kind", KINDS)
def test_noise_costs_a_few_percent(kind, name):
    """2 % of r's spread: depth is found within 5 % in the median over ten draws."""
    off = []
    for seed in range(10):
        relative, _, _ = affine(kind, noise=0.02, seed=seed)
        found = fit_depth(relative, ENOUGH[name])
        off.append(np.nanmedian(np.abs(relative.metric(found.scale, found.shift) / Z - 1)))
    assert np.median(off) < 0.05


def test_noise_on_a_slanted_plane_does_not_carry_its_shift_away():
    """Relative errors of z would vanish at an infinite shift; errors of r do not."""
    off = []
    for seed in range(10):
        relative, _, b = affine("depth", noise=0.02, seed=seed)
        found = fit_depth(relative, Knowledge((BACK,), planes=(PARTS["floor"],)))
        off.append(abs(found.shift - b))
    assert np.median(off) < 0.15  # m, of a room 4 m deep


@pytest.mark.parametrize("kind", KINDS)
def test_a_third_of_wrong_depths_is_set_aside(kind):
    relative, a, b = affine(kind, noise=0.01)
    draw = np.random.default_rng(1)
    wrong = draw.random(Z.shape) < 0.33
    known = np.where(wrong, draw.uniform(0.5, 9, Z.shape), Z)
    known[draw.random(Z.shape) < 0.9] = np.nan
    found = fit_depth(relative, Knowledge(known_m=known))
    assert_agree([found.scale, found.shift], [a, b], rtol=0.03)
    assert 0.2 < found.outlier_share < 0.4
    assert found.scatter_share < 0.05


def test_stated_errors_cover_what_tapes_do():
    """Lengths err by 2 %, as is assumed: nine of ten depths are within two standard errors."""
    relative, _, _ = affine("inverse")
    draw = np.random.default_rng(2)
    pixels = [((10, 20), (70, 20)), ((30, 110), (100, 110)), ((150, 40), (20, 100)),
              ((80, 100), (80, 118))]  # fmt: skip
    inside = []
    for _ in range(30):
        lengths = tuple(length(*ends, error=0.02 * draw.standard_normal()) for ends in pixels)
        found = fit_depth(relative, Knowledge(lengths))
        depth = np.nanpercentile(relative.metric(found.scale, found.shift), [2, 50, 98])
        true = np.percentile(Z, [2, 50, 98])
        inside.append(np.abs(depth / true - 1) < 2 * np.array(found.error_share))
    assert np.mean(inside) > 0.85


# ── refusals ──────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ["three lengths", "two depths", "metric depth"])
def test_depth_that_runs_the_other_way_is_refused(kind, name):
    relative, _, _ = affine(kind)
    turned = replace(relative, values=-relative.values)
    other = "depth" if kind == "inverse" else "inverse"
    with pytest.raises(InputError, match=f"scale below 0.*try --kind {other}"):
        fit_depth(turned, ENOUGH[name])


def test_contradictions_say_by_how_much():
    relative, _, _ = affine("inverse")
    wrong = length(ACROSS.first, ACROSS.second, error=0.5)
    message = r"contradicts itself: .*150,40 to 20,100 is \S+ m, stated 5.842 m \(-3\d\.\d%\)"
    with pytest.raises(InputError, match=message):
        fit_depth(relative, Knowledge((BACK, FLOOR, wrong)))
    little = length(ACROSS.first, ACROSS.second, error=0.15)
    assert any(
        "150,40" in line for line in fit_depth(relative, Knowledge((BACK, FLOOR, little))).notes
    )


REFUSED = [
    (Knowledge((replace(BACK, second=(160, 20)),)), "160,20 is outside the depth of 160×120 px"),
    (Knowledge((replace(BACK, second=(5, 5)),)), "5,5 is a hole"),
    (Knowledge((replace(BACK, second=BACK.first),)), "both ends are the pixel 10,20"),
    (Knowledge((replace(BACK, metres=0.0),)), "must be > 0 m, got 0"),
    (Knowledge(points=(At((10, 20), float("nan")),)), "--at: must be > 0 m"),
    (Knowledge((BACK,), planes=(Plane(Z < 0, "--plane 1"),)), "--plane 1: selects 0 pixels"),
    (
        Knowledge((BACK,), planes=(Plane(np.arange(120)[:, None] + 0 * Z == 30, "--plane 1"),)),
        "pixels on one line",
    ),
    (Knowledge(floor=Floor(PARTS["floor"], -1.0)), "--height: must be > 0 m"),
    (Knowledge(known_m=Z * np.nan), "--known: has 0 depths"),
    (Knowledge(known_m=np.where(PARTS["back"].mask, 4.0, np.nan)), "has one depth only"),
]


@pytest.mark.parametrize(("known", "rule"), REFUSED)
def test_bad_knowledge_is_refused(known, rule):
    relative, _, _ = affine("inverse")
    relative.values[5, 5] = np.nan
    with pytest.raises(InputError, match=rule):
        fit_depth(relative, known)


def test_bad_depth_is_refused():
    for values, rule in [
        (np.full(VIEW.shape, np.nan), "no pixel with a number"),
        (np.ones(VIEW.shape), "is 1 everywhere"),
        (np.ones((120, 100)), "is 100×120 px but the camera is 160×120"),
    ]:
        with pytest.raises(InputError, match=rule):
            relative_depth(values, VIEW, "inverse")
    with pytest.raises(InputError, match="needs a pinhole camera"):
        relative_depth(Z, replace(VIEW, projection="fisheye"), "inverse")


def test_pixels_behind_the_camera_become_holes_and_are_counted():
    relative, a, b = affine("inverse")
    relative.values[:2, :3] = -b / a - 1.0
    found = fit_depth(relative, Knowledge((BACK, FLOOR)))
    assert found.behind_pixels == 6
    assert np.isnan(relative.metric(found.scale, found.shift)[:2, :3]).all()


def test_points_are_where_the_room_is():
    """Units and axes in one number: the right wall is 1.8 m to the right."""
    relative, _, _ = affine("inverse")
    found = fit_depth(relative, ENOUGH["three lengths"])
    points = relative.rays * relative.metric(found.scale, found.shift)[..., None]
    assert_agree(
        points[PARTS["right"].mask][:, 0], 1.8 + 0 * points[PARTS["right"].mask][:, 0], rtol=1e-8
    )
    assert_agree(points, POINTS, rtol=1e-7, atol=1e-7)
