"""What photographs have and computed scenes do not: holes in things, and things behind things."""

from importlib import resources

import numpy as np

from andon.glass.backdrops import Footprint, look
from andon.glass.backdrops.march import march
from andon.glass.model import Backdrop
from andon.pipeline import render
from andon.quantities import merged
from andon.scene import load_scene
from comparison import assert_agree
from worlds import block, sheet, unit

from .backdrop_scenes import VIEWS, eye_of, surface_of

WALL = sheet((-4, -4, -3), (8, 0, 0), (0, 8, 0))
BOX = block((0.3, 0.3, 0.1), (0.0, 0.0, -1.0))
# Left of the box and behind it.
START = np.array([[-0.9, 0.0, -1.7]])


def test_holes_in_a_thing_do_not_bring_the_ray_behind_it_to_light():
    """Spokes and cylinders are full of pixels without depth; nothing is hit behind them."""
    aside = sheet((0.9, -1, -3), (0, 0, 2.5), (0, 2, 0))
    whole, _ = surface_of(VIEWS["pinhole"], merged(WALL, BOX, aside))
    holed, _ = surface_of(VIEWS["pinhole"], merged(WALL, BOX, aside))
    is_box = whole.depth < 1.2
    generator = np.random.default_rng(1)
    holed.valid[is_box & (generator.random(is_box.shape) < 0.3)] = False
    course = np.array([[1.0, 0.0, 0.0]])
    straight, through = (march(each, START, course) for each in (whole, holed))
    assert_agree(straight.distance_m, [1.8], rtol=1e-6)
    assert_agree(through.distance_m, straight.distance_m, rtol=1e-9)
    assert not through.hidden.any()


def test_what_is_out_of_sight_is_what_was_seen_last():
    """Of the wall behind the box nothing is known; the frame beside the box is shown."""
    eye = eye_of(VIEWS["pinhole"], merged(WALL, BOX))
    course = unit(np.array([[0.7, 0.0, -1.3]]))
    still = Footprint(np.zeros((1, 2, 3)), np.zeros((1, 2, 3)))
    seen = look(Backdrop("surface"), START, course, still, eye)
    assert seen.beside.tolist() == [True]
    # Of the box's back left edge, as the eye sees it.
    place = START + seen.distance_m[:, None] * course
    column, row = eye.view.project(place * [1, -1, -1])[0]
    left = np.flatnonzero(eye.surface.depth[90] < 1.2).min()
    assert abs(column - left) <= 1
    assert_agree(seen.light[0], eye.luminance[round(row), left], rtol=0.05)


def test_the_demonstration_turns_the_motorcycle_upside_down():
    """A ball before it shows it upside down, and nothing in it is lost."""
    with resources.as_file(resources.files("andon") / "data" / "motorcycle") as folder:
        frame = render(load_scene(folder / "glass.toml"), engine="reference")
    layers, counts = frame.glass.layers, frame.glass.counts
    assert counts.glass > 15000
    assert counts.lost == 0
    assert counts.beside < 0.35 * counts.glass
    inside = layers.coverage > 0.99
    rows, columns = np.nonzero(inside)
    middle = int(rows.mean()), int(columns.mean())
    reach = (rows.max() - rows.min()) // 4
    seen = layers.refracted[middle[0] - reach : middle[0] + reach, middle[1]]
    red = (seen[:, 0] > 2 * seen[:, 1]) & (seen[:, 0] > 5)
    # In the photograph the tank is above the engine.
    assert np.flatnonzero(red).mean() > 1.2 * reach
