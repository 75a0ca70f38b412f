"""Bounces by Radiance: closed forms, truths, what cannot be, and that nothing done is lost."""

from dataclasses import replace

import numpy as np
import pytest
from worlds_of_probes import furnace, lamp_room, scene_of

import andon.bake.radiance_bounces as pass_module
from andon.bake import bake_file, bake_probes
from andon.bake.tasks import DaskWorkers, LocalWorkers
from andon.bake.to_file import placed_in
from andon.engines.cubes import cube_engine, cube_setting
from andon.engines.cubes_radiance import light_scenes, photographed_geometry, seen_points
from andon.engines.prepared import prepare
from andon.errors import InputError, MachineError
from andon.files.volumes import read_volume
from andon.quantities import Geometry
from andon.transport.probes.photograph import Shown
from requirements import required
from worlds import ball, block, scene, sheet, write_glb

RADIANCE = {"bounces_by": "radiance", "cube_size_px": 8}
TWO = [{"position": [0.3, 0.1, -0.4]}, {"position": [-0.6, -0.2, 0.5]}]
HAND = {"placement": {"kind": "hand"}, "place": TWO}


def light_of(volume):
    return next(iter(volume.states.values()))


def baked(loaded, engine="reference", **options):
    return bake_probes(loaded, placed_in(loaded), engine=engine, **options)


def mean_light(loaded, engine="reference"):
    """(n, 3) mean luminance around each probe, cd/m²."""
    return light_of(baked(loaded, engine).volume)[:, 0] / np.sqrt(4 * np.pi)


@pytest.mark.parametrize(("bounces", "within"), [(0, 1e-6), (1, 2e-3), (2, 0.03), (4, 0.03)])
def test_a_furnace_is_a_geometric_series(tmp_path, engine, bounces, within):
    """L = ε·(1 + ρ + … + ρᵏ). Rays of Radiance end by chance."""
    loaded = furnace(tmp_path, 0.6, probes=RADIANCE | HAND | {"bounces": bounces})
    expected = sum(0.6**k for k in range(bounces + 1))
    light = light_of(baked(loaded, engine).volume)
    np.testing.assert_allclose(light[:, 0] / np.sqrt(4 * np.pi), expected, rtol=within)
    np.testing.assert_allclose(light[:, 1:], 0, atol=within * expected * 3)


def test_the_furnace_at_its_finest(tmp_path):
    probes = RADIANCE | HAND | {"bounces": 2, "bounces_quality": "fine", "place": TWO[:1]}
    loaded = furnace(tmp_path, 0.6, probes=probes)
    np.testing.assert_allclose(mean_light(loaded), 1 + 0.6 + 0.36, rtol=0.01)


def test_one_bounce_of_lamps_is_the_first_pictures(tmp_path):
    """Nothing is left for Radiance, and no scene is made."""
    through, traced = (
        baked(lamp_room(tmp_path, probes=HAND | {"cube_size_px": 8, "bounces_by": by})).volume
        for by in ("probes", "radiance")
    )
    np.testing.assert_array_equal(light_of(through), light_of(traced))


def test_two_ways_agree_on_the_second_bounce_of_a_lamp(tmp_path):
    """Probes that reach the walls: what they add is what Radiance adds, within a tenth."""
    reach = {"low": [-1.6, -1.2, -2.0], "high": [1.6, 1.2, 2.0]}
    place = {"placement": {"kind": "lattice", "counts": [2, 2, 2], **reach}}
    once, through, traced = (
        mean_light(lamp_room(tmp_path, probes=place | {"cube_size_px": 16} | own)).mean(axis=0)
        for own in ({}, {"bounces": 2}, {"bounces": 2, "bounces_by": "radiance"})
    )
    np.testing.assert_allclose(traced - once, through - once, rtol=0.1)


