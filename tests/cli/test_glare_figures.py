"""`andon glare figures`: what the pictures show, and refusals of one line."""

from itertools import pairwise

import numpy as np
import pytest

from andon.cli.figures.model import Asked
from andon.cli.figures.sheet import SHEET_PX
from andon.cli.figures.sources import BLOOM_HFOV, NEEDLE_HFOV
from andon.cli.figures.steps import seen_in_steps
from andon.display.eye_response import cone_response, printed
from andon.files.pictures import read_picture, write_exr
from andon.spaces import pinhole_view

from .command import run_andon, run_refused

WIDTH = 96
# A narrow view of a lamp in a dark street, as figure 7 has it.
HFOV = 10.0


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def read(path):
    return read_picture(path).values.astype(float)


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    """Figures 4 to 6 of one run: a folder."""
    from andon.cli.figures.run import run
    from andon.cli.glare_figures import FiguresOptions

    folder = tmp_path_factory.mktemp("figures")
    run(FiguresOptions(folder, figures="4,5,6", width=WIDTH, engine="reference"))
    return folder


def lamp_view(width=240):
    return pinhole_view(width, width, width / 2 / np.tan(np.radians(HFOV / 2)))


@pytest.fixture(scope="module")
def lamp():
    """A lamp of 0.3° and 25,000 cd/m² before 0.5 cd/m², step by step, and the angles from it."""
    view = lamp_view()
    theta = np.degrees(np.arccos(np.clip(view.directions()[..., 2], -1, 1)))
    light = np.where(theta < 0.15, 25_000.0, 0.5)[..., None] * np.ones(3)
    asked = Asked(view.width, "reference", glasses="spectacles", glasses_dioptres=-4.0)
    return seen_in_steps(light, view, asked, lambda: None), theta, view


def ring_radius(colour, theta):
    """Angle at which a channel of the ring is brightest."""
    bins = np.linspace(2, 4, 41)
    which = np.digitize(theta, bins)
    means = [colour[which == i].mean() for i in range(1, len(bins))]
    return (bins[:-1] + 0.025)[int(np.argmax(means))]


def test_files_and_sheet(sources):
    names = {path.name for path in sources.iterdir()}
    assert names == {
        "4-point.png",
        "4-ellipse.png",
        "5-circle.png",
        "5-ellipse.png",
        "5-tube.png",
        "6-needle-model.png",
        "figure-4.png",
        "figure-5.png",
        "glare-figures.png",
    }
    assert read(sources / "4-point.png").shape == (72, WIDTH, 3)
    assert read(sources / "glare-figures.png").shape[1] == SHEET_PX


def test_bloom_falls_with_the_angle_and_is_round(sources):
    picture = read(sources / "4-point.png").mean(axis=-1)
    rows, columns = np.mgrid[: picture.shape[0], : picture.shape[1]]
    away = np.hypot(rows - 35.5, columns - 47.5) * BLOOM_HFOV / WIDTH
    means = [picture[np.abs(away - at) < 0.1].mean() for at in (0.2, 0.5, 1, 2, 3, 4)]
    assert all(a > b + 5 for a, b in pairwise(means))
    ring = picture[np.abs(away - 2) < 0.07]
    assert ring.std() < 0.06 * ring.mean()
    assert picture.max() < 255.5
    assert means[-1] > 1


def test_an_ellipse_has_an_elliptic_bloom(sources):
    picture = read(sources / "4-ellipse.png").mean(axis=-1)
    per_degree = WIDTH / BLOOM_HFOV
    along, across = (
        picture[35, 47 + round(1.3 * per_degree)],
        picture[35 + round(1.3 * per_degree), 47],
    )
    assert along > 1.2 * across


def unevenness(picture, azimuths):
    """(n,) deviation of light from a smooth glow in sectors of 44° about azimuths in degrees."""
    rows, columns = np.mgrid[: picture.shape[0], : picture.shape[1]]
    x, y = columns - (picture.shape[1] - 1) / 2, rows - (picture.shape[0] - 1) / 2
    away = np.hypot(x, y) * NEEDLE_HFOV / picture.shape[1]
    turn = np.degrees(np.arctan2(y, x))
    found = []
    for azimuth in azimuths:
        off = np.abs((turn - azimuth + 180) % 360 - 180)
        within = (away > 1.5) & (away < 2.5) & (off < 22)
        terms = np.stack([away[within] ** 0, away[within], away[within] ** 2, off[within]], 1)
        glow = terms @ np.linalg.lstsq(terms, picture[within], rcond=None)[0]
        found.append((picture[within] - glow).std())
    return np.array(found)


@pytest.mark.parametrize(("name", "axis", "ratio"), [("5-ellipse", 0, 1.3), ("5-tube", -35, 2.5)])
def test_needles_of_long_sources_have_two_lobes(sources, name, axis, ratio):
    """On both sides along the axis, and few across."""
    picture = read(sources / f"{name}.png").mean(axis=-1)
    one, other, across, behind = unevenness(picture, (axis, axis + 180, axis + 90, axis - 90))
    assert min(one, other) > ratio * max(across, behind)


def test_needles_of_a_circle_are_everywhere(sources):
    found = unevenness(read(sources / "5-circle.png").mean(axis=-1), range(0, 360, 45))
    assert found.max() < 2.5 * found.min()
    assert found.min() > 3


