"""The comparison helper itself: a helper that lets everything pass makes every test worthless."""

import numpy as np
import pytest

from comparison import assert_agree, assert_golden, assert_same_picture

GREY = np.full((24, 32, 3), 128, np.uint8)


def test_equal_arrays_and_pictures_pass(tmp_path):
    assert_agree(np.ones(3), np.ones(3))
    assert_same_picture(GREY, GREY, tmp_path)


def test_another_shape_fails_even_where_it_would_broadcast():
    with pytest.raises(AssertionError, match="shape"):
        assert_agree(np.ones((4, 1)), np.ones((4, 3)), atol=9)


def test_nan_fails_on_either_side_and_on_both():
    nan = np.array([np.nan, 1])
    for pair in ((nan, np.ones(2)), (np.ones(2), nan), (nan, nan)):
        with pytest.raises(AssertionError, match="finite"):
            assert_agree(*pair, atol=9)


def test_nothing_at_all_fails():
    with pytest.raises(AssertionError, match="nothing"):
        assert_agree(np.ones(0), np.ones(0))


def test_the_failing_share_counts():
    one_in_ten = np.array([5.0] + [0.0] * 9)
    assert_agree(one_in_ten, np.zeros(10), atol=1, share=0.1)
    with pytest.raises(AssertionError, match=r"10\.000%.*\(0,\): 5, not 0"):
        assert_agree(one_in_ten, np.zeros(10), atol=1, share=0.09)


def test_a_small_shift_of_everything_fails_by_its_mean(tmp_path):
    with pytest.raises(AssertionError, match="mean difference is 1"):
        assert_same_picture(GREY + np.uint8(1), GREY, tmp_path)


def test_a_difference_is_written_and_named(tmp_path):
    other = GREY.copy()
    other[:2] = 200
    with pytest.raises(AssertionError, match=r"my-picture-difference\.png"):
        assert_same_picture(other, GREY, tmp_path, what="my picture")
    assert (tmp_path / "my-picture-difference.png").stat().st_size > 0


def test_codes_of_another_type_fail(tmp_path):
    with pytest.raises(AssertionError, match="float64"):
        assert_same_picture(GREY / 255, GREY, tmp_path)


def test_a_missing_golden_picture_fails(tmp_path, monkeypatch):
    monkeypatch.delenv("ANDON_REGENERATE", raising=False)
    with pytest.raises(AssertionError, match="ANDON_REGENERATE=1 makes it"):
        assert_golden(GREY, "no-such-picture", tmp_path)
