"""Refraction against closed forms: Snell, Fresnel, balls, slabs, lenses, and bodies in bodies."""

from dataclasses import replace

import numpy as np
import pytest

from andon.glass.model import Ball, LensShape, Slab, Solid
from andon.glass.paths import LOST, MAX_EVENTS, THROUGH, trace
from andon.glass.refraction import fresnel, mirrored, refracted
from comparison import assert_agree

from .rays import BALL, EYE, angles_between, slant, unit

UP = np.array([0.0, 0.0, 1.0])
DEGREES = np.arange(90.0)
GLASS = 1.51

# ── Snell ───────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(("n1", "n2"), [(1.0, 1.51), (1.51, 1.0), (1.33, 1.9), (1.9, 1.33)])
@pytest.mark.parametrize("side", [1, -1])
def test_snell_from_0_to_89_degrees(n1, n2, side):
    directions = slant(DEGREES)
    found, total = refracted(directions, np.broadcast_to(side * UP, directions.shape), n1, n2)
    sine = n1 / n2 * np.sin(np.radians(DEGREES))
    assert (total == (sine > 1)).all()
    assert total.any() == (n1 > n2)
    inside = ~total
    expected = np.stack([sine, 0 * sine, -np.sqrt(np.maximum(1 - sine**2, 0))], axis=-1)
    assert_agree(found[inside], expected[inside], atol=1e-12)
    mirror = mirrored(directions, np.broadcast_to(UP, (90, 3)))
    assert np.allclose(found[total], mirror[total], rtol=0, atol=1e-12)
    assert_agree(np.linalg.norm(found, axis=-1), np.ones(90), atol=1e-12)


def test_reflection_is_total_beyond_the_critical_angle():
    critical = np.degrees(np.arcsin(1 / GLASS))
    directions = slant([critical - 1e-6, critical + 1e-6])
    _, total = refracted(directions, np.broadcast_to(UP, (2, 3)), GLASS, 1.0)
    assert total.tolist() == [False, True]
    share = fresnel(-directions[:, 2], GLASS, 1.0)
    assert share[1] == 1
    assert 0.99 < share[0] < 1


def whitted(directions, normal, index, *, scaled=True, printed=False):
    """Whitted 1980's T as the paper prints it, its direction; and the radicand."""
    v = directions / np.abs(directions @ normal)[:, None] if scaled else directions
    across = (normal - v) if printed else (v + normal)
    radicand = index**2 * (v**2).sum(-1) - (across**2).sum(-1)
    k = 1 / np.sqrt(np.maximum(radicand, 1e-300))
    return unit(k[:, None] * (normal + v) - normal), radicand


def test_whitted_is_snell_and_what_the_paper_prints_is_not():
    directions = slant(DEGREES)
    found, _ = refracted(directions, np.broadcast_to(UP, (90, 3)), 1.0, GLASS)
    assert_agree(whitted(directions, UP, GLASS)[0], found, atol=1e-12)
    # ‖N − V‖ instead of ‖N + V′‖ has no root even straight ahead.
    assert whitted(slant(0), UP, GLASS, printed=True)[1] == pytest.approx(-1.72, abs=1e-3)
    # V instead of V′ errs by 1.9° at 30° and by 19° at 60°.
    wrong = angles_between(whitted(directions, UP, GLASS, scaled=False)[0], found)
    assert np.degrees(wrong[[30, 60]]) == pytest.approx([1.9, 19], rel=0.03)


def test_refraction_is_the_same_in_every_frame():
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    directions, normals = slant(DEGREES), np.broadcast_to(UP, (90, 3))
    here, _ = refracted(directions, normals, 1.0, GLASS)
    there, _ = refracted(directions @ turn.T, normals @ turn.T, 1.0, GLASS)
    assert_agree(there, here @ turn.T, atol=1e-14)


# ── Fresnel ─────────────────────────────────────────────────────────────────────────────────────


