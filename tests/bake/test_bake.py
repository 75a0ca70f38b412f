"""Bakes: bounces, states, and that nothing done is lost."""

import signal
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from worlds_of_probes import bake_command, furnace, lamp_room, scene_of, stopped

import andon.bake.bake as bake_module
from andon.bake import bake_file, bake_probes
from andon.bake.to_file import placed_in
from andon.engines.cubes import cube_setting
from andon.engines.prepared import prepare
from andon.errors import InputError, MachineError
from andon.files.volumes import read_volume
from andon.harmonics import irradiance
from andon.rays import RayScene, face_normals
from andon.transport.direct.reference import illuminance
from worlds import block, scene, unit, write_glb


def light_of(volume):
    return next(iter(volume.states.values()))


def baked(loaded, engine="reference", **options):
    return bake_probes(loaded, placed_in(loaded), engine=engine, **options)


@pytest.mark.parametrize("bounces", [0, 1, 2, 4])
def test_a_furnace_is_a_geometric_series(tmp_path, engine, bounces):
    """Uniform emission ε and reflectance ρ: L = ε·(1 + ρ + … + ρᵏ) everywhere, E = πL."""
    volume = baked(furnace(tmp_path, 0.6, probes={"bounces": bounces}), engine).volume
    expected = sum(0.6**k for k in range(bounces + 1))
    light = light_of(volume)
    np.testing.assert_allclose(light[:, 0], expected * 2 * np.sqrt(np.pi), rtol=1e-6)
    np.testing.assert_allclose(light[:, 1:], 0, atol=1e-6)
    up = np.broadcast_to([0.0, 1.0, 0.0], (len(light), 3))
    np.testing.assert_allclose(irradiance(light, up), expected * np.pi, rtol=1e-6)


def test_many_bounces_converge(tmp_path):
    volume = baked(furnace(tmp_path, 0.5, probes={"bounces": 16, "cube_size_px": 8})).volume
    np.testing.assert_allclose(light_of(volume)[:, 0] / np.sqrt(4 * np.pi), 2, rtol=1e-4)


def test_what_lamps_give_bounces_too(tmp_path):
    """The second reflection, against paths of two reflections from each probe."""
    rho = np.array([0.8, 0.4, 0.2])
    place = {"placement": {"kind": "lattice", "counts": [2, 2, 2], "low": [-1.6, -1.2, -2.1],
                           "high": [1.6, 1.2, 2.1]}}  # fmt: skip
    one, two, none = (
        light_of(baked(lamp_room(tmp_path, probes=place | {"bounces": n})).volume)[:, 0]
        for n in (1, 2, 0)
    )
    np.testing.assert_array_equal(none, 0)
    loaded = lamp_room(tmp_path, probes=place)
    truth = second_reflection(loaded, placed_in(loaded).positions)
    gained = (two - one) / np.sqrt(4 * np.pi)
    np.testing.assert_allclose(gained, truth[:, None] * rho**2, rtol=0.12)


def second_reflection(loaded, places, count=40_000):
    """(n,) mean luminance of light that was reflected twice, for ρ = 1 (Monte Carlo)."""
    setting = cube_setting(loaded, prepare(loaded, drawn=False))
    geometry, lamp = setting.surface.objects, setting.lamps[0]
    rays, planes = RayScene(geometry), face_normals(geometry)
    generator = np.random.default_rng(1)

    def scattered():
        return unit(generator.normal(size=(count, 3)))

    def met(points, directions):
        hits = rays.first_hits(points, directions)
        normal = planes[hits.triangle]
        normal = normal * np.where((normal * directions).sum(axis=1) > 0, -1, 1)[:, None]
        return points + directions * hits.distance[:, None] + 1e-4 * normal, normal

    means = []
    for place in places:
        first, normal = met(np.broadcast_to(place, (count, 3)), scattered())
        second, normal = met(first, unit(normal + scattered()))
        lux = illuminance(lamp, second, normal)[:, 0]
        means.append((lux * rays.is_visible(second, lamp.position_m, near_m=0.01)).mean() / np.pi)
    return np.array(means)


def test_both_engines_bake_the_same(tmp_path, gpu):
    loaded = lamp_room(tmp_path, probes={"bounces": 2, "cube_size_px": 64})
    a, b = (light_of(baked(loaded, name).volume) for name in ("reference", "gpu"))
    np.testing.assert_allclose(a, b, atol=0.01 * a[:, 0].mean())


