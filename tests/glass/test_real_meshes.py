"""Meshes of others as glass: Khronos's test models, and a drinking glass."""

import shutil
from dataclasses import replace

import numpy as np
import pytest

from andon.errors import InputError
from andon.files.meshes import read_mesh
from andon.glass.closed import closed_geometry, glass_parts
from andon.glass.load import solids_of
from andon.glass.media import medium_of_material, transmits
from andon.glass.model import Closed
from andon.glass.paths import THROUGH, trace
from andon.quantities import Geometry
from andon.rays import RayScene
from andon.scene import scene_from_dict

MODELS = "gltf_models"
COLOUR = np.array([0.1, 0.5, 0.9])


def materials(data_dir, name):
    """Material name → (medium if it transmits, its triangles)."""
    path = data_dir / MODELS / name
    geometry = read_mesh(path).geometry
    found = {}
    for number, material in enumerate(geometry.materials):
        medium = medium_of_material(material, name) if transmits(material, name) else None
        own = geometry.triangles[geometry.material_ids == number]
        found[material.name] = (medium, replace(geometry, triangles=own, material_ids=None))
    return found


def test_attenuation_is_one_law_for_colour_and_distance(data_dir):
    """attenuationColor is what is left after attenuationDistance, whatever the thickness says."""
    found = materials(data_dir, "AttenuationTest.glb")
    for strength in ("0.25", "0.50", "1.0", "1.5", "2.0"):
        medium, part = found[f"R5_Attenuation_{strength}"]
        assert medium.index == 1.5
        left = np.exp(-np.array(medium.absorption_per_m) / float(strength))
        np.testing.assert_allclose(left, COLOUR, rtol=1e-9)
        closed_geometry(part, ("AttenuationTest.glb", "mesh"))
        if strength != "1.0":  # that one has the name of its row
            thick = found[f"R2_ThicknessFac_{strength}"][0]
            np.testing.assert_allclose(np.exp(-np.array(thick.absorption_per_m)), COLOUR)


def test_panes_without_a_volume_are_clear_and_open(data_dir):
    found = materials(data_dir, "AttenuationTest.glb")
    medium, pane = found["R1_Sample_1.0"]
    assert medium.absorption_per_m == (0.0, 0.0, 0.0)
    with pytest.raises(InputError, match="must be closed, 4 edges"):
        closed_geometry(pane, ("AttenuationTest.glb", "mesh"))
    assert found["FlatBackdrop"][0] is None


@pytest.mark.parametrize("index", ["1.0", "1.33", "1.50", "1.76", "2.42"])
def test_indices_are_those_of_the_labels(data_dir, index):
    medium, part = materials(data_dir, "TransmissionRoughnessTest.glb")[f"Mat_IOR_{index}"]
    assert medium.index == float(index)
    assert len(closed_geometry(part, ("test", "mesh")).triangles) == 12960


def test_only_what_transmits_is_glass(data_dir):
    path = data_dir / MODELS / "TransmissionRoughnessTest.glb"
    clear, media = glass_parts(read_mesh(path).geometry, str(path))
    assert len(clear.triangles) == 5 * 12960
    assert len(media) == 5


def test_a_file_of_many_glasses_is_refused_until_the_scene_says_which(data_dir, tmp_path):
    shutil.copy(data_dir / MODELS / "TransmissionRoughnessTest.glb", tmp_path / "glass.glb")
    table = {"shape": "mesh", "mesh": "glass.glb"}
    with pytest.raises(InputError, match="materials of different index"):
        solids_of(scene_from_dict({"glass": [table]}, folder=tmp_path))
    (solid,) = solids_of(scene_from_dict({"glass": [table | {"index": 1.5}]}, folder=tmp_path))
    assert solid.index == (1.5, 1.5, 1.5)


def test_a_drinking_glass_is_closed_and_lets_rays_through(data_dir, tmp_path):
    """7.5 cm wide and 19.5 cm high; its wall is 58 cm³ of glass."""
    shutil.copytree(data_dir / "glass_and_lamp_ccby" / "glass", tmp_path, dirs_exist_ok=True)
    tables = {"scene": {"unit": "cm"}, "glass": [{"shape": "mesh", "mesh": "glass.obj"}]}
    (solid,) = solids_of(scene_from_dict(tables, folder=tmp_path))
    assert isinstance(solid.shape, Closed)
    geometry = solid.shape.geometry
    size = np.ptp(geometry.positions, axis=0)
    np.testing.assert_allclose(size, [0.0752, 0.1953, 0.0741], atol=1e-4)
    corners = geometry.positions[geometry.triangles]
    volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    assert volume == pytest.approx(57.67e-6, rel=1e-3)
    middle = geometry.positions.mean(axis=0)
    eye = middle + np.array([0.0, 0.1, 0.5])
    aims = middle + np.random.default_rng(3).uniform(-0.5, 0.5, (500, 3)) * 0.8 * size
    directions = (aims - eye) / np.linalg.norm(aims - eye, axis=1, keepdims=True)
    paths = trace([solid], eye, directions)
    hits = paths.events > 0
    seen = RayScene(Geometry(geometry.positions, geometry.triangles))
    first = seen.first_hits(np.broadcast_to(eye, directions.shape), directions).distance
    np.testing.assert_array_equal(hits, np.isfinite(first))
    assert hits.mean() > 0.4
    assert (paths.status[hits] == THROUGH).mean() > 0.9