def test_fresnel_straight_ahead_at_brewsters_angle_and_grazing():
    assert fresnel(np.ones(1), 1.0, GLASS) == pytest.approx(((GLASS - 1) / (GLASS + 1)) ** 2)
    assert fresnel(np.ones(1), 1.0, GLASS) == pytest.approx(0.0413, abs=1e-4)
    brewster = np.arctan(GLASS)
    # Only one polarisation is mirrored, by sin²(i − t) where i + t = 90°.
    expected = np.cos(2 * brewster) ** 2 / 2
    assert fresnel(np.cos([brewster]), 1.0, GLASS) == pytest.approx(expected, rel=1e-12)
    assert fresnel(np.zeros(1), 1.0, GLASS) == 1


def test_fresnel_is_the_same_both_ways_and_nothing_between_equal_media():
    angle = np.radians(np.arange(0, 90.0))
    behind = np.arcsin(np.sin(angle) / GLASS)
    there = fresnel(np.cos(angle), 1.0, GLASS)
    back = fresnel(np.cos(behind), GLASS, 1.0)
    assert_agree(back, there, atol=1e-12)
    assert (np.diff(there) > -1e-4).all()
    assert_agree(fresnel(np.cos(angle), 1.33, 1.33), np.zeros(90), atol=1e-12)
    assert fresnel(np.zeros(1), 1.5, 1.5) == 0


def test_light_is_kept_by_a_boundary():
    """What passes carries (n2 c2 / n1 c1)·|t|² of the light, by the amplitudes of Fresnel."""
    i = np.radians(np.arange(0.0, 90))
    t = np.arcsin(np.sin(i) / GLASS)
    c1, c2 = np.cos(i), np.cos(t)
    t_s = 2 * c1 / (c1 + GLASS * c2)
    t_p = 2 * c1 / (GLASS * c1 + c2)
    passed = GLASS * c2 / c1 * (t_s**2 + t_p**2) / 2
    assert_agree(fresnel(c1, 1.0, GLASS) + passed, np.ones(90), atol=1e-12)


# ── shapes ──────────────────────────────────────────────────────────────────────────────────────


def parallel_rays(offsets):
    """Rays down −z from z = 1, `offsets` (n,) from the axis, around it."""
    turn = np.linspace(0, 2 * np.pi, len(offsets), endpoint=False)
    origins = np.stack([offsets * np.cos(turn), offsets * np.sin(turn), np.ones_like(turn)], -1)
    return origins, np.broadcast_to([0.0, 0.0, -1.0], origins.shape)


@pytest.mark.parametrize("index", [1.0, 1.1, 1.51, 2.4])
def test_a_ball_turns_light_by_2_i_minus_t(index):
    offsets = np.linspace(0, 0.0749, 60)
    origins, directions = parallel_rays(offsets)
    found = trace([replace(BALL, index=(index,) * 3)], origins, directions)
    i, t = np.arcsin(offsets / 0.075), np.arcsin(offsets / 0.075 / index)
    assert_agree(angles_between(found.exit_direction, directions), 2 * (i - t), atol=1e-12)
    assert_agree(found.path_m[:, 0], 2 * 0.075 * np.cos(t), atol=1e-12)
    share = fresnel(np.cos(i), 1.0, index)
    assert_agree(found.reflectance, share, atol=1e-12)
    assert_agree(found.transmitted, (1 - share) ** 2, atol=1e-12)
    assert (found.events == 2).all()
    assert (found.solid == 0).all()


def test_a_slab_shifts_light_in_parallel():
    slab = Solid("slab", Slab(np.array([1.0, 1.0, 0.05])))
    degrees = np.arange(0.0, 80)
    found = trace([slab], np.array([-0.3, 0.1, 0.4]), slant(degrees))
    i = np.radians(degrees)
    inside = np.arcsin(np.sin(i) / GLASS)
    met = found.solid == 0
    through = met & (found.events == 2)
    assert through.sum() > 60
    assert_agree(found.exit_direction[through], slant(degrees)[through], atol=1e-13)
    start = np.array([-0.3, 0.1, 0.4])
    sideways = found.exit_point - start
    sideways -= (sideways * slant(degrees)).sum(-1)[:, None] * slant(degrees)
    expected = 0.1 * np.sin(i - inside) / np.cos(inside)
    assert_agree(np.linalg.norm(sideways, axis=-1)[through], expected[through], atol=1e-12)
    assert_agree(found.path_m[through, 0], 0.1 / np.cos(inside)[through], atol=1e-12)


