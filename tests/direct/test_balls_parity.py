"""Glass balls on the GPU: the same light as the reference, and tables that follow what moves."""

from dataclasses import replace

import numpy as np
import pytest

from andon.display.false_colour import false_colour
from andon.errors import InputError
from andon.lamps import PointLamp
from andon.pipeline import Renderer
from andon.quantities import photometric
from andon.transport.direct.balls import GlassBall
from andon.transport.direct.balls.buffers import BallBuffers
from andon.transport.direct.balls.records import MAX_PAIRS
from andon.verify.edges import near_change
from andon.verify.setting import prepared_of
from comparison import assert_agree, assert_golden
from direct.rooms import HARD, SOFT, VIEW, lamps, luminaire
from worlds import open_room

# One in the air before the block, tinted; one near it, of strong dispersion, in the other's light.
BALLS = (
    GlassBall(np.array([0.35, 0.85, 0.35]), 0.25, (1.5, 1.51, 1.53), (0.0, 0.2, 2.0)),
    GlassBall(np.array([-0.1, 0.25, 0.2]), 0.24, (1.6, 1.65, 1.72)),
)
KINDS = {**lamps(HARD), "luminaire": luminaire(HARD)}
SERVED = ("point", "spot", "wide spot", "directional", "luminaire")


def drawn(engine, lamp, balls=BALLS, view=VIEW):
    prepared = replace(prepared_of(open_room(), view, (lamp,)), balls=balls)
    return Renderer(prepared, engine).render()


def edges_of(lux):
    lit = lux.max(axis=-1) > 1e-3 * np.median(lux[lux > 0])
    return near_change(lit, 3)


@pytest.mark.parametrize("kind", SERVED)
def test_both_engines_see_the_same_light(kind, gpu):
    fast, slow = (drawn(engine, KINDS[kind]) for engine in ("gpu", "reference"))
    plain = np.asarray(drawn("reference", KINDS[kind], ()).illuminance.lux)
    truth, ours = np.asarray(slow.illuminance.lux), np.asarray(fast.illuminance.lux, float)
    assert np.abs(truth - plain).max() > 0.05 * plain.max()
    # Shadows of the room are edges of the plain light, those of balls of the difference.
    kept = slow.surface.valid & ~edges_of(plain) & ~near_change(slow.surface.valid, 1)
    depth = np.nan_to_num(slow.surface.depth)
    kept &= ~near_change(np.abs(depth - np.nan_to_num(fast.surface.depth)) > 1e-3 * depth, 1)
    # 2⁻¹¹ of a half float, four times blended, and packed normals (see test_parity).
    floor = 0.05 * plain.max()
    assert_agree(ours[kept], truth[kept], rtol=2e-3, atol=2e-3 * floor, share=8e-3, what=kind)


@pytest.mark.parametrize("kind", ["sky", "hemisphere"])
def test_light_from_all_sides_passes_balls(kind, gpu):
    for engine in ("gpu", "reference"):
        with_balls, without = (drawn(engine, KINDS[kind], x) for x in (BALLS, ()))
        np.testing.assert_array_equal(with_balls.illuminance.lux, without.illuminance.lux)


def test_balls_of_air_cost_nothing_and_change_nothing(gpu):
    air = tuple(replace(ball, index=(1.0,) * 3, absorption_per_m=(0.0,) * 3) for ball in BALLS)
    lamp = KINDS["point"]
    pictures = [np.asarray(drawn("gpu", lamp, balls).luminance.cd_m2) for balls in (air, ())]
    np.testing.assert_array_equal(*pictures)
    prepared = replace(prepared_of(open_room(), VIEW, (lamp,)), balls=air)
    assert not Renderer(prepared, "gpu")._engine.direct.glass.variants


def test_tables_follow_a_lamp_that_moves_also_through_a_ball(gpu):
    start = KINDS["point"]
    higher = start.position_m + np.array([0, 0.4, 0])
    places = {0.0: start.position_m, 1.0: BALLS[0].centre_m, 2.0: higher}

    def at(time_seconds):
        return (replace(start, position_m=places[time_seconds]),)

    prepared = replace(prepared_of(open_room(), VIEW, at(0.0)), balls=BALLS, lamps=at)
    renderer = Renderer(prepared, "gpu")
    moving = [np.asarray(renderer.render(time).illuminance.lux) for time in places]
    for time, lux in zip(places, moving, strict=True):
        fresh = Renderer(replace(prepared, lamps=lambda _, now=time: at(now)), "gpu")
        np.testing.assert_array_equal(lux, fresh.render().illuminance.lux)


def test_more_pairs_than_there_is_room_for_are_refused(gpu):
    from andon.gpu.device import open_gpu

    many = [PointLamp(f"p{k}", np.array([0.0, 2.0, 0.0]), np.ones(3)) for k in range(MAX_PAIRS + 1)]
    with pytest.raises(InputError, match="at most 64"):
        BallBuffers(open_gpu(), many, BALLS[:1], {})


def picture(engine):
    frame = drawn(engine, lamps(SOFT)["point"], view=VIEW.resized(160, 120))
    lux = photometric(np.asarray(frame.illuminance.lux))
    return false_colour(lux, "lx", valid=frame.surface.valid)


def test_a_picture_of_shadow_and_caustic(tmp_path):
    assert_golden(picture("reference"), "direct-balls", tmp_path)


def test_the_same_picture_on_the_gpu(tmp_path, gpu):
    assert_golden(picture("gpu"), "direct-balls", tmp_path, written=False, share=0.03, mean=1.5)
