"""Luminaires of a scene: which way they hang, how much light they give, the same for all."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from andon.composite.reference import lamp_luminance
from andon.errors import InputError
from andon.files import read_photometry
from andon.lamps import GoniometricLamp, PointLamp, SpotLamp, intensity_cd, resolve_lamps
from andon.lamps.goniometry import flux_lm, maximum_cd
from andon.lamps.intensity import luminaire_from_world
from andon.quantities import photometric
from andon.scene import scene_from_dict
from andon.transport.direct.reference import illuminance
from photometry_files import ies

PLANES, GAMMAS = (0, 90, 180, 270, 360), (0, 45, 90, 135, 180)
# 1000 cd down, 100 cd to C = 0, 200 to C = 90, 300 to C = 180, 400 to C = 270, 50 cd up.
TABLE = [[1000, 550, side, 60, 50] for side in (100, 200, 300, 400, 100)]
X, Y, Z = np.eye(3)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "lamp.ies").write_text(ies(verticals=GAMMAS, horizontals=PLANES, candela=TABLE))
    return tmp_path


def resolve(folder, **keys):
    table = {"kind": "ies", "position": [0, 3, 0], "file": "lamp.ies", **keys}
    (lamp,) = resolve_lamps(scene_from_dict({"lamp": [table]}, folder=folder), 0.0)
    assert type(lamp) is GoniometricLamp
    return lamp


def towards(lamp, direction):
    return intensity_cd(lamp, np.asarray(direction, float))[1]


def test_which_way_it_hangs(folder):
    """Down is the nadir, C = 0 is +X, and from above C runs counter-clockwise: C = 90 is −Z."""
    lamp = resolve(folder)
    directions = {(0, -1, 0): 1000, (0, 1, 0): 50, (1, 0, 0): 100, (0, 0, -1): 200,
                  (-1, 0, 0): 300, (0, 0, 1): 400}  # fmt: skip
    for direction, expected in directions.items():
        assert towards(lamp, direction) == pytest.approx(expected), direction


def test_roll_turns_the_planes_as_c_grows(folder):
    lamp = resolve(folder, roll_degrees=90)
    assert towards(lamp, -Z) == pytest.approx(100)
    assert towards(lamp, X) == pytest.approx(400)
    assert towards(lamp, -Y) == pytest.approx(1000)


@pytest.mark.parametrize(
    ("direction", "right"),
    [
        # Tilted by hand: what pointed to +X swings up, or stays where the axis of the tilt is.
        ((1, 0, 0), (0, 1, 0)), ((-1, 0, 0), (0, -1, 0)),
        ((0, 0, 1), (1, 0, 0)), ((0, 0, -1), (1, 0, 0)), ((0, 1, 0), (1, 0, 0)),
        ((0.6, -0.8, 0), (0.8, 0.6, 0)),
    ],
)  # fmt: skip
def test_a_tilted_luminaire(folder, direction, right):
    lamp = resolve(folder, direction=direction)
    assert lamp.right == pytest.approx(right)
    assert towards(lamp, direction) == pytest.approx(1000)
    assert towards(lamp, right) == pytest.approx(100)


@given(
    st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 1e-3),
    st.floats(-400, 400),
)
def test_its_frame_is_a_rotation(direction, roll):
    from andon.lamps.resolve import _right
    from andon.lamps.tables import unit

    nadir = unit(direction)
    distribution = read_photometry_of_a_bulb()
    lamp = GoniometricLamp(
        "l", np.zeros(3), np.ones(3), direction=nadir, right=_right(nadir, np.radians(roll)),
        distribution=distribution,
    )  # fmt: skip
    frame = luminaire_from_world(lamp)
    assert frame @ frame.T == pytest.approx(np.eye(3), abs=1e-9)
    assert np.linalg.det(frame) == pytest.approx(1)
    assert frame @ nadir == pytest.approx([0, 0, -1], abs=1e-9)


def read_photometry_of_a_bulb():
    from andon.files import Distribution

    return Distribution("C", np.array([0.0, 360]), np.array([0.0, 180]), np.full((2, 2), 7.0))


def test_light_as_the_file_says_or_scaled(folder):
    own = read_photometry(folder / "lamp.ies")
    assert photometric(resolve(folder).intensity_cd) == pytest.approx(maximum_cd(own))
    assert photometric(resolve(folder, intensity_cd=50).intensity_cd) == pytest.approx(50)
    scaled = resolve(folder, flux_lm=800, temperature_k=2700)
    share = photometric(scaled.intensity_cd) / maximum_cd(own)
    assert share * flux_lm(own) == pytest.approx(800)
    assert scaled.intensity_cd[0] > scaled.intensity_cd[2]


def test_flux_on_a_sphere_around_it(folder):
    """The illuminance on the inside of a sphere, summed up, is the flux that was asked for."""
    lamp = resolve(folder, flux_lm=800, direction=(0.3, -0.5, 0.9), roll_degrees=20)
    gamma = (np.arange(400) + 0.5) * np.pi / 400
    around = (np.arange(400) + 0.5) * np.pi / 200
    g, c = np.meshgrid(gamma, around, indexing="ij")
    outward = np.stack([np.sin(g) * np.cos(c), np.cos(g), np.sin(g) * np.sin(c)], axis=-1)
    lux = illuminance(lamp, lamp.position_m + 2 * outward, -outward)[..., 1]
    area = 4 * np.sin(g) * (np.pi / 400) * (np.pi / 200)
    assert (lux * area).sum() == pytest.approx(800, rel=1e-3)


def test_discharge_lamps_droop_when_tilted(folder):
    tilt = "TILT=INCLUDE\n1\n2\n0 90\n1 0.5"
    (folder / "lamp.ies").write_text(
        ies(verticals=GAMMAS, horizontals=PLANES, candela=TABLE, tilt=tilt)
    )
    assert resolve(folder).intensity_cd[0] == pytest.approx(1000)
    assert resolve(folder, direction=(0, 0, -1)).intensity_cd[0] == pytest.approx(500)
    assert resolve(folder, direction=(1, -1, 0)).intensity_cd[0] == pytest.approx(750)
    assert resolve(folder, direction=(0, 0, -1), intensity_cd=80).intensity_cd[0] == pytest.approx(
        80
    )


LAMPS = [
    PointLamp("p", np.zeros(3), np.array([3.0, 2, 1]), None, 0.1),
    SpotLamp("s", np.zeros(3), np.array([3.0, 2, 1]), None, 0.1, np.array([0, 0, -1.0]), 0.2, 1.2),
    GoniometricLamp(
        "g", np.zeros(3), np.array([3.0, 2, 1]), None, 0.1, direction=np.array([0, 0, -1.0]),
        right=np.array([0, 1.0, 0]), distribution=read_photometry_of_a_bulb(),
    ),
]  # fmt: skip


@pytest.mark.parametrize("lamp", LAMPS, ids=lambda lamp: lamp.name)
def test_one_intensity_for_surfaces_and_for_the_eye(lamp):
    directions = np.random.default_rng(2).normal(size=(20, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    cd = intensity_cd(lamp, directions)
    assert cd.shape == (20, 3)
    assert illuminance(lamp, 2 * directions, -directions) == pytest.approx(cd / 4)
    for direction, expected in zip(directions, cd, strict=True):
        seen = lamp_luminance(lamp, 5 * direction)
        assert seen == pytest.approx(expected / (np.pi * 0.1**2))


def test_a_file_is_read_once_and_again_when_it_changes(folder, monkeypatch):
    from andon.lamps import resolve as module

    calls = []
    monkeypatch.setattr(
        module, "read_photometry", lambda path: calls.append(path) or read_photometry(path)
    )
    first = resolve(folder).distribution
    assert resolve(folder).distribution is first
    (folder / "lamp.ies").write_text(ies(labels=["[TEST] other"], candela=5))
    assert resolve(folder).intensity_cd[0] == pytest.approx(5)
    assert len(calls) == 2


def test_what_is_wrong_is_named(folder):
    with pytest.raises(InputError, match=r"missing\.ies: must exist"):
        resolve(folder, file="missing.ies")
    with pytest.raises(InputError, match=r"lamp\[0\]\.file: a reference must stay inside"):
        resolve(folder, file="../lamp.ies")
    (folder / "lamp.txt").write_text("x")
    with pytest.raises(InputError, match=r"must be one of \.ies, \.ldt"):
        resolve(folder, file="lamp.txt")
    with pytest.raises(InputError, match="too large"):
        resolve(folder, flux_lm=1e308, rgb=(0, 0, 1))
