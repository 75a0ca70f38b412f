"""Bakes of photographed scenes: what light they hold, and how frames use it."""

import numpy as np
import pytest

from andon.bake import bake_file
from andon.bake.to_file import placed_in, scene_geometry
from worlds import ball, scene, write_glb


def with_ball(folder, **tables):
    """A photograph with its depth, two probes, and a ball between them."""
    write_glb(folder / "ball.glb", ball(0.25, (-0.3, 0, -1.4)), colour=(0.5, 0.5, 0.5))
    places = [{"position": [x, 0.0, -1.2]} for x in (-0.5, 0.1)]
    probes = {"volume": "p.glb", "place": places, "cube_size_px": 16}
    base = {"probes": probes, "object": [{"mesh": "ball.glb"}]}
    return scene(folder, **(base | tables))


def test_a_photograph_with_an_object_is_placed_and_baked_without_a_volume(tmp_path):
    loaded = with_ball(tmp_path)
    assert not (tmp_path / "p.glb").exists()
    geometry = scene_geometry(loaded)
    alone = scene_geometry(with_ball(tmp_path, object=[]))
    assert len(geometry.triangles) > len(alone.triangles) > 1000
    assert placed_in(loaded).count == 2
    assert bake_file(loaded, engine="reference").states == ("default",)


def test_the_places_of_e0_by_probes_need_no_volume(tmp_path):
    assert placed_in(with_ball(tmp_path, ambient={"probes": True})).count == 2
