"""Luminous bodies: where every lumen of a lamp in a shell goes."""

import numpy as np
import pytest

from andon.lamps import MeshLamp, PointLamp, PolygonLamp, Shell, SphereLamp, SpotLamp, expand
from andon.lamps.shells.beams import beam_of
from andon.lamps.shells.exact import solve_shell
from andon.lamps.shells.form import form_of
from andon.lamps.solids import icosphere
from andon.quantities import Geometry
from lamps.shell_worlds import (
    CENTRE,
    area_lm,
    box,
    directions,
    drawn_lm,
    far_intensity,
    holed_ball,
    lamp,
    moved,
    sent_lm,
    tube,
)

PHI = 4 * np.pi * 100
T = np.array([0.5, 0.4, 0.3])
STEP = np.array([1.0, 0, 0])


def solution(shell, bulb=None):
    return solve_shell(shell, beam_of(bulb or lamp()))


def by_name(parts):
    return {part.name: part for part in parts}


def test_a_sphere_around_its_lamp_is_the_closed_form():
    (ball,), body = expand(lamp(), Shell(radius_m=0.1, transmittance=T))
    assert type(ball) is SphereLamp
    assert (ball.name, ball.radius_m, ball.drawn) == ("lantern", 0.1, False)
    assert ball.position_m.tolist() == CENTRE.tolist()
    np.testing.assert_allclose(ball.luminance_cd_m2, T * 100 / (np.pi * 0.01), rtol=1e-12)
    np.testing.assert_allclose(body.outside_cd_m2, np.tile(ball.luminance_cd_m2, (2562, 1)), 2e-3)
    assert len(body.geometry.triangles) >= 2500
    np.testing.assert_allclose(drawn_lm(body), T * PHI, rtol=1e-9)
    assert body.name == "lantern"
    assert ball.shadow.through == {"lantern"}
    assert ball.shadow.samples == 16


def test_the_same_sphere_as_a_mesh_shines_alike():
    ball = icosphere(3)
    mesh = Geometry(0.1 * ball.positions, ball.triangles, ball.normals)
    (part,), body = expand(lamp(), Shell(mesh=mesh, transmittance=T))
    assert type(part) is MeshLamp
    assert len(part.triangles) <= 96
    expected = T * 100 / (np.pi * 0.01)
    weights = np.linalg.norm(
        np.cross(*(part.positions_m[part.triangles[:, k]] - CENTRE for k in (0, 1))), axis=1
    )
    mean = np.average(part.facet_luminance_cd_m2, axis=0, weights=weights)
    np.testing.assert_allclose(mean, expected, rtol=0.1)  # the area of few flat triangles
    np.testing.assert_allclose(body.outside_cd_m2.mean(axis=0), expected, rtol=0.01)
    towards = directions(500)
    np.testing.assert_allclose(far_intensity(part, body, towards), np.tile(T * 100, (500, 1)), 0.1)
    assert np.abs(body.geometry.normals @ body.geometry.normals[0]).max() <= 1 + 1e-9


@pytest.mark.parametrize("absorptance", [0.0, 0.5])
def test_a_closed_shell_absorbs_what_it_does_not_let_through(absorptance):
    shell = Shell(mesh=box(), transmittance=T, absorptance=absorptance)
    parts, body = expand(lamp(), shell)
    assert [part.name for part in parts] == ["lantern"]
    np.testing.assert_allclose(area_lm(parts[0]), T * PHI, rtol=1e-9)
    np.testing.assert_allclose(drawn_lm(body), T * PHI, rtol=1e-9)
    np.testing.assert_allclose(sent_lm(parts, body), T * PHI, rtol=2e-3)
    assert not body.inside_cd_m2.any()


@pytest.mark.parametrize("mesh", [tube(), tube(floor=True), box(sides="xz"), holed_ball()])
@pytest.mark.parametrize("absorptance", [0.0, 0.1, 0.5])
def test_an_open_shell_loses_only_what_it_absorbs(mesh, absorptance):
    shell = Shell(mesh=mesh, transmittance=T, absorptance=absorptance)
    parts, body = expand(lamp(), shell)
    met = solution(shell).met
    glow, bulb, *lids = parts
    np.testing.assert_allclose(area_lm(glow), met * T * PHI, rtol=1e-9)
    np.testing.assert_allclose(drawn_lm(body), met * T * PHI, rtol=1e-9)
    reflected = sum(area_lm(lid) for lid in lids)
    np.testing.assert_allclose(reflected, met * (1 - T - absorptance) * PHI, rtol=1e-9, atol=1e-9)
    # And by rays, which know nothing of solid angles or lids.
    expected = (1 - met * absorptance) * PHI
    np.testing.assert_allclose(sent_lm(parts, body), expected, rtol=6e-3)
    assert bulb.intensity_cd.tolist() == [100, 100, 100]