def test_light_is_mirrored_at_the_side_of_a_slab():
    slab = Solid("slab", Slab(np.array([0.02, 0.02, 0.5])))
    found = trace([slab], np.array([0.0, 0.0, 0.6]), unit([[0.1, 0.0, -1.0]]))
    assert found.status == THROUGH
    assert found.events > 3
    straight = np.abs(unit([[0.1, 0.0, -1.0]]))
    assert_agree(np.abs(found.exit_direction), straight, atol=1e-13)
    share = fresnel(straight[:, 2], 1.0, GLASS)
    # Mirroring inside is total: only the two ends of the slab cost light.
    assert found.transmitted == pytest.approx((1 - share) ** 2)


def test_light_that_is_caught_is_lost():
    cube = Solid("cube", Slab(np.full(3, 0.1)))
    found = trace([cube], np.array([0.01, 0.02, 0.03]), unit([[1.0, 1.1, 0.9]]))
    assert found.status == LOST
    assert found.events == MAX_EVENTS
    assert found.transmitted == 0
    assert np.isfinite(found.pencil).all()


@pytest.mark.parametrize(("front", "back"), [(0.2, 0.3), (-0.2, -0.3), (0.1, -0.3), (-0.3, 0.1)])
def test_a_lens_has_the_focal_length_of_the_lensmakers_equation(front, back):
    thick = 0.01
    lens = Solid("lens", LensShape(0.02, (front, back), thick))
    origins, directions = parallel_rays(np.array([1e-5, 1e-5]))
    found = trace([lens], origins, directions)
    power = (GLASS - 1) * (1 / front + 1 / back - (GLASS - 1) * thick / (GLASS * front * back))
    toward = (found.exit_direction[:, :2] * origins[:, :2]).sum(-1) / 1e-10
    assert_agree(-toward, np.full(2, power), rtol=1e-6)


def test_a_ball_lens_has_its_focal_length():
    origins, directions = parallel_rays(np.array([1e-6]))
    found = trace([BALL], origins, directions)
    focal = GLASS * 0.15 / (4 * (GLASS - 1))
    assert -found.exit_direction[0, 0] / 1e-6 == pytest.approx(1 / focal, rel=1e-8)


def test_a_lens_of_a_balls_curvature_is_that_ball():
    """Two hemispheres' worth of caps, rim of no height: the ball itself."""
    directions = unit(np.random.default_rng(0).uniform(-0.075, 0.075, (500, 3)) - EYE)
    lens = replace(BALL, shape=LensShape(0.075, (0.075, 0.075), 0.15))
    one, other = trace([BALL], EYE, directions), trace([lens], EYE, directions)
    assert_agree(other.exit_direction, one.exit_direction, atol=1e-12)
    assert_agree(other.exit_point, one.exit_point, atol=1e-12)
    assert_agree(other.pencil, one.pencil, atol=1e-10, rtol=1e-10)


def test_a_lens_has_a_rim():
    lens = Solid("lens", LensShape(0.05, (-0.2, -0.2), 0.01))
    found = trace([lens], np.array([0.3, 0.0, 0.011]), unit([[-1.0, 0.0, 0.0]]))
    assert found.solid == 0
    assert found.distance_m == pytest.approx(0.25)
    assert_agree(found.normal, [[1.0, 0.0, 0.0]])
    assert np.isnan(found.uv).all()
    beside = trace([lens], np.array([0.3, 0.0, 0.012]), unit([[-1.0, 0.0, 0.0]]))
    assert beside.solid == -1
    assert beside.distance_m == np.inf