def test_the_sky_is_occluded(tmp_path):
    """Through an opening in the ceiling; a closed room has none of it."""
    sky = [{"kind": "sky", "illuminance_lux": 1000.0}]
    probes = RADIANCE | HAND
    closed = light_of(baked(lamp_room(tmp_path, lamp=sky, probes=probes)).volume)
    np.testing.assert_allclose(closed, 0, atol=1e-3)
    room = block((4, 3, 5), (0, 0, 0), inwards=True)
    up = np.cross(*np.moveaxis(np.diff(room.positions[room.triangles], axis=1), 1, 0))[:, 1]
    write_glb(
        tmp_path / "open.glb", replace(room, triangles=room.triangles[~(up < -1e-9)]),
        colour=(0.5,) * 3,
    )  # fmt: skip
    first, lit = (
        light_of(
            baked(
                scene_of(
                    tmp_path,
                    surface={"mesh": "open.glb"},
                    lamp=sky,
                    probes=probes | {"bounces": bounces},
                )
            ).volume
        )[:, 0]
        for bounces in (0, 1)
    )
    assert (lit > 1.05 * first).all()


def test_a_floor_under_the_sky(tmp_path):
    """E = 1000 lx on it, so it sends 500/π cd/m² upwards: an open plain, in closed form."""
    write_glb(tmp_path / "floor.glb", sheet((-50, 0, -50), (100, 0, 0), (0, 0, 100)),
              colour=(0.5,) * 3)  # fmt: skip
    sky = [{"kind": "sky", "illuminance_lux": 1000.0}]
    probes = RADIANCE | HAND | {"place": [{"position": [0, 1, 0], "range_m": 20.0}]}
    none, once = (
        mean_light(scene_of(tmp_path, surface={"mesh": "floor.glb"}, lamp=sky,
                            probes=probes | {"bounces": n, "cube_size_px": 64}))
        for n in (0, 1)
    )  # fmt: skip
    # Of the sphere, the floor within 20 m takes (1 − sin β)/2, sin β = 1/20.
    expected = 500 / np.pi * (1 - 1 / 20) / 2
    np.testing.assert_allclose(once - none, expected, rtol=0.02)


def test_lamps_that_are_not_in_probes_are_not_traced(tmp_path):
    lamp = {"kind": "point", "position": [0.5, 1.2, -0.7], "intensity_cd": 200.0}
    other = lamp | {"position": [-0.5, 1.0, 1.0], "in_probes": False, "name": "other"}
    probes = RADIANCE | HAND | {"bounces": 2}
    one, both = (
        light_of(baked(lamp_room(tmp_path, lamp=lamps, probes=probes)).volume)
        for lamps in ([lamp], [lamp, other])
    )
    np.testing.assert_array_equal(one, both)


def test_illuminance_maps_are_not_asked_for(tmp_path):
    """A bake of probes may come before that of maps: captures take nothing from them."""
    lamp = {"kind": "point", "position": [0.5, 1.2, -0.7], "intensity_cd": 200.0, "name": "bulb"}
    probes = {"cube_size_px": 8} | HAND
    plain, mapped = (
        light_of(baked(lamp_room(tmp_path, probes=probes, **tables)).volume)
        for tables in (
            {"lamp": [lamp]},
            {"lamp": [lamp | {"transport": "direct+bounce"}],
             "baked": {"folder": "maps", "lamps": ["bulb"]}},
        )
    )  # fmt: skip
    np.testing.assert_array_equal(plain, mapped)


def test_e0_is_not_reflected_again(tmp_path):
    ambient = {"illuminance_lux": 100.0}
    once, often = (
        light_of(
            baked(lamp_room(tmp_path, lamp=[], ambient=ambient,
                            probes=RADIANCE | HAND | {"bounces": n})).volume
        )
        for n in (0, 5)
    )  # fmt: skip
    np.testing.assert_array_equal(once, often)


def test_what_lies_beyond_the_range_sends_nothing(tmp_path):
    near = [place | {"range_m": 0.01} for place in TWO]
    probes = RADIANCE | HAND | {"bounces": 3, "place": near}
    assert (light_of(baked(lamp_room(tmp_path, probes=probes)).volume) == 0).all()