@pytest.mark.parametrize(("radius", "height"), [(0.1, 0.3), (0.3, 0.1)])
def test_the_openings_of_a_cylinder_have_their_solid_angle(radius, height):
    through_one = (1 - 1 / np.hypot(1, 2 * radius / height)) / 2
    shell = Shell(mesh=tube(radius, height, sides=256))
    assert solution(shell).met == pytest.approx(1 - 2 * through_one, abs=1e-4)
    parts, body = expand(lamp(), shell)
    bulb = by_name(parts)["lantern: bulb"]
    seen = far_intensity(bulb, body, directions(20_000)).mean() / 100
    assert seen == pytest.approx(2 * through_one, abs=1e-3)


def test_lids_look_out_and_have_the_area_of_their_opening():
    parts, _ = expand(lamp(), Shell(mesh=tube(sides=64), transmittance=T))
    lids = sorted(
        (part for part in parts if type(part) is PolygonLamp), key=lambda lid: lid.vertices_m[0, 1]
    )
    for lid, sign in zip(lids, (-1, 1), strict=True):
        relative = lid.vertices_m - lid.vertices_m.mean(axis=0)
        area = np.cross(relative, np.roll(relative, -1, axis=0)).sum(axis=0) / 2
        expected = sign * np.array([0, 64 / 2 * np.sin(2 * np.pi / 64) * 0.01, 0])
        np.testing.assert_allclose(area, expected, atol=1e-9)
        assert len(lid.vertices_m) <= 20
        np.testing.assert_allclose(lid.vertices_m[:, 1], CENTRE[1] + sign * 0.15)
        assert not lid.two_sided
        assert not lid.drawn


@pytest.mark.parametrize("rest", [0.2, 0.5, 0.9])
def test_reflections_in_a_ball_with_a_hole_have_a_closed_form(rest):
    # In a sphere every place sends each other place the same: with an opening of the share o,
    # of what is reflected once, o leaves, so rest = ρ·o / (1 − ρ·(1 − o)).
    mesh = holed_ball(0.2)
    shell = Shell(mesh=mesh, transmittance=np.full(3, 1 - rest))
    kept = (
        np.linalg.norm(
            np.cross(
                *(
                    mesh.positions[mesh.triangles[:, k]] - mesh.positions[mesh.triangles[:, 0]]
                    for k in (1, 2)
                )
            ),
            axis=1,
        ).sum()
        / 2
    )
    hole = 1 - kept / (4 * np.pi)
    rho = rest / (hole + rest * (1 - hole))
    found = solution(shell)
    ratio = found.inside_cd_m2 / found.outside_cd_m2  # ρ₀/τ₀, and τ₀ = 1 − ρ₀ without absorption
    np.testing.assert_allclose(ratio / (1 + ratio), rho, rtol=0.02)


@pytest.mark.parametrize("t", [0.0, 1.0])
def test_limits(t):
    shell = Shell(mesh=tube(), transmittance=np.full(3, t))
    parts, body = expand(lamp(), shell)
    names = list(by_name(parts))
    openings = ["lantern: opening 1", "lantern: opening 2"]
    assert names == (["lantern", "lantern: bulb"] if t else ["lantern: bulb", *openings])
    np.testing.assert_allclose(sent_lm(parts, body), PHI, rtol=6e-3)
    closed, body = expand(lamp(), Shell(radius_m=0.1, transmittance=np.full(3, t)))
    assert len(closed) == int(t)
    np.testing.assert_allclose(drawn_lm(body), t * PHI, atol=1e-9)


def test_a_lamp_off_the_centre_is_nearer_to_one_side():
    ball = icosphere(4)
    offset = np.array([0.05, 0, 0])  # of the shell: the lamp is at its −x side
    mesh = Geometry(0.1 * ball.positions + offset, ball.triangles, ball.normals)
    (part,), body = expand(lamp(), Shell(mesh=mesh, transmittance=T))
    np.testing.assert_allclose(area_lm(part), T * PHI, rtol=1e-9)
    relative = body.geometry.positions - CENTRE
    distance = np.linalg.norm(relative, axis=1)
    cosine = np.einsum("ij,ij->i", relative, body.geometry.normals) / distance
    expected = np.outer(100 * cosine / distance**2 / np.pi, T)
    np.testing.assert_allclose(body.outside_cd_m2, expected, rtol=4e-3)
    near, far = np.argmin(relative[:, 0]), np.argmax(relative[:, 0])
    ratio = body.outside_cd_m2[near] / body.outside_cd_m2[far]
    np.testing.assert_allclose(ratio, (0.15 / 0.05) ** 2, rtol=1e-3)


