"""Defocus on the GPU against the reference: pictures, points, rims, what moves, what is wrong."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.glass.defocus.reference import blurred
from andon.glass.defocus.stage import DefocusStage
from andon.gpu.textures import make_texture
from comparison import assert_agree
from defocus.pictures import disc_of_glass, natural, sheet, spread

HEIGHT, WIDTH = 190, 230
BALL = disc_of_glass(HEIGHT, WIDTH, 70)
WITHIN = (45, 25, 140, 140)
BEHIND = natural(HEIGHT, WIDTH, seed=9)
# Cross-engine tolerance: 99.9 % of the pixels within 5/255, 0.5/255 in the mean.
CODE, SHARE, MEAN = 1 / 255, 1e-3, 0.5 / 255


def layers(refracted_px, surface_px, reflected_px, cover=BALL):
    shape = cover.shape
    alpha = 0.2 * (natural(*shape, seed=5)[..., 0] > 0.5)
    return sheet(
        cover,
        refracted=natural(*shape, seed=2),
        surface=alpha[..., None] * natural(*shape, seed=3),
        surface_alpha=alpha,
        reflected=0.1 * natural(*shape, seed=4),
        refracted_px=refracted_px,
        surface_px=surface_px,
        reflected_px=reflected_px,
    )


def textures(gpu, seen, behind):
    none = np.zeros(seen.coverage.shape)
    pictures = {
        "refracted": [seen.refracted, seen.refracted_px],
        "surface": [seen.surface, seen.surface_alpha],
        "reflected": [seen.reflected, seen.reflected_px],
        "sizes": [seen.coverage, seen.surface_px, none, none],
        "target": [behind, none + 0.25],
    }
    made = {}
    for name, parts in pictures.items():
        height, width = seen.coverage.shape
        made[name] = make_texture(gpu, "rgba16float", width, height)
        made[name].write(np.dstack(parts))
    return made


def extremes(seen):
    covered = seen.coverage > 0
    names = ("refracted_px", "surface_px", "reflected_px")
    values = [getattr(seen, name)[covered] for name in names]
    return tuple(float(v.max()) for v in values), tuple(float(v.min()) for v in values)


def drawn(gpu, stage, made, within=None, largest=None, smallest=(0.0, 0.0, 0.0)):
    encoder = gpu.device.create_command_encoder()
    stage.encode(encoder, within, largest or (64.0, 64.0, 64.0), smallest)
    gpu.device.queue.submit([encoder.finish()])
    after = made["target"].read().astype(np.float64)
    assert (after[..., 3] == 0.25).all()
    return after[..., :3]


def by_gpu(gpu, seen, kind="optical", behind=BEHIND, within=WITHIN):
    made = textures(gpu, seen, behind)
    height, width = seen.coverage.shape
    stage = DefocusStage(gpu, **made, kind=kind, size=(width, height))
    return drawn(gpu, stage, made, within, *extremes(seen))


def assert_same_to_the_eye(actual, expected):
    assert_agree(actual.mean(), expected.mean(), atol=MEAN)
    difference = np.abs(actual - expected)
    assert np.isfinite(actual).all()
    assert difference.mean() <= MEAN
    assert (difference.max(axis=-1) > 5 * CODE).mean() <= SHARE


# ── pictures ────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    "diameters",
    [(3, 3, 3), (10, 10, 10), (30, 30, 30), (60, 60, 60), (0, 30, 20), (20, 0, 10), (10, 40, 0)],
)
def test_constant_discs(gpu, diameters):
    seen = layers(*map(float, diameters))
    assert_same_to_the_eye(by_gpu(gpu, seen), blurred(seen).over(BEHIND))


@pytest.mark.parametrize("diameters", [(3, 3, 3), (30, 30, 30), (60, 60, 60), (0, 40, 24)])
def test_constant_gaussians(gpu, diameters):
    seen = layers(*map(float, diameters))
    assert_same_to_the_eye(by_gpu(gpu, seen, "gaussian"), blurred(seen, "gaussian").over(BEHIND))


@pytest.mark.parametrize("kind", ["optical", "gaussian"])
def test_discs_that_vary(gpu, kind):
    """Through every level and what lies between, slowly, as over a ball."""
    across = np.linspace(0, 1, WIDTH)[None, :] * np.ones((HEIGHT, 1))
    down = np.linspace(0, 1, HEIGHT)[:, None] * np.ones((1, WIDTH))
    seen = layers(5 + 40 * across**2, 3 + 20 * down, 50 * (1 - down))
    assert_same_to_the_eye(by_gpu(gpu, seen, kind), blurred(seen, kind).over(BEHIND))


def test_the_papers_mode(gpu):
    seen = layers(30.0, 16.0, 40.0)
    assert_same_to_the_eye(by_gpu(gpu, seen, "paper"), blurred(seen, "paper").over(BEHIND))


@pytest.mark.parametrize("kind", ["off", "optical", "gaussian", "paper"])
def test_in_focus_nothing_changes(gpu, kind):
    """But for what half floats hold."""
    seen = layers(0.9, 0.0, 0.4)
    assert_agree(by_gpu(gpu, seen, kind), seen.over(BEHIND), atol=2e-3)
    outside = BALL == 0
    half = BEHIND.astype(np.float16).astype(np.float64)
    assert (by_gpu(gpu, seen, kind)[outside] == half[outside]).all()


# ── points ──────────────────────────────────────────────────────────────────────────────────────


def point_layers(row, column, diameter, name, grey=0.0):
    light = np.zeros((HEIGHT, WIDTH, 3))
    light[row, column] = 400
    parts = {"refracted": grey, f"{name}_px": diameter}
    return sheet(np.ones((HEIGHT, WIDTH)), **parts | {name: light + parts.get(name, 0.0)})


@pytest.mark.parametrize("name", ["refracted", "surface", "reflected"])
@pytest.mark.parametrize("diameter", [2.0, 4.1, 8.0, 16.5, 30.0, 60.0])
def test_points_spread_by_a_sixteenth_of_the_square(gpu, diameter, name):
    """On grey, so that what sharpening takes away beside the disc is not cut at 0."""
    for row, column in ((95, 115), (90, 112), (97, 118)):
        grey = 0.2 * 400 * 4 / np.pi / diameter**2 if diameter > 5 else 0.0
        seen = point_layers(row, column, diameter, name, grey)
        image = by_gpu(gpu, seen, within=None)[..., 1] - seen.refracted[0, 0, 1]
        # Half floats err by a share of the grey everywhere.
        away = np.hypot(*(np.mgrid[:HEIGHT, :WIDTH] - np.array([row, column])[:, None, None]))
        image = np.where(away < diameter + 10, image, 0)
        total, centre, (yy, xx, xy) = spread(image)
        assert total == pytest.approx(400, rel=0.02)
        assert centre == pytest.approx((row, column), abs=0.1)
        assert [yy, xx] == pytest.approx([diameter**2 / 16] * 2, rel=0.03)
        assert abs(xy) < 0.03 * diameter**2 / 16


@pytest.mark.parametrize("diameter", [8.0, 24.0, 60.0])
def test_points_are_round_and_flat(gpu, diameter):
    """A disc on two or three texels' rim: no square, no ring that is seen."""
    seen = point_layers(95, 115, diameter, "reflected")
    image = by_gpu(gpu, seen, within=None)[..., 0] * np.pi * diameter**2 / 4 / 400
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    away = np.hypot(rows - 95, columns - 115) / diameter
    assert np.abs(image[away < 0.25] - 1).max() < 0.3
    assert image[away > 0.8].max() < 0.02
    dy, dx = rows - 95, columns - 115
    fourth, crossed = (image * (dy**4 + dx**4)).sum() / 2, (image * dy**2 * dx**2).sum()
    assert fourth / crossed == pytest.approx(3, rel=0.1)


