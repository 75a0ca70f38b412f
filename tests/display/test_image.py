"""Pictures for people: false colours, depth, normals, contact sheets, and golden ones of them."""

from itertools import pairwise

import numpy as np
import pytest

from andon.display.false_colour import (
    ABOVE_PX,
    BAR_WIDTH_PX,
    BELOW_PX,
    CAPTION_PX,
    HOLE,
    PAPER,
    contact_sheet,
    depth_picture,
    false_colour,
    normal_picture,
)
from andon.display.model import Exposure
from andon.display.reference import encode
from andon.responses import SRGB
from comparison import assert_golden

RAMP = np.geomspace(0.5, 900, 160)[None, :] * np.ones((120, 1))


def test_a_scale_of_lux(tmp_path):
    valid = np.ones(RAMP.shape, bool)
    valid[50:70, 60:90] = False
    picture = false_colour(RAMP, "lx", valid=valid)
    # Without the labels, whose letters are the font's and not ours.
    assert_golden(picture[:, : 160 + 24], "display-scale", tmp_path)


def test_tones(tmp_path):
    """Two decades around white, clipped above and bent below."""
    light = np.geomspace(0.05, 5, 160)[None, :, None] * np.array([1, 0.8, 0.5])
    bands = [encode(np.repeat(light, 30, axis=0), Exposure(tone=t), SRGB, 1.0)
             for t in ("none", "reinhard")]  # fmt: skip
    assert_golden(np.concatenate(bands), "display-tones", tmp_path)


def test_a_sheet():
    tiles = [
        ("light", false_colour(RAMP, "lx")),
        ("depth", depth_picture(RAMP, RAMP < 500)),
        ("normals", normal_picture(np.dstack([RAMP * 0, RAMP * 0, RAMP * 0 + 1]), RAMP < 500)),
        ("four", np.full((30, 40, 3), 90, np.uint8)),
    ]
    sheet = contact_sheet(tiles, columns=3)
    height, width = 120 + CAPTION_PX, 160 + BAR_WIDTH_PX
    assert sheet.shape == (2 * height, 3 * width, 3)
    assert sheet.dtype == np.uint8
    assert (sheet[CAPTION_PX:height, :width] == tiles[0][1]).all()
    # Shapes are kept: 40×30 becomes 160×120, in the middle of its cell.
    row, left = sheet[height + CAPTION_PX :], (width - 160) // 2
    assert (row[:, left : left + 160] == 90).all()
    assert (row[:, :left] == PAPER).all()
    # The bar of the first tile leaves paper beside the others; so is what is left of the last row.
    second = sheet[CAPTION_PX:height, width : 2 * width]
    assert (second[:, left : left + 160] == tiles[1][1]).all()
    assert (second[:, -10:] == PAPER).all()
    assert len(np.unique(sheet[height:, width:].reshape(-1, 3), axis=0)) == 1
    # Captions are written in ink.
    assert sheet[:CAPTION_PX, :width].min() < 60


def test_a_sheet_has_gaps_and_long_captions():
    tile = np.full((20, 100, 3), 90, np.uint8)
    sheet = contact_sheet([("short", tile), ("of very many words", tile)], columns=2, gap_px=4)
    lines = (sheet.shape[0] - 20) // CAPTION_PX
    assert sheet.shape == (20 + lines * CAPTION_PX, 204, 3)
    assert lines == 2
    assert (sheet[:, 100:104] == PAPER).all()
    assert (sheet[CAPTION_PX : 2 * CAPTION_PX, :100] == PAPER).all()
    assert sheet[CAPTION_PX : 2 * CAPTION_PX, 104:].min() < 60
    assert (sheet[-20:, 104:] == 90).all()


def test_holes_have_a_colour_of_their_own_and_the_bar_is_beside():
    valid = RAMP < 100
    picture = false_colour(RAMP, "lx", valid=valid)
    assert picture.shape == (120, 160 + BAR_WIDTH_PX, 3)
    assert (picture[:, :160][~valid] == HOLE).all()
    assert not (picture[:, :160][valid] == HOLE).all(axis=-1).any()
    depth = depth_picture(np.where(valid, RAMP, np.nan), valid)
    assert (depth[~valid] == HOLE).all()