@pytest.mark.parametrize("outer", [90.0, 40.0, 5.0, 0.3])
@pytest.mark.parametrize("shell", [{"radius_m": 0.1}, {"mesh": tube()}])
def test_a_spot_in_a_shell(outer, shell):
    spot = SpotLamp(
        "lantern",
        CENTRE,
        np.full(3, 100.0),
        direction=np.array([0.8, 0.6, 0]),
        outer_radians=np.radians(outer),
    )
    shell = Shell(transmittance=T, **shell)
    found = solution(shell, spot)
    flux = 100 * beam_of(spot).flux_lm
    parts, body = expand(spot, shell)
    assert type(parts[0]) is MeshLamp
    np.testing.assert_allclose(area_lm(parts[0]), found.met * T * flux, rtol=1e-9)
    sent = sum(area_lm(part) for part in parts if type(part) is not SpotLamp)
    out = np.ones(3) if shell.mesh else T
    np.testing.assert_allclose(sent, found.met * out * flux, rtol=1e-9)
    if outer < 10:  # the axis meets the wall of the tube at 0.1/0.8·0.6 = 0.075 m, half way up
        assert found.met == pytest.approx(1, abs=1e-6)
        hottest = body.geometry.positions[np.argmax(body.outside_cd_m2[:, 0])] - CENTRE
        assert hottest[0] > 0.9 * np.hypot(hottest[0], hottest[2])
        np.testing.assert_allclose(drawn_lm(body), T * flux, rtol=1e-9)


def test_a_spot_through_an_opening_leaves_the_shell_dark():
    spot = SpotLamp("s", CENTRE, np.ones(3), outer_radians=0.1, direction=np.array([0, 1.0, 0]))
    parts, body = expand(spot, Shell(mesh=tube(), transmittance=T))
    assert not body.outside_cd_m2.any()
    assert not sum(area_lm(part) for part in parts if type(part) is not SpotLamp).any()
    assert by_name(parts)["s: bulb"].outer_radians == 0.1


@pytest.mark.parametrize("seed", range(8))
def test_any_convex_shell(seed):
    random = np.random.default_rng(seed)
    ball = icosphere(int(random.integers(0, 4)))
    stretch = random.normal(size=(3, 3)) + 2 * np.eye(3)
    points = 0.1 * ball.positions @ stretch.T
    offset = 0.3 * points.mean(axis=0) + 0.4 * points[random.integers(len(points))]
    mesh = Geometry(points - offset, ball.triangles[:, :: random.choice([-1, 1])])
    (part,), body = expand(lamp(), Shell(mesh=mesh, transmittance=T))
    np.testing.assert_allclose(area_lm(part), T * PHI, rtol=1e-9)
    np.testing.assert_allclose(sent_lm((part,), body), T * PHI, rtol=6e-3)
    assert (part.facet_luminance_cd_m2 >= 0).all()


def test_panes_leave_gaps_between_them():
    shell = Shell(mesh=box(gap=0.02), transmittance=T, absorptance=0.1)
    parts, body = expand(lamp(), shell)
    assert list(by_name(parts)) == ["lantern", "lantern: bulb", "lantern: gaps"]
    met = solution(shell).met
    assert 0.5 < met < 0.9
    np.testing.assert_allclose(area_lm(parts[0]), met * T * PHI, rtol=1e-9)
    np.testing.assert_allclose(sent_lm(parts, body), (1 - 0.1 * met) * PHI, rtol=0.02)
    assert type(by_name(parts)["lantern: gaps"]) is PointLamp


def test_panes_without_gaps_are_one_closed_shell():
    panes = box()
    parts, _ = expand(lamp(), Shell(mesh=panes, transmittance=T))
    assert len(parts) == 1
    assert not form_of(Shell(mesh=panes)).is_open
    hairline = box(gap=1e-6)  # parts that do not meet, but hardly
    assert not form_of(Shell(mesh=hairline)).is_open


