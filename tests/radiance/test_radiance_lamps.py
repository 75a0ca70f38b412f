"""Every lamp in Radiance against our own direct light, and against closed forms."""

import numpy as np
import pytest
from asked import errors, lux_of, our_direct

from andon.errors import InputError
from andon.files.photometry import Distribution, read_photometry
from andon.lamps import (
    DirectionalLamp,
    DiskLamp,
    GoniometricLamp,
    HemisphereLamp,
    MeshLamp,
    PointLamp,
    PolygonLamp,
    Shadow,
    SkyLamp,
    SphereLamp,
    SpotLamp,
    TubeLamp,
)
from andon.quantities import Geometry
from andon.transport.baked.radiance import is_distant_glow, radiance_bundle, unsaid
from requirements import required
from worlds import ball, open_room, points_on, unit

required("pyradiance")

ROOM = open_room()
POINTS, NORMALS = points_on(ROOM, 1500)
SHADOW = Shadow(samples=64)
WARM = np.array([90.0, 70.0, 40.0])
UP = np.array([0.0, 1.0, 0.0])
AT = np.array([0.9, 1.7, 0.9])
AIM = unit(np.array([-0.3, 0.2, -0.6]) - AT)
SQUARE = np.array([[-0.3, 1.9, 0.2], [0.5, 1.9, 0.2], [0.5, 1.5, 0.8], [-0.3, 1.5, 0.8]])
PICTURE = np.random.default_rng(3).uniform(0, 2, (6, 9, 3))
PICTURE /= PICTURE.mean(axis=(0, 1))
TILE = ball(0.2, (0.2, 1.8, 0.4), 3)
BRIGHT = np.random.default_rng(5).uniform(100, 900, (len(TILE.triangles), 3))


def luminaire(kind):
    """A lopsided distribution of a photometric type that hangs askew."""
    around, polar = {
        "C": (np.arange(0, 361, 30.0), np.array([0, 10, 25, 30, 45, 60, 80, 90.0])),
        "B": (np.arange(-90, 91, 15.0), np.arange(-60, 91, 10.0)),
        "A": (np.arange(-40, 81, 10.0), np.arange(-50, 91, 7.0)),
    }[kind]
    candela = (1.2 + np.sin(np.radians(around)))[:, None] * (2 + np.cos(np.radians(3 * polar)))
    if kind == "C":  # 0° and 360° are one plane
        candela[-1] = candela[0]
    direction = unit([0.3, -1, 0.1]) if kind != "A" else unit([-0.2, -1, 0.3])
    right = unit(np.cross(direction, [0.3, 0.2, 1.0]))
    form = Distribution(kind, around, polar, candela)
    return GoniometricLamp(
        "luminaire", AT, WARM, SHADOW, direction=direction, right=right, distribution=form
    )


LAMPS = {
    "point": PointLamp("point", AT, WARM, SHADOW),
    "spot": SpotLamp("spot", AT, 3 * WARM, SHADOW, 0.0, AIM, 0.2, 0.6),
    "wide spot": SpotLamp("spot", AT, 2 * WARM, SHADOW, 0.0, AIM, 0.5, 1.45),
    "directional": DirectionalLamp("sun", unit([-0.5, -0.8, -0.4]), 10 * WARM, SHADOW),
    "type C": luminaire("C"),
    "type B": luminaire("B"),
    "type A": luminaire("A"),
    "sphere": SphereLamp("sphere", WARM, AT, 0.15, shadow=SHADOW),
    "disk": DiskLamp("disk", WARM, AT, AIM, 0.25, shadow=SHADOW),
    "disk of two sides": DiskLamp("disk", WARM, AT, -AIM, 0.25, True, shadow=SHADOW),
    "tube": TubeLamp("tube", WARM, np.array([[-1, 2, 0.5], [1, 2, 0.7]]), 0.04, shadow=SHADOW),
    "rectangle": PolygonLamp("flat", WARM, SQUARE, shadow=SHADOW),
    "rectangle of two sides": PolygonLamp("flat", WARM, SQUARE[::-1], True, shadow=SHADOW),
    "triangle": PolygonLamp("flat", WARM, SQUARE[[0, 1, 3]], shadow=SHADOW),
    "picture": PolygonLamp("picture", WARM, SQUARE, False, PICTURE, shadow=SHADOW),
    "mesh": MeshLamp("mesh", WARM, TILE.positions, TILE.triangles, shadow=SHADOW),
    "bright facets": MeshLamp(
        "mesh", BRIGHT.mean(axis=0), TILE.positions, TILE.triangles, BRIGHT, shadow=SHADOW
    ),
}


