"""Thinned accuracy rows of area lamps."""

import pytest

from andon.verify.registry import rows
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