# ── rims, frames, faults ────────────────────────────────────────────────────────────────────────


def test_a_constant_has_no_rim(gpu):
    seen = sheet(BALL, refracted=0.7, refracted_px=17.0, surface_px=30.0)
    behind = np.full((HEIGHT, WIDTH, 3), 0.7)
    assert_agree(by_gpu(gpu, seen, behind=behind), behind, atol=3e-3)


def test_glass_at_the_border_of_the_picture(gpu):
    cover = np.roll(BALL, (60, 90), (0, 1))
    cover[:50], cover[:, :50] = 0, 0
    seen = layers(25.0, 14.0, 33.0, cover)
    actual = by_gpu(gpu, seen, within=(50, 50, 180, 140))
    expected = blurred(seen).over(BEHIND)
    # What lies beyond is unknown: the reference repeats the last pixel, a level its last texel.
    known = np.s_[:-16, :-16]
    assert_same_to_the_eye(actual[known], expected[known])
    assert np.abs(actual - expected).mean() <= MEAN


def test_frame_after_frame_nothing_is_left_behind(gpu):
    """One stage, glass that moves: each frame as if it were the first."""
    first, second = layers(30.0, 20.0, 9.0), layers(12.0, 40.0, 50.0, np.roll(BALL, 40, 1))
    made = textures(gpu, first, BEHIND)
    stage = DefocusStage(gpu, **made, kind="optical", size=(WIDTH, HEIGHT))
    for seen, within in ((first, WITHIN), (second, (85, 25, 140, 140)), (first, WITHIN)):
        for name, texture in textures(gpu, seen, BEHIND).items():
            made[name].write(texture.read())
        after = drawn(gpu, stage, made, within, *extremes(seen))
        assert (after == by_gpu(gpu, seen, within=within)).all()