def test_light_that_is_taken_away_is_refused(tmp_path):
    write_glb(tmp_path / "ball.glb", ball(0.25, (-0.3, 0, -1.4)))
    bulb = {"name": "bulb", "kind": "point", "position": [0.0, 0.5, -1.0], "intensity_cd": 5.0}
    loaded = scene(
        tmp_path,
        ambient={"illuminance_lux": 200.0, "source": [bulb], "removed": ["bulb"]},
        object=[{"mesh": "ball.glb"}],
        probes={"volume": "p.glb", "place": [{"position": [0, 0, -1.2]}]} | RADIANCE,
    )
    with pytest.raises(InputError, match=r"probes\.bounces_by: .* light is taken away"):
        baked(loaded)


def test_eight_bits_are_refused_and_so_are_workers_of_probes(tmp_path):
    loaded = lamp_room(tmp_path, probes=RADIANCE | {"encoding": "srgb8"})
    with pytest.raises(InputError, match=r"probes\.encoding: must be 'linear'"):
        baked(loaded)
    with pytest.raises(InputError, match="not traced by workers"):
        baked(lamp_room(tmp_path), workers=LocalWorkers(1))
    with pytest.raises(InputError, match="bounces_quality"):
        lamp_room(tmp_path, probes={"bounces_quality": "fine"})


def test_photographed_triangles_reflect_what_is_shown():
    """A mean over each triangle, 0…1, in steps of 1/32."""

    class Halves:
        """A picture that is dark on the left and shines on the right."""

        def at(self, points):
            rho = np.where(points[:, :1] < 0, 0.2, 1.7) * np.ones(3)
            return Shown(rho, rho, np.ones(len(points), bool))

    corners = np.array([[-2, 0, 0], [-1, 0, 0], [-1, 1, 0], [1, 0, 0], [2, 0, 0], [1, 1, 0],
                        [-1, 0, 0], [1, 0, 0], [0, 1, 0]], float)  # fmt: skip
    real = Geometry(corners, np.arange(9, dtype=np.int32).reshape(3, 3))
    found = photographed_geometry(real, Halves())
    rho = np.array([found.materials[i].reflectance for i in found.material_ids])
    np.testing.assert_allclose(rho[:2], [[0.1875] * 3, [1.0] * 3])
    np.testing.assert_allclose(rho[2], 0.95, atol=0.08)  # half and half, cut at 1 as a whole


def test_a_photographed_room_bounces(tmp_path):
    """A virtual lamp's light, off a photographed surface onto a ball and into a probe."""
    write_glb(tmp_path / "ball.glb", ball(0.25, (-0.3, 0, -1.4)), colour=(0.5, 0.5, 0.5))
    lamp = {"kind": "point", "position": [0.0, 0.5, -1.0], "intensity_cd": 5.0}
    probes = {"volume": "p.glb", "place": [{"position": [0.1, 0.0, -1.2]}]} | RADIANCE
    once, often = (
        light_of(
            baked(scene(tmp_path, object=[{"mesh": "ball.glb"}], lamp=[lamp],
                        probes=probes | {"bounces": n})).volume
        )[:, 0]
        for n in (1, 3)
    )  # fmt: skip
    assert (often > once).all()


def test_points_beyond_the_range_are_not_asked(tmp_path):
    loaded = lamp_room(tmp_path)
    setting = cube_setting(loaded, prepare(loaded, drawn=False))
    seen, _ = cube_engine(setting, 8, "reference").look(np.zeros(3), lit=False)
    points = seen_points(seen, 1.6)
    assert 0 < len(points.position) < 6 * 64
    assert (np.linalg.norm(points.position, axis=1) <= 1.6 + 1e-9).all()
    lux = np.arange(3 * len(points.position), dtype=float).reshape(-1, 3)
    np.testing.assert_array_equal(points.spread(lux)[points.texels], lux)


def test_scenes_are_made_of_the_light_that_there_is(tmp_path):
    def names(loaded, bounces):
        setting = cube_setting(loaded, prepare(loaded, drawn=False))
        return set(light_scenes(setting, bounces))

    lit, shining = lamp_room(tmp_path), furnace(tmp_path, 0.5)
    assert names(lit, 1) == set()
    assert names(lit, 2) == {"lamps"}
    assert names(shining, 0) == set()
    assert names(shining, 1) == {"emitted"}


