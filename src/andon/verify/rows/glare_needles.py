"""Rows of flare needles: the light that is drawn, that it is steady, and both engines alike."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.errors import MachineError
from andon.glare.model import Source
from andon.glare.needles import NeedleModel, Needles, needles_of, reference
from andon.observer.spread.model import Eye
from andon.pipeline import EngineName
from andon.spaces import View, pinhole_view
from andon.verify.registry import NotShown, Row

__all__ = ["ROWS"]

Float = NDArray[np.float64]

EYE, AMBIENT_CD_M2, LUX, SEED = Eye(pupil_mm=6.0), 0.1, 5.0, 1
# Pixels of 0.01° to 0.1° around a source; 100 px each.
DEGREES_PER_PIXEL = (0.01, 0.03, 0.1)
SIZE, PLACES = 100, 8
# Of the picture: what is brightest is less than half floats hold.
UNIT_CD_M2 = 100.0


def _close_ups() -> list[View]:
    return [pinhole_view(SIZE, SIZE, 1 / np.radians(angle)) for angle in DEGREES_PER_PIXEL]


def _scenes() -> list[tuple[View, Needles]]:
    """Stars in the middle and aside, in every projection."""
    wide = pinhole_view(240, 160, 120 / np.tan(np.radians(55)))
    fisheye = View("fisheye", 200, 200, 64.0, 64.0, 99.5, 99.5)
    places: list[tuple[View, tuple[float, float, float]]] = [
        *((view, (0.0, 0.0, 1.0)) for view in _close_ups()),
        (wide, (0.9, -0.3, 1.0)),
        (fisheye, (0.8, 0.5, 0.1)),
        (View("latlong", 360, 180), (0.05, 0.3, -1.0)),
    ]
    return [(view, _star(view, np.array(direction))) for view, direction in places]


def _star(view: View, direction: Float) -> Needles:
    """Long enough to be seen as needles, short enough to stay in the picture."""
    pixel = np.degrees(np.sqrt(np.median(view.solid_angles())))
    model = NeedleModel(length_degrees=15 * pixel, longest_degrees=40 * pixel, number=20, most=32)
    source = Source(direction / np.linalg.norm(direction), LUX * np.ones(3))
    return needles_of(source, EYE, AMBIENT_CD_M2, SEED, model=model)


def _drawn(engine: EngineName, star: Needles, view: View) -> Float:
    if engine == "reference":
        return reference.draw([star], view)
    from andon.glare.needles.stage import NeedleStage
    from andon.gpu.device import open_gpu
    from andon.gpu.textures import make_texture

    try:
        gpu = open_gpu()
    except MachineError as error:
        raise NotShown(str(error)) from error
    target = make_texture(gpu, "rgba16float", view.width, view.height)
    target.write(np.zeros((*view.shape, 4)))
    stage = NeedleStage(gpu, view, len(star), model=star.model, luminance_per_unit=UNIT_CD_M2)
    stage.update([star])
    encoder = gpu.device.create_command_encoder()
    stage.encode(encoder, target)
    gpu.device.queue.submit([encoder.finish()])
    return np.asarray(target.read()[..., :3], np.float64) * UNIT_CD_M2


def _share_drawn(engine: EngineName, star: Needles, view: View) -> Float:
    """(3,) light in the picture for each lux that the needles have."""
    picture = _drawn(engine, star, view)
    light = np.einsum("ijc,ij->c", picture, view.solid_angles())
    return light / star.illuminance_lux.sum(axis=0)


def light_error(engine: EngineName) -> float:
    """The largest error of the light of a whole star."""
    errors = [np.abs(_share_drawn(engine, star, view) - 1).max() for view, star in _scenes()]
    return float(max(errors))


def unsteadiness(engine: EngineName) -> float:
    """Peak to peak, as the source moves by fractions of a pixel; the worst pixel size."""
    found: list[float] = []
    generator = np.random.default_rng(SEED)
    for view, angle in zip(_close_ups(), DEGREES_PER_PIXEL, strict=True):
        places = np.radians(generator.uniform(-0.5, 0.5, (PLACES, 2)) * angle)
        shares = [_share_drawn(engine, _star(view, np.array([x, y, 1.0])), view) for x, y in places]
        found.append(float(np.ptp(shares, axis=0).max()))
    return max(found)


def engines_apart() -> float:
    """Relative RMS over solid angle between the engines, the worst picture."""
    return max(_rms(view, star) for view, star in _scenes())


def _rms(view: View, star: Needles) -> float:
    expected, actual = (_drawn(engine, star, view) for engine in ("reference", "gpu"))
    weight = view.solid_angles()[..., None]
    error = ((actual - expected) ** 2 * weight).sum() / (expected**2 * weight).sum()
    return float(np.sqrt(error))


def _rows(engines: Sequence[EngineName]) -> list[Row]:
    rows: list[Row] = []
    for engine in engines:
        light = Row(
            f"glare.needles.light.{engine}",
            "glare",
            0.01,
            "relative",
            "the needles' share of the source's light, pinhole, fisheye and latlong",
            lambda engine=engine: light_error(engine),
        )
        steady = Row(
            f"glare.needles.steady.{engine}",
            "glare",
            0.01,
            "of their light",
            "itself, while the source moves by fractions of a pixel",
            lambda engine=engine: unsteadiness(engine),
        )
        rows += [light, steady]
    return rows


ROWS: tuple[Row, ...] = (
    *_rows(("reference", "gpu")),
    Row(
        "glare.needles.parity.gpu",
        "glare",
        0.01,
        "relative RMS",
        "the reference in float64, pinhole, fisheye and latlong",
        engines_apart,
    ),
)
