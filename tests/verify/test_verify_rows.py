"""The accuracy rows and the command that prints them."""

import json

import pytest

from andon.cli import _run
from andon.verify.registry import STAGES, NotShown, Row, rows
from andon.verify.run import chosen, measured

KEYS = ["name", "stage", "bar", "figure", "unit", "holds", "against"]


def row(figure, bar=1.0, *, at_least=False):
    def measure():
        if isinstance(figure, Exception):
            raise figure
        return figure

    return Row("relight.test", "relight", bar, "lx", "a closed form", measure, at_least)


def test_names_are_unique_and_begin_with_their_stage():
    names = [entry.name for entry in rows()]
    assert len(set(names)) == len(names)
    for entry in rows():
        assert entry.stage in STAGES
        assert entry.name.startswith(f"{entry.stage}.")
        assert entry.unit
        assert entry.against


@pytest.mark.parametrize(
    ("figure", "bar", "at_least", "holds"),
    [
        (0.5, 1.0, False, True),
        (1.5, 1.0, False, False),
        (1.5, 1.0, True, True),
        (2.0, None, False, None),
    ],
)
def test_a_bar_holds_or_does_not(figure, bar, at_least, holds):
    result = measured(row(figure, bar, at_least=at_least))
    assert list(result) == KEYS
    assert result["holds"] is holds
    assert result["figure"] == figure


def test_a_figure_that_is_no_number_does_not_hold():
    assert measured(row(float("nan")))["holds"] is False


def test_what_is_not_there_is_not_shown_and_does_not_hold():
    result = measured(row(NotShown("Radiance is missing")))
    assert result["holds"] is False
    assert result["figure"] is None
    assert "Radiance" in result["not_shown"]


def test_rows_are_chosen_by_the_beginning_of_their_names():
    assert {entry.name for entry in chosen(["relight.point"], rows())} == {
        "relight.point.reference",
        "relight.point.gpu",
    }


def test_the_command_prints_measures_and_writes(tmp_path, capsys):
    path = tmp_path / "rows.json"
    assert _run(["verify", "relight.point.reference", "--json", str(path)], debug=False) == 0
    (entry,) = json.loads(path.read_text())
    assert list(entry) == KEYS
    assert entry["holds"] is True
    assert entry["figure"] < 1e-6
    assert "holds" in capsys.readouterr().out


def test_an_unknown_row_names_the_nearest(capsys):
    assert _run(["verify", "relight.pont"], debug=False) == 2
    assert "did you mean 'relight.point" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["relight.identity.reference", "relight.scene.median.reference"])
def test_reference_rows_hold(name):
    (entry,) = chosen([name], rows())
    assert measured(entry)["holds"] is True, measured(entry)


@pytest.mark.usefixtures("gpu")
@pytest.mark.parametrize(
    "name", ["relight.point.gpu", "relight.identity.gpu", "relight.scene.median.gpu"]
)
def test_gpu_rows_hold(name):
    (entry,) = chosen([name], rows())
    assert measured(entry)["holds"] is True, measured(entry)


@pytest.mark.slow
@pytest.mark.usefixtures("gpu")
@pytest.mark.parametrize("name", ["relight.parity.within_5", "relight.parity.mean"])
def test_both_engines_agree_on_the_motorcycle(name):
    (entry,) = chosen([name], rows())
    assert measured(entry)["holds"] is True, measured(entry)


@pytest.mark.usefixtures("gpu")
def test_engines_differ_on_the_motorcycle_only_at_shadow_edges():
    """A thinned `andon verify relight.parity`: only the pixels that differ are looked at."""
    import numpy as np

    from andon.rays import RayScene
    from andon.verify.edges import near_change, shadow_edges
    from andon.verify.rows.motorcycle import _demonstration

    gpu, slow = _demonstration("gpu"), _demonstration("reference")
    difference = np.abs(gpu.frame.image.rgb.astype(int) - slow.frame.image.rgb.astype(int))
    surface, prepared = slow.frame.surface, slow.renderer.prepared
    apart = (difference.max(axis=-1) > 5) & surface.valid & ~near_change(surface.is_object, 1)
    points, normals = surface.position[apart], surface.normal[apart]
    bias, casters = prepared.surface.bias.real_m, RayScene(prepared.surface.shadow_casters)

    def visible(at, facing, lamp_position):
        return casters.is_visible(at + bias * facing, lamp_position)

    edges = np.zeros(len(points), bool)
    for lamp in prepared.lamps(0.0):
        size = lamp.shadow.map_size
        edges |= shadow_edges(points, normals, lamp, visible, casters, size, steps=9)
    assert (~edges).sum() <= 1e-3 * apart.size
