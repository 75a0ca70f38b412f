"""Curves of surfaces: known ones come back through texture, noise and clipping; refusals."""

import json
import tomllib

import numpy as np
import pytest

from andon.calibrate.surface import KnownLight, fit_surface
from andon.calibrate.surface.figure import surface_figure
from andon.calibrate.surface.monotone import isotonic, smooth_between, strictly_rising
from andon.errors import InputError
from andon.files.pictures import read_picture, write_exr, write_png
from andon.files.responses import read_surface_response
from andon.responses import srgb_encode
from andon.scene.surface import SurfaceResponse
from cli.command import run_andon, run_refused

SHAPE = (48, 64)
LEVELS = (40, 90, 160, 250, 360, 490, 640, 810, 1000)
TINT = np.array([1.0, 0.8, 0.6])
CURVES = {
    "linear": lambda lux: 0.9e-3 * lux,
    "gamma": lambda lux: 0.9 * (lux / 1000) ** 0.5,
    "s": lambda lux: 0.9 * (lux / 1000) ** 2 * (3 - 2 * lux / 1000),
}


def texture(seed=1):
    noise = np.random.default_rng(seed).standard_normal((*SHAPE, 1))
    return np.clip(0.5 + 0.15 * noise, 0.1, 0.9) * TINT


def shot(curve, lux, noise=0.003, seed=0):
    """A photograph in `lux`, a number or a map, of the textured surface."""
    generator = np.random.default_rng(int(np.mean(lux)) + seed)
    linear = texture() * curve(np.asarray(lux, float)) + generator.normal(0, noise, (*SHAPE, 3))
    known = np.asarray(lux, float) if np.ndim(lux) else np.full(3, float(lux))
    return KnownLight(f"{np.mean(lux):.0f}", linear.astype(np.float32), linear > 0.98, known)


def shaded(lux, turn):
    """Light that falls off over the view, differently in each photograph."""
    across = np.linspace(0, 3, SHAPE[1]) + turn
    return np.broadcast_to((lux * (0.6 + 0.4 * np.cos(across)))[None, :, None], (*SHAPE, 3))


def error_of(fit, curve):
    """Largest, as a share of the range, between 40 lx and what the photographs reach."""
    lux = np.linspace(40, fit.curve.illuminance_lux[-1], 100)
    truth = curve(lux)[:, None] * texture().mean(axis=(0, 1))
    found = fit.curve.linear_of(np.repeat(lux[:, None], 3, axis=1))
    return (np.abs(found - truth).max(axis=0) / truth.max(axis=0)).max()


@pytest.mark.parametrize("name", CURVES)
def test_known_curves_come_back(name):
    fit = fit_surface([shot(CURVES[name], lux) for lux in LEVELS])
    assert error_of(fit, CURVES[name]) < 0.015
    assert fit.zero_assumed
    assert (fit.curve.linear[0] == 0).all()
    assert (np.diff(fit.curve.linear, axis=0) > 0).all()
    np.testing.assert_allclose(fit.texture.mean(axis=0), 1.0)
    known = texture().reshape(-1, 3) / texture().mean(axis=(0, 1))
    assert np.corrcoef(fit.texture[:, 1], known[:, 1])[0, 1] > 0.99


@pytest.mark.parametrize("name", CURVES)
def test_known_curves_come_back_from_maps(name):
    shots = [shot(CURVES[name], shaded(lux, turn)) for turn, lux in enumerate((150, 400, 700, 990))]
    assert error_of(fit_surface(shots), CURVES[name]) < 0.02


def test_a_linear_surface_comes_out_linear():
    fit = fit_surface([shot(CURVES["linear"], lux) for lux in LEVELS])
    np.testing.assert_allclose(fit.exponent, 1.0, atol=0.01)
    assert fit.straightness.max() < 0.005
    exact = fit_surface([shot(CURVES["linear"], lux, noise=0) for lux in (100, 900)])
    assert error_of(exact, CURVES["linear"]) < 1e-6
    assert exact.rms_relative.max() < 1e-5
    np.testing.assert_allclose(
        fit_surface([shot(CURVES["gamma"], lux) for lux in LEVELS]).exponent, 0.5, atol=0.01
    )


def test_what_moves_shines_or_is_clipped_has_no_weight():
    clean = fit_surface([shot(CURVES["linear"], lux) for lux in LEVELS])
    assert clean.clipped_share == 0
    shots = [shot(lambda lux: 1.6e-3 * lux, lux) for lux in LEVELS]
    for s in shots:
        s.linear[...] = np.minimum(s.linear, 0.98)
        s.linear[:6, :9] += 0.1 * (s.name == "250")
    fit = fit_surface([KnownLight(s.name, s.linear, s.linear >= 0.98, s.illuminance_lux)
                       for s in shots])  # fmt: skip
    assert fit.clipped_share > 0.01
    assert fit.outlier_share > 0.001
    assert error_of(fit, lambda lux: 1.6e-3 * lux) < 0.015
    assert fit.straightness.max() < 0.01


