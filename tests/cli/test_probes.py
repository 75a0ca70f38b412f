"""`andon probes info` and `andon probes export`."""

import json
from dataclasses import replace

import numpy as np
import pytest

from andon.files import write_volume
from andon.files.volumes import Distances, rounded
from andon.harmonics import basis, deringed, smallest
from andon.transport.probes.export import EXPORTS, ExportUnit, probe_lights
from andon.transport.probes.light import probe_coefficients, probe_light
from volume_files import flat_volume, two_rooms

from .command import run_andon, run_refused


@pytest.fixture
def folder(tmp_path, monkeypatch):
    write_volume(tmp_path / "two.glb", two_rooms())
    write_volume(tmp_path / "point.glb", flat_volume("point"))
    write_volume(tmp_path / "cells.glb", flat_volume("cells"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_info_says_what_the_volume_holds(capfd, folder):
    outcome = run_andon(capfd, "probes", "info", "two.glb")
    assert outcome.code == 0, outcome.err
    text = " ".join(outcome.out.split())
    volume = two_rooms()
    mean = volume.states["day"][:, 0].mean(axis=0) / np.sqrt(4 * np.pi)
    photometric = mean @ [0.2126, 0.7152, 0.0722]
    for part in (
        "photometry absolute", "probes 10: 1 sky, 1 bounce, 1 bleeding, 7 general",
        "(0, -1, -1) … (6, 1.1, 0) m", "L2, 9 coefficients a channel", "1 probe, 3…3 m",
        f"day: mean {photometric:.4g} cd/m² (R {mean[0]:.4g},",
        "east: 5 probes, 2 tetrahedra, 6 facets, 2 boxes", "4 tetrahedra, 12 facets",
        "4² directions a probe, up to 100 m", "light 2.16 kB", "scene: zwei Räume",
    ):  # fmt: skip
        assert part in text, part


def test_info_of_a_volume_without_cells(capfd, folder):
    text = " ".join(run_andon(capfd, "probes", "info", "cells.glb").out.split())
    assert "nobody joined the probes yet" in text
    assert "relative units" in text
    assert "cd/m²" not in text
    assert "1 probe, 0 tetrahedra, 1 facet, all of space" in " ".join(
        run_andon(capfd, "probes", "info", "point.glb").out.split()
    )


def test_info_as_json(capfd, folder):
    facts = json.loads(run_andon(capfd, "probes", "info", "two.glb", "--json").out)
    assert facts["probes"] == 10
    assert facts["roles"] == {"sky": 1, "bounce": 1, "bleeding": 1, "general": 7}
    assert [state["name"] for state in facts["states"]] == ["day", "night"]
    assert facts["zones"][1]["boxes_m"][1] == [[7, 0, 0], [8.1, 1, 1]]
    assert facts["bytes"]["light"] == 2 * 10 * 9 * 3 * 4
    assert facts["bytes"]["file"] == (folder / "two.glb").stat().st_size
    assert facts["distances"] == {"side_px": 4, "far_m": 100}


def test_info_refuses_what_is_no_volume(capfd, folder):
    (folder / "x.glb").write_bytes(b"glTF\x02\0\0\0")
    assert "x.glb: must be a sound GLB file" in run_refused(
        capfd, folder, "probes", "info", "x.glb"
    )
    assert "must exist" in run_refused(capfd, folder, "probes", "info", "none.glb")


FORMATS = {"three": ".json", "gltf": ".glb", "unity": ".json", "filament": ".txt", "csv": ".csv"}


@pytest.mark.parametrize("name", FORMATS)
def test_export_writes_what_the_library_gives(capfd, folder, name):
    volume = rounded(two_rooms())
    light = probe_lights(volume, volume.states["night"])[3]
    out = f"out{FORMATS[name]}"
    outcome = run_andon(
        capfd, "probes", "export", "two.glb", "--format", name, "--probe", "probe 3",
        "--state", "night", "--white-cd-m2", "20", "-o", out,
    )  # fmt: skip
    assert outcome.code == 0, outcome.err
    assert outcome.out.splitlines() == [out]
    assert "1.0 is a luminance of 20 cd/m² (absolute)" in outcome.err
    expected = EXPORTS[name].write([light], ExportUnit("absolute", 20.0))
    assert (folder / out).read_bytes() == expected


def test_export_prints_text_without_a_file(capfd, folder):
    outcome = run_andon(capfd, "probes", "export", "two.glb", "--format", "csv")
    assert outcome.code == 0, outcome.err
    assert len(outcome.out.splitlines()) == 11
    assert outcome.err == "andon: unit of light: cd/m² (absolute)\n"


def test_export_between_probes_and_states(capfd, folder):
    """In the middle of an edge between probes 0 and 1, in the middle of day and night."""
    outcome = run_andon(
        capfd, "probes", "export", "two.glb", "--format", "csv", "--at", "0.5,0,0",
        "--state", "day", "--blend-state", "night", "--blend", "0.5",
    )  # fmt: skip
    assert outcome.code == 0, outcome.err
    volume = rounded(two_rooms())
    expected = sum(values[:2].sum(axis=0) for values in volume.states.values()) / 4
    row = outcome.out.splitlines()[1].split(",")
    found = np.array(row[-27:], float).reshape(9, 3)
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_export_outside_takes_the_nearest_point_of_the_hull(capfd, folder):
    outcome = run_andon(
        capfd, "probes", "export", "two.glb", "--format", "csv", "--at", "-1,0,2"
    )  # below and left of probe 0, towards which both axes point
    row = outcome.out.splitlines()[1].split(",")
    volume = rounded(two_rooms())
    np.testing.assert_allclose(
        np.array(row[-27:], float).reshape(9, 3), volume.states["day"][0], rtol=1e-9
    )


def exported(capfd, *words):
    """(rows, k, 3) of the table."""
    outcome = run_andon(capfd, "probes", "export", *words, "--format", "csv")
    assert outcome.code == 0, outcome.err
    rows = [line.split(",")[4:] for line in outcome.out.splitlines()[1:]]
    return np.array(rows, float).reshape(len(rows), -1, 3)


@pytest.fixture
def ringing(folder):
    """A lone lamp at each probe, and every other probe sees nothing but a wall beside it."""
    volume = two_rooms()
    lamps = 50 * basis(np.tile([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0]], (5, 1)))
    near = np.where(np.arange(10) % 2 == 0, 0.01, 9.0)[:, None, None] * np.ones((10, 4, 4))
    walls = Distances(near.astype(np.float32), (near**2).astype(np.float32), 100.0)
    states = {"day": lamps[..., None] * np.ones(3)}
    write_volume(folder / "ringing.glb", replace(volume, states=states, distances=walls))
    return rounded(replace(volume, states=states, distances=walls))


def test_export_smooths_unless_told_otherwise(capfd, ringing):
    raw = exported(capfd, "ringing.glb", "--raw")
    np.testing.assert_allclose(raw, ringing.states["day"], rtol=1e-12)
    assert smallest(raw).max() < -1
    smooth = exported(capfd, "ringing.glb")
    np.testing.assert_allclose(smooth, deringed(ringing.states["day"]), rtol=1e-12, atol=1e-12)
    assert smallest(smooth).min() > -1e-9


def test_export_at_a_point_asks_the_walls_unless_told_otherwise(capfd, ringing):
    place = ("ringing.glb", "--at", "0.4,0.2,-0.3")
    through = exported(capfd, *place, "--no-visibility")
    seen = exported(capfd, *place)
    light = probe_light(ringing)
    at = np.array([[0.4, 0.2, -0.3]])
    np.testing.assert_allclose(seen, probe_coefficients(light, at), rtol=1e-9, atol=1e-9)
    plain = probe_coefficients(replace(light, walls=None), at)
    np.testing.assert_allclose(through, plain, rtol=1e-9, atol=1e-9)
    assert np.abs(seen - through).max() > 1


@pytest.mark.parametrize(
    ("at", "outside"),
    [("0.5,0,0", False), ("0.1,-0.1,-0.1", False), ("-1,0,2", True), ("0.5,0,0.01", True)],
)
def test_export_says_what_lies_outside(capfd, folder, at, outside):
    outcome = run_andon(capfd, "probes", "export", "two.glb", "--format", "csv", "--at", at)
    assert (
        "outside the probes: light of the nearest point of their hull" in outcome.err
    ) == outside


def test_a_scene_names_its_volume(capfd, folder):
    (folder / "lit.toml").write_text('[probes]\nvolume = "two.glb"\n')
    (folder / "dark.toml").write_text('[probes]\nvolume = "none.glb"\n')
    (folder / "bare.toml").write_text("")
    for words in (["info"], ["export", "--format", "csv"]):
        line = run_refused(capfd, folder, "probes", *words, "lit.toml")
        assert line.endswith(f"lit.toml: is a scene; its volume is {folder / 'two.glb'}")
        line = run_refused(capfd, folder, "probes", *words, "dark.toml")
        assert "none.glb; andon probes bake dark.toml writes it" in line
        line = run_refused(capfd, folder, "probes", *words, "bare.toml")
        assert "is a scene, and has no [probes]" in line


def test_help_says_the_suffixes(capfd, folder):
    text = " ".join(run_andon(capfd, "probes", "export", "--help").out.replace("│", " ").split())
    for suffix in FORMATS.values():
        assert f"({suffix})" in text


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--format", "unty"), "did you mean 'unity'?"),
        (("--format", "gltf"), "the format gltf is no text; give -o FILE.glb"),
        (("--format", "gltf", "-o", "two.glb"), "is also the input"),
        (("--format", "three", "-o", "x.glb"), "must end in .json"),
        (("--format", "three", "-o", "none/x.json"), "folder 'none' does not exist"),
        (
            ("--format", "filament"),
            "holds one probe; choose one with --probe, or a point with --at",
        ),
        (("--format", "csv", "--probe", "prob 3"), "did you mean 'probe 3'?"),
        (
            ("--format", "csv", "--probe", "xyz"),
            "is called 'xyz'; give one of 'probe 0', 'probe 1', ",
        ),
        (("--format", "csv", "--state", ""), "there is no state ''"),
        (("--format", "csv", "--probe", "12"), "probe: must be 0…9, got 12"),
        (("--format", "csv", "--at", "1,2"), "must be three numbers x,y,z"),
        (("--format", "csv", "--at", "1,2,nan"), "must be three numbers x,y,z"),
        (("--format", "csv", "--at", "1,2,3", "--probe", "1"), "give one of --probe and --at"),
        (("--format", "csv", "--state", "nigt"), "did you mean 'night'?"),
        (("--format", "csv", "--blend", "0.5"), "blend: needs blend_state"),
        (("--format", "csv", "--white-cd-m2", "0"), "must be > 0 cd/m²"),
    ],
)
def test_export_refusals(capfd, folder, words, message):
    assert message in run_refused(capfd, folder, "probes", "export", "two.glb", *words)