class TestPaper:
    def test_closed(self):
        shell = Shell(mesh=tube(floor=True), transmittance=T, mode="paper")
        sphere = Shell(radius_m=0.1, transmittance=T, mode="paper")
        (part,), body = expand(lamp(visible_radius_m=0.01), sphere)
        assert type(part) is PointLamp
        np.testing.assert_allclose(part.intensity_cd, T * 100)
        assert part.shadow.through == {"lantern"}
        assert part.visible_radius_m == 0
        np.testing.assert_allclose(
            body.outside_cd_m2, np.tile(T * 100 / (np.pi * 0.01), (2562, 1)), rtol=1e-9
        )
        assert len(expand(lamp(), shell)[0]) == 2

    def test_open(self):
        shell = Shell(mesh=tube(), transmittance=T, mode="paper")
        (through, direct), body = expand(lamp(visible_radius_m=0.01), shell)
        assert (through.name, direct.name) == ("lantern", "lantern: direct")
        np.testing.assert_allclose(through.intensity_cd + direct.intensity_cd, 100)
        assert "lantern" not in direct.shadow.through
        assert direct.visible_radius_m == 0.01
        towards = np.array([[0, 1.0, 0], [1.0, 0, 0]])
        both = far_intensity(through, body, towards) + far_intensity(direct, body, towards)
        np.testing.assert_allclose(both, [[100, 100, 100], T * 100])

    def test_inverted_normal(self):
        _, body = expand(lamp(), Shell(mesh=tube(sides=4), transmittance=T, mode="paper"))
        relative = body.geometry.positions - CENTRE
        squared = (relative**2).sum(axis=1)
        # Four flat walls at a distance of 0.1·cos 45° from the axis.
        expected = 100 * 0.1 * np.sqrt(0.5) / squared**1.5 / np.pi
        np.testing.assert_allclose(body.outside_cd_m2, np.outer(expected, T), rtol=1e-9)

    def test_spot(self):
        spot = SpotLamp("s", CENTRE, np.full(3, 8.0), direction=np.array([1.0, 0, 0]))
        (part,), body = expand(spot, Shell(radius_m=0.1, transmittance=T, mode="paper"))
        assert type(part) is SpotLamp
        at = np.argmax(body.geometry.positions[:, 0])
        np.testing.assert_allclose(body.outside_cd_m2[at], T * 8 / (np.pi * 0.01), rtol=1e-9)


def test_a_lamp_without_shadows_is_still_hidden_by_its_own_shell():
    bulb = lamp(shadow=None)
    parts, _ = expand(bulb, Shell(mesh=tube(), transmittance=T), groups={"other", "lantern"})
    named = by_name(parts)
    assert named["lantern"].shadow is None
    assert named["lantern: opening 1"].shadow is None
    assert named["lantern: bulb"].shadow.through == {"real", "objects", "other"}


def test_a_lamp_that_moves_computes_nothing_anew():
    shell = Shell(mesh=tube(), transmittance=T, absorptance=0.1)
    here, body_here = expand(lamp(), shell)
    before = solve_shell.cache_info(), form_of.cache_info()
    there, body_there = expand(PointLamp("lantern", CENTRE + STEP, np.full(3, 50.0)), shell)
    after = solve_shell.cache_info(), form_of.cache_info()
    assert [info.misses for info in before] == [info.misses for info in after]
    np.testing.assert_allclose(
        there[0].facet_luminance_cd_m2, here[0].facet_luminance_cd_m2 / 2, rtol=1e-12
    )
    np.testing.assert_allclose(
        body_there.geometry.positions, body_here.geometry.positions + STEP, rtol=1e-12
    )
    np.testing.assert_allclose(there[0].positions_m, here[0].positions_m + STEP, rtol=1e-12)


@pytest.mark.parametrize("scale", [1e-5, 1.0, 1e4])
def test_any_size(scale):
    mesh = tube()
    shell = Shell(mesh=Geometry(scale * mesh.positions, mesh.triangles), transmittance=T)
    small = Shell(mesh=mesh, transmittance=T)
    np.testing.assert_allclose(solution(shell).met, solution(small).met, rtol=1e-9)
    np.testing.assert_allclose(
        solution(shell).facet_cd_m2 * scale**2, solution(small).facet_cd_m2, rtol=1e-6
    )


def test_a_fine_mesh_is_lit_by_few_facets_and_drawn_whole():
    mesh = moved(tube(sides=1500), [0.02, 0, 0])
    shell = Shell(mesh=mesh, transmittance=T)
    parts, body = expand(lamp(), shell)
    assert len(parts[0].triangles) <= 96 * 4
    assert len(body.geometry.triangles) >= 3000
    np.testing.assert_allclose(area_lm(parts[0]), solution(shell).met * T * PHI, rtol=1e-9)
    np.testing.assert_allclose(sent_lm(parts, body), PHI, rtol=0.02)
