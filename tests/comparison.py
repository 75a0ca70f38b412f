"""How two arrays or pictures are compared: shape, all finite, maximum and failing share, FLIP.

The order matters. A FLIP of pictures with NaN is 0, and a mean over arrays of different shapes
broadcasts, so shape and finiteness come first.
"""

import os
from pathlib import Path

import numpy as np

__all__ = [
    "GOLDEN_FOLDER",
    "assert_agree",
    "assert_golden",
    "assert_same_picture",
    "difference_picture",
]

GOLDEN_FOLDER = Path(__file__).parent / "images"
GOLDEN_BYTES = 20_000
REGENERATE = "ANDON_REGENERATE"

# Cross-engine tolerance: 99.9 % of the pixels within 5/255, mean difference at most 0.5/255.
CODES, SHARE, MEAN_CODES = 5, 1e-3, 0.5
# Mean FLIP (0…1, at 67 pixels a degree) above which a reader sees two different pictures.
MEAN_FLIP = 0.02
MAGNIFIED = 16


def assert_agree(actual, expected, /, *, atol=0.0, rtol=0.0, share=0.0, what="arrays"):
    """`actual` is `expected` within atol + rtol·|expected|, but for a `share` of the values."""
    actual, expected = np.asarray(actual), np.asarray(expected)
    assert actual.shape == expected.shape, f"{what}: shape {actual.shape}, not {expected.shape}"
    assert actual.size, f"{what}: nothing to compare"
    _assert_finite(actual, expected, what)
    difference = np.abs(actual.astype(np.float64) - expected.astype(np.float64))
    failing = difference > atol + rtol * np.abs(expected.astype(np.float64))
    place = np.unravel_index(np.argmax(difference), difference.shape)
    assert failing.mean() <= share, (
        f"{what}: {failing.mean():.3%} of the values differ by more than {atol:g} + {rtol:g}·x "
        f"(allowed: {share:.3%}); most at {tuple(map(int, place))}: "
        f"{actual[place]:g}, not {expected[place]:g}"
    )


def assert_same_picture(
    actual, expected, folder, /, *, codes=CODES, share=SHARE, mean=MEAN_CODES, what="picture"
):
    """8-bit pictures (H, W, 3) agree within the cross-engine tolerance.

    On failure a magnified difference picture is written into `folder` and named in the message.
    """
    actual, expected = np.asarray(actual), np.asarray(expected)
    assert actual.shape == expected.shape, f"{what}: shape {actual.shape}, not {expected.shape}"
    assert actual.dtype == expected.dtype == np.uint8, f"{what}: {actual.dtype}, {expected.dtype}"
    difference = np.abs(actual.astype(int) - expected.astype(int))
    failing = float((difference.max(axis=-1) > codes).mean())
    flip = _mean_flip(actual, expected)
    faults = []
    if failing > share:
        faults.append(f"{failing:.3%} of the pixels differ by more than {codes} codes")
    if difference.mean() > mean:
        faults.append(f"the mean difference is {difference.mean():.3f} codes")
    if flip > MEAN_FLIP:
        faults.append(f"the mean FLIP is {flip:.4f}")
    if faults:
        path = Path(folder) / f"{what.replace(' ', '-')}-difference.png"
        _write_png(path, difference_picture(actual, expected))
        raise AssertionError(
            f"{what}: {'; '.join(faults)}; largest {difference.max()}; "
            f"expected, actual and {MAGNIFIED}× difference: {path}"
        )


def assert_golden(picture, name, folder, /, *, written=True, **tolerance):
    """`picture` (H, W, 3) uint8 is tests/images/`name`.png.

    With ANDON_REGENERATE=1 in the environment the picture is written instead of compared, if it is
    one to be `written`: the reference engine makes golden pictures, the GPU is held against them.
    """
    path = GOLDEN_FOLDER / f"{name}.png"
    if written and os.environ.get(REGENERATE) == "1":
        _write_png(path, picture)
        assert path.stat().st_size <= GOLDEN_BYTES, f"{path}: more than {GOLDEN_BYTES} bytes"
        return
    assert path.is_file(), f"{path} is missing; {REGENERATE}=1 makes it"
    from PIL import Image

    with Image.open(path) as image:
        expected = np.asarray(image.convert("RGB"))
    try:
        assert_same_picture(picture, expected, folder, what=name, **tolerance)
    except AssertionError as error:
        raise AssertionError(f"{error}; if the change is meant: {REGENERATE}=1") from None


def difference_picture(actual, expected, /):
    """Expected, actual and the magnified difference side by side, (H, 3W, 3) uint8."""
    difference = np.abs(actual.astype(int) - expected.astype(int)) * MAGNIFIED
    return np.concatenate([expected, actual, difference.clip(0, 255).astype(np.uint8)], axis=1)


def _assert_finite(actual, expected, what):
    for name, values in (("actual", actual), ("expected", expected)):
        bad = int(np.count_nonzero(~np.isfinite(values)))
        assert not bad, f"{what}: {bad} of {values.size} {name} values are not finite"


def _mean_flip(actual, expected):
    import flip_evaluator

    floats = [np.ascontiguousarray(x, np.float32) / 255 for x in (expected, actual)]
    return float(flip_evaluator.evaluate(*floats, "LDR", applyMagma=False)[1])


def _write_png(path, picture):
    from PIL import Image

    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(np.ascontiguousarray(picture)).save(path, optimize=True)