def test_a_surface_is_what_its_mask_selects():
    wall = np.zeros(SHAPE, bool)
    wall[:, 32:] = True
    shots = []
    for lux in LEVELS:
        a, b = shot(CURVES["gamma"], lux), shot(CURVES["linear"], lux)
        linear = np.where(wall[..., None], a.linear, b.linear)
        shots.append(KnownLight(a.name, linear, linear > 0.98, a.illuminance_lux))
    exponents = [fit_surface(shots, m, name="x").exponent.mean() for m in (wall, ~wall)]
    np.testing.assert_allclose(exponents, [0.5, 1.0], atol=0.02)


def test_a_dark_photograph_says_what_no_light_gives():
    shots = [shot(lambda lux: 0.05 + 8e-4 * lux, lux) for lux in (0, 100, 400, 900)]
    fit = fit_surface(shots)
    assert not fit.zero_assumed
    start = fit.curve.linear[0] / fit.curve.linear[-1]
    np.testing.assert_allclose(start, 0.05 / 0.77, rtol=0.05)


def test_noise_that_falls_is_levelled_and_counted():
    levels = (100, 101.5, 103, 400)
    shots = [shot(CURVES["linear"], lux, noise=0.02) for lux in levels]
    shots[1].linear[...] *= 1.02
    fit = fit_surface(shots)
    assert 0 < fit.fall_share < 0.02
    assert (np.diff(fit.curve.linear, axis=0) > 0).all()


def of(*levels, curve=CURVES["linear"]):
    return [shot(curve, lux) for lux in levels]


def everywhere_white(lux):
    s = shot(CURVES["linear"], lux)
    return KnownLight(s.name, s.linear, np.ones((*SHAPE, 3), bool), s.illuminance_lux)


def small(lux):
    s = shot(CURVES["linear"], lux)
    return KnownLight("small.png", s.linear[:9], s.clipped[:9], s.illuminance_lux)


REFUSED = [
    ([], None, "are missing"),
    ([*of(100), small(300)], None, r"small\.png: is 64×9 px but 100 is 64×48"),
    (of(100, 300), np.zeros(SHAPE, bool), "selects no pixel of 'wall'"),
    (of(100, 300), np.ones((3, 4), bool), r"mask of 'wall': is 4×3 px"),
    ([everywhere_white(100), everywhere_white(300)], None, "100% of the red values of 'wall' are"),
    ([*of(100), everywhere_white(300)], None, "no pixel is left that 2 photographs show"),
    (of(200, 200), None, "about one illuminance, 200 to 200 lx"),
    (of(0, 0), None, "about one illuminance, 0 to 0 lx"),
    (of(100, 200, 300, curve=lambda lux: 1e-3 * (400 - lux)), None,
     r"red of 'wall' is darker in more light: 0\.\d+ in 300 lx against 0\.\d+ in 100 lx"),
]  # fmt: skip


@pytest.mark.parametrize(("shots", "mask", "words"), REFUSED)
def test_what_says_nothing_of_a_curve_is_refused(shots, mask, words):
    with pytest.raises(InputError, match=words):
        fit_surface(shots, mask, name="wall")


def test_isotonic_regression():
    values, blocks = isotonic(np.array([1.0, 3.0, 2.0, 4.0, 0.0]), np.array([1.0, 1, 1, 1, 2]))
    np.testing.assert_allclose(values, [1.0, 1.8, 1.8, 1.8, 1.8])
    assert blocks.tolist() == [0, 1, 1, 1, 1]
    rng = np.random.default_rng(3)
    noisy, weights = rng.standard_normal(40) + np.linspace(0, 3, 40), rng.uniform(0.2, 2, 40)
    fitted, _ = isotonic(noisy, weights)
    assert (np.diff(fitted) >= 0).all()
    # Of a least-squares fit on a cone: no rising sequence is nearer, and the residual is normal.
    assert (weights * (noisy - fitted)) @ fitted == pytest.approx(0, abs=1e-9)
    for _ in range(50):
        other = np.sort(fitted + rng.normal(0, 0.1, 40))
        assert weights @ (noisy - other) ** 2 >= weights @ (noisy - fitted) ** 2


def test_strictly_rising_keeps_what_rises():
    x, y = np.array([0.0, 1, 2, 4]), np.array([0.0, 2, 3, 9])
    np.testing.assert_allclose(strictly_rising(x, y, np.ones(4)), y, atol=1e-4)
    assert (np.diff(strictly_rising(x, np.array([0.0, 2, 1, 1]), np.ones(4))) > 0).all()
    assert (np.diff(strictly_rising(x, -y, np.ones(4))) > 0).all()


