"""The demonstration's real photograph on both engines."""

from importlib import resources

import numpy as np
import pytest
from PIL import Image

from andon.engines.prepared import prepare
from andon.pipeline import Renderer
from andon.scene import load_scene
from andon.transport.direct.casters import ShadowRays
from andon.transport.direct.reference import visibility
from andon.verify.edges import near_change

# A depth image of noisy stereo is cut everywhere, so shadow edges are everywhere: maps and rays
# may differ there by a texel. This bounds them roughly; `andon verify` finds the edges as the lamp
# sees them and holds the rest to the cross-engine tolerance.
NEAR_EDGES_PX = 2
SHARE_AWAY, SHARE_ANYWHERE = 0.005, 0.06


@pytest.fixture(scope="module")
def prepared():
    with resources.as_file(resources.files("andon") / "data" / "motorcycle") as folder:
        return prepare(load_scene(folder / "scene.toml"))


@pytest.fixture(scope="module")
def expected(prepared):
    return Renderer(prepared, "reference").render()


def shadow_edges(prepared, surface):
    """(H, W) bool: within 2 px of where a lamp's shadow begins or ends."""
    casters = ShadowRays(prepared.casters(prepared.at(0.0)))
    bias = prepared.surface.bias
    lift = np.where(surface.is_object, bias.object_m, bias.real_m)
    points = surface.position + surface.normal * lift[..., None]
    edges = np.zeros(surface.valid.shape, bool)
    for lamp in prepared.lamps(0.0):
        visible = np.zeros(surface.valid.shape, bool)
        visible[surface.valid] = visibility(lamp, points[surface.valid], casters)
        edges |= near_change(visible, NEAR_EDGES_PX)
    return edges


def test_the_motorcycle_on_both_engines(gpu, prepared, expected):
    actual = Renderer(prepared, "gpu").render()
    difference = np.abs(actual.image.rgb.astype(int) - expected.image.rgb).max(axis=-1)
    away = ~shadow_edges(prepared, expected.surface)
    assert away.mean() > 0.4
    assert (difference[away] > 5).mean() <= SHARE_AWAY
    assert difference[away].mean() <= 0.5
    assert (difference > 5).mean() <= SHARE_ANYWHERE
    assert (actual.surface.valid != expected.surface.valid).mean() < 1e-4
    assert abs(actual.report.hole_pixels - expected.report.hole_pixels) < 40


def test_the_lamps_light_it_and_holes_stay(prepared, expected):
    with resources.as_file(resources.files("andon") / "data" / "motorcycle" / "photo.png") as path:
        photo = np.asarray(Image.open(path).convert("RGB")).astype(int)
    rgb = expected.image.rgb.astype(int)
    holes = ~expected.surface.valid
    changed = np.abs(rgb - photo).max(axis=-1)
    assert 0.02 < holes.mean() < 0.2
    # In holes only the drawn disc of the lamp may differ.
    assert (changed[holes] > 0).mean() < 0.01
    lit = expected.surface.valid & ~expected.surface.is_object
    assert (rgb - photo)[lit].min() >= 0, "added light darkens nothing"
    assert (changed[lit] > 20).mean() > 0.3
    assert expected.report.photometry == "relative"
    assert 0.001 < expected.surface.is_object.mean() < 0.1
    assert expected.report.occluder_triangles < 32_000
