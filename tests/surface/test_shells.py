"""Which pixels of a photograph show a real shade, and how much of its light they get."""

from dataclasses import replace

import numpy as np
import pytest

from andon.lamps import PointLamp, Shell, expand
from andon.lamps.shells.drum import drum_mesh
from andon.lamps.shells.model import Drum
from andon.quantities import Geometry
from andon.spaces import View
from andon.surface.reference import from_depth, trace
from andon.surface.shells import find_shells
from worlds import sheet

# The camera looks along −Z, 1.2 m before the shade; a wall is 40 cm behind it.
VIEW = View("pinhole", 96, 72, 110.0, 110.0, 47.5, 35.5)
PLACE = np.array([0.0, 0.0, -1.2])
MARGIN_M = 0.02
WALL_M = 1.6


def drum(grown=0.0):
    return Drum(0.15 + grown, 0.12 + grown, 0.2, 0.1)


def body(grown=0.0, flux_cd=50.0):
    lamp = PointLamp("lamp", PLACE, np.full(3, flux_cd))
    shell = Shell(drum=drum(grown), transmittance=np.full(3, 0.5), absorptance=0.1, real=True)
    return expand(lamp, shell)[1]


def room(shade=None, *, lift=0.0):
    """Depth of a shade before a wall, as the view has it."""
    mesh = drum_mesh(drum() if shade is None else shade, 96, 8)
    seen = trace(
        Geometry(mesh.positions + PLACE + (0, lift, 0), mesh.triangles), VIEW, is_object=False
    )
    return np.where(seen.valid, seen.depth, WALL_M), seen.valid


def looked(depth, stated, margin_m=MARGIN_M):
    """What the view sees, with normals towards the camera."""
    real = from_depth(depth, np.broadcast_to((0.0, 0.0, 1.0), (*VIEW.shape, 3)), VIEW)
    return find_shells(real, [stated], [margin_m])


def test_a_shade_shines_as_its_body_says():
    depth, shade = room()
    seen = looked(depth, body())
    np.testing.assert_array_equal(seen.shell_id == 0, shade)
    light = seen.light([body()])[..., 1]
    alone = body().outside_cd_m2[:, 1]
    inner = shade & (np.abs(np.indices(VIEW.shape)[0] - 35.5) < 6)
    assert light[inner].min() > 0.9 * alone.min()
    assert light[inner].max() < 1.01 * alone.max()
    assert seen.seen_share[0] == 1.0


def test_its_outline_is_smooth_and_its_light_is_kept():
    """As much light as the solid angle that it has, to the pixel's hundredths."""
    depth, _ = room()
    even = replace(body(), outside_cd_m2=np.ones((len(body().outside_cd_m2), 3)))
    even = replace(even, inside_cd_m2=even.outside_cd_m2)
    light = looked(depth, even).light([even])[..., 0]
    assert ((light > 0.1) & (light < 0.9)).sum() > 40
    assert light.max() <= 1 + 1e-9
    many = VIEW.resized(4 * VIEW.width, 4 * VIEW.height)
    mesh = drum_mesh(drum(), 72, 12)
    fine = trace(Geometry(mesh.positions + PLACE, mesh.triangles), many, is_object=False)
    assert light.sum() == pytest.approx(fine.valid.mean() * light.size, rel=2e-3)


@pytest.mark.parametrize("grown", [-0.015, 0.015])
def test_a_stated_shade_that_is_a_little_off_leaves_no_ring(grown):
    """The measured shade shines up to its own rim, and nothing beside it does."""
    depth, shade = room()
    stated = body(grown)
    light = looked(depth, stated).light([stated])[..., 1]
    exact = looked(depth, body()).light([body()])[..., 1]
    interior, near = shade.copy(), shade.copy()
    for down, right in np.ndindex(3, 3):
        moved = np.roll(shade, (down - 1, right - 1), (0, 1))
        interior, near = interior & moved, near | moved
    # A smaller shade of the same lamp is brighter, and the other way round.
    np.testing.assert_allclose(light[interior], exact[interior], rtol=0.3)
    # What is smoothed of an outline that is somewhere else is one pixel wide.
    assert not light[~near].any()


def test_holes_in_the_shade_shine_and_hide():
    depth, shade = room()
    random = np.random.default_rng(2)
    holed = np.where(shade & (random.random(depth.shape) < 0.5), np.nan, depth)
    whole, seen = looked(depth, body()), looked(holed, body())
    light, holed_light = (x.light([body()]) for x in (whole, seen))
    np.testing.assert_allclose(holed_light, light, rtol=0.02, atol=1e-9)
    marked = seen.marked(from_depth(holed, np.ones((*VIEW.shape, 3)), VIEW))
    assert (marked.cover[shade & np.isnan(holed)] < 1.4).all()


def test_all_of_it_may_be_a_hole():
    depth, shade = room()
    light = looked(np.where(shade, np.nan, depth), body()).light([body()])[..., 1]
    np.testing.assert_array_equal(light > 0.5 * light.max(), shade & (light > 0.5 * light.max()))
    assert light[shade].min() > 0


def test_what_is_before_the_shade_takes_no_light_of_it():
    depth, _ = room()
    columns = np.broadcast_to(np.arange(VIEW.width) > 47, VIEW.shape)
    seen = looked(np.where(columns, 0.8, depth), body())
    assert not seen.light([body()])[columns].any()
    assert (seen.shell_id[columns] == -1).all()
    assert 0 < seen.seen_share[0] < 0.6


def test_a_shade_somewhere_else_is_not_found():
    depth, _ = room()
    lamp = PointLamp("lamp", PLACE + np.array([0.0, 0.0, 0.15]), np.ones(3))
    elsewhere = expand(lamp, Shell(drum=drum(), real=True))[1]
    seen = looked(depth, elsewhere)
    assert seen.seen_share[0] < 0.3


def test_from_above_the_inside_is_seen():
    """The camera looks down into the shade: its far wall is brighter than its outside."""
    pose = np.eye(4)
    forward = np.array([0, -1.0, -0.9]) / np.hypot(1.0, 0.9)
    right = np.array([1.0, 0, 0])
    pose[:3, :3] = np.stack([right, np.cross(forward, right), forward], axis=1)
    pose[:3, 3] = PLACE + np.array([0, 1.0, 0.9])
    view = replace(VIEW, world_from_camera=pose)
    mesh = drum_mesh(drum(), 96, 8)
    seen = trace(Geometry(mesh.positions + PLACE, mesh.triangles), view, is_object=False)
    table = trace(sheet((-3, -0.4, 3), (6, 0, 0), (0, 0, -6)), view, is_object=False)
    depth = np.where(seen.valid, seen.depth, table.depth)
    real = from_depth(depth, np.broadcast_to((0.0, 1.0, 0.0), (*view.shape, 3)), view)
    stated = body()
    found = find_shells(real, [stated], [MARGIN_M])
    light = found.light([stated])[..., 1]
    inside = light[26, 47], light[29, 47]
    assert min(inside) == pytest.approx(np.median(stated.inside_cd_m2[:, 1]), rel=0.5)
    both = {round(float(x), 3) for x in (stated.inside_cd_m2.max(), stated.outside_cd_m2.max())}
    assert len(both) == 2