@pytest.mark.parametrize("name", LAMPS)
def test_direct_light_is_that_of_our_own_engine(name):
    """Median ≤ 1 %, 95th percentile ≤ 3 %, penumbrae excluded: relighting's own bar."""
    truth = lux_of(radiance_bundle([ROOM], [LAMPS[name]]), POINTS, NORMALS)
    ours, edge = our_direct([LAMPS[name]], [("real", ROOM)], POINTS, NORMALS)
    assert edge.mean() < 0.06
    median, most, ratio = errors(ours, truth, ~edge)
    assert median < 0.005
    assert most < 0.015
    assert abs(ratio - 1) < 0.005


@pytest.mark.parametrize("name", ["point", "spot", "directional", "type C", "type B", "type A"])
def test_lamps_without_an_area_are_exact(name):
    truth = lux_of(radiance_bundle([ROOM], [LAMPS[name]]), POINTS, NORMALS)
    ours, _ = our_direct([LAMPS[name]], [("real", ROOM)], POINTS, NORMALS)
    assert errors(ours, truth, np.ones(len(ours), bool))[1] < 2e-4


def test_real_luminaires_are_exact(data_dir):
    files = sorted((data_dir / "ies_luminaires").rglob("*.[iI][eE][sS]"))
    assert files
    for file in files[:: max(1, len(files) // 5)][:5]:
        form = read_photometry(file)
        lamp = GoniometricLamp(
            "real", AT, WARM, SHADOW,
            direction=AIM, right=unit(np.cross(AIM, UP)), distribution=form,
        )  # fmt: skip
        truth = lux_of(radiance_bundle([ROOM], [lamp]), POINTS, NORMALS)
        ours, edge = our_direct([lamp], [("real", ROOM)], POINTS, NORMALS)
        median, most, _ = errors(ours, truth, ~edge)
        assert median < 1e-4, file.name
        assert most < 1e-3, file.name


def test_more_tiles_are_nearer_to_the_closed_form():
    """A ball's light, E = π L (r/d)² cos θ as far as all of it is above the horizon."""
    lamp = SphereLamp("ball", WARM, np.array([0.0, 1.0, 0.0]), 0.2)
    floor = Geometry(10.0 * np.array([[-1, 0, 1], [1, 0, 1], [0, 0, -1.0]]), np.array([[0, 1, 2]]))
    x = np.linspace(0, 2, 40)
    points, normals = np.column_stack([x, 0 * x, 0 * x]), np.tile(UP, (40, 1))
    want = (np.pi * 0.2**2 / np.hypot(1, x) ** 3)[:, None] * WARM
    off = [
        np.median(
            np.abs(lux_of(radiance_bundle([floor], [lamp], tiles=n), points, normals) / want - 1)
        )
        for n in (64, 300, 1200)
    ]
    assert off[0] < 0.006
    assert off[1] < 0.5 * off[0]
    assert off[2] < 0.5 * off[1]


NOTHING = Geometry(
    np.array([[0, -9, 0], [1, -9, 0], [0, -9, 1.0]]), np.array([[0, 1, 2]], np.int32)
)


@pytest.mark.parametrize(
    "lamp",
    [
        SkyLamp("sky", unit([0.2, 1, 0.1]), WARM),
        HemisphereLamp("both", unit([0.1, 1, 0]), WARM, 0.2 * WARM[::-1]),
    ],
)
def test_skies_are_found_by_the_first_bounce(lamp):
    """E = E_up (1 + n·up)/2 and the like, among nothing that could hide the sky."""
    random = np.random.default_rng(2)
    normals = unit(random.normal(size=(60, 3)))
    points = random.uniform(-1, 1, (60, 3))
    bundle = radiance_bundle([NOTHING], [lamp], black=True)
    assert is_distant_glow(lamp)
    assert not lux_of(bundle, points, normals).any()
    truth = lux_of(bundle, points, normals, 1, "-aa", "0", "-ad", "4096", "-as", "0")
    ours, _ = our_direct([lamp], [("real", NOTHING)], points, normals)
    np.testing.assert_allclose(truth, ours, atol=0.01 * WARM.max())


def test_walls_hide_a_sky_and_a_note_says_so():
    lamp = SkyLamp("sky", UP, WARM)
    bundle = radiance_bundle([ROOM], [lamp], black=True)
    near = np.array([[-2.45, 0.0, -2.45]])  # in the corner of two walls of 3 m
    lux = lux_of(bundle, near, UP[None], 1, "-aa", "0", "-ad", "4096", "-as", "0")
    # Of a corner's four quarters of the sky one is left, and a little above the walls.
    assert 0.24 * WARM[0] < lux[0, 0] < 0.35 * WARM[0]
    assert "surfaces hide this sky" in unsaid([lamp])[0]


def test_lamps_shine_through_one_another_unless_they_are_drawn():
    """A rectangle hides the lamp above it if it is something that is seen."""
    above = PointLamp("above", np.array([0.1, 2.5, 0.5]), WARM)
    points, normals = np.array([[0.1, 0.0, 0.5]]), UP[None]
    away = np.add(SQUARE[::-1], [0, 0.2, 0])  # shines upwards
    seen = [PolygonLamp("flat", WARM, away, drawn=drawn) for drawn in (True, False)]
    hidden, shown = (lux_of(radiance_bundle([ROOM], [above, x]), points, normals) for x in seen)
    assert not hidden.any()
    np.testing.assert_allclose(shown[0], WARM / 2.5**2, rtol=1e-4)


@pytest.mark.parametrize("which", ["bulb", "bulb and spot", "no bulb"])
def test_lamps_in_one_place_add_up(which):
    at = np.array([0.9, 1.7, 0.9])
    bulb = SphereLamp("bulb", 100 * WARM, at, 0.03, shadow=SHADOW)
    points = [PointLamp("gaps", at, WARM[::-1], SHADOW), PointLamp("more", at, WARM, SHADOW)]
    spots = [
        SpotLamp(f"spot {aim}", at, WARM, SHADOW, 0.0, unit(aim), 0.3, 1.2)
        for aim in ([0, -1, 0], [-1, -1, -1.0])
    ]
    lamps = {"bulb": [bulb, *points], "bulb and spot": [bulb, spots[0]], "no bulb": points + spots}
    lamps = lamps[which]
    truth = lux_of(radiance_bundle([ROOM], lamps), POINTS, NORMALS)
    ours, edge = our_direct(lamps, [("real", ROOM)], POINTS, NORMALS)
    median, most, _ = errors(ours, truth, ~edge)
    assert median < 0.004
    assert most < 0.01


def test_three_different_lamps_in_one_place_are_refused():
    spot = SpotLamp("spot", AT, WARM, SHADOW, 0.0, AIM, 0.3, 1.2)
    bulb, point = SphereLamp("bulb", WARM, AT, 0.03), PointLamp("point", AT, WARM)
    with pytest.raises(InputError, match="spot: stands in a glowing ball"):
        radiance_bundle([ROOM], [bulb, point, spot])


def test_what_is_within_a_lamp_does_not_hide_it():
    """A bulb's own glass, nearer than `near_m`; what is farther away does."""
    glass = [ball(radius, AT, 2) for radius in (0.008, 0.02)]
    lamp = PointLamp("bulb", AT, WARM, Shadow(near_m=0.01))
    lit, dark = (lux_of(radiance_bundle([ROOM, part], [lamp]), POINTS, NORMALS) for part in glass)
    alone = lux_of(radiance_bundle([ROOM], [lamp]), POINTS, NORMALS)
    np.testing.assert_array_equal(lit, alone)
    assert alone.any()
    assert not dark.any()


def test_what_radiance_cannot_say_is_noted():
    lamps = [
        PointLamp("a", AT, WARM, None),
        PointLamp("b", AT, WARM, Shadow(through=frozenset({"real", "objects"}))),
        PointLamp("c", AT, WARM, Shadow(through=frozenset({"c"}))),
    ]
    assert unsaid(lamps) == (
        "a: casts no shadow in frames, but does in its maps",
        "b: shines through objects, real in frames, but not in its maps",
    )


@pytest.mark.parametrize(
    "lamp",
    [
        PointLamp("bad", AT, np.array([1.0, -1.0, 1.0])),
        PointLamp("bad", AT, np.array([1.0, np.nan, 1.0])),
        DirectionalLamp("bad", np.array([np.inf, 0, 0]), WARM),
        SphereLamp("bad", -WARM, AT, 0.1),
        SkyLamp("bad", 0 * UP, WARM),
    ],
)
def test_hostile_lamps_of_a_bundle_are_refused(lamp):
    with pytest.raises(InputError, match="bad: must"):
        radiance_bundle([ROOM], [lamp])
