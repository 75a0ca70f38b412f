"""Measured distributions: which way the angles run, flux, beams, the table for the GPU."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from andon.errors import InputError
from andon.files import Distribution, read_photometry
from andon.lamps import goniometry
from andon.lamps.uniform import uniform_grid
from andon.verify.truths.luminaires import radiance_candela
from requirements import required

ANGLES_C = (np.linspace(0, 360, 25), np.linspace(0, 180, 37))
ANGLES_B = (np.linspace(-90, 90, 37), np.linspace(-180, 180, 73))
ANGLES_A = (np.linspace(-180, 180, 73), np.linspace(-90, 90, 37))


def distribution(photometry, function, angles=None):
    """A distribution whose candela at each knot are `function` of the direction."""
    grid = {"A": ANGLES_A, "B": ANGLES_B, "C": ANGLES_C}[photometry] if angles is None else angles
    empty = Distribution(photometry, *grid, np.ones((len(grid[0]), len(grid[1]))))
    directions = goniometry.directions_of(empty, grid[0][:, None], grid[1])
    return Distribution(photometry, *grid, function(directions))


def lobe(towards):
    """Candela that are largest (2) towards a direction."""
    axis = np.array(towards, float) / np.linalg.norm(towards)
    return lambda directions: 1 + directions @ axis


X, Y, Z = np.eye(3)
# LM-63-02, definitions: photometric zero is straight down and (0, 0) of B and C, (0, −90) of A;
# photometric horizontal is (0, 90) of B and C and (0, 0) of A; from above, H runs
# counter-clockwise for C and clockwise for A and B.
CORNERS = [
    ("C", 0, 0, -Z), ("C", 0, 90, X), ("C", 90, 90, Y), ("C", 180, 90, -X), ("C", 270, 90, -Y),
    ("C", 0, 180, Z), ("C", 45, 90, (X + Y) / np.sqrt(2)),
    ("B", 0, 0, -Z), ("B", 0, 90, X), ("B", 0, -90, -X), ("B", 90, 0, -Y), ("B", -90, 0, Y),
    ("B", 90, 77, -Y), ("B", 45, 0, (-Y - Z) / np.sqrt(2)), ("B", 45, 90, (X - Y) / np.sqrt(2)),
    ("B", 0, 180, Z),
    ("A", 0, -90, -Z), ("A", 0, 0, X), ("A", 0, 90, Z), ("A", 90, 0, -Y), ("A", -90, 0, Y),
    ("A", 33, 90, Z), ("A", 45, 45, (X / np.sqrt(2) - Y / np.sqrt(2) + Z) / np.sqrt(2)),
]  # fmt: skip


@pytest.mark.parametrize(("photometry", "h", "v", "expected"), CORNERS)
def test_which_way_the_angles_run(photometry, h, v, expected):
    lamp = distribution(photometry, lobe(X))
    assert goniometry.directions_of(lamp, h, v) == pytest.approx(expected, abs=1e-12)
    peaked = distribution(photometry, lobe(expected))
    assert goniometry.candela(peaked, np.asarray(expected)) == pytest.approx(2, abs=5e-3)
    assert goniometry.candela(peaked, -np.asarray(expected)) == pytest.approx(0, abs=5e-3)


UNIT = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1)


@pytest.mark.parametrize("photometry", ["A", "B", "C"])
@given(UNIT)
def test_angles_and_directions_are_inverse(photometry, direction):
    direction = np.array(direction) / np.linalg.norm(direction)
    lamp = distribution(photometry, lobe(X))
    angles = goniometry.angles_of(lamp, direction)
    assert goniometry.directions_of(lamp, *angles) == pytest.approx(direction, abs=1e-12)


def test_candela_are_bilinear_in_the_angles():
    table = np.array([[1.0, 2, 4], [5, 6, 8], [1, 2, 4]])
    lamp = Distribution("C", np.array([0.0, 90, 360]), np.array([0.0, 60, 90]), table)
    at = goniometry.directions_of(lamp, np.array([0.0, 45, 90, 225]), np.array([30.0, 60, 75, 75]))
    assert goniometry.candela(lamp, at) == pytest.approx([1.5, 4, 7, 5])
    assert goniometry.candela(lamp, np.array([0.0, 0, 1])) == 0, "dark outside the file"


@pytest.mark.parametrize("photometry", ["A", "B", "C"])
def test_flux_of_a_lobe_is_the_mean_times_four_pi(photometry):
    """1 + cos has the mean 1; 5° steps of a bilinear interpolant lose 1e-3 of it."""
    for towards in (X, Y, Z, X + Y - Z):
        lamp = distribution(photometry, lobe(towards))
        assert goniometry.flux_lm(lamp) == pytest.approx(4 * np.pi, rel=2e-3)


@pytest.mark.parametrize("photometry", ["A", "B", "C"])
def test_flux_is_the_integral_of_what_candela_returns(photometry):
    """Gauss-Legendre in each cell, against a rough distribution."""
    random = np.random.default_rng(3)
    angles = {
        "C": (np.array([0.0, 50, 120, 360]), np.array([0.0, 7, 60, 95])),
        "B": (np.array([-70.0, -5, 30, 90]), np.array([-90.0, 0, 11, 170])),
        "A": (np.array([-120.0, 0, 33, 180]), np.array([-90.0, -20, 40, 60])),
    }[photometry]
    lamp = Distribution(photometry, *angles, random.uniform(0, 9, (4, 4)))
    nodes, weights = np.polynomial.legendre.leggauss(12)
    total = 0.0
    for h0, h1 in zip(angles[0][:-1], angles[0][1:], strict=True):
        for v0, v1 in zip(angles[1][:-1], angles[1][1:], strict=True):
            h = (h0 + h1 + nodes * (h1 - h0)) / 2
            v = (v0 + v1 + nodes * (v1 - v0)) / 2
            jacobian = {
                "C": np.sin(np.radians(v)) + 0 * h[:, None],
                "B": np.cos(np.radians(h))[:, None] + 0 * v,
                "A": np.cos(np.radians(v)) + 0 * h[:, None],
            }[photometry]
            values = goniometry.candela(lamp, goniometry.directions_of(lamp, h[:, None], v))
            area = np.radians(h1 - h0) * np.radians(v1 - v0) / 4
            total += area * (weights @ (values * jacobian) @ weights)
    assert goniometry.flux_lm(lamp) == pytest.approx(total, rel=1e-12)


def cosine_lamp():
    """A Lambertian disk, as fine as it takes."""
    return distribution(
        "C", lambda d: np.maximum(-d[..., 2], 0), (np.array([0.0, 360]), np.linspace(0, 90, 901))
    )


def test_a_lambertian_disk():
    lamp = cosine_lamp()
    assert goniometry.flux_lm(lamp) == pytest.approx(np.pi, rel=1e-6)
    assert goniometry.maximum_cd(lamp) == 1
    assert goniometry.beam_degrees(lamp) == pytest.approx((120, 120), abs=1e-3)
    assert goniometry.field_degrees(lamp) == pytest.approx((168.52, 168.52), abs=1e-2)


def test_beams_of_the_main_planes():
    """±20° in C0–C180, ±40° in C90–C270, of triangular profiles."""
    planes = np.array([0.0, 90, 180, 270, 360])
    gamma = np.linspace(0, 90, 91)
    half = np.array([20.0, 40, 20, 40, 20])
    lamp = Distribution("C", planes, gamma, np.maximum(0, 1 - gamma / (2 * half[:, None])))
    assert goniometry.beam_degrees(lamp) == pytest.approx((40, 80), abs=1e-6)
    assert goniometry.field_degrees(lamp) == pytest.approx((72, 144), abs=1e-6)
    first, second = goniometry.main_planes(lamp)
    assert (first.name, second.name) == ("C0-C180", "C90-C270")


def test_two_wings_count_with_what_lies_between():
    """A street lamp: its beam reaches from wing to wing, though the middle is dark."""
    gamma = np.linspace(0, 90, 91)
    wings = np.interp(gamma, [0, 40, 60, 80], [0.1, 0.1, 1.0, 0])
    lamp = Distribution("C", np.array([0.0, 360]), gamma, np.tile(wings, (2, 1)))
    assert goniometry.beam_degrees(lamp)[0] == pytest.approx(140, abs=1e-6)


def test_planes_that_differ_at_the_nadir():
    """Physically impossible, and published: the profile takes the halves' mean there."""
    gamma = np.array([0.0, 30, 90])
    table = np.array([[4.0, 4, 0], [2, 2, 0], [2, 2, 0], [2, 2, 0], [4, 4, 0]])
    lamp = Distribution("C", np.array([0.0, 90, 180, 270, 360]), gamma, table)
    first, second = goniometry.main_planes(lamp)
    assert np.interp([-10, 0, 10], first.angles_degrees, first.candela) == pytest.approx([2, 3, 4])
    assert second.candela.max() == 2


