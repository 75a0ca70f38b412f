"""Rows of highlights: a ball of metal under a luminous ball against Mitsuba, and both engines."""

from __future__ import annotations

from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from andon.composite.model import Ambient
from andon.engines.highlights import SceneHighlights
from andon.engines.prepared import Prepared
from andon.errors import MachineError
from andon.glare.highlights.model import Finish
from andon.lamps import Lamp, SphereLamp
from andon.pipeline import EngineName, Renderer
from andon.quantities import CameraFrame, Geometry, Material
from andon.spaces import View, pinhole_view
from andon.surface.model import ObjectInfo, SurfaceModel
from andon.verify.registry import NotShown, Row
from andon.verify.solids import icosphere
from andon.verify.truths.mitsuba_metal import metal_ball

__all__ = ["ROWS", "highlight_error"]

Float = NDArray[np.float64]

# Metres, in front of the default camera; a lamp of 17° beside and above it.
CENTRE, RADIUS_M = np.array([0.0, 0.0, -1.0]), 0.3
LAMP = SphereLamp("lamp", np.full(3, 1000.0), np.array([0.7, 0.9, -0.5]), 0.17, shadow=None)
VIEW = pinhole_view(64, 64, 96.0)
ALPHAS = (0.05, 0.15, 0.35)
# Its own noise is then 1 to 2 %.
SAMPLES = 2048
ENGINES: tuple[EngineName, ...] = ("reference", "gpu")


def _ball() -> Geometry:
    solid = icosphere(RADIUS_M, 24)
    look = (Material(reflectance=(1.0, 1.0, 1.0)),)
    triangles = solid.triangles.astype(np.int32)
    normals = solid.positions / RADIUS_M
    return Geometry(solid.positions + CENTRE, triangles, normals, materials=look)


@cache
def _truth(alpha: float) -> Float:
    return metal_ball(VIEW, CENTRE, RADIUS_M, alpha, LAMP, SAMPLES)


def _prepared(view: View, alpha: float) -> Prepared:
    ball = _ball()

    def lamps(time_seconds: float) -> tuple[Lamp, ...]:
        return (LAMP,)

    return Prepared(
        frames={"mono": CameraFrame(np.zeros((*view.shape, 3), np.float32), view)},
        surface=SurfaceModel(
            objects=ball, objects_table=(ObjectInfo("ball", 0, 1, len(ball.triangles)),)
        ),
        ambient=Ambient(np.full(3, 1e-30)),
        lamps=lamps,
        highlights=SceneHighlights((Finish(alpha=(alpha, alpha)),), (None,)),
    )


def highlight_error(engine: EngineName) -> float:
    """Relative root mean square error of the highlight, in %, of the worst roughness."""
    worst = 0.0
    for alpha in ALPHAS:
        truth = _truth(alpha)
        try:
            frame = Renderer(_prepared(VIEW, alpha), engine).render()
        except MachineError as error:
            raise NotShown(str(error)) from error
        assert frame.highlights is not None
        ours = np.asarray(frame.highlights.cd_m2, np.float64)[..., 1]
        error = float(np.sqrt(((ours - truth) ** 2).sum() / (truth**2).sum()))
        worst = max(worst, 100 * error)
    return worst


ROWS = tuple(
    Row(
        f"glare.highlights.{engine}",
        "glare",
        5.0,
        "% RMS",
        "Mitsuba: a GGX ball under a luminous ball",
        partial(highlight_error, engine),
    )
    for engine in ENGINES
)
