"""What a review found: hidden geometry, thickness, empty maps, names, lenses, overwriting."""

from dataclasses import replace

import numpy as np
import pytest

from andon.cli import _run
from andon.composite.model import Ambient
from andon.engines.prepared import Prepared
from andon.errors import InputError
from andon.lamps import DirectionalLamp, PointLamp
from andon.pipeline import Renderer, relight
from andon.quantities import CameraFrame, merged
from andon.spaces import View
from andon.surface.load import surface_of_depth
from andon.surface.model import SurfaceModel
from andon.surface.occluder import decimated
from andon.surface.triangulate import triangulate_depth

VIEW = View("pinhole", 160, 120, 100.0, 100.0, 79.5, 59.5)


def test_hidden_geometry_is_no_decimation_error():
    """A plane hidden behind a plane: both decimate exactly, so nothing has moved."""
    planes = [triangulate_depth(np.full((120, 160), z), VIEW) for z in (2.0, 3.0)]
    fewer = decimated(merged(*planes), 2000, VIEW.position)
    assert fewer.triangles_before > 70_000
    assert fewer.error_m < 1e-4


def test_thickness_neither_inflates_the_lift_nor_breaks_the_budget():
    x, y = np.meshgrid(np.arange(160), np.arange(120))
    depth = np.where((x - 80) ** 2 + (y - 60) ** 2 < 900, 1.5, 3.0 + 0.001 * x)
    thin = surface_of_depth(depth, VIEW, occluder_triangles=3000)
    thick = surface_of_depth(depth, VIEW, occluder_triangles=3000, thickness_m=0.3)
    assert thick.bias.real_m < 2 * thin.bias.real_m + 0.01
    assert len(thick.occluder.geometry.triangles) <= 3000


@pytest.mark.usefixtures("gpu")
def test_the_sun_is_not_shadowed_by_nothing():
    normals = np.broadcast_to([0.0, 0, 1], (120, 160, 3)).copy()
    sun = DirectionalLamp("sun", np.array([0.6, 0.0, -0.8]), np.full(3, 50.0))
    prepared = Prepared(
        {"mono": CameraFrame(np.full((120, 160, 3), 0.3, np.float32), VIEW)},
        SurfaceModel(normals={"mono": normals}),
        Ambient(np.full(3, 100.0)),
        lambda _: (sun,),
    )
    for engine in ("gpu", "reference"):
        lux = np.asarray(Renderer(prepared, engine).render().illuminance.lux)
        np.testing.assert_allclose(lux, 40.0, rtol=1e-3)


def test_two_lamps_of_one_name_are_refused():
    lamp = PointLamp("bulb", np.array([0, 0, -1.0]), np.ones(3))
    photo, depth = np.full((120, 160, 3), 99, np.uint8), np.full((120, 160), 2.0)
    with pytest.raises(InputError, match="names must differ"):
        relight(photo, VIEW, [lamp, replace(lamp)], depth_m=depth, ambient_lux=100.0)


def test_outputs_never_overwrite_inputs_or_each_other(tmp_path, capsys):
    photo = tmp_path / "p.png"
    photo.write_bytes(b"mine")
    same = str(photo)
    assert _run(["relight", same, "-o", same], debug=False) == 2
    out = str(tmp_path / "o.png")
    assert _run(["relight", same, "-o", out, "--illuminance-map", out], debug=False) == 2
    assert "overwritten" in capsys.readouterr().err
    assert photo.read_bytes() == b"mine"


@pytest.mark.usefixtures("gpu")
@pytest.mark.parametrize("engine", ["gpu", "reference"])
def test_a_lamp_exactly_at_the_eye_has_no_disc_and_does_not_crash(engine):
    lamp = PointLamp("here", np.zeros(3), np.ones(3), visible_radius_m=0.05)
    photo, depth = np.full((120, 160, 3), 99, np.uint8), np.full((120, 160), 2.0)
    frame = relight(photo, VIEW, [lamp], depth_m=depth, ambient_lux=100.0, engine=engine)
    assert np.isfinite(np.asarray(frame.luminance.cd_m2)).all()
    assert frame.image.rgb.max() < 120
