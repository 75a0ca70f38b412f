"""Photometric stereo on a computed ball, and real photographs predicted from one another."""

import runpy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from andon.errors import InputError
from andon.verify import relit_scores
from andon.verify.photometric_stereo import photometric_stereo
from andon.verify.psnr import psnr_db
from andon.verify.registry import NotShown
from andon.verify.relit_photographs import (
    LIGHT_LUX,
    Photographs,
    known_without,
    photographs,
    write_pair,
)
from andon.verify.relit_scores import (
    METHODS,
    Pair,
    best_gain,
    predictions,
    relit,
    score,
    unlit,
)

ROOT = Path(__file__).resolve().parents[2]
TINT = np.array([0.9, 0.7, 0.5])


def towards(*degrees):
    """Unit vectors, each tilted from z by the first angle towards the second."""
    tilt, turn = np.radians(degrees).T
    return np.stack([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)], 1)


LIGHTS = towards((0, 0), *((35, turn) for turn in range(0, 360, 40)))
STRENGTHS = np.array([1, 1.1, 0.9, 1, 1.05, 0.95, 1, 1, 1.02, 0.98])


def ball(size=41):
    """Normals (n, 3) of a ball seen from +z, its rim left out; the mask (size, size)."""
    y, x = np.mgrid[1 : -1 : size * 1j, -1 : 1 : size * 1j]
    mask = np.hypot(x, y) < 0.9
    x, y = x[mask], y[mask]
    return np.stack([x, y, np.sqrt(1 - x**2 - y**2)], axis=1), mask


def shown(normals, lights=LIGHTS, strengths=STRENGTHS):
    """(k, n, 3) of a matte thing whose ρ is a texture, and that ρ (n, 3)."""
    reflectance = (0.5 + 0.3 * np.sin(9 * normals[:, :1])) * TINT
    lux = strengths[:, None] * np.maximum(lights @ normals.T, 0)
    return lux[..., None] * reflectance, reflectance


def degrees_between(a, b):
    return np.degrees(2 * np.arcsin(np.clip(np.linalg.norm(a - b, axis=1) / 2, 0, 1)))


def test_a_matte_ball_is_recovered():
    normals, _ = ball()
    values, reflectance = shown(normals)
    found = photometric_stereo(values, LIGHTS, strengths=STRENGTHS)
    assert found.is_known.all()
    # The ridge alone keeps it from being exact.
    assert degrees_between(found.normals, normals).max() < 1e-3
    np.testing.assert_allclose(found.strengths, STRENGTHS, rtol=1e-5)
    np.testing.assert_allclose(found.reflectance, reflectance, rtol=1e-5)


def test_strengths_are_seen_by_normals_that_took_them_for_equal():
    normals, _ = ball()
    found = photometric_stereo(shown(normals)[0], LIGHTS)
    np.testing.assert_allclose(found.strengths, STRENGTHS, atol=0.02)
    assert np.median(degrees_between(found.normals, normals)) < 1.5


def test_normals_turn_with_the_lights():
    normals, _ = ball()
    turn = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
    values, _ = shown(normals)
    found = photometric_stereo(values, LIGHTS @ turn.T, strengths=STRENGTHS)
    assert degrees_between(found.normals, normals @ turn.T).max() < 1e-3


def test_cast_shadows_and_highlights_are_left_out():
    normals, _ = ball()
    values, _ = shown(normals)
    left = normals[:, 0] < 0
    values[2][left] *= 0.02
    values[6][~left] += 0.25
    found = photometric_stereo(values, LIGHTS, strengths=STRENGTHS)
    plain = np.linalg.lstsq(STRENGTHS[:, None] * LIGHTS, values.mean(axis=2), rcond=None)[0].T
    plain /= np.linalg.norm(plain, axis=1, keepdims=True)
    robust = degrees_between(found.normals, normals)
    assert np.median(degrees_between(plain, normals)) > 3
    assert np.median(robust) < 0.3
    assert np.percentile(robust, 95) < 1
    lit = LIGHTS @ normals.T > 0.2
    assert found.weights[2][left & lit[2]].max() < 0.01
    assert found.weights[6][~left & lit[6]].mean() < 0.05


def test_a_pixel_that_two_lights_reach_is_not_known():
    values, _ = shown(np.array([[0, 0, 1.0]]))
    values[2:] = 0
    assert not photometric_stereo(values, LIGHTS).is_known[0]


@pytest.mark.parametrize("lights", [LIGHTS[:2], towards((30, 0), (10, 0), (20, 180), (40, 0))])
def test_lights_in_a_plane_are_refused(lights):
    with pytest.raises(InputError, match=r"directions.*span space"):
        photometric_stereo(np.full((len(lights), 4, 3), 0.5), lights)