# ── bodies in bodies ────────────────────────────────────────────────────────────────────────────


def test_a_bubble_in_a_ball():
    """Concentric: n·r·sin i is the same on all boundaries (Bouguer)."""
    outer, bubble = 0.075, 0.045
    offsets = np.linspace(0, 0.0731, 72)
    origins, directions = parallel_rays(offsets)
    glass = replace(BALL, index=(1.5,) * 3)
    hollow = Solid("bubble", Ball(bubble), index=(1.0,) * 3)
    found = trace([glass, hollow], origins, directions)
    i1, t1 = np.arcsin(offsets / outer), np.arcsin(offsets / outer / 1.5)
    i2 = np.arcsin(np.minimum(offsets / bubble / 1.5, 1))
    t2 = np.arcsin(np.minimum(offsets / bubble, 1))
    through, around = offsets < bubble, offsets > 1.5 * bubble
    turned = np.where(through, 2 * (i1 - t1) + 2 * (i2 - t2), 2 * (i1 - t1) - np.pi + 2 * i2)
    turned = np.where(around, 2 * (i1 - t1), turned)
    assert_agree(angles_between(found.exit_direction, directions), np.abs(turned), atol=1e-12)
    assert (found.events == np.where(through, 4, np.where(around, 2, 3))).all()
    assert (found.status == THROUGH).all()
    inside = np.where(through, 2 * bubble * np.cos(t2), 0)
    assert_agree(found.path_m[:, 1], inside, atol=1e-9)


def test_equal_media_have_no_boundary():
    origins, directions = parallel_rays(np.linspace(0, 0.07, 50))
    alone = trace([BALL], origins, directions)
    core = Solid("core", Slab(np.array([0.03, 0.04, 0.02])))
    both = trace([BALL, core], origins, directions)
    assert_agree(both.exit_direction, alone.exit_direction, atol=1e-12)
    assert_agree(both.transmitted, alone.transmitted, atol=1e-12)
    assert_agree(both.path_m.sum(-1), alone.path_m.sum(-1), atol=1e-12)
    assert both.path_m[0, 1] == pytest.approx(0.04)
    nothing = trace([replace(BALL, index=(1.0,) * 3)], origins, directions)
    assert_agree(nothing.exit_direction, directions, atol=1e-13)
    assert_agree(nothing.transmitted, np.ones(50), atol=1e-12)
    assert (nothing.solid == 0).all()


def test_bodies_that_touch_have_no_air_between_them():
    def slab(index, z):
        place = np.eye(4)
        place[2, 3] = z
        return Solid("slab", Slab(np.array([1.0, 1.0, 0.05])), place, index=(index,) * 3)

    degrees = np.arange(0.0, 70)
    found = trace([slab(1.9, 0.05), slab(1.3, -0.05)], np.array([-0.3, 0, 0.4]), slant(degrees))
    through = found.status == THROUGH
    i = np.arcsin(np.sin(np.radians(degrees)) / 1.9)
    j = np.arcsin(np.sin(np.radians(degrees)) / 1.3)
    assert_agree(found.exit_direction, slant(degrees), atol=1e-12)
    assert (found.events == 3).all()
    assert through.all()
    assert_agree(found.path_m, np.stack([0.1 / np.cos(i), 0.1 / np.cos(j)], -1), atol=1e-12)
    rim = 0.9 * (1 - 0.9 / 1.9)
    assert rim > 0  # i reaches 29.6°: from 1.9 into air 31.8° would be total, and soon was


def test_the_last_body_displaces_the_others():
    """Where two overlap, the path is in the later one."""
    place = np.eye(4)
    place[2, 3] = -0.06
    a = Solid("a", Slab(np.array([1.0, 1.0, 0.05])), index=(1.4,) * 3)
    b = Solid("b", Slab(np.array([1.0, 1.0, 0.05])), place, index=(1.7,) * 3)
    straight = np.array([[0.0, 0.0, -1.0]])
    for solids, expected in (([a, b], [0.06, 0.1]), ([b, a], [0.06, 0.1])):
        found = trace(solids, EYE, straight)
        assert_agree(found.path_m, [expected], atol=1e-12)
        assert found.events == 4