def test_workers_trace_the_same_light(tmp_path):
    loaded = lamp_room(tmp_path, probes=RADIANCE | HAND | {"bounces": 2})
    told = []
    alone = bake_file(loaded, engine="reference").path.read_bytes()
    (tmp_path / "probes.glb").unlink()
    result = bake_file(
        loaded,
        engine="reference",
        workers=LocalWorkers(1),
        progress=lambda done, of, _: told.append((done, of)),
    )
    assert result.path.read_bytes() == alone
    assert told == [(n, 6) for n in range(1, 7)]
    assert not (tmp_path / "probes.glb.bake").exists()


def test_a_cluster_traces_the_same_light(tmp_path):
    distributed = required("distributed")
    loaded = lamp_room(tmp_path, probes=RADIANCE | HAND | {"bounces": 2})
    alone = bake_file(loaded, engine="reference").path.read_bytes()
    (tmp_path / "probes.glb").unlink()
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, protocol="tcp",
        host="127.0.0.1", dashboard_address=None,
    ) as cluster:  # fmt: skip
        workers = DaskWorkers(cluster.scheduler_address)
        result = bake_file(loaded, engine="reference", workers=workers)
    assert result.path.read_bytes() == alone


def test_what_workers_have_traced_is_kept(tmp_path, monkeypatch):
    """Stopped after the light was traced, and before it was made a result."""
    loaded = lamp_room(tmp_path, probes=RADIANCE | HAND | {"bounces": 2})
    whole = bake_file(loaded, engine="reference").path.read_bytes()
    (tmp_path / "probes.glb").unlink()

    def stop(done, of, what):
        if done == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        bake_file(loaded, engine="reference", workers=LocalWorkers(1), progress=stop)
    assert list((tmp_path / "probes.glb.bake" / "traced").glob("*.npy"))
    monkeypatch.setattr(pass_module, "gathered", None)
    again = bake_file(loaded, engine="reference", workers=LocalWorkers(1))
    assert again.path.read_bytes() == whole
    assert not (tmp_path / "probes.glb.bake").exists()


def test_what_changes_the_light_is_traced_again(tmp_path):
    folder = tmp_path / "kept"
    base = RADIANCE | HAND | {"bounces": 2}
    assert baked(lamp_room(tmp_path, probes=base), folder=folder).report.captured == 4
    assert baked(lamp_room(tmp_path, probes=base), folder=folder).report.captured == 0
    for own, count in (({"bounces": 3}, 2), ({"bounces_quality": "normal"}, 2)):
        report = baked(lamp_room(tmp_path, probes=base | own), folder=folder).report
        assert report.captured == count, own
    painted = baked(lamp_room(tmp_path, probes=base, colour=(0.8, 0.4, 0.3)), folder=folder)
    assert painted.report.captured == 4


def test_a_fault_of_radiance_is_told_and_what_is_done_is_kept(tmp_path, monkeypatch):
    loaded = lamp_room(tmp_path, probes=RADIANCE | HAND | {"bounces": 2})

    def lost(*arguments, **options):
        raise MachineError("Radiance's rtrace failed (1): no memory")

    with monkeypatch.context() as patch:
        patch.setattr(pass_module, "gathered", lost)
        with pytest.raises(MachineError, match=r"2 of 2 probes failed 3 times.*no memory"):
            bake_file(loaded, engine="reference")
    assert bake_file(loaded, engine="reference").report.kept == 2


def test_a_state_by_radiance_is_added_and_its_notes_say_so(tmp_path):
    day = bake_file(lamp_room(tmp_path, probes=HAND | {"cube_size_px": 8, "state": "day"}),
                    engine="reference")  # fmt: skip
    assert "bounces_by" not in read_volume(day.path).notes
    night = lamp_room(tmp_path, probes=RADIANCE | HAND | {"bounces": 2, "state": "night"})
    written = bake_file(night, engine="reference")
    assert written.states == ("day", "night")
    notes = read_volume(written.path).notes
    assert (notes["bounces_by"], notes["bounces_quality"]) == ("radiance", "draft")
