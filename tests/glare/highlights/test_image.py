"""A picture of the finishes side by side, and that both engines have it."""

import numpy as np

from andon.composite.model import Ambient
from andon.display.model import Exposure
from andon.engines.highlights import SceneHighlights
from andon.engines.prepared import Prepared
from andon.glare.highlights.model import Finish
from andon.lamps import HemisphereLamp, SphereLamp
from andon.pipeline import Renderer
from andon.quantities import CameraFrame, Geometry, Material, merged
from andon.spaces import look_at, pinhole_view
from andon.surface.model import ObjectInfo, SurfaceModel
from comparison import assert_golden
from worlds import ball

UP = np.array([0.0, 1, 0])
FINISHES = (
    Finish(alpha=(0.03, 0.03)),
    Finish(alpha=(0.3, 0.3)),
    Finish(alpha=(0.6, 0.08), axis=UP, around=True),
    Finish("phong", exponent=40.0, metallic=0.3),
    Finish(alpha=(0.1, 0.1), metallic=0.0),
)


def balls():
    solids = [ball(0.42, (column - 2.0, 0, 0), 12) for column in range(5)]
    middles = np.repeat(
        [(column - 2.0, 0, 0) for column in range(5)],
        [len(solid.positions) for solid in solids],
        axis=0,
    )
    points = merged(*solids)
    ids = np.repeat(np.arange(5, dtype=np.int32), len(solids[0].triangles))
    looks = tuple(Material(reflectance=(0.9, 0.65, 0.3)) for _ in range(5))
    normals = (points.positions - middles) / 0.42
    return Geometry(points.positions, points.triangles, normals, None, ids, looks)


def picture(engine):
    view = pinhole_view(250, 60, 130.0, look_at([0, 0.6, 2.6], [0, 0, 0]))
    geometry, black = balls(), np.zeros((60, 250, 3), np.float32)
    lamps = (
        SphereLamp("lamp", np.full(3, 3e3), np.array([1.2, 2.0, 1.5]), 0.12, shadow=None),
        HemisphereLamp("room", UP, np.array([40.0, 45, 60]), np.array([25.0, 20, 15])),
    )
    scene = Prepared(
        frames={"mono": CameraFrame(black, view, luminance_per_unit=60.0)},
        surface=SurfaceModel(
            objects=geometry, objects_table=(ObjectInfo("balls", 0, 5, len(geometry.triangles)),)
        ),
        ambient=Ambient(np.full(3, 1e-30)),
        lamps=lambda _: lamps,
        exposure=Exposure(),
        highlights=SceneHighlights(FINISHES, (None,) * 5),
    )
    return Renderer(scene, engine).picture()


def test_finishes(tmp_path):
    assert_golden(picture("reference"), "highlights-finishes", tmp_path)


def test_both_engines_draw_them(gpu, tmp_path):
    assert_golden(picture("gpu"), "highlights-finishes", tmp_path, written=False)
