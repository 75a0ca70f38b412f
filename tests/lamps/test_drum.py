"""Shells of the form drum: their areas, their light, and what a scene may say of them."""

import numpy as np
import pytest
from shell_worlds import directions, far_intensity, lamp, sent_lm

from andon.errors import InputError
from andon.lamps import PointLamp, Shell, expand
from andon.lamps.polygons import vector_area
from andon.lamps.shells.drum import drum_mesh
from andon.lamps.shells.form import form_of
from andon.lamps.shells.model import Drum
from andon.lamps.triangles import triangle_areas

CONE = Drum(0.17, 0.13, 0.22, 0.10)
T = np.array([0.5, 0.4, 0.3])


def test_facets_and_lids_have_the_areas_of_the_cone():
    form = form_of(Shell(drum=CONE))
    slant = np.hypot(CONE.height_m, CONE.radius_m - CONE.top_radius_m)
    side = np.pi * (CONE.radius_m + CONE.top_radius_m) * slant
    # A polygon of sixteen corners has 0.65 % more edge than the circle of its area.
    assert triangle_areas(form.facets).sum() == pytest.approx(1.0065 * side, rel=1e-3)
    lids = [float(np.linalg.norm(vector_area(lid))) for lid in form.lids]
    circles = [np.pi * CONE.top_radius_m**2, np.pi * CONE.radius_m**2]
    np.testing.assert_allclose(lids, circles, rtol=1e-9)
    assert len(form.facets) <= 64


def test_lids_and_panels_face_outwards():
    form = form_of(Shell(drum=CONE))
    above, below = (vector_area(lid) for lid in form.lids)
    assert above[1] > 0 > below[1]
    middles = form.facets.mean(axis=1)
    a, b, c = np.moveaxis(form.facets, 1, 0)
    outwards = np.einsum("ij,ij->i", np.cross(b - a, c - a)[:, [0, 2]], middles[:, [0, 2]])
    assert (outwards > 0).all()


def test_normals_are_those_of_the_cone():
    mesh = drum_mesh(CONE, 48, 4)
    a, b, c = (mesh.positions[mesh.triangles[:, i]] for i in range(3))
    flat = np.cross(b - a, c - a)
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    middle = mesh.normals[mesh.triangles].mean(axis=1)
    # Within half a panel, and the mean of three unit vectors is a little shorter than one.
    assert np.einsum("ij,ij->i", flat, middle).min() > np.cos(np.pi / 48) - 2e-3


def test_every_lumen_is_accounted_for():
    parts, body = expand(lamp(), Shell(drum=CONE, transmittance=T, absorptance=0.2))
    met = 1 - sum(_cap(height, radius) for height, radius in ((0.12, 0.13), (0.10, 0.17)))
    expected = 400 * np.pi * (1 - 0.2 * met)
    np.testing.assert_allclose(sent_lm(parts, body), expected, rtol=0.02)


def _cap(height, radius):
    """Share of all directions within a disk at `height` above the lamp."""
    return (1 - height / np.hypot(height, radius)) / 2


def test_a_drum_shines_as_the_same_drum_of_a_mesh():
    mesh = drum_mesh(CONE, 48, 6)
    options = {"transmittance": T, "absorptance": 0.2}
    towards = directions(400)
    sums = [
        sum(far_intensity(part, body, towards) for part in parts)
        for parts, body in (
            expand(lamp(), Shell(drum=CONE, **options)),
            expand(lamp(), Shell(mesh=mesh, **options)),
        )
    ]
    # At the rims of the shadow either has its own polygon.
    apart = np.abs(sums[0] - sums[1]) / sums[1].mean()
    assert np.median(apart) < 0.02
    assert np.percentile(apart, 90) < 0.06


def test_a_shell_says_that_it_is_real_to_its_body():
    shell = Shell(drum=CONE, transmittance=T, real=True, margin_m=0.03)
    _, body = expand(PointLamp("lamp", np.array([1.0, 2, 3]), np.ones(3)), shell)
    assert body.real
    assert body.margin_m == 0.03
    assert body.covers.shape[1:] == (3, 3)
    np.testing.assert_allclose(body.covers.reshape(-1, 3)[:, 1].max(), 2.12)


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"radius_m": 0.0}, "radius_m"),
        ({"top_radius_m": -1.0}, "top_radius_m"),
        ({"height_m": np.inf}, "height_m"),
        ({"drop_m": 0.22}, "drop_m"),
        ({"drop_m": 0.0}, "drop_m"),
    ],
)
def test_drums_that_are_none(changes, field):
    values = {"radius_m": 0.17, "top_radius_m": 0.13, "height_m": 0.22, "drop_m": 0.1}
    with pytest.raises(InputError) as caught:
        Drum(**(values | changes))
    assert caught.value.field == f"shell.drum.{field}"


def test_one_form_only():
    with pytest.raises(InputError, match="exactly one of radius_m, mesh, drum"):
        Shell(radius_m=0.1, drum=CONE)
    with pytest.raises(InputError, match="must be > 0 m"):
        Shell(drum=CONE, real=True, margin_m=0.0)