def test_needles_lie_where_the_model_has_them():
    """Brighter on the strongest needles of the star than beside them."""
    from andon.cli.figures import sources as figure
    from andon.glare.needles import needles_of

    asked = Asked(160, "reference")
    (drawn,) = figure.draw_needles(asked, lambda: None)
    picture = drawn.panels[0].picture.astype(float).mean(axis=-1)
    source = figure._source(figure.circle(np.radians(0.25)))
    star = needles_of(source, asked.eye(figure.AMBIENT_CD_M2), figure.AMBIENT_CD_M2, 0)
    per_degree = 160 / NEEDLE_HFOV
    index = int(
        np.argmax(np.where(star.length_radians < np.radians(5), star.illuminance_lux[:, 1], 0))
    )
    azimuth = star.azimuth_radians[index]
    at = np.degrees(star.start_radians[index] + 0.4 * star.length_radians[index]) * per_degree

    def light(turn):
        x, y = at * np.cos(azimuth + turn) + 79.5, at * np.sin(azimuth + turn) + 59.5
        return picture[round(y), round(x)]

    beside = np.median([light(turn) for turn in np.linspace(-0.5, 0.5, 41)])
    assert light(0.0) > beside + 3


def test_halo_is_red_outside_and_blue_inside(lamp):
    """Spencer's radii: 3°·λ/568 nm beyond the outline, of 611, 549 and 467 nm."""
    steps, theta, _ = lamp
    _, bloomed, haloed, _ = steps.pictures
    ring = haloed - bloomed
    radii = [ring_radius(ring[..., channel], theta) for channel in range(3)]
    assert radii[0] > radii[1] > radii[2]
    np.testing.assert_allclose(radii, 0.15 + 3 * np.array([611, 549, 467]) / 568, atol=0.1)


def test_printed_halo_is_coloured(lamp):
    steps, theta, _ = lamp
    picture = steps.printed(2, finer=1, seed=0).astype(float)
    outside = picture[np.abs(theta - 3.4) < 0.05].mean(axis=0)
    inside = picture[np.abs(theta - 2.5) < 0.05].mean(axis=0)
    assert outside[0] > outside[2] + 20
    assert inside[2] > inside[0] + 20


def test_no_step_makes_light(lamp):
    """Bloom leaves the picture at its border, halo and needles here do not."""
    steps, _, view = lamp
    solid = view.solid_angles()[..., None]
    original, bloomed, haloed, needled = (float((light * solid).sum()) for light in steps.pictures)
    assert bloomed < original
    assert haloed == pytest.approx(bloomed, rel=0.01)
    assert needled == pytest.approx(haloed, rel=0.01)
    assert np.abs(steps.pictures[3] - steps.pictures[2]).max() > 1


def test_photograph(folder, capfd):
    view = lamp_view(120)
    theta = np.degrees(np.arccos(np.clip(view.directions()[..., 2], -1, 1)))
    light = np.where(theta < 0.3, 25_000.0, 0.5)[..., None] * np.ones(3, np.float32)
    write_exr(folder / "night.exr", light.astype(np.float32), unit="cd/m2", photometry="absolute")
    from andon.cli.figures.photograph import Photograph, draw_photograph

    photo = Photograph.read(folder / "night.exr", 60, hfov_degrees=HFOV)
    assert photo.view.width == 60
    assert photo.light_cd_m2.max() == pytest.approx(25_000, rel=1e-3)
    (figure,) = draw_photograph(photo, Asked(60, "reference"), lambda: None)
    original, bloom = (panel.picture.astype(float) for panel in figure.panels[:2])
    assert bloom[20, 30].mean() > original[20, 30].mean() + 20


def test_response_of_cones():
    assert cone_response(np.array([0.0, 3.0]), 3.0).tolist() == [0.0, 0.5]
    light = np.array([1e-3, 1.0, 1e3])
    low, middle, high = cone_response(light, 1.0)
    assert low == pytest.approx(1 - high)
    assert low < middle < high < 1


def test_printed_keeps_the_mean_of_what_is_less_than_a_step():
    """Codes of a slow gradient are dithered: their means follow it, and no run is long."""
    light = np.linspace(0.10, 0.101, 400)[None, :, None] * np.ones((400, 1, 3))
    codes = printed(light, 1.0)
    wanted = 255 * cone_response(light, 1.0)
    np.testing.assert_allclose(codes.mean(axis=0), wanted[0], atol=0.15)
    assert len(np.unique(codes[:, 0, 0])) == 2
    assert (codes[..., 0] == codes[..., 2]).all()


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("--figures", "3"), "--figures"),
        (("--width", "10"), "64…2048"),
        (("--age", "130"), "0…120"),
        (("--glasses", "reading"), "none, myopic, contact"),
        (("--seed", "-1"), "--seed"),
        (("--photo", "none.hdr"), "none.hdr"),
    ],
)
def test_refusals(words, expected, folder, capfd):
    line = run_refused(capfd, folder, "glare", "figures", "-o", "out", *words)
    assert expected in line


def test_command(folder, capfd):
    outcome = run_andon(capfd, "glare", "figures", "-o", "out", "--figures", "6", "--width", "64")
    assert outcome.code == 0, outcome.err
    assert outcome.out.strip().endswith("glare-figures.png")
    assert (folder / "out" / "6-needle-model.png").is_file()
