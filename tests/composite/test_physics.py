"""The photograph under its new light, against numbers worked out by hand."""

import numpy as np
import pytest

from andon.composite.model import Ambient
from andon.composite.reference import (
    compose,
    draw_lamps,
    lamp_luminance,
    object_luminance,
    relit_linear,
)
from andon.lamps import PointLamp, SpotLamp
from andon.quantities import CameraFrame
from andon.responses import LINEAR, SRGB, Response
from andon.spaces import View, look_at
from andon.surface.reference import empty_surface, from_depth, trace
from comparison import assert_agree
from worlds import ball

VIEW = View("pinhole", 4, 3, 3.0, 3.0, 1.5, 1.0)
E0 = np.array([200.0, 100.0, 50.0])


def frame_of(linear, view=VIEW, response=SRGB, **more):
    linear = np.broadcast_to(np.asarray(linear, np.float32), (*view.shape, 3))
    return CameraFrame(linear.copy(), view, response, **more)


def lux(*triple, view=VIEW):
    return np.broadcast_to(np.asarray(triple, float), (*view.shape, 3))


def test_the_ratio_by_hand():
    """0.4 × (0.5·200 + 50)/200 = 0.3;  0.2 × (1·100 + 300)/100 = 0.8;  0.1 × (0 + 25)/50."""
    ambient = Ambient(E0, (0.5, 1.0, 0.0))
    relit = relit_linear(frame_of([0.4, 0.2, 0.1]), ambient, lux(50, 300, 25))
    assert_agree(relit, lux(0.3, 0.8, 0.05), rtol=1e-6)


def test_a_map_of_e0_counts_pixel_by_pixel():
    e0 = np.random.default_rng(0).uniform(1, 500, (*VIEW.shape, 3))
    relit = relit_linear(frame_of(0.25), Ambient(e0, (0.3,) * 3), lux(10, 20, 30))
    assert_agree(relit, 0.25 * (0.3 + lux(10, 20, 30) / e0), rtol=1e-6)


def test_a_surface_in_twice_the_light_is_twice_as_bright():
    captured = np.random.default_rng(1).random((*VIEW.shape, 3))
    frame = frame_of(captured)
    assert_agree(relit_linear(frame, Ambient(E0), lux(*E0)), 2 * frame.linear, rtol=1e-6)
    assert_agree(relit_linear(frame, Ambient(E0, (0, 0, 0)), lux(*E0)), frame.linear, rtol=1e-6)


@pytest.mark.parametrize("response", [SRGB, LINEAR, Response("gamma", gamma=2.0)])
def test_the_papers_dimming_scales_codes(response):
    """Without lamps the encoded RGB is scaled; with them, their light is added to that."""
    codes = np.linspace(0.05, 1, 12).reshape(3, 4, 1) * np.ones(3)
    frame = frame_of(response.decode(codes), response=response)
    ambient = Ambient(E0, (0.5, 0.25, 1.0), "paper")
    dimmed = relit_linear(frame, ambient, lux(0, 0, 0))
    assert_agree(response.encode(dimmed), codes * (0.5, 0.25, 1.0), atol=1e-6)
    lit = relit_linear(frame, ambient, lux(*(0.1 * E0)))
    assert_agree(lit - dimmed, 0.1 * frame.linear, atol=1e-6)


def test_the_papers_dimming_darkens_more_than_its_number_says():
    """Gamma 2: half the code is a quarter of the light."""
    frame = frame_of(0.64, response=Response("gamma", gamma=2.0))
    half = (0.5, 0.5, 0.5)
    assert_agree(
        relit_linear(frame, Ambient(E0, half, "paper"), lux(0, 0, 0)), lux(*[0.16] * 3), rtol=1e-6
    )
    assert_agree(relit_linear(frame, Ambient(E0, half), lux(0, 0, 0)), lux(*[0.32] * 3), rtol=1e-6)