def test_psnr_and_gain_by_hand():
    assert psnr_db(np.full(4, 100.0), np.full(4, 125.5), peak=255) == pytest.approx(20)
    codes = np.array([250, 0], np.uint8)
    assert psnr_db(codes, codes[::-1], peak=255) == pytest.approx(-20 * np.log10(250 / 255))
    # (1·3 + 2·2)/(1 + 4)
    assert best_gain(np.array([1, 2]), np.array([3, 2])) == pytest.approx(1.4)


def test_dB_over_a_baseline():
    scores = dict.fromkeys(METHODS, 20.0) | {"relit": 31.0, "gain": 24.0}
    pair = Pair(0, 1, scores, scores | {"relit": 33.0}, 0.1)
    assert pair.over("gain") == 7
    assert pair.over("gain", lit_only=True) == 9
    assert pair.over("unchanged", "gain") == 4


def computed(seed=None):
    """A ball as ten 8-bit photographs of what they would show, in little light from elsewhere."""
    normals, mask = ball()
    values, reflectance = shown(normals, strengths=np.ones(len(LIGHTS)))
    codes = np.zeros((len(LIGHTS), *mask.shape, 3), np.uint8)
    codes[:, mask] = np.rint(np.clip(values + 0.01 * reflectance, 0, 1) * 255)
    if seed is not None:
        codes = np.random.default_rng(seed).integers(0, 256, codes.shape, np.uint8)
    return Photographs("ball", codes, mask, LIGHTS)


def test_a_computed_ball_is_predicted_to_some_codes(tmp_path):
    shots = computed()
    known = known_without(shots, 3)
    assert known.lux[3] == LIGHT_LUX
    predicted = predictions(tmp_path, shots, known, 7, "reference")
    pair = score(shots, known, 7, predicted)
    assert tuple(pair.psnr_db) == METHODS
    assert pair.psnr_db["relit"] > 36
    assert pair.psnr_db["gain"] < 25
    assert pair.unlit_share == pytest.approx(unlit(shots, known, 7).mean())


def test_the_target_is_never_looked_at(tmp_path):
    shots, noise = computed(), computed(seed=5)
    codes = shots.codes.copy()
    codes[3] = noise.codes[3]
    other = replace(shots, codes=codes)
    pictures = [
        predictions(tmp_path / str(k), own, known_without(own, 3), 7, "reference")
        for k, own in enumerate((shots, other))
    ]
    for method in ("unchanged", "ratio", "relit", "lambert"):
        np.testing.assert_array_equal(pictures[0][method], pictures[1][method])
    assert (pictures[0]["gain"] != pictures[1]["gain"]).any()


def test_a_light_in_its_own_place_changes_nothing(tmp_path):
    shots = computed()
    directions = LIGHTS.copy()
    directions[3] = directions[7]
    known = known_without(replace(shots, directions=directions), 3)
    known.lux[3] = known.lux[7]
    scene = write_pair(tmp_path, replace(shots, directions=directions), known, 7)
    np.testing.assert_array_equal(relit(scene, "reference"), shots.codes[7])


def thinned(shots, step):
    return replace(
        shots,
        codes=shots.codes[:, ::step, ::step],
        mask=shots.mask[::step, ::step],
    )


@pytest.mark.parametrize(("name", "bar"), [("sphere", 7), ("cat", 3)])
def test_real_photographs(name, bar, data_dir, monkeypatch, tmp_path, engine):
    monkeypatch.setenv("ANDON_DATA", str(data_dir))
    shots = thinned(photographs(name), 6)
    over = []
    for target in (0, 5, 8):
        known = known_without(shots, target)
        assert known.unknown_share < 0.05
        for source in (1, 7):
            predicted = predictions(tmp_path / str(target), shots, known, source, engine)
            over.append(score(shots, known, source, predicted).over("gain"))
    assert np.median(over) > bar


def test_missing_photographs_are_not_shown(monkeypatch, tmp_path):
    monkeypatch.setenv("ANDON_DATA", str(tmp_path))
    with pytest.raises(NotShown, match=r"gray\.0\.png is missing"):
        photographs("sphere")
    monkeypatch.delenv("ANDON_DATA")
    with pytest.raises(NotShown, match="ANDON_DATA is not set"):
        relit_scores.pairs_of.__wrapped__("sphere")


def test_the_table_has_a_colour_for_each_pair():
    figures = runpy.run_path(str(ROOT / "examples" / "photometric_stereo" / "figures.py"))
    pairs = [
        Pair(i, j, dict.fromkeys(METHODS, 20.0) | {"relit": 20.0 + 15 * (i < j)}, {}, 0.0)
        for i in range(3)
        for j in range(3)
        if i != j
    ]
    picture = figures["table"]("ball", pairs)

    def colour(row, column):
        x, y = figures["_middle"](column, row)
        return picture[int(y) - 17, int(x)].tolist()

    assert colour(0, 1) == colour(1, 2) == list(figures["_viridis"](0.75))
    assert colour(1, 0) == list(figures["_viridis"](0.0))
    assert colour(1, 1) == list(figures["EMPTY"])
