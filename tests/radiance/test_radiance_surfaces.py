"""Surfaces in Radiance: what they reflect and emit, textures, and a reflectance per triangle."""

from dataclasses import replace

import numpy as np
import pytest
from asked import luminance_of, lux_of

from andon.errors import InputError
from andon.lamps import PointLamp
from andon.quantities import Geometry, Material
from andon.responses import srgb_decode
from andon.surface.textures import sample_bilinear
from andon.transport.baked.radiance import radiance_bundle, with_triangle_reflectance
from requirements import required
from worlds import ball, block

required("pyradiance")

EMITTED = np.array([10.0, 20.0, 30.0])
FLOOR = np.array([[0.2, 0.0, 0.3], [-0.5, 0.0, -0.3], [0.7, 0.0, 0.9]])
UP = np.tile([0.0, 1.0, 0.0], (3, 1))


def furnace(reflectance):
    """A closed box of 2 × 3 × 2.5 m whose walls all reflect and all emit."""
    box = block((2, 3, 2.5), (0, 1.5, 0))
    walls = Material("walls", reflectance, None, tuple(EMITTED))
    inwards = np.ascontiguousarray(box.triangles[:, ::-1])
    return Geometry(box.positions, inwards, materials=(walls,))


@pytest.mark.parametrize("reflectance", [(0.5, 0.3, 0.0), (0.98, 0.1, 1.0)])
@pytest.mark.parametrize("bounces", [1, 2, 3])
def test_a_furnace_is_the_geometric_series(reflectance, bounces):
    """E = π L (1 + ρ + ρ² …): every wall sees the same, wherever it looks."""
    bundle = radiance_bundle([furnace(reflectance)], [], emission=True)
    lux = lux_of(bundle, FLOOR, UP, bounces, "-aa", "0", "-ad", "64", "-as", "0")
    rho = np.array(reflectance)
    want = np.pi * EMITTED * sum(rho**k for k in range(bounces))
    np.testing.assert_allclose(lux, np.tile(want, (3, 1)), rtol=0.004)


def test_many_bounces_in_a_furnace_approach_the_closed_form():
    bundle = radiance_bundle([furnace((0.5, 0.3, 0.0))], [], emission=True)
    lux = lux_of(bundle, FLOOR, UP, 7, "-aa", "0.2", "-ad", "128", "-as", "32")
    want = np.pi * EMITTED / (1 - np.array([0.5, 0.3, 0.0]))
    np.testing.assert_allclose(lux, np.tile(want, (3, 1)), rtol=0.01)


def test_emission_is_left_out_and_black_reflects_nothing():
    room, lamp = furnace((0.5, 0.5, 0.5)), PointLamp("p", np.array([0, 1.5, 0]), np.full(3, 50.0))
    dark = radiance_bundle([room], [])
    assert not lux_of(dark, FLOOR, UP, 2, "-aa", "0", "-ad", "64").any()
    direct = lux_of(radiance_bundle([room], [lamp]), FLOOR, UP)
    bounced = lux_of(radiance_bundle([room], [lamp]), FLOOR, UP, 1, "-aa", "0", "-ad", "256")
    black = radiance_bundle([room], [lamp], black=True)
    assert (bounced > 1.2 * direct).all()
    np.testing.assert_array_equal(lux_of(black, FLOOR, UP, 1, "-aa", "0", "-ad", "256"), direct)


def test_surfaces_are_diffuse_and_have_two_sides():
    """L = ρ E/π from any direction, above and below, whatever glTF says of metal and gloss."""
    colour = np.array([0.6, 0.3, 0.1])
    shiny = Material("m", tuple(colour), metallic=1.0, roughness=0.1, two_sided=False)
    sheet = Geometry(
        np.array([[-5, 0, 5], [5, 0, 5], [0, 0, -5.0]]), np.array([[0, 1, 2]], np.int32),
        materials=(shiny,),
    )  # fmt: skip
    for side in (1.0, -1.0):
        lamp = PointLamp("p", np.array([0, 2.0 * side, 0]), np.full(3, 90.0))
        bundle = radiance_bundle([sheet], [lamp])
        origins = np.array([[0.3, side, 0], [1.2, side, 0], [0, 0.2 * side, 1.5]])
        looking = -origins / np.linalg.norm(origins, axis=1, keepdims=True)
        seen = luminance_of(bundle, origins, looking)
        np.testing.assert_allclose(seen, np.tile(colour * 90 / 4 / np.pi, (3, 1)), rtol=1e-4)