def test_a_diffuse_object_has_rho_e_over_pi():
    surface = empty_surface(VIEW)
    surface.reflectance[:] = (0.8, 0.4, 0.0)
    surface.emitted_cd_m2[0] = (5, 6, 7)
    ambient = Ambient(E0, (0.5, 1, 1))
    expected = np.array([0.8, 0.4, 0.0]) * (E0 * (0.5, 1, 1) + (30, 60, 90)) / np.pi
    luminance = object_luminance(surface, ambient, lux(30, 60, 90))
    assert_agree(luminance[1:], np.broadcast_to(expected, (2, 4, 3)), rtol=1e-12)
    assert_agree(luminance[0], np.broadcast_to(expected + np.array([5, 6, 7]), (4, 3)), rtol=1e-12)


def test_a_white_object_in_unchanged_light_is_the_photographs_white():
    """luminance_per_unit = E0/π makes ρ = 1 exactly 1.0, so object and photograph agree."""
    surface = empty_surface(VIEW)
    surface.reflectance[:] = 0.6
    surface.is_object[:, :2] = True
    neutral = Ambient(np.full(3, 150.0))
    frame = frame_of(0.6, luminance_per_unit=150 / np.pi)
    luminance = compose(frame, surface, neutral, lux(70, 70, 70), ())
    assert_agree(luminance, np.broadcast_to(luminance[0, 0], luminance.shape), rtol=1e-6)
    assert luminance[0, 0, 0] == pytest.approx(0.6 * 220 / np.pi, rel=1e-6)


def test_objects_in_a_map_of_e0_stand_in_its_mean():
    e0 = np.ones((*VIEW.shape, 3)) * [10, 20, 30]
    e0[0] *= 4
    assert_agree(Ambient(e0).mean_lux, np.array([10, 20, 30]) * (4 + 1 + 1) / 3)


def test_luminance_of_the_picture_is_its_unit_times_its_light():
    luminance = compose(
        frame_of([0.1, 0.2, 0.3], luminance_per_unit=80.0),
        empty_surface(VIEW),
        Ambient(E0),
        lux(0, 0, 0),
        (),
    )
    assert_agree(luminance, lux(8, 16, 24), rtol=1e-6)


# ── visible lamps ─────────────────────────────────────────────────────────────────────────────

WIDE = View("pinhole", 161, 121, 150.0, 150.0, 80.0, 60.0)


def lamp_at(x, y, z, radius=0.1, **more):
    return PointLamp(
        "bulb", np.array([x, y, z]), np.array([30.0, 20.0, 10.0]), None, radius, **more
    )


def black(view):
    return np.zeros((*view.shape, 3))


def covered(picture, lamp, eye):
    return picture[..., 0] / lamp_luminance(lamp, eye)[0]


VIEWS = {
    "pinhole": WIDE,
    "fisheye": View("fisheye", 161, 121, 60.0, 60.0, 80.0, 60.0),
    "latlong": View("latlong", 360, 180),
    "posed": View(
        "pinhole", 161, 121, 150.0, 150.0, 80.0, 60.0,
        world_from_camera=look_at(np.array([1.0, 2, 3]), np.array([0.1, 0.2, -2])),
    ),
}  # fmt: skip


@pytest.mark.parametrize("place", [(0.1, 0.2, -2.0), (-0.4, -0.3, -1.5)])
@pytest.mark.parametrize("name", VIEWS)
def test_a_lamp_covers_the_solid_angle_of_its_ball(name, place):
    view = VIEWS[name]
    if name == "posed" and place[0] < 0:
        place = (0.4, 0.0, -1.0)
    # A rim of one pixel takes 1/12 px² too much of r²: discs of 5 px and more are within 1 %.
    lamp = lamp_at(*place, radius=0.25)
    picture = draw_lamps(black(view), empty_surface(view), [lamp])
    cover = covered(picture, lamp, view.position)
    assert cover.max() == pytest.approx(1)
    away = np.linalg.norm(lamp.position_m - view.position)
    exact = 2 * np.pi * (1 - np.sqrt(1 - (0.25 / away) ** 2))
    assert (cover * view.solid_angles()).sum() == pytest.approx(exact, rel=0.01)
    assert exact == pytest.approx(np.pi * 0.25**2 / away**2, rel=0.01)


