"""Baked light beside all else that frames have: two eyes, time, probes, mirrors, glare."""

import numpy as np
import pytest

import andon
from andon.engines.prepared import prepare
from andon.errors import InputError
from andon.files.volumes import write_volume
from andon.pipeline import Renderer
from pipeline.direct_maps import lamp_tables, lux_of, relative, world
from probes.volumes import POSITIONS, random_volume
from worlds import ball, write_obj

EYE = {"hfov_degrees": 70.0, "width": 64, "height": 48, "look_at": [0, 0.9, 0]}


def eyes():
    left, right = (EYE | {"position": [x, 1.4, 1.7]} for x in (-0.3, 0.3))
    return {"kind": "stereo", "left": left, "right": right}


def test_two_eyes_share_the_maps(tmp_path, engine):
    """Each sees what a camera alone at its place sees, in any order."""
    rig, source = eyes(), {"source": {"left": "photo.png", "right": "photo.png"}}
    both = Renderer(world(tmp_path, {"ball": "baked"}, rig=rig, capture=source), engine)
    seen = {n: both.render(view=n) for n in ("right", "left", "right")}
    assert np.abs(seen["left"].baked.lux - seen["right"].baked.lux).mean() > 1
    for name, frame in seen.items():
        alone = world(tmp_path, {"ball": "baked"}, rig={"camera": rig[name]})
        expected = andon.render(alone, engine=engine)
        np.testing.assert_allclose(frame.baked.lux, expected.baked.lux, rtol=1e-5)
        np.testing.assert_array_equal(frame.image.rgb, expected.image.rgb)


class TestTime:
    """A lamp flies; its maps are those of three moments."""

    MOMENTS = (0.0, 1.0, 3.0)

    def flying(self, folder):
        key = [
            {"time_seconds": time, "position": [0.5 - 0.5 * time, 1.5, 0.2]} for time in (0.0, 3.0)
        ]
        lamps = lamp_tables({"ball": "baked"}, ["ball"], key=key)
        session = {"duration_seconds": 3.0}
        return world(folder, {"ball": "baked"}, moments=self.MOMENTS, lamp=lamps, scene=session)

    def test_between_moments_their_mean_by_time(self, tmp_path, engine):
        renderer = Renderer(self.flying(tmp_path), engine)
        # There and back again: what is drawn does not hang on what was drawn before.
        at = {time: renderer.render(time).baked.lux for time in (0.5, 3.0, 2.5, 0.0, 1.0, 2.5, 0.5)}
        assert np.abs(at[0.0] - at[3.0]).mean() > 1
        bright = max(lux.max() for lux in at.values())
        for time, (before, after, share) in {0.5: (0.0, 1.0, 0.5), 2.5: (1.0, 3.0, 0.75)}.items():
            expected = (1 - share) * at[before] + share * at[after]
            np.testing.assert_allclose(at[time], expected, rtol=2e-3, atol=2e-4 * bright)
        np.testing.assert_array_equal(renderer.render(9.0).baked.lux, at[3.0])

    def test_at_a_moment_as_direct_light(self, tmp_path, engine):
        scene = self.flying(tmp_path)
        direct = scene.model_copy(
            update={"lamp": [scene.lamp[0].model_copy(update={"transport": "direct"})]}
        )
        for time in self.MOMENTS:
            frame = Renderer(scene, engine).render(time)
            truth = Renderer(direct, engine).render(time).illuminance.lux
            assert relative(frame.illuminance.lux, truth, frame.baked.covered)[0] < 0.005


