"""Speed of glass: a stereo frame of 2 × 1280×720 with all layers, beside Mitsuba's path tracer.

Mitsuba draws a picture of `SHARE` of the pixels, whose time is taken as that share of a frame's: a
path tracer's cost is that of its paths. An easy peer, and the only one that knows all of it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from andon.bench.registry import BenchRow, Duel
from andon.gpu.device import open_gpu
from andon.verify.traced_frame import SMALLER, differences, renderer_of, traced

__all__ = ["ROWS"]

EYES = ("left", "right")
PIXELS = len(EYES) * 1280 * 720
SHARE = 1 / (len(EYES) * SMALLER**2)
SAMPLES = 64
# Of white: 0.03 are mirrored inside the ball, which ours leaves out, and 64 paths scatter by 0.04.
AGREED = 0.15


def _against_mitsuba() -> Duel:
    renderer = renderer_of("gpu")

    def ours() -> None:
        for eye in EYES:
            renderer.draw(view=eye)

    def peer() -> Any:
        return traced(renderer, SAMPLES)

    picture = np.asarray(renderer.render(view="left").luminance.cd_m2, np.float64)
    off = np.abs(differences(picture, peer())).max(axis=-1)
    same = float((off <= AGREED).mean())
    return Duel(ours, peer, same, 0.97, open_gpu().adapter_name, peer_repeats=3, peer_parts=SHARE)


ROWS: tuple[BenchRow, ...] = (
    BenchRow(
        "glass.frame.mitsuba",
        "glass",
        f"Mitsuba scalar_rgb, {SAMPLES} paths a pixel, {SHARE:.2%} of the pixels, scaled",
        PIXELS,
        _against_mitsuba,
        bar=150.0,
        bar_is_milliseconds=True,
    ),
)