def test_the_rectangle_saves_work_only(gpu):
    seen = layers(30.0, 20.0, 9.0)
    assert_agree(by_gpu(gpu, seen), by_gpu(gpu, seen, within=None), atol=2e-3)


def test_what_is_known_of_the_discs_saves_work_only(gpu):
    seen = layers(40.0, 15.0, 50.0)
    made = textures(gpu, seen, BEHIND)
    stage = DefocusStage(gpu, **made, kind="optical", size=(WIDTH, HEIGHT))
    assert_agree(drawn(gpu, stage, made, WITHIN), by_gpu(gpu, seen), atol=4e-3)


@pytest.mark.parametrize("within", [(10, 10, 0, 5), (-90, 3, 9, 9), (400, 0, 4, 4)])
def test_nowhere(gpu, within):
    half = BEHIND.astype(np.float16).astype(np.float64)
    seen = sheet(np.zeros((HEIGHT, WIDTH)))
    made = textures(gpu, seen, BEHIND)
    stage = DefocusStage(gpu, **made, kind="optical", size=(WIDTH, HEIGHT))
    assert (drawn(gpu, stage, made, within, (9.0, 9.0, 9.0)) == half).all()


def test_no_glass_within(gpu):
    seen = sheet(np.zeros((HEIGHT, WIDTH)))
    made = textures(gpu, seen, BEHIND)
    stage = DefocusStage(gpu, **made, kind="optical", size=(WIDTH, HEIGHT))
    assert_agree(drawn(gpu, stage, made, WITHIN), BEHIND, atol=1e-3)


@pytest.mark.parametrize("wrong", ["refracted", "surface", "reflected", "sizes", "target"])
def test_textures_have_one_size(gpu, wrong):
    made = textures(gpu, sheet(np.zeros((9, 7))), np.zeros((9, 7, 3)))
    made[wrong] = make_texture(gpu, "rgba16float", 9, 7)
    with pytest.raises(InputError, match=rf"defocus\.{wrong}: must be 7×9 rgba16float, got 9×7"):
        DefocusStage(gpu, **made, kind="optical", size=(7, 9))
