"""Exposure fusion: of alike pictures the picture; of brackets the details of all of them."""

import numpy as np
import pytest

import andon
from andon.display.fusion import FILTERS, fuse, fused_codes
from andon.display.model import Exposure
from andon.display.reference import encode
from andon.display.stage import DisplayStage
from andon.gpu.textures import make_texture
from andon.responses import SRGB
from comparison import assert_golden
from worlds import ALL_CODES, write_relight_files

FUSED = Exposure(tone="fusion")


def room(size=(96, 144)):
    """Linear light: a fine texture in a dark half, and the same 100 times brighter outside."""
    rows, columns = np.mgrid[: size[0], : size[1]]
    texture = 0.12 * (1 + 0.4 * np.sin(rows / 2.0) * np.cos(columns / 2.5))
    light = np.where(columns < size[1] // 2, 0.35, 35.0)
    return (texture * light)[..., None] * [1.0, 0.9, 0.75]


def local_contrast(codes, columns):
    """Mean spread of small blocks, of codes."""
    part = codes[:, columns].mean(axis=2)
    rows, wide = part.shape[0] // 8 * 8, part.shape[1] // 8 * 8
    blocks = part[:rows, :wide].reshape(rows // 8, 8, wide // 8, 8)
    return blocks.std(axis=(1, 3)).mean()


def test_alike_pictures_give_the_picture():
    assert (fuse([ALL_CODES]) == ALL_CODES).all()
    assert (fuse([ALL_CODES] * 3) == ALL_CODES).all()
    # Floats are encoded values in [0, 1].
    assert (fuse([ALL_CODES / 255.0] * 2) == ALL_CODES).all()


def test_the_order_of_the_exposures_does_not_matter():
    exposures = [SRGB.encode(np.clip(room() * gain, 0, 1)) for gain in (4, 1, 0.25)]
    difference = fuse(exposures).astype(int) - fuse(exposures[::-1])
    assert np.abs(difference).max() <= 1


def test_flat_pictures_are_weighted_by_their_exposure():
    """No contrast and no saturation: OpenCV's product is then all but nil, so give it both.

    Of two pictures of the same texture, one near ½ and one near white, the fused mean lies near
    that of the first.
    """
    texture = 0.04 * np.random.default_rng(2).standard_normal((64, 64, 3))
    good, bright = np.clip(0.5 + texture, 0, 1), np.clip(0.95 + 0.1 * texture, 0, 1)
    mean = fuse([good, bright]).mean() / 255
    assert 0.48 < mean < 0.58


def test_details_of_all_exposures_are_kept():
    """More local contrast in the worse half than any single exposure has in its worse half."""
    light = room()
    fused = fused_codes(light, FUSED, SRGB, 1.0)
    left, right = slice(0, 68), slice(76, 144)
    kept = min(local_contrast(fused, left), local_contrast(fused, right))
    single = [
        min(local_contrast(codes, left), local_contrast(codes, right))
        for codes in (encode(light * share, Exposure(), SRGB, 1.0) for share in FILTERS)
    ]
    assert kept > 1.5 * max(single)


def test_nothing_gets_brighter_than_the_photograph():
    """The brightest exposure is the frame's own: a dark picture stays as it is, but for noise."""
    light = 0.02 * room()
    own = encode(light, Exposure(), SRGB, 1.0)
    fused = fused_codes(light, FUSED, SRGB, 1.0)
    assert fused.mean() <= own.mean() + 0.5
    assert fused.mean() > 0.5 * own.mean()


def test_a_stated_exposure_is_the_brightest():
    light = room()
    stated = fused_codes(light, Exposure(units_per_cd_m2=0.01, tone="fusion"), SRGB, 3.0)
    again = fused_codes(light * 0.01, FUSED, SRGB, 1.0)
    assert np.abs(stated.astype(int) - again).max() <= 1
    assert (stated != fused_codes(light, FUSED, SRGB, 1.0)).any()


@pytest.mark.parametrize("size", [(1, 1), (1, 7), (5, 3)])
def test_small_pictures(size):
    codes = fused_codes(np.full((*size, 3), 0.2), FUSED, SRGB, 1.0)
    assert codes.shape == (*size, 3)
    assert 0 < codes.min() <= codes.max() < 255


def test_infinite_light_is_bright():
    light = room()
    light[40:50, 100:110] = np.inf
    codes = encode(light, FUSED, SRGB, 1.0)
    assert codes[43:47, 103:107].min() > 200


def test_fused_picture(tmp_path):
    picture = np.concatenate(
        [encode(room(), Exposure(), SRGB, 1.0), encode(room(), FUSED, SRGB, 1.0)]
    )
    assert_golden(picture, "display-fusion", tmp_path)


def test_the_gpu_fuses_the_same(gpu):
    light = room().astype(np.float16).astype(np.float64)
    texture = make_texture(gpu, "rgba16float", light.shape[1], light.shape[0])
    texture.write(np.dstack([light, np.ones(light.shape[:2])]))
    stage = DisplayStage(gpu, texture, SRGB, FUSED, 50.0)
    encoder = gpu.device.create_command_encoder()
    stage.encode(encoder)
    gpu.device.queue.submit([encoder.finish()])
    # OpenCV's sums differ in the last bit from call to call.
    difference = stage.read().rgb.astype(int) - encode(light * 50.0, FUSED, SRGB, 50.0)
    assert np.abs(difference).max() <= 1
    assert (difference != 0).mean() < 1e-3


def test_a_frame_with_the_tone(engine, tmp_path):
    write_relight_files(tmp_path)
    tables = {
        "rig": {"camera": {"file": "camera.toml"}},
        "capture": {"source": "photo.png"},
        "surface": {"depth": {"file": "depth.npy"}},
        "ambient": {"illuminance_lux": 200.0},
        "lamp": [{"name": "bulb", "kind": "point", "position": [0.5, 0.3, -1.2], "flux_lm": 9e4}],
    }
    frames = [
        andon.render(
            andon.scene_from_dict(tables | {"display": {"tone": tone}}, folder=tmp_path),
            engine=engine,
        )
        for tone in ("none", "fusion")
    ]
    plain, fused = (frame.image.rgb for frame in frames)
    frame = frames[1]
    expected = encode(frame.luminance.cd_m2, FUSED, SRGB, frame.captured.luminance_per_unit)
    # Where the Laplacian of every exposure is nil by chance, weights hang on the last bit.
    assert (np.abs(fused.astype(int) - expected).max(axis=-1) > 1).mean() <= 1e-3
    # The lamp burns the wall out; the fusion brings it back.
    burnt = (plain == 255).all(axis=-1)
    assert burnt.mean() > 0.02
    assert (fused == 255).all(axis=-1).mean() < 0.3 * burnt.mean()