def test_the_sky_comes_in_by_the_window_alone(tmp_path):
    """A closed room has no sky in it, a room without a ceiling has."""
    sky = [{"kind": "sky", "illuminance_lux": 1000.0}]
    closed = light_of(baked(lamp_room(tmp_path, lamp=sky)).volume)
    np.testing.assert_array_equal(closed, 0)
    room = block((4, 3, 5), (0, 0, 0), inwards=True)
    up = np.cross(*np.moveaxis(np.diff(room.positions[room.triangles], axis=1), 1, 0))[:, 1]
    # Inwards: the ceiling is what faces down.
    without = replace(room, triangles=room.triangles[~(up < -1e-9)])
    write_glb(tmp_path / "open.glb", without, colour=(0.5,) * 3)
    loaded = scene_of(tmp_path, surface={"mesh": "open.glb"}, lamp=sky)
    first = light_of(baked(loaded.model_copy(
        update={"probes": loaded.probes.model_copy(update={"bounces": 0})}
    )).volume)  # fmt: skip
    lit = light_of(baked(loaded).volume)
    assert (first[:, 1] > 0).all(), "from above"
    assert (lit[:, 0] > 1.05 * first[:, 0]).all(), "and from the walls"


def test_e0_is_not_reflected_again(tmp_path):
    ambient = {"illuminance_lux": 100.0}
    once, often = (
        light_of(baked(lamp_room(tmp_path, lamp=[], ambient=ambient, probes={"bounces": n})).volume)
        for n in (0, 5)
    )
    np.testing.assert_array_equal(once, often)
    expected = np.array([0.8, 0.4, 0.2]) * 100 / np.pi
    np.testing.assert_allclose(
        once[:, 0] / np.sqrt(4 * np.pi), np.tile(expected, (8, 1)), rtol=1e-6
    )


def test_eight_bits_differ_a_little_and_clip(tmp_path):
    probes = {"cube_size_px": 32}
    hdr = light_of(baked(lamp_room(tmp_path, probes=probes)).volume)
    probes["encoding"] = "srgb8"
    bright = baked(lamp_room(tmp_path, probes=probes, capture={"luminance_per_unit": 900.0}))
    np.testing.assert_allclose(light_of(bright.volume)[:, 0], hdr[:, 0], rtol=0.03)
    assert (light_of(bright.volume) != hdr).any()
    dark = baked(lamp_room(tmp_path, probes=probes, capture={"luminance_per_unit": 5.0}))
    assert len(dark.report.clipped) == 8
    assert dark.report.clipped_share > 0.05
    assert (light_of(dark.volume)[:, 0, 0] < 0.9 * hdr[:, 0, 0]).all()


def test_the_volume_has_what_was_asked_for(tmp_path):
    zones = [
        {"name": "low", "low": [-2, -2, -3], "high": [2, 0, 3]},
        {"name": "high", "low": [-2, 0, -3], "high": [2, 2, 3]},
    ]
    probes = {"zone": zones, "order": 3, "state": "day"}
    volume = baked(lamp_room(tmp_path, probes=probes)).volume
    assert volume.order == 3
    assert list(volume.states) == ["day"]
    assert [(zone.name, len(zone.probes)) for zone in volume.zones] == [("low", 4), ("high", 4)]
    assert volume.distances is not None
    assert volume.distances.mean_m.shape == (8, 16, 16)
    assert volume.notes["cube_size_px"] == "16"
    probes["visibility"] = False
    assert baked(lamp_room(tmp_path, probes=probes)).volume.distances is None


def test_a_zone_without_a_probe_is_refused(tmp_path):
    zone = {"name": "attic", "low": [0, 9, 0], "high": [1, 10, 1]}
    room = {"name": "room", "low": [-2, -2, -3], "high": [2, 2, 3]}
    with pytest.raises(InputError, match="no probe lies in the zone 'attic'"):
        baked(lamp_room(tmp_path, probes={"zone": [room, zone]}))


def test_probes_inside_walls_are_reported(tmp_path):
    write_glb(tmp_path / "pillar.glb", block((1, 2, 1), (0, 0, 0)))
    place = [{"name": "free", "position": [2, 0, 0]}, {"name": "stuck", "position": [0, 0, 0.1]}]
    probes = {"place": place, "placement": {"kind": "hand"}}
    loaded = scene_of(tmp_path, surface={"mesh": "pillar.glb"}, probes=probes)
    assert baked(loaded).report.in_walls == ("stuck",)


