"""Speed of the frame's glare: sources found, veil and needles, on the demonstration.

Timed is a frame with glare less one without. The peer is the reference's stage, which does all of
it, too.
"""

from __future__ import annotations

import numpy as np

from andon.bench.registry import BenchRow, Duel
from andon.engines.glare_lamps import UnpicturedLamps
from andon.engines.glare_reference import glare_seen
from andon.gpu.device import open_gpu
from andon.verify.glare_frames import demonstration, renderer_of

__all__ = ["ROWS"]

WIDTH, HEIGHT = 741, 500


def _against_the_reference() -> Duel:
    prepared, ours = demonstration(), renderer_of("gpu")
    plain, own = renderer_of("gpu", glare=False), prepared.glare
    assert own is not None
    light = np.asarray(plain.render().luminance.cd_m2, np.float64)
    (frame,) = prepared.frames.values()
    lamps, hiding = prepared.lamps(0.0), UnpicturedLamps(prepared.surface.shadow_casters)

    def peer() -> np.ndarray:
        stays, added = glare_seen(own, light, frame.view, lamps, hiding, None)
        return stays + added

    seen = np.asarray(ours.render().luminance.cd_m2, np.float64)
    truth = peer()
    same = float((np.abs(seen - truth) <= 0.01 * truth + 0.01).all(axis=-1).mean())
    name = open_gpu().adapter_name
    return Duel(ours.draw, peer, same, 0.98, name, peer_repeats=2, ours_less=plain.draw)


ROWS: tuple[BenchRow, ...] = (
    BenchRow(
        "glare.frame.reference",
        "glare",
        "the reference engine's stage (NumPy)",
        WIDTH * HEIGHT,
        _against_the_reference,
    ),
)