@pytest.mark.parametrize("kind", [np.uint8, np.float32])
@pytest.mark.parametrize("shape", [(5, 9), (8, 3), (16, 16), (1, 1)])
def test_textures_are_looked_up_as_our_own(shape, kind):
    """Wrapping, v down, any aspect, bilinear; off by the steps of RGBE, 0.4 % of a channel."""
    random = np.random.default_rng(7)
    texture = random.integers(0, 256, (*shape, 3)).astype(kind)
    if kind == np.float32:
        texture /= 255
    corners = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1.0]])
    uvs = np.array([[-0.7, 2.3], [1.9, 2.1], [1.5, -0.8], [-0.9, -0.2]])
    colour = (0.9, 0.5, 0.7)
    painted = Geometry(
        corners, np.array([[0, 2, 1], [0, 3, 2]], np.int32), uvs=uvs,
        materials=(Material("t", colour, texture),),
    )  # fmt: skip
    weights, triangle = random.dirichlet((1, 1, 1), 400), random.integers(0, 2, 400)
    chosen = painted.triangles[triangle]
    points = np.einsum("ni,nij->nj", weights, corners[chosen])
    uv = np.einsum("ni,nij->nj", weights, uvs[chosen])
    linear = srgb_decode(texture / 255) if kind == np.uint8 else texture
    want = sample_bilinear(linear, uv) * colour
    lamp = np.array([0, 50.0, 0])
    bundle = radiance_bundle([painted], [PointLamp("p", lamp, np.full(3, 1e6))])
    seen = luminance_of(bundle, np.add(points, [0, 0.5, 0]), np.tile([0, -1.0, 0], (400, 1)))
    lux = 1e6 * 50 / np.linalg.norm(points - lamp, axis=1) ** 3
    np.testing.assert_allclose(seen * np.pi / lux[:, None], want, atol=0.004)


def test_a_texture_without_coordinates_is_left_out_and_no_surface_reflects_more_than_all():
    floor = np.array([[-5, 0, 5], [5, 0, 5], [0, 0, -5.0]])
    bright = Material("m", (0.5, 1.0, 0.2), np.full((2, 2, 3), 1.5, np.float32))
    lamp = PointLamp("p", np.array([0, 2.0, 0]), np.full(3, 90.0))
    for uvs, want in ((None, [0.5, 1, 0.2]), (np.zeros((3, 2)), [0.75, 1, 0.3])):
        part = Geometry(floor, np.array([[0, 1, 2]], np.int32), uvs=uvs, materials=(bright,))
        bundle = radiance_bundle([part], [lamp])
        seen = luminance_of(bundle, np.array([[0, 1.0, 0]]), np.array([[0, -1.0, 0]]))
        np.testing.assert_allclose(seen[0] * np.pi / 22.5, want, rtol=0.005)


def test_large_textures_are_averaged():
    stripes = np.zeros((4, 4096, 3), np.float32)
    stripes[:, ::2] = 1  # finer than 1024 pixels: half as bright
    part = Geometry(
        np.array([[-5, 0, 5], [5, 0, 5], [0, 0, -5.0]]), np.array([[0, 1, 2]], np.int32),
        uvs=np.array([[0, 0], [1, 0], [0, 1.0]]), materials=(Material("m", (1, 1, 1), stripes),),
    )  # fmt: skip
    bundle = radiance_bundle([part], [PointLamp("p", np.array([0, 2.0, 0]), np.full(3, 90.0))])
    seen = luminance_of(bundle, np.array([[0, 1.0, 0]]), np.array([[0, -1.0, 0]]))
    np.testing.assert_allclose(seen[0] * np.pi / 22.5, 0.5, rtol=0.005)
    assert len(bundle["part0.0.hdr"]) < 40_000


