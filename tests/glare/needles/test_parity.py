"""The needles' shader against the reference, in every projection."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.glare.needles import NeedleModel, needles_of, reference
from andon.glare.needles.stage import NeedleStage
from andon.gpu.textures import make_texture
from andon.observer.spread.model import Eye

from .stars import AHEAD, close_up, disc, ellipse, fisheye, lamp, latlong, unit, wide

EYE = Eye(pupil_mm=6.0)
# Few and long enough that half floats, cut at each needle, do not cover what is compared.
MODEL = NeedleModel(number=20.0, most=32)
LONG = NeedleModel(number=20.0, most=32, length_degrees=12.0, width_degrees=1.0)


def by_gpu(gpu, stars, view, model, *, before=0.0, **options):
    target = make_texture(gpu, "rgba16float", view.width, view.height)
    target.write(np.full((*view.shape, 4), before))
    stage = NeedleStage(gpu, view, 256, model=model, **options)
    stage.update(stars)
    encoder = gpu.device.create_command_encoder()
    stage.encode(encoder, target)
    gpu.device.queue.submit([encoder.finish()])
    picture = target.read().astype(np.float64)
    assert (picture[..., 3] == before).all()
    return picture[..., :3]


@pytest.mark.parametrize(
    ("view", "direction", "model"),
    [
        (close_up(), AHEAD, MODEL),
        (close_up(), unit(0.01, -0.02, 1), MODEL),
        (wide(), unit(0.9, -0.3, 1), LONG),
        (wide(), unit(1.6, 0.1, 1), LONG),
        (wide(), unit(3, 0.1, -0.1), LONG),
        (fisheye(), unit(0.02, -0.03, 1), LONG),
        (fisheye(), unit(0.8, 0.5, 0.1), LONG),
        (latlong(), unit(0.4, 0.1, 1), LONG),
        (latlong(), unit(0.02, 0.3, -1), LONG),
        (latlong(), unit(0.3, -1, 0.6), LONG),
        (latlong(), unit(0.1, 1, -0.1), LONG),
    ],
)
def test_pictures_agree(gpu, view, direction, model):
    sources = [lamp([2.0, 1.5, 1.0], direction), lamp(1.0, unit(*(direction + 0.02)), disc(0.3))]
    stars = [needles_of(source, EYE, 0.01, 3, model=model) for source in sources]
    expected = reference.draw(stars, view)
    actual = by_gpu(gpu, stars, view, model)
    weight = view.solid_angles()[..., None]
    error = np.sqrt(((actual - expected) ** 2 * weight).sum())
    assert error <= 0.01 * np.sqrt((expected**2 * weight).sum())
    assert np.abs(actual - expected).max() <= 0.02 * expected.max()
    # Of a source behind a pinhole's plane there may be nothing to see.
    assert expected.any() or (view.projection == "pinhole" and direction[2] < 0)


def test_ellipses_agree(gpu):
    star = needles_of(lamp(3.0, outline=ellipse(0.3, 0.1, 30)), EYE, 0.01, 3, model=MODEL)
    expected = reference.draw([star], close_up())
    actual = by_gpu(gpu, [star], close_up(), MODEL)
    assert np.abs(actual - expected).max() <= 0.01 * expected.max()


def test_light_is_added_in_units_of_the_picture(gpu):
    star = needles_of(lamp(), EYE, 0.01, 3, model=MODEL)
    alone = by_gpu(gpu, [star], close_up(), MODEL, luminance_per_unit=10.0)
    added = by_gpu(gpu, [star], close_up(), MODEL, luminance_per_unit=10.0, before=0.25)
    assert added - 0.25 == pytest.approx(alone, abs=2e-3 * alone.max() + 1e-3)
    expected = reference.draw([star], close_up())
    assert alone.sum() * 10 == pytest.approx(expected.sum(), rel=5e-3)


def test_nothing_to_draw(gpu):
    assert not by_gpu(gpu, [], close_up(16), MODEL).any()


def test_an_update_stands_in_for_the_one_before(gpu):
    view = close_up(60)
    stage = NeedleStage(gpu, view, 256, model=MODEL)
    stage.update([needles_of(lamp(), EYE, 0.01, 3, model=MODEL)])
    stage.update([])
    target = make_texture(gpu, "rgba16float", view.width, view.height)
    target.write(np.zeros((*view.shape, 4)))
    encoder = gpu.device.create_command_encoder()
    stage.encode(encoder, target)
    gpu.device.queue.submit([encoder.finish()])
    assert not target.read().any()


def test_what_a_stage_refuses(gpu):
    stage = NeedleStage(gpu, close_up(16), 4, model=MODEL)
    star = needles_of(lamp(), EYE, 0.01, model=MODEL)
    with pytest.raises(InputError, match="at most 4 needles"):
        stage.update([star])
    with pytest.raises(InputError, match=r"needles\.model"):
        stage.update([needles_of(lamp(0.02), EYE, 0.01)])