def test_a_beam_to_the_side_and_no_beam_at_all():
    tilted = distribution("C", lambda d: np.maximum(d @ ((X - Z) / np.sqrt(2)), 0) ** 20)
    first, _ = goniometry.main_planes(tilted)
    assert first.angles_degrees[first.candela.argmax()] == pytest.approx(45)
    exact = 2 * np.degrees(np.arccos(0.5 ** (1 / 20)))
    assert goniometry.beam_degrees(tilted)[0] == pytest.approx(exact, abs=0.3)
    bulb = distribution("C", lambda d: np.ones(d.shape[:-1]))
    assert goniometry.beam_degrees(bulb) == (360, 360)
    assert goniometry.flux_lm(bulb) == pytest.approx(4 * np.pi, rel=1e-12)


@pytest.mark.parametrize(("photometry", "names"), [("A", (Z, -Y)), ("B", (X, -Y)), ("C", (X, Y))])
def test_main_planes_turn_to_the_named_side(photometry, names):
    for plane, side in zip((0, 1), names, strict=True):
        profile = goniometry.main_planes(distribution(photometry, lobe(side)))[plane]
        assert profile.angles_degrees[profile.candela.argmax()] == pytest.approx(90)


@pytest.mark.parametrize("photometry", ["A", "B", "C"])
def test_the_uniform_grid(photometry):
    lamp = distribution(photometry, lambda d: 1 + d[..., 0] ** 2 + d[..., 1] - 0.2 * d[..., 2])
    grid = uniform_grid(lamp)
    directions = np.random.default_rng(0).normal(size=(500, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    exact = goniometry.candela(lamp, directions)
    assert grid.at(directions) == pytest.approx(exact, abs=2e-3 * exact.max())
    assert grid.error < (1e-12 if photometry == "C" else 1e-3)
    assert grid.candela[:, 0] == pytest.approx(grid.candela[:, -1])
    # Row 0 is the nadir, the last one the zenith; a quarter of the columns on is C = 90.
    rows, columns = grid.candela.shape
    for row, column, towards in (
        (0, 0, -Z), (rows - 1, 3, Z), (rows // 2, 0, X), (rows // 2, columns // 4, Y)
    ):  # fmt: skip
        assert grid.candela[row, column] == pytest.approx(goniometry.candela(lamp, towards))


def test_the_uniform_grid_is_as_small_as_it_can_be():
    assert uniform_grid(cosine_lamp()).candela.shape == (361, 2)
    # A dark half that begins with a step is a ramp of one cell, and the error says so.
    half = Distribution("C", np.array([0.0, 360]), np.array([0.0, 90]), np.ones((2, 2)))
    assert uniform_grid(half, gamma_step_degrees=1).error == pytest.approx(0.75, abs=0.01)
    with pytest.raises(InputError, match="must divide 180"):
        uniform_grid(half, gamma_step_degrees=7)


def test_tilt_factor():
    from andon.files.photometry import Tilt

    lamp = cosine_lamp()
    assert goniometry.tilt_factor(lamp, 45) == 1
    tilted = Distribution(
        "C", lamp.horizontal_degrees, lamp.vertical_degrees, lamp.candela,
        tilt=Tilt(1, np.array([0.0, 90]), np.array([1.0, 0.8])),
    )  # fmt: skip
    assert goniometry.tilt_factor(tilted, 45) == pytest.approx(0.9)


# The published lumens are Photometric Toolbox's, of the data set's own summary.
LUMENS = {"1.IES": 9217.18, "3.IES": 13359.57, "5.IES": 753.8, "7.IES": 531.98}


@pytest.mark.parametrize("name", LUMENS)
def test_lumens_of_real_files(data_dir, name):
    lamp = read_photometry(data_dir / "ies_luminaires" / "cu_calc" / name)
    assert goniometry.flux_lm(lamp) == pytest.approx(LUMENS[name], rel=1e-3)
    if lamp.stated_lumens is not None:
        assert goniometry.flux_lm(lamp) == pytest.approx(lamp.stated_lumens, rel=1e-3)


def test_poles_of_a_real_floodlight_are_those_of_type_b(data_dir):
    """At H = ±90 all V are one direction; so the file says that H is the latitude."""
    lamp = read_photometry(data_dir / "ies_luminaires" / "cu_calc" / "flood_2.2.ies")
    assert lamp.photometry == "B"
    assert np.ptp(lamp.candela[0]) == np.ptp(lamp.candela[-1]) == 0 < lamp.candela[0, 0]
    assert np.ptp(lamp.candela[:, 0]) > 0


@pytest.fixture
def radiance():
    """Radiance's programs are here."""
    return required("pyradiance")


def directions_within(lamp, count=300):
    """Random directions inside the file's angles, off its edge."""
    random = np.random.default_rng(5)
    spans = [(angles[0], angles[-1]) for angles in (lamp.horizontal_degrees, lamp.vertical_degrees)]
    h, v = (random.uniform(low + 0.5, high - 0.5, count) for low, high in spans)
    return h, v


@pytest.mark.usefixtures("radiance")
@pytest.mark.parametrize("name", ["cu_calc/1.IES", "cu_calc/3.IES", "cu_calc/5.IES",
                                  "cu_calc/7.IES", "tuberlin/HeadLight.ies"])  # fmt: skip
def test_candela_beside_ies2rad(data_dir, name):
    path = data_dir / "ies_luminaires" / name
    lamp = read_photometry(path)
    directions = goniometry.directions_of(lamp, *directions_within(lamp))
    theirs = radiance_candela(path, directions)
    assert goniometry.candela(lamp, directions) == pytest.approx(
        theirs, abs=2e-4 * goniometry.maximum_cd(lamp)
    )


@pytest.mark.usefixtures("radiance")
@pytest.mark.parametrize("plane", ["vertical", "horizontal"])
@pytest.mark.parametrize("name", ["flood_2.1.IES", "flood_2.2.ies"])
def test_floodlights_beside_ies2rad_in_their_main_planes(data_dir, name, plane):
    path = data_dir / "ies_luminaires" / "cu_calc" / name
    lamp = read_photometry(path)
    h, v = directions_within(lamp)
    h, v = (0 * h, v) if plane == "vertical" else (h, 0 * v)
    directions = goniometry.directions_of(lamp, h, v)
    theirs = radiance_candela(path, directions)
    assert goniometry.candela(lamp, directions) == pytest.approx(
        theirs, abs=2e-4 * goniometry.maximum_cd(lamp)
    )
    assert theirs.max() > 0.9 * goniometry.candela(lamp, directions).max() > 0


@pytest.mark.usefixtures("radiance")
@pytest.mark.parametrize("first", ["IESNA91", "IESNA:LM-63-2002"])
def test_factors_beside_ies2rad(tmp_path, first):
    """Multiplier × ballast, and the second factor for old files only; -m scales on top."""
    rows = "\n".join(" ".join(str(10 * i + j + 1) for j in range(4)) for i in range(5))
    path = tmp_path / "old.ies"
    path.write_text(
        f"{first}\n[TEST] 1\nTILT=NONE\n1 1000 2.5 4 5 1 2 0.1 0.1 0\n0.9 0.8 50\n"
        f"0 30 60 90\n0 90 180 270 360\n{rows}\n"
    )
    lamp = read_photometry(path)
    directions = goniometry.directions_of(lamp, *directions_within(lamp))
    theirs = radiance_candela(path, directions, multiplier=2)
    ours = goniometry.candela(lamp, directions)
    assert 2 * ours == pytest.approx(theirs, abs=5e-4 * goniometry.maximum_cd(lamp))


@settings(max_examples=30)
@given(st.floats(0, 360), st.floats(0, 180))
def test_no_direction_breaks_it(h, v):
    lamp = cosine_lamp()
    value = goniometry.candela(lamp, goniometry.directions_of(lamp, h, v))
    assert value == pytest.approx(max(np.cos(np.radians(v)), 0), abs=1e-5)