def test_a_lamp_is_as_bright_as_its_intensity_over_its_area():
    """30 cd from a disc of radius 0.1 m: 30/(π·0.01) = 954.93 cd/m²."""
    picture = draw_lamps(black(WIDE), empty_surface(WIDE), [lamp_at(0, 0, -2)])
    assert picture[60, 80] == pytest.approx([954.9297, 636.6198, 318.3099], rel=1e-6)


def test_the_candela_of_the_disc_are_those_of_the_lamp():
    """Luminance times solid angle times distance² gives back the intensity."""
    lamp = lamp_at(0.2, 0.1, -1.7)
    picture = draw_lamps(black(WIDE), empty_surface(WIDE), [lamp])
    away = np.linalg.norm(lamp.position_m)
    intensity = (picture * WIDE.solid_angles()[..., None]).sum(axis=(0, 1)) * away**2
    assert_agree(intensity, lamp.intensity_cd, rtol=0.01)


def test_a_spot_is_as_bright_as_it_shines_towards_the_eye():
    towards = {"direction": np.array([0.0, 0, 1]), "outer_radians": 0.5}
    spot = SpotLamp("spot", np.array([0, 0, -2.0]), np.full(3, 30.0), None, 0.1, **towards)
    assert lamp_luminance(spot, np.zeros(3)) == pytest.approx(30 / (np.pi * 0.01))
    away = SpotLamp(**{**vars(spot), "direction": np.array([0.0, 0, -1])})
    assert (lamp_luminance(away, np.zeros(3)) == 0).all()


def wall(distance, view=WIDE):
    depth = np.full(view.shape, float(distance))
    normal = np.broadcast_to([0, 0, 1.0], (*view.shape, 3))
    return from_depth(depth, normal, view)


def test_what_is_nearer_hides_the_lamp_and_what_is_farther_does_not():
    lamp = lamp_at(0, 0, -2.0)
    assert (draw_lamps(black(WIDE), wall(1.5), [lamp]) == 0).all()
    behind = draw_lamps(black(WIDE), wall(2.5), [lamp])
    free = draw_lamps(black(WIDE), empty_surface(WIDE), [lamp])
    assert (behind == free).all()


def test_an_object_covers_just_its_part_of_a_lamp():
    lamp = lamp_at(0, 0, -2.0, radius=0.3)
    surface = trace(ball(0.2, (0.2, 0, -1.2)), WIDE, is_object=True)
    picture = draw_lamps(black(WIDE), surface, [lamp])
    free = draw_lamps(black(WIDE), empty_surface(WIDE), [lamp])
    assert (picture[surface.valid] == 0).all()
    assert_agree(picture[~surface.valid], free[~surface.valid])
    hidden = free[surface.valid].sum() / free.sum()
    assert 0.1 < hidden < 0.9


def test_the_nearer_of_two_lamps_is_in_front_whatever_their_order():
    near, far = lamp_at(0, 0, -1.0), lamp_at(0, 0, -2.0, radius=0.4)
    pictures = [
        draw_lamps(black(WIDE), empty_surface(WIDE), pair) for pair in ([near, far], [far, near])
    ]
    assert (pictures[0] == pictures[1]).all()
    assert pictures[0][60, 80] == pytest.approx(lamp_luminance(near, np.zeros(3)))
    assert pictures[0][60, 80 + 24] == pytest.approx(lamp_luminance(far, np.zeros(3)))


def test_a_lamp_behind_the_eye_or_without_a_radius_is_not_drawn():
    base = np.random.default_rng(0).random((*WIDE.shape, 3))
    for lamp in (lamp_at(0, 0, 2.0), lamp_at(0, 0, -2, radius=0.0)):
        assert (draw_lamps(base, empty_surface(WIDE), [lamp]) == base).all()


def test_a_disc_stands_for_the_whole_picture_from_inside_the_lamp():
    lamp = lamp_at(0, 0, -0.05, radius=0.1)
    picture = draw_lamps(black(WIDE), empty_surface(WIDE), [lamp])
    assert (picture > 0).all()