class TestProbes:
    def room(self, folder, transports, in_probes, **changes):
        write_volume(folder / "light.glb", random_volume(POSITIONS["lattice"] - [1.5, 0, 1.5]))
        lamps = lamp_tables(transports, in_probes=in_probes)
        return world(folder, transports, lamp=lamps, probes={"volume": "light.glb"}, **changes)

    @pytest.mark.parametrize("in_probes", [True, False])
    def test_reflected_light_is_in_one_of_them(self, tmp_path, engine, in_probes):
        """Objects that probes light take maps of lamps alone that the probes do not have."""
        bounce = {"ball": "direct+bounce", "spot": "direct+bounce"}
        frame = andon.render(self.room(tmp_path, bounce, in_probes), engine=engine)
        direct = lux_of(self.room(tmp_path, {}, in_probes), engine)
        baked = np.asarray(frame.illuminance.lux, float) - direct
        on_box = frame.surface.is_object
        assert on_box.sum() > 50
        assert frame.baked.asked[on_box].all() != in_probes
        assert (np.abs(baked[on_box]).max() > 10) != in_probes
        assert np.abs(baked[~on_box & frame.surface.valid]).mean() > 10

    def test_an_object_may_leave_the_probes_alone(self, tmp_path, engine):
        box = {"name": "box", "mesh": "box.obj", "lit_by_probes": False}
        frame = andon.render(
            self.room(tmp_path, {"ball": "baked"}, True, object=[box]), engine=engine
        )
        assert frame.baked.asked[frame.surface.is_object].all()

    @pytest.mark.parametrize(
        "transports", [{"ball": "baked"}, {"ball": "baked", "spot": "direct+bounce"}]
    )
    def test_what_is_baked_as_a_whole_must_not_be_in_probes(self, tmp_path, transports):
        with pytest.raises(InputError, match="'ball' is in the maps and in the probes") as caught:
            prepare(self.room(tmp_path, transports, True))
        assert caught.value.field == "lamp.in_probes"

    def test_some_in_the_probes_and_some_not(self, tmp_path):
        bounce = {"ball": "direct+bounce", "spot": "direct+bounce"}
        scene = self.room(tmp_path, bounce, True)
        lamps = [scene.lamp[0], scene.lamp[1].model_copy(update={"in_probes": False})]
        with pytest.raises(InputError, match="'ball' is in the maps and in the probes"):
            prepare(scene.model_copy(update={"lamp": lamps}))


def with_a_metal_ball(folder, transports, engine, **tables):
    write_obj(folder / "metal.obj", ball(0.3, (0.3, 0.8, 0.0), 16))
    metal = {
        "name": "metal", "mesh": "metal.obj", "highlights": "cook-torrance", "metallic": 1.0,
        "roughness": 0.3,
    }  # fmt: skip
    return andon.render(world(folder, transports, object=[metal], **tables), engine=engine)


def test_metal_mirrors_baked_lamps(tmp_path, engine):
    """As it mirrors direct ones: where light comes from is no question of how it was computed."""
    direct = with_a_metal_ball(tmp_path, {}, engine)
    baked = with_a_metal_ball(tmp_path, {"ball": "baked", "spot": "baked"}, engine)
    mirrored = np.asarray(direct.highlights.cd_m2, float)
    assert mirrored.max() > 50
    np.testing.assert_allclose(baked.highlights.cd_m2, mirrored, rtol=1e-3, atol=1e-3)
    # And the direct light of what is baked is not computed beside the maps.
    assert relative(baked.illuminance.lux, direct.illuminance.lux, baked.baked.covered)[0] < 0.01


def test_a_baked_lamp_is_seen_and_glares(tmp_path, engine):
    def frame(transports):
        lamps = lamp_tables(transports, ["ball"], drawn=True)
        glare = {"model": "cie135", "needles": False, "halo": False}
        dim = {"illuminance_lux": 2.0}
        return andon.render(
            world(tmp_path, transports, lamp=lamps, glare=glare, ambient=dim), engine=engine
        )

    direct, baked = frame({}), frame({"ball": "baked"})
    body = np.asarray(direct.bodies.cd_m2, float)
    assert body.max() > 1000
    np.testing.assert_array_equal(baked.bodies.cd_m2, body)
    veil = np.asarray(direct.glare.cd_m2, float)
    assert veil.max() > 1
    # Of all light: the room's own is that of the maps now.
    np.testing.assert_allclose(baked.glare.cd_m2, veil, rtol=0.02, atol=2e-3 * veil.max())
    on_body = baked.surface.body_id >= 0
    assert on_body.any()
    assert not baked.baked.asked[on_body].any()