# ── what a path says of itself ──────────────────────────────────────────────────────────────────


def test_one_interface_is_entry_only():
    directions = unit(np.array([[0.01, 0.02, 0.0], [0.3, 0.0, 0.0]]) - EYE)
    found = trace([replace(BALL, interfaces=1)], EYE, directions)
    exact = trace([BALL], EYE, directions)
    assert found.solid.tolist() == [0, -1]
    assert found.events.tolist() == [1, 0]
    assert_agree(found.exit_point, exact.point)
    bent, _ = refracted(directions[:1], exact.normal[:1], 1.0, GLASS)
    assert_agree(found.exit_direction, np.concatenate([bent, directions[1:]]), atol=1e-14)
    assert_agree(found.path_m, np.zeros((2, 1)))
    assert_agree(found.transmitted, 1 - found.reflectance)


def test_a_ray_beside_the_glass_is_itself():
    found = trace([BALL], EYE, unit([[0.0, 1.0, 0.0]]))
    assert found.solid == -1
    assert_agree(found.exit_point, EYE[None])
    assert_agree(found.exit_direction, [[0.0, 1.0, 0.0]])
    assert found.transmitted == 1
    assert found.reflectance == 0
    assert trace([], EYE, unit([[0.0, 1.0, 0.0]])).path_m.shape == (1, 0)


def test_the_first_boundary_is_mirrored_and_has_coordinates():
    found = trace([BALL], EYE, unit([[0.0, 0.0, -1.0]]))
    assert_agree(found.mirrored, [[0.0, 0.0, 1.0]])
    assert_agree(found.uv, [[0.5, 0.5]])  # the middle of the picture is at +z
    above = trace([BALL], np.array([0, 0.4, 0.0]), unit([[0.0, -1.0, 0.001]]))
    assert above.uv[0, 1] < 0.01
    right = trace([BALL], np.array([0.4, 0.0, 0.0]), unit([[-1.0, 0.0, 0.0]]))
    assert_agree(right.uv, [[0.75, 0.5]])
    slab = Solid("slab", Slab(np.array([0.2, 0.1, 0.01])))
    corner = trace([slab], np.array([-0.2, 0.1, 1.0]) * 0.999, unit([[0.0, 0.0, -1.0]]))
    assert_agree(corner.uv, [[0.0005, 0.0005]], atol=1e-12)


def test_channels_have_their_own_index():
    ball = replace(BALL, index=(1.5, 1.51, 1.53))
    direction = unit(np.array([[0.05, 0.0, 0.0]]) - EYE)
    for channel, index in enumerate(ball.index):
        alone = trace([replace(BALL, index=(index,) * 3)], EYE, direction)
        found = trace([ball], EYE, direction, channel=channel)
        assert_agree(found.exit_direction, alone.exit_direction)


def test_a_placed_body_is_the_same_body():
    place = np.eye(4)
    place[:3, :3] = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    place[:3, :3] *= np.sign(np.linalg.det(place[:3, :3]))
    place[:3, 3] = [0.3, -2.0, 5.0]
    lens = Solid("lens", LensShape(0.05, (0.1, -0.2), 0.02))
    directions = unit(np.random.default_rng(0).uniform(-0.05, 0.05, (300, 3)) - EYE)
    turn = place[:3, :3]
    here = trace([lens], EYE, directions)
    there = trace(
        [replace(lens, world_from_glass=place)], EYE @ turn.T + place[:3, 3], directions @ turn.T
    )
    assert (here.events == there.events).all()
    assert_agree(there.exit_direction, here.exit_direction @ turn.T, atol=1e-12)
    assert_agree(there.normal, here.normal @ turn.T, atol=1e-12)
    assert_agree(there.local_point, here.local_point, atol=1e-12)