def test_geometry_that_is_no_manifold_is_captured(tmp_path):
    room = block((4, 3, 5), (0, 0, 0), inwards=True)
    twice = np.concatenate([room.triangles, room.triangles[:5], [[0, 0, 1], [2, 2, 2]]])
    write_glb(tmp_path / "room.glb", replace(room, triangles=twice.astype(np.int32)))
    lamp = [{"kind": "point", "position": [0, 1, 0], "intensity_cd": 9.0}]
    result = baked(scene_of(tmp_path, surface={"mesh": "room.glb"}, lamp=lamp))
    assert np.isfinite(light_of(result.volume)).all()
    assert (light_of(result.volume)[:, 0] > 0).all()


def test_a_white_that_frames_will_need_is_told(tmp_path):
    """A lamp in a room does not say it; a sun, E0 or a stated white do."""
    assert baked(lamp_room(tmp_path)).report.needs_white
    sun = {"kind": "directional", "direction": [0, -1, 0], "illuminance_lux": 1.0}
    for tables in (
        {"lamp": [sun]}, {"ambient": {"illuminance_lux": 1.0}},
        {"capture": {"luminance_per_unit": 9.0}},
    ):  # fmt: skip
        assert not baked(lamp_room(tmp_path, **tables)).report.needs_white


def test_light_that_is_to_be_found_cannot_be_baked_from(tmp_path):
    loaded = scene(tmp_path, ambient={"probes": True}, probes={
        "volume": "p.glb", "place": [{"position": [0, 0, 0]}],
    })  # fmt: skip
    placed = placed_in(lamp_room(tmp_path))
    with pytest.raises(InputError, match=r"ambient\.probes: is the light that a bake is to find"):
        bake_probes(loaded, placed)


def counted(monkeypatch, fails=()):
    """Counts first pictures; those numbers (in the order of calls) in `fails` fail."""
    calls = []
    genuine = bake_module.first_light

    def first_light(pictures, index):
        calls.append(index)
        if len(calls) - 1 in fails:
            raise RuntimeError("lost")
        return genuine(pictures, index)

    monkeypatch.setattr(bake_module, "first_light", first_light)
    return calls


def test_a_task_that_fails_twice_succeeds(tmp_path, monkeypatch):
    truth = light_of(baked(lamp_room(tmp_path)).volume)
    calls = counted(monkeypatch, fails={3, 4})
    result = baked(lamp_room(tmp_path))
    assert calls == [0, 1, 2, 3, 3, 3, 4, 5, 6, 7]
    np.testing.assert_array_equal(light_of(result.volume), truth)


def test_one_that_fails_three_times_is_reported_and_the_rest_goes_on(tmp_path, monkeypatch):
    calls = counted(monkeypatch, fails={3, 4, 5})
    loaded = lamp_room(tmp_path)
    with pytest.raises(MachineError, match=r"1 of 8 probes .*lattice-0-1-1 \(RuntimeError: lost\)"):
        bake_file(loaded, engine="reference")
    assert calls[-1] == 7
    del calls[:]
    written = bake_file(loaded, engine="reference")
    assert calls == [3]
    assert written.report.kept == 7
    assert not (tmp_path / "probes.glb.bake").exists()


def test_an_interrupted_bake_goes_on_and_gives_the_same_bytes(tmp_path, monkeypatch):
    loaded = lamp_room(tmp_path, probes={"bounces": 2})
    whole = bake_file(loaded, engine="reference").path.read_bytes()
    (tmp_path / "probes.glb").unlink()

    def stop(done, of, what):
        assert of == 16
        if done == 11:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        bake_file(loaded, engine="reference", progress=stop)
    assert not (tmp_path / "probes.glb").exists()
    again = bake_file(loaded, engine="reference")
    assert (again.report.kept, again.report.captured) == (11, 5)
    assert again.path.read_bytes() == whole