def test_what_is_finer_than_a_bounce_shows_is_averaged():
    """Of 512 pixels on half a metre 100 are left, on 10 m all; what is reflected is the same."""
    texture = np.random.default_rng(3).uniform(0, 1, (512, 256, 3)).astype(np.float32)
    uvs = np.array([[0, 0], [1, 0], [0, 1.0]])
    lamp, size = PointLamp("p", np.array([0.1, 1.0, 0.1]), np.full(3, 90.0)), {}
    points, down = np.array([[0.15, 0.2, 0.15]]), np.array([[0, -1.0, 0]])
    for side, count in ((0.5, 102 * 102), (10.0, 514 * 258)):
        corners = np.array([[0, 0, 0], [side, 0, 0], [0, 0, side]])
        part = Geometry(corners, np.array([[0, 1, 2]], np.int32), uvs=uvs,
                        materials=(Material("m", (1, 1, 1), texture),))  # fmt: skip
        bundle = radiance_bundle([part], [lamp])
        size[side] = len(bundle["part0.0.hdr"])
        assert 4 * count < size[side] < 4 * count + 100
    plain = replace(part, positions=part.positions * 0.05, materials=(Material("m", (0.5,) * 3),))
    part = replace(part, positions=plain.positions)
    options = ("-aa", "0", "-ad", "16384", "-as", "0")
    found, want = (
        lux_of(radiance_bundle([x], [lamp]), points, down, 1, *options) for x in (part, plain)
    )
    np.testing.assert_allclose(found, want, rtol=0.02)


def test_every_triangle_gets_its_reflectance():
    """Each within 1/levels, all of a cell exactly on the mean, so also all together."""
    shape = ball(1.0, (0, 0, 0), 12)
    rgb = np.random.default_rng(0).uniform(0, 1, (len(shape.triangles), 3))
    rgb[5] = np.nan
    known = np.arange(len(rgb)) != 5
    painted = with_triangle_reflectance(shape, rgb, levels=8)
    got = np.array([m.reflectance for m in painted.materials])[painted.material_ids]
    assert len(painted.materials) <= 8**3
    assert np.abs(got - rgb)[known].max() < 1 / 8
    np.testing.assert_allclose(got.mean(axis=0), rgb[known].mean(axis=0), rtol=1e-9)
    np.testing.assert_allclose(got[5], rgb[known].mean(axis=0), atol=1 / 8)
    fine = with_triangle_reflectance(shape, rgb)
    finer = np.array([m.reflectance for m in fine.materials])[fine.material_ids]
    assert np.abs(finer - rgb)[known].max() < 1 / 32
    assert np.abs(finer - rgb)[known].mean() < 1 / 100


@pytest.mark.parametrize(
    ("rgb", "levels", "rule"),
    [
        (np.zeros((3, 3)), 8, "must be"),
        (np.full((1, 3), 1.2), 8, "0…1"),
        (np.full((1, 3), -0.1), 8, "0…1"),
        (np.zeros((1, 3)), 1, "2…64"),
    ],
)
def test_hostile_reflectances_are_refused(rgb, levels, rule):
    one = Geometry(np.eye(3), np.array([[0, 1, 2]], np.int32))
    with pytest.raises(InputError, match=rule):
        with_triangle_reflectance(one, rgb, levels=levels)


@pytest.mark.parametrize(
    "material",
    [
        Material(reflectance=(np.nan, 0, 0)),
        Material(reflectance=(1.5, 0, 0)),
        Material(emissive_cd_m2=(-1, 0, 0)),
        Material(texture=np.zeros((0, 2, 3), np.uint8)),
    ],
)
def test_hostile_materials_are_refused(material):
    part = Geometry(np.eye(3), np.array([[0, 1, 2]], np.int32), uvs=np.zeros((3, 2)))
    with pytest.raises(InputError, match=r"parts\[0\].materials\[0\]"):
        radiance_bundle([replace(part, materials=(material,))], [])
