"""The whole picture's veil: shaders against the reference, on a real night and cut out of it."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from andon.errors import MachineError
from andon.glare.kernel import Kernel
from andon.glare.whole_picture import reference
from andon.glare.whole_picture.plan import plan_whole
from andon.glare.whole_picture.stage import WholePictureStage
from andon.gpu.device import open_gpu
from andon.gpu.textures import make_texture
from andon.observer.spread.family import spread_function
from andon.spaces import View, pinhole_view
from andon.verify.panoramas import panorama
from andon.verify.registry import NotShown, Row

__all__ = ["ROWS", "cut_out"]

Float = NDArray[np.float64]

NIGHT = "hdri_night_open3d/nightlights_latlong512.hdr"
# The mean of the picture, in units that half floats are fine in.
MEAN = 0.05


def cut_out(latlong: Float, view: View, /) -> Float:
    """(H, W, 3) what `view` sees of a panorama (h, w, 3), its nearest pixels."""
    whole = View("latlong", latlong.shape[1], latlong.shape[0])
    column, row = np.moveaxis(np.round(whole.project(view.directions())).astype(int), -1, 0)
    return latlong[np.clip(row, 0, whole.height - 1), column % whole.width]


def _night(view: View | None) -> tuple[View, Float]:
    picture = panorama(NIGHT).astype(np.float64)
    picture *= MEAN / picture.mean()
    if view is None:
        return View("latlong", picture.shape[1], picture.shape[0]), picture
    return view, cut_out(picture, view)


def _parity(view: View | None) -> float:
    """Relative RMS of the difference of the two veils."""
    try:
        gpu = open_gpu()
    except MachineError as reason:
        raise NotShown(str(reason)) from None
    seen, picture = _night(view)
    light = picture.astype(np.float16).astype(np.float64)
    plan = plan_whole(seen, Kernel(spread_function("cie135")))
    source, target = (make_texture(gpu, "rgba16float", seen.width, seen.height) for _ in range(2))
    source.write(np.dstack([light, np.ones(seen.shape)]))
    encoder = gpu.device.create_command_encoder()
    WholePictureStage(gpu, source, target, plan).encode_glare(encoder, target)
    gpu.device.queue.submit([encoder.finish()])
    expected = reference.scattered(light, plan).glare
    off = target.read()[..., :3].astype(np.float64) - expected
    return float(np.sqrt(np.sum(off**2) / np.sum(expected**2)))


def _row(name: str, view: View | None) -> Row:
    measure: Callable[[], float] = partial(_parity, view)
    return Row(
        f"glare.whole_parity.{name}",
        "glare",
        0.005,
        "of the veil (RMS)",
        "the reference in float64, on a real night",
        measure,
    )


ROWS: tuple[Row, ...] = (
    _row("latlong", None),
    _row("60_degrees", pinhole_view(640, 360, 554.0)),
)
