"""What of a scene stands still."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.scene import scene_from_dict
from andon.surface.still import still_geometry, still_objects
from worlds import block, write_obj


@pytest.fixture
def folder(tmp_path):
    write_obj(tmp_path / "room.obj", block((4, 3, 4), (0, 1.5, 0), inwards=True))
    write_obj(tmp_path / "box.obj", block((1, 1, 1), (0, 0.5, 0)))
    return tmp_path


def scene(folder, **tables):
    return scene_from_dict(tables, folder=folder)


def test_the_surface_and_objects_that_stand(folder):
    key = [{"time_seconds": 0.0, "position": [0, 0, 0]}]
    still = scene(
        folder,
        surface={"mesh": "room.obj"},
        object=[
            {"mesh": "box.obj", "key": key},
            {"mesh": "box.obj", "position": [1, 0, 0]},
        ],
    )
    assert still_objects(still) == (1,)
    geometry = still_geometry(still)
    assert len(geometry.triangles) == 24
    np.testing.assert_allclose(geometry.positions[:, 0].max(), 2)
    assert len(geometry.materials) == 2
    assert set(geometry.material_ids) == {0, 1}


def test_another_real_surface_stands_in_for_the_mesh(folder):
    real = block((9, 9, 9), (0, 0, 0))
    geometry = still_geometry(scene(folder, surface={"depth": "d.npy"}), real=real)
    assert len(geometry.triangles) == 12
    np.testing.assert_allclose(np.ptp(geometry.positions, axis=0), 9)


def test_nothing_is_empty(folder):
    assert len(still_geometry(scene(folder)).triangles) == 0


def test_a_depth_image_alone_is_refused(folder):
    with pytest.raises(InputError, match="does not depend on a view"):
        still_geometry(scene(folder, surface={"depth": "d.npy"}))
