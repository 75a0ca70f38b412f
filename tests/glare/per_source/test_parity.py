"""The stage against the reference: 0.5 %, but within θ_min of a point and where all veils end."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.glare import shapes
from andon.glare.model import Source
from andon.glare.per_source.model import PerSource
from andon.glare.per_source.reference import veil_of_sources
from andon.glare.per_source.stage import PerSourceStage
from andon.observer.spread.family import spread_function
from andon.spaces import View
from comparison import assert_agree

from .drawing import drawn, encoded
from .views import CORNER, KERNEL, PLACES, VIEWS, angles, unit

DEGREE = np.pi / 180
LUX = np.array([30.0, 20.0, 10.0])
OUTLINES = [
    shapes.ellipse(3 * DEGREE, 1 * DEGREE),
    shapes.cylinder(2 * DEGREE, 0.1 * DEGREE),
    shapes.hemisphere(2 * DEGREE),
    shapes.pear(2 * DEGREE, 0.6 * DEGREE, 3 * DEGREE),
]


def assert_parity(gpu, view, sources, **options):
    # What half floats hold.
    expected = np.minimum(veil_of_sources(sources, view, KERNEL, **options), 65504.0)
    actual = drawn(gpu, view, sources, **options)
    theta = np.stack([angles(view.directions(), source.direction) for source in sources])
    # Where K jumps within a pixel, and where the field of view ends, values are all but 0.
    seen = np.all((theta > 0.12 * DEGREE) & (theta < 100 * DEGREE), axis=0)
    assert_agree(actual[seen], expected[seen], rtol=5e-3, atol=2e-4)


@pytest.mark.parametrize("degrees", [0.002, 0.033, 2.0])
@pytest.mark.parametrize(("name", "towards"), PLACES)
def test_circles(gpu, name, towards, degrees):
    assert_parity(gpu, VIEWS[name], [Source(towards, LUX, shapes.circle(degrees * DEGREE))])


@pytest.mark.parametrize("name", VIEWS)
def test_outlines_and_halos(gpu, name):
    view, spread = VIEWS[name], spread_function("spencer")
    tilted = unit(0.1, 0.2, 1)
    places = [CORNER[name], unit(0.011, 0.02, 1), tilted, unit(-0.1, 0.05, 1)]
    right = np.cross(tilted, unit(1, 2, 3))
    sources = [Source(place, LUX, o) for place, o in zip(places, OUTLINES, strict=True)]
    sources[2] = Source(tilted, LUX, OUTLINES[2], right / np.linalg.norm(right))
    assert_parity(gpu, view, sources, halo=spread, weights=[1, 0.5, 0, 1])


def test_many_sources_some_with_a_reach(gpu):
    view = VIEWS["60"]
    generator = np.random.default_rng(5)
    places = view.directions_at(generator.uniform(0, (view.width, view.height), (20, 2)))
    lights = np.geomspace(0.1, 100, 20)
    sources = [
        Source(place, np.full(3, lux), shapes.circle(0.1 * DEGREE))
        for place, lux in zip(places, lights, strict=True)
    ]
    expected = veil_of_sources(sources, view, KERNEL, settings=PerSource(least_cd_m2=0.05))
    actual = drawn(gpu, view, sources, settings=PerSource(least_cd_m2=0.05))
    assert_agree(actual, expected, rtol=5e-3, atol=0.06, share=1e-3)


def test_stage_adds_and_is_updated(gpu):
    view = View("latlong", 90, 45)
    stage = PerSourceStage(gpu, view, 3, luminance_per_unit=10.0)
    assert (encoded(gpu, view, stage, start=1.0) == 1).all()
    source = Source(unit(1, 0, 0.2), LUX, shapes.circle(1 * DEGREE))
    for sources in ([source], [], [source, source, source]):
        stage.update(sources, KERNEL)
        expected = len(sources) * veil_of_sources([source], view, KERNEL) / 10
        assert_agree(encoded(gpu, view, stage, start=1.0) - 1, expected, rtol=5e-3, atol=6e-3)


def test_more_than_there_is_room_for(gpu):
    stage = PerSourceStage(gpu, VIEWS["20"], 2, outlines=1)
    sources = [Source(unit(0, 0, 1), LUX, outline) for outline in OUTLINES]
    with pytest.raises(InputError, match="at most 2 sources"):
        stage.update(sources, KERNEL)
    with pytest.raises(InputError, match="at most 1 outlines"):
        stage.update(sources[:2], KERNEL)
    stage.update(sources[:1], KERNEL)
    stage.update(sources[1:2], KERNEL)
    picture = encoded(gpu, VIEWS["20"], stage)
    expected = veil_of_sources(sources[1:2], VIEWS["20"], KERNEL)
    assert_agree(picture, expected, rtol=5e-3, atol=2e-4)
