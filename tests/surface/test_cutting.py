"""The real surface without a lamp's own shade: what is cut away, and what is not."""

import numpy as np
import pytest

from andon.lamps import PointLamp, Shell, expand
from andon.lamps.shells.drum import drum_mesh
from andon.lamps.shells.model import Drum
from andon.lamps.triangles import triangle_areas
from andon.quantities import Geometry, merged
from andon.rays import RayScene
from andon.surface.cutting import parted, within
from worlds import block, points_on, sheet

PLACE = np.array([0.3, 1.0, -0.5])
DRUM = Drum(0.15, 0.11, 0.2, 0.09)
MARGIN_M = 0.02
# A wall 30 cm behind the lamp, and a table under it.
WALL = sheet((-1, 0.75, -0.8), (2.6, 0, 0), (0, 2, 0))
TABLE = sheet((-0.5, 0.7, -0.8), (0, 0, 0.8), (1.6, 0, 0))


def shade(name="lamp", place=PLACE, **options):
    lamp = PointLamp(name, np.asarray(place, float), np.ones(3))
    return expand(lamp, Shell(drum=DRUM, real=True, **options))[1]


def area(geometry):
    return triangle_areas(geometry.positions[geometry.triangles]).sum()


def measured(noise_m=0.004):
    """The shade as it is measured: rough, with its socket, on a stem."""
    mesh = drum_mesh(DRUM, 24, 6)
    random = np.random.default_rng(3)
    points = mesh.positions + PLACE + random.normal(0, noise_m, mesh.positions.shape)
    socket = block((0.03, 0.05, 0.03), PLACE)
    stem = block((0.02, 0.3, 0.02), PLACE - (0, 0.15, 0))
    return merged(Geometry(points, mesh.triangles), socket, stem)


def test_within_is_inside_or_near():
    body = shade()
    inside = PLACE + np.array([[0, 0.1, 0], [0, -0.08, 0], [0.1, 0, 0.02], [0, 0, 0]])
    near = PLACE + np.array([[0, 0.02, 0.14], [0.16, -0.1, 0]])
    away = PLACE + np.array([[0, 0.17, 0], [0, -0.15, 0], [0.2, 0, 0], [0, 0.0, -0.3]])
    assert within(body, MARGIN_M, np.concatenate([inside, near])).all()
    assert not within(body, MARGIN_M, away).any()


def test_the_bulb_shines_out_of_what_was_its_shade():
    rest, parts = parted(merged(WALL, TABLE, measured()), [shade()], [MARGIN_M])
    assert list(parts) == [frozenset({"lamp"})]
    towards, _ = points_on(WALL, 300)
    assert RayScene(rest).is_visible(0.999 * towards + 0.001 * PLACE, PLACE).mean() > 0.99
    whole = merged(WALL, TABLE, measured())
    assert not RayScene(whole).is_visible(0.999 * towards + 0.001 * PLACE, PLACE).all()


def test_nothing_else_is_cut():
    everything = merged(WALL, TABLE, measured())
    rest, parts = parted(everything, [shade()], [MARGIN_M])
    (own,) = parts.values()
    assert area(rest) + area(own) == pytest.approx(area(everything), rel=1e-9)
    assert area(rest) > area(WALL) + area(TABLE)
    # The stem hides the table under it still.
    below = np.array([[PLACE[0] + 0.05, 0.701, PLACE[2]]])
    assert not RayScene(rest).is_visible(below, PLACE - (0, 0.12, 0)).any()


def test_skirts_from_the_rim_to_the_wall_go():
    body = shade()
    rim = PLACE + np.array([0.15, -0.09, 0])
    skirt = Geometry(
        rim + np.array([[0, 0, 0], [0, 0, -0.3], [0, 0.15, -0.3]]), np.array([[0, 1, 2]], np.int32)
    )
    _, parts = parted(merged(WALL, skirt), [body], [MARGIN_M])
    (own,) = parts.values()
    # Of a large triangle only what touches the shade is the shade.
    assert 0 < area(own) < 0.25 * area(skirt)


def test_two_shades_that_touch_share_what_is_between():
    other = PLACE + np.array([0.31, 0, 0])
    bodies = [shade(), shade("other", other)]
    between = block((0.03, 0.03, 0.03), (PLACE + other) / 2 - (0, 0.08, 0))
    _, parts = parted(merged(WALL, between), bodies, [MARGIN_M, MARGIN_M])
    assert frozenset({"lamp", "other"}) in parts


def test_without_anything_near_nothing_is_parted():
    rest, parts = parted(WALL, [shade(place=(0.3, 1.0, 3.0))], [MARGIN_M])
    assert not parts
    assert len(rest.triangles) == len(WALL.triangles)
