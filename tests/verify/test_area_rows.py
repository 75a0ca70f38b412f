"""Thinned accuracy rows of area lamps."""

import pytest

from andon.verify.registry import rows
from andon.verify.rows import area_scene, penumbra
from andon.verify.run import chosen, measured


@pytest.mark.parametrize("name", ["relight.area.disk.reference", "relight.area.polygon.reference"])
def test_closed_forms_hold(name):
    (entry,) = chosen([name], rows())
    assert measured(entry)["holds"] is True, measured(entry)


@pytest.mark.usefixtures("gpu")
@pytest.mark.parametrize("name", ["relight.area.sphere.gpu", "relight.area.disk.gpu"])
def test_shaders_hold(name):
    (entry,) = chosen([name], rows())
    assert measured(entry)["holds"] is True, measured(entry)


@pytest.mark.slow
@pytest.mark.usefixtures("gpu")
@pytest.mark.parametrize("kind", ["sphere", "polygon", "tube", "mesh"])
@pytest.mark.parametrize("engine", ["reference", "gpu"])
def test_all_kinds_hold(kind, engine):
    (entry,) = chosen([f"relight.area.{kind}.{engine}"], rows())
    assert measured(entry)["holds"] is True, measured(entry)


def test_a_room_with_area_lamps_is_radiances_but_for_penumbrae(monkeypatch):
    """A thinned `relight.area.scene.reference`: a thirtieth of the points, coarser lamps."""
    monkeypatch.setattr(area_scene, "ROWS_STEP", 11)
    monkeypatch.setattr(area_scene, "COLUMNS_STEP", 23)
    monkeypatch.setattr(area_scene, "CUTS", 0)
    caches = area_scene._frame, area_scene._truth, area_scene._edges, area_scene.area_scene
    for cache in caches:
        cache.cache_clear()
    median, p95, left_out = area_scene.area_scene("reference", 4)
    for cache in caches:
        cache.cache_clear()
    assert median < 0.01
    assert p95 < 0.05
    assert left_out < 0.8


@pytest.mark.parametrize("shape", penumbra.SHAPES)
def test_a_penumbra_has_its_width(shape):
    ours, truth = penumbra.penumbra_widths(shape, 1.0, "reference")
    assert ours == pytest.approx(truth, rel=0.15)


def test_the_truth_of_a_rectangles_penumbra_is_its_size_seen_through_a_slit():
    # A square of side s over an edge: what is left falls evenly, and 80 % of its s·b/a is counted.
    _, truth = penumbra.penumbra_widths("rectangle", 1.0, "reference")
    assert truth == pytest.approx(0.8 * 2 * penumbra.RADIUS_M, rel=0.01)


@pytest.mark.usefixtures("gpu")
@pytest.mark.parametrize("shape", penumbra.SHAPES)
def test_shaders_have_it_too_where_maps_are_fine(shape):
    ours, truth = penumbra.penumbra_widths(shape, 1.0, "gpu", penumbra.FINE_SHADOW)
    assert ours == pytest.approx(truth, rel=0.15)


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["reference", "gpu"])
def test_the_whole_room_holds(engine, request):
    if engine == "gpu":
        request.getfixturevalue("gpu")
    for entry in chosen([f"relight.area.scene.{engine}"], rows()):
        assert measured(entry)["holds"] is not False, measured(entry)
