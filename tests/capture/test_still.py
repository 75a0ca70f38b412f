"""A photograph as linear light: codes, clipping, lens, refusals."""

import numpy as np
import pytest

from andon.capture.still import frame_from_picture, linear_from_picture
from andon.errors import InputError
from andon.files.pictures import Picture
from andon.responses import LINEAR, SRGB, Response
from andon.spaces import View
from comparison import assert_agree
from worlds import ALL_CODES

VIEW = View("pinhole", 48, 16, 40.0, 40.0, 23.5, 7.5)
KNOTS = np.linspace(0, 1, 5)[:, None]
CURVE = Response("curve", linear=KNOTS ** [1.5, 2, 3], encoded=KNOTS * np.ones(3))


def framed(values, encoding="srgb", view=VIEW, response=SRGB, **more):
    return frame_from_picture(
        Picture(values, encoding), view, response, luminance_per_unit=1, **more
    )


@pytest.mark.parametrize("response", [SRGB, LINEAR, Response("gamma", gamma=2.2), CURVE])
@pytest.mark.parametrize("factor", [1, 257])
def test_codes_become_light_by_the_inverse_response(response, factor):
    """8 bit, and the same picture in 16 bit: v·257 is the same share of the top."""
    values = ALL_CODES if factor == 1 else ALL_CODES.astype(np.uint16) * 257
    linear = linear_from_picture(Picture(values, "srgb"), response)
    assert linear.dtype == np.float32
    assert_agree(linear, response.decode(ALL_CODES / 255), rtol=1e-6, atol=1e-9)


def test_hdr_light_is_taken_as_it_is():
    values = np.geomspace(1e-6, 1e5, 16 * 48 * 3).reshape(16, 48, 3).astype(np.float32)
    frame = framed(values, "linear")
    assert (frame.linear == values).all()
    assert not frame.clipped.any()
    assert frame.response is SRGB


def test_clipped_pixels_are_those_with_a_channel_at_the_end():
    frame = framed(ALL_CODES)
    assert (frame.clipped == (ALL_CODES >= 254).any(axis=-1)).all()
    assert 0 < frame.clipped.sum() < 20
    wide = framed(ALL_CODES.astype(np.uint16) * 257)
    assert (wide.clipped == (ALL_CODES == 255).any(axis=-1)).all()


def test_a_lens_is_taken_out_and_what_it_did_not_see_is_black():
    view = View(**{**vars(VIEW), "distortion": (0.9, 0.0, 0.0, 0.0)})
    frame = framed(np.full((16, 48, 3), 255, np.uint8), view=view)
    assert frame.view.distortion == ()
    assert np.isfinite(frame.linear).all()
    assert frame.linear[0, 0].tolist() == [0, 0, 0]
    assert frame.linear[8, 24] == pytest.approx(1)
    assert not frame.clipped[0, 0]
    assert frame.clipped[8, 24]


def test_a_picture_of_another_size_is_refused():
    with pytest.raises(InputError, match=r"p\.png: capture\.source: is 47×16 px but .* 48×16"):
        framed(ALL_CODES[:, 1:], file="p.png")


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_hdr_light_that_is_no_number_is_refused(bad):
    values = np.ones((16, 48, 3), np.float32)
    values[3, 4, 1] = bad
    with pytest.raises(InputError, match=r"p\.exr: has 1 pixels that are NaN or infinite"):
        framed(values, "linear", file="p.exr")
