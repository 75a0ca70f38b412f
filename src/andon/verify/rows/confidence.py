"""Whether the confidence in relit pixels says how wrong they are.

The room of `synthetic`, photographed four stops under in 8 bits, is lit by lamps that brighten it
and shown as bright as before: a step of the photograph becomes one to some hundred codes. The
photograph has no noise and E0 is Radiance's, so what is wrong comes of the steps, but for the
edges of shadows.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from andon.engines.confidence import confidence_of_frame
from andon.pipeline import EngineName
from andon.verify.registry import Row
from andon.verify.rows.synthetic import relit_frame, shown_and_truth

__all__ = ["ROWS", "rank", "scale_error"]

Float = NDArray[np.float64]

STOPS_UNDER = 4.0
# Of pixels alike in what is expected: the error of one is chance, of these it is not.
GROUPS = 64


@cache
def _errors(engine: EngineName) -> tuple[Float, Float]:
    """Expected and actual error (n,) of the pixels that were lit, in codes, RMS of the channels."""
    frame = relit_frame(engine, True, STOPS_UNDER)
    ours, truth, lit = shown_and_truth(frame)
    steps = np.full(ours.shape, frame.captured.code_step / np.sqrt(12))
    expected = confidence_of_frame(frame, steps).expected_error_codes
    known = lit & np.isfinite(expected)
    actual = np.sqrt(((ours - truth) ** 2).mean(axis=-1))
    return expected[known].astype(np.float64), actual[known]


def scale_error(engine: EngineName) -> float:
    """Of the median ratio of actual to expected error, its distance from 1.

    The RMS of three errors that are even within their steps has a median of 0.985 of the expected.
    """
    expected, actual = _errors(engine)
    return abs(float(np.median(actual / expected)) - 1)


def rank(engine: EngineName, *, grouped: bool) -> float:
    """Spearman's correlation of expected and actual error, of pixels or of groups' medians."""
    expected, actual = _errors(engine)
    if grouped:
        order = np.array_split(np.argsort(expected, kind="stable"), GROUPS)
        expected, actual = (
            np.array([np.median(x[part]) for part in order]) for x in (expected, actual)
        )
    return _correlation(_ranks(expected), _ranks(actual))


def _ranks(values: Float) -> Float:
    """Place of each value in their order; those that are alike share the mean of theirs."""
    _, inverse, counts = np.unique(values, return_inverse=True, return_counts=True)
    last = np.cumsum(counts)
    return (last - (counts - 1) / 2)[inverse]


def _correlation(a: Float, b: Float) -> float:
    return float(np.corrcoef(a, b)[0, 1])


AGAINST = "errors against Radiance of `relight.synthetic`, photographed four stops under, 8 bits"


def _rows(engine: EngineName) -> tuple[Row, ...]:
    return (
        Row(
            f"relight.confidence.scale.{engine}",
            "relight",
            0.1,
            "share",
            f"median of actual to expected error, from 1: {AGAINST}",
            lambda: scale_error(engine),
        ),
        Row(
            f"relight.confidence.rank.{engine}",
            "relight",
            0.9,
            "Spearman",
            f"{GROUPS} groups of pixels of like expected error: {AGAINST}",
            lambda: rank(engine, grouped=True),
            at_least=True,
        ),
        Row(
            f"relight.confidence.rank.pixels.{engine}",
            "relight",
            None,
            "Spearman",
            f"pixel by pixel, of which each errs by chance: {AGAINST}",
            lambda: rank(engine, grouped=False),
        ),
    )


ROWS: tuple[Row, ...] = (*_rows("reference"), *_rows("gpu"))