@pytest.mark.parametrize(
    ("most", "label"), [(900, "1000"), (70, "100"), (4.2, "5"), (0.013, "0.02")]
)
def test_the_scale_ends_at_a_round_number_above_the_light(most, label, monkeypatch):
    from PIL import ImageDraw

    written = []
    draw = ImageDraw.ImageDraw.text
    monkeypatch.setattr(
        ImageDraw.ImageDraw, "text",
        lambda self, xy, text, **more: (written.append((xy, text)), draw(self, xy, text, **more)),
    )  # fmt: skip
    false_colour(RAMP / RAMP.max() * most, "lx")
    # The top of the bar is its brightest colour; the labels fall by half a decade downwards.
    by_height = [text for (_, y), text in sorted(written, key=lambda entry: entry[0][1])]
    assert by_height[:2] == ["lx", label]
    numbers = [float(text) for text in by_height[1:]]
    assert numbers == sorted(numbers, reverse=True)
    assert numbers[-1] == pytest.approx(numbers[0] / 100, rel=0.01)


@pytest.mark.parametrize("unit", ["lx", "lx, relative", "lx (relative)"])
@pytest.mark.parametrize("height", [1, 12, 20, 33, 45, 60, 76, 90, 120, 200, 500, 1080])
def test_no_label_lies_on_another_or_beyond_the_rim(height, unit, monkeypatch):
    from PIL import ImageDraw

    boxes = {}
    draw = ImageDraw.ImageDraw.text

    def text(self, xy, text, **more):
        boxes[text] = self.textbbox(xy, text, font=more["font"], anchor=more["anchor"])
        draw(self, xy, text, **more)

    monkeypatch.setattr(ImageDraw.ImageDraw, "text", text)
    false_colour(np.full((height, 5), 700.0), unit)
    assert (unit in boxes) == (height >= 76)
    assert boxes
    if height >= 20:
        assert all(top >= 0 and bottom <= height for _, top, _, bottom in boxes.values())
        assert all(right <= BAR_WIDTH_PX for _, _, right, _ in boxes.values())
    spans = sorted((top, bottom) for _, top, _, bottom in boxes.values())
    assert all(below >= above for (_, above), (below, _) in pairwise(spans)), boxes


def test_colours_and_labels_say_the_same():
    """The picture's colour of a tenth of the top is the bar's colour at half its height."""
    values = np.full((120, 160), 100.0)
    values[:60] = 1000.0
    picture = false_colour(values, "lx").astype(int)
    bar = picture[ABOVE_PX:-BELOW_PX, 160 + 14]
    assert np.abs(bar[len(bar) // 2] - picture[90, 50]).max() <= 8
    assert np.abs(bar[0] - picture[10, 50]).max() <= 2


def test_less_light_is_a_darker_colour():
    picture = false_colour(RAMP, "lx")[60, :160].astype(int) @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(picture) >= -1).all()
    assert picture[-1] > picture[0] + 150


@pytest.mark.parametrize("values", [np.zeros((64, 64)), np.full((64, 64), 1e-9)])
def test_darkness_is_black_not_an_error(values):
    assert false_colour(values, "lx")[:, :64].max() <= 10
    nothing = np.zeros(values.shape, bool)
    assert (false_colour(values, "lx", valid=nothing)[:, :64] == HOLE).all()
    assert (depth_picture(values, nothing) == HOLE).all()


def test_one_infinite_pixel_leaves_the_scale_to_the_others():
    values = RAMP.copy()
    values[0, 0] = np.inf
    picture = false_colour(values, "lx")
    assert (picture[1:] == false_colour(RAMP, "lx")[1:]).all()
    assert picture[0, 0].sum() >= picture.sum(axis=-1)[:, :160].max()


def test_near_is_bright():
    depth = np.linspace(1, 5, 64)[None, :] * np.ones((8, 1))
    luma = depth_picture(depth, np.ones(depth.shape, bool))[4] @ [0.2126, 0.7152, 0.0722]
    assert luma[0] > luma[-1] + 100


def test_small_pictures_have_a_scale_too():
    for shape in ((1, 1), (3, 200), (20, 20), (33, 5)):
        assert false_colour(np.ones(shape), "lx").shape == (shape[0], shape[1] + BAR_WIDTH_PX, 3)
