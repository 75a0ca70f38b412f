"""The whole picture's shaders against the reference: within 0.5 % of the veil."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.glare.kernel import Kernel
from andon.glare.whole_picture import reference, tables
from andon.glare.whole_picture.charts import block_directions
from andon.glare.whole_picture.plan import plan_whole
from andon.glare.whole_picture.stage import WholePictureStage
from andon.gpu.textures import make_texture
from andon.observer.spread.family import spread_function
from andon.spaces import View, pinhole_view
from comparison import assert_agree

KERNEL = Kernel(spread_function("cie135"))
# Of the veil, pixel by pixel; a few in a thousand may be off by three times as much, where steep.
SAME, SHARE = 5e-3, 2e-3
VIEWS = {
    "narrow": pinhole_view(161, 93, 456.0),
    "wide": pinhole_view(160, 120, 138.0),
    "very wide": pinhole_view(320, 180, 92.0),
    "fisheye": View("fisheye", 150, 140, 60.0, 55.0, 70.3, 74.5),
    "fisheye 200": View("fisheye", 240, 240, 68.0, 68.0, 119.5, 119.5),
    "latlong": View("latlong", 128, 64),
    "odd latlong": View("latlong", 101, 51),
}


def picture(shape, seed=0):
    """Dim noise and five bright pixels, as half floats hold them."""
    generator = np.random.default_rng(seed)
    made = generator.gamma(0.3, 0.3, (*shape, 3))
    for _ in range(5):
        made[generator.integers(shape[0]), generator.integers(shape[1])] = generator.uniform(
            100, 5000, 3
        )
    return made.astype(np.float16).astype(np.float64)


def texture(gpu, light, format="rgba16float", alpha=0.25):
    made = make_texture(gpu, format, light.shape[1], light.shape[0])
    made.write(np.dstack([light, np.full(light.shape[:2], alpha)]))
    return made


def run(gpu, record):
    encoder = gpu.device.create_command_encoder()
    record(encoder)
    gpu.device.queue.submit([encoder.finish()])


def by_gpu(gpu, light, plan, format="rgba16float", **options):
    """Picture and veil."""
    source = texture(gpu, light, format)
    target, alone = (texture(gpu, np.full(light.shape, 7.0)) for _ in range(2))
    stage = WholePictureStage(gpu, source, target, plan, **options)
    run(gpu, stage.encode)
    run(gpu, lambda encoder: stage.encode_glare(encoder, alone))
    seen = target.read().astype(np.float64)
    assert (seen[..., 3] == 0.25).all()
    return seen[..., :3], alone.read()[..., :3].astype(np.float64)


def assert_same_veil(actual, expected):
    assert_agree(actual, expected, rtol=SAME, share=SHARE, what="veil")
    assert_agree(actual, expected, rtol=3 * SAME, what="veil")
    difference = np.sqrt(((actual - expected) ** 2).sum() / (expected**2).sum())
    assert difference < SAME
    assert_agree(actual.sum(axis=(0, 1)), expected.sum(axis=(0, 1)), rtol=2e-3)


@pytest.mark.parametrize("name", VIEWS)
def test_pictures_agree(gpu, name):
    plan = plan_whole(VIEWS[name], KERNEL)
    light = picture(plan.view.shape)
    expected = reference.scattered(light, plan)
    seen, veil = by_gpu(gpu, light, plan)
    assert_same_veil(veil, expected.glare)
    assert_agree(seen, expected.picture, rtol=SAME, atol=1e-3)


@pytest.mark.parametrize("name", ["narrow", "fisheye", "odd latlong"])
def test_finite_pictures_agree(gpu, name):
    """Sampled rather than loaded, borders and corners too."""
    plan = plan_whole(VIEWS[name], KERNEL)
    light = picture(plan.view.shape)
    light[0, 0] = light[-1, -1] = light[1, -1] = light[40, 0] = 900
    expected = reference.scattered(light, plan)
    seen, veil = by_gpu(gpu, light, plan, finite=True)
    assert_same_veil(veil, expected.glare)
    assert_agree(seen, expected.picture, rtol=SAME, atol=1e-3)


@pytest.mark.parametrize("name", ["narrow", "latlong"])
def test_one_bright_pixel(gpu, name):
    """In a corner, where most of the veil leaves the picture."""
    plan = plan_whole(VIEWS[name], KERNEL)
    light = np.zeros((*plan.view.shape, 3))
    light[2, 3] = [60000, 30000, 10]
    expected = reference.scattered(light, plan).glare
    _, veil = by_gpu(gpu, light, plan)
    # Where light is so little that half floats are coarse only their step counts.
    assert_agree(veil, expected, rtol=2 * SAME, atol=2e-7)
    assert_agree(veil.sum(axis=(0, 1)), expected.sum(axis=(0, 1)), rtol=SAME)


def test_whatever_comes_stays_finite(gpu):
    """NaN and negative light are none, infinity is the limit; float32 in, half floats out."""
    plan = plan_whole(VIEWS["narrow"], KERNEL)
    light = picture(plan.view.shape)
    light[20:24, 30] = np.nan
    light[50] = -3
    light[60, 70] = np.inf
    usable = np.clip(np.nan_to_num(light, nan=0, posinf=65504), 0, 65504)
    expected = reference.scattered(usable, plan)
    for format in ("rgba16float", "rgba32float"):
        seen, veil = by_gpu(gpu, light, plan, format)
        assert_same_veil(veil, expected.glare)
        assert_agree(seen, expected.picture, rtol=SAME, atol=1e-3)


def test_twice_is_the_same_as_once_each(gpu):
    """Nothing is left over from the frame before."""
    plan = plan_whole(VIEWS["narrow"], KERNEL)
    first, then = picture(plan.view.shape, 1), picture(plan.view.shape, 2)
    source, target = texture(gpu, first), texture(gpu, first)
    stage = WholePictureStage(gpu, source, target, plan)
    run(gpu, stage.encode)
    source.write(np.dstack([then, np.ones(plan.view.shape)]))
    run(gpu, stage.encode)
    fresh, _ = by_gpu(gpu, then, plan)
    assert (target.read()[..., :3] == fresh).all()


def test_darkness_stays_dark(gpu):
    plan = plan_whole(VIEWS["wide"], KERNEL)
    seen, veil = by_gpu(gpu, np.zeros((*plan.view.shape, 3)), plan)
    assert (seen == 0).all()
    assert (veil == 0).all()


@pytest.mark.parametrize("name", ["narrow", "very wide", "fisheye"])
def test_windows_hold_all_that_the_spline_reaches(name):
    """Every block lies, by its exact place, in the windows of the nine cells around it."""
    plan = plan_whole(VIEWS[name], KERNEL)
    (chart,) = plan.charts
    places = chart.array_place(chart.place_from_direction(block_directions(plan.view)), 1)
    found = tables.windows(plan, chart)
    rows, columns = chart.array_shape(1)
    y, x = np.mgrid[: places.shape[0], : places.shape[1]]
    near = np.floor(places + 0.5).astype(int)
    for j in (-1, 0, 1):
        for i in (-1, 0, 1):
            cx, cy = near[..., 0] + i, near[..., 1] + j
            ok = (cx >= 0) & (cy >= 0) & (cx < columns) & (cy < rows)
            # Blocks that touch a cell by a hair may be left out of a flat window.
            ok &= np.abs(places - np.stack([cx, cy], -1)).max(-1) < 1.45
            first = found.first[cy[ok], cx[ok]]
            size = first[:, 2:] if found.size is None else np.array(found.size)
            offset = np.stack([x[ok], y[ok]], -1) - first[:, :2]
            assert ((offset >= 0) & (offset < size)).all()


@pytest.mark.parametrize("wrong", ["source", "target"])
def test_pictures_have_the_views_size(gpu, wrong):
    plan = plan_whole(VIEWS["narrow"], KERNEL)
    sizes = {"source": (161, 93), "target": (161, 93)} | {wrong: (93, 161)}
    pictures = [make_texture(gpu, "rgba16float", *sizes[name]) for name in ("source", "target")]
    with pytest.raises(InputError, match=rf"glare\.{wrong}: must be 161×93 px, got 93×161"):
        WholePictureStage(gpu, *pictures, plan)