def test_damaged_results_are_captured_again(tmp_path):
    loaded = lamp_room(tmp_path)
    whole = bake_file(loaded, engine="reference").path.read_bytes()
    folder = tmp_path / "kept"
    baked(loaded, folder=folder)
    results = sorted(folder.glob("*.probe"))
    assert len(results) == 8
    data = results[0].read_bytes()
    for cut in (0, 1, 31, 32, 33, len(data) // 2, len(data) - 1):
        results[0].write_bytes(data[:cut])
        assert baked(loaded, folder=folder).report.damaged == 1
    results[1].write_bytes(results[1].read_bytes()[:-2] + b"xy")
    folder.rename(tmp_path / "probes.glb.bake")
    again = bake_file(loaded, engine="reference")
    assert (again.report.damaged, again.report.kept) == (1, 7)
    assert again.path.read_bytes() == whole


def test_what_changes_the_light_is_captured_again(tmp_path):
    folder = tmp_path / "kept"
    baked(lamp_room(tmp_path), folder=folder)
    assert baked(lamp_room(tmp_path), folder=folder).report.captured == 0
    lamp = {"kind": "point", "position": [0.5, 1.2, -0.7], "intensity_cd": 201.0}
    for tables in (
        {"lamp": [lamp]}, {"probes": {"cube_size_px": 24}}, {"colour": (0.8, 0.4, 0.3)},
        {"probes": {"solid_angle": "paper"}}, {"ambient": {"illuminance_lux": 1.0}},
    ):  # fmt: skip
        assert baked(lamp_room(tmp_path, **tables), folder=folder).report.captured == 8, tables
    moved = {"placement": {"kind": "lattice", "counts": [2, 2, 2], "low": [-0.8, -0.8, -0.8],
                           "high": [0.8, 0.8, 0.7]}}  # fmt: skip
    report = baked(lamp_room(tmp_path, probes=moved), folder=folder).report
    assert (report.captured, report.kept) == (4, 4), "half of them stand where they stood"


def test_a_second_state_is_added(tmp_path):
    bake_file(lamp_room(tmp_path, probes={"state": "day"}), engine="reference")
    lamp = {"kind": "point", "position": [-1, 0, 1], "intensity_cd": 5.0}
    night = lamp_room(tmp_path, lamp=[lamp], probes={"state": "night"})
    written = bake_file(night, engine="reference")
    assert written.states == ("day", "night")
    assert not written.replaced
    volume = read_volume(written.path)
    assert volume.states["day"].mean() != volume.states["night"].mean()
    assert bake_file(night, engine="reference").states == ("day", "night")


def test_outputs_that_cannot_be_are_refused_first(tmp_path, monkeypatch):
    calls = counted(monkeypatch)
    for volume, rule in (("p.bin", "must end in .glb"), ("no/p.glb", "does not exist")):
        with pytest.raises(InputError, match=rule):
            bake_file(lamp_room(tmp_path, probes={"volume": volume}), engine="reference")
    (tmp_path / "probes.glb.bake").write_text("a file")
    with pytest.raises(MachineError, match="cannot be made"):
        bake_file(lamp_room(tmp_path), engine="reference")
    assert calls == []


def test_fresh_forgets(tmp_path):
    loaded = lamp_room(tmp_path)
    baked(loaded, folder=tmp_path / "probes.glb.bake")
    assert bake_file(loaded, engine="reference", fresh=True).report.kept == 0


SCENE = """
[surface]
mesh = "room.glb"

[[lamp]]
kind = "point"
position = [0.5, 1.2, -0.7]
intensity_cd = 200.0

[probes]
volume = "probes.glb"
cube_size_px = 64
bounces = 2

[probes.placement]
kind = "lattice"
counts = [3, 3, 3]
low = [-0.8, -0.8, -0.8]
high = [0.8, 0.8, 0.8]
"""


def interrupted(folder, how):
    """Ends a bake by a signal once it has made some results; returns its exit code."""
    kept = folder / "probes.glb.bake"

    def results():
        return len(list(kept.glob("*.probe")))

    return stopped(bake_command(folder), how, results, results() + 6)


def test_kill_at_any_moment_gives_the_same_bytes(tmp_path):
    lamp_room(tmp_path)
    (tmp_path / "scene.toml").write_text(SCENE)
    assert interrupted(tmp_path, signal.SIGKILL) == -signal.SIGKILL
    assert len(list((tmp_path / "probes.glb.bake").iterdir())) >= 6
    assert interrupted(tmp_path, signal.SIGINT) == 130
    assert not (tmp_path / "probes.glb").exists()
    done = subprocess.run(bake_command(tmp_path), check=True, capture_output=True, text=True)
    assert "kept from before" in done.stderr
    assert "andon probes show" in done.stderr
    assert done.stdout.strip() == str(tmp_path / "probes.glb")
    resumed = (tmp_path / "probes.glb").read_bytes()
    (tmp_path / "probes.glb").unlink()
    subprocess.run(bake_command(tmp_path), check=True, capture_output=True)
    assert (tmp_path / "probes.glb").read_bytes() == resumed
    assert not (tmp_path / "probes.glb.bake").exists()