def test_smooth_curves_rise_and_keep_lines_straight():
    x = np.array([0.0, 1, 3, 4, 10])
    places, values = smooth_between(x, 2 * x, 4)
    np.testing.assert_allclose(values, 2 * places, atol=1e-12)
    assert len(places) == 17
    steep = np.array([0.0, 0.01, 5, 5.01, 20])
    places, values = smooth_between(x, steep, 8)
    assert (np.diff(values) > 0).all()
    np.testing.assert_allclose(values[::8], steep)
    knots = np.linspace(0, 1, 7)
    places, values = smooth_between(knots, knots**2, 4)
    assert (
        np.abs(values - places**2).max()
        < 0.3 * np.abs(np.interp(places, knots, knots**2) - places**2).max()
    )


def test_the_figure_shows_curves_and_residuals():
    picture = surface_figure(fit_surface(of(*LEVELS), name="wall"))
    assert picture.shape == (520 + 340, 1200, 3)
    assert (np.abs(picture.astype(int) - (190, 40, 30)).max(axis=-1) < 30).sum() > 1000


@pytest.fixture
def folder(tmp_path, monkeypatch):
    for lux in (60, 200, 500, 900):
        linear = np.clip(shot(CURVES["gamma"], lux).linear, 0, 1)
        write_png(tmp_path / f"{lux}.png", (srgb_encode(linear) * 255 + 0.5).astype(np.uint8))
    mask = np.zeros((*SHAPE, 3), np.uint8)
    mask[:, 20:] = 255
    write_png(tmp_path / "wall.png", mask)
    write_png(tmp_path / "none.png", mask * 0)
    write_exr(tmp_path / "lux.exr", np.full((*SHAPE, 3), 60, np.float32), unit="lx")
    write_exr(tmp_path / "cd.exr", np.full((*SHAPE, 3), 60, np.float32), unit="cd/m2")
    monkeypatch.chdir(tmp_path)
    return tmp_path


TYPED = ["60.png=lux.exr", "200.png=200", "500.png=500,500,500", "900.png=900"]


def test_the_command_writes_what_a_scene_names(capfd, folder):
    words = ["calibrate", "surface", *TYPED, "-o", "made", "--mask", "wall=wall.png"]
    outcome = run_andon(capfd, *words)
    assert outcome.code == 0, outcome.err
    assert outcome.out == "made\n"
    assert "60.png is taken for sRGB" in outcome.err
    assert "exponent 0.5" in outcome.err
    curve = read_surface_response(folder / "made/wall.csv")
    truth = 0.9 * 0.35**0.5 * texture()[:, 20:].mean(axis=(0, 1))
    np.testing.assert_allclose(curve.linear_of(np.full((1, 3), 350.0))[0], truth, rtol=0.02)
    (table,) = tomllib.loads((folder / "made/surface_response.toml").read_text())["surface"][
        "response"
    ]
    stated = SurfaceResponse(**table)
    assert (stated.material, stated.mask, stated.file) == ("wall", "wall.png", "made/wall.csv")
    facts = json.loads((folder / "made/fit.json").read_text())["surfaces"]["wall"]
    assert facts["exponent"] == pytest.approx([0.5] * 3, abs=0.02)
    assert list(facts["photographs"]) == ["60.png", "200.png", "500.png", "900.png"]
    assert read_picture("made/wall.png").shape == (860, 1200)
    assert run_andon(capfd, *words[:6], "-o", "whole", "--response", "gamma:2.2").code == 0
    assert (folder / "whole/all.csv").is_file()


BAD = [
    (["200.png", "-o", "o"], "PHOTO=LUX: must be PHOTO=LUX, got '200.png'"),
    (["200.png=x", "-o", "o"], "illuminance must be one or three numbers"),
    (["200.png=-3", "-o", "o"], "illuminance must be one or three numbers"),
    (["200.png=1,2", "-o", "o"], "illuminance must be one or three numbers"),
    (["200.png=cd.exr", "-o", "o"], "must be illuminance in lx, is in 'cd/m2'"),
    (["gone.png=200", "-o", "o"], "gone.png: must exist"),
    ([*TYPED, "-o", "60.png"], "must be a folder"),
    ([*TYPED, "-o", "no/where"], "does not exist"),
    ([*TYPED, "-o", "o", "--mask", "wall.png"], "must be NAME=MASK.png"),
    ([*TYPED, "-o", "o", "--mask", "w=wall.png", "--mask", "w=none.png"], "names a surface twice"),
    ([*TYPED, "-o", "o", "--mask", "w=none.png"], "selects no pixel of 'w'"),
    ([*TYPED, "-o", "o", "--response", "log"], "must be a CSV file, srgb, linear or gamma:G"),
    ([*TYPED, "-o", "o", "--response", "gamma:-1"], "must be a CSV file, srgb, linear or gamma:G"),
    (["60.png=900", "900.png=60", "-o", "o"], "is darker in more light"),
    (["60.png=60", "-o", "o"], "about one illuminance"),
    ([*TYPED, "-o", ".", "--mask", "900=wall.png"], "would be overwritten"),
]


@pytest.mark.parametrize(("words", "rule"), BAD)
def test_refusals(capfd, folder, words, rule):
    assert rule in run_refused(capfd, folder, "calibrate", "surface", *words)
