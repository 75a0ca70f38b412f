"""The shaders against the reference: every kind of lamp, both filters, away from shadow edges."""

import numpy as np
import pytest

from andon.lamps import PointLamp, Shadow
from andon.pipeline import Renderer
from andon.rays import RayScene
from andon.spaces import View
from andon.verify.edges import near_change, shadow_edges
from andon.verify.rooms import random_view
from andon.verify.rows.closed_forms import floor_error
from andon.verify.setting import prepared_of, room, room_lamps
from comparison import assert_agree
from direct.rooms import HARD, SOFT, VIEW, lamps
from worlds import ball, open_room

pytestmark = pytest.mark.usefixtures("gpu")

# Pixels around a shadow's edge that are left out: two texels of a 1024² map at 3 m are 24 mm,
# 2 to 3 pixels of this view, more on surfaces that are seen or lit at a slant.
EDGE_PX = 4


def both(geometry, view, *bulbs):
    prepared = prepared_of(geometry, view, bulbs)
    return [Renderer(prepared, engine).render() for engine in ("gpu", "reference")]


@pytest.mark.parametrize("shadow", [HARD, SOFT], ids=["hard", "soft"])
@pytest.mark.parametrize("kind", lamps(HARD))
def test_every_lamp(kind, shadow):
    fast, slow = both(open_room(), VIEW, lamps(shadow)[kind])
    truth = np.asarray(slow.illuminance.lux)
    lit = truth.max(axis=-1) > 1e-3 * truth.max()
    edges = near_change(lit, EDGE_PX) | near_change(slow.surface.valid, 1)
    depth = np.nan_to_num(slow.surface.depth)
    edges |= np.abs(depth - np.nan_to_num(fast.surface.depth)) > 1e-3 * depth
    kept = ~edges & slow.surface.valid
    assert kept.mean() > 0.5
    ours = np.asarray(fast.illuminance.lux, float)
    # 6.5e-5 rad of a packed normal against cos φ ≥ 0.05: 1.3e-3. The share is for creases: within
    # a texel of one, the receiver's plane runs on behind the other wall.
    floor = 0.05 * truth.max()
    assert_agree(ours[kept], truth[kept], rtol=1e-3, atol=1e-3 * floor, share=5e-3, what=kind)


def test_closed_form_on_the_gpu():
    assert floor_error("gpu") <= 1e-3


def test_many_lamps_of_all_kinds_add_up():
    bulbs = list(lamps(HARD).values())
    together, _ = both(open_room(), VIEW, *bulbs)
    single = [
        np.asarray(Renderer(prepared_of(open_room(), VIEW, (x,)), "gpu").render().illuminance.lux)
        for x in bulbs
    ]
    assert_agree(np.asarray(together.illuminance.lux), np.sum(single, axis=0), rtol=1e-5, atol=1e-3)


def test_nothing_shadows_itself_around_a_lamp():
    """A lamp in a ball lights all of it: no acne between facets, no seam between paraboloids."""
    view = View("latlong", 256, 128)
    lamp = PointLamp("middle", np.array([0.1, 0.05, -0.1]), np.full(3, 50.0), HARD)
    fast, slow = both(ball(1.5, (0, 0, 0), 24), view, lamp)
    assert np.asarray(slow.illuminance.lux).min() > 0
    assert np.asarray(fast.illuminance.lux).min() > 0


@pytest.mark.parametrize("seed", range(3))
def test_shadows_differ_only_at_edges(seed):
    """A thinned `andon verify relight.paraboloid`: other views, other lamps."""
    view = random_view(seed, 192, 108)
    lamp = room_lamps(16, HARD)[4 * seed + 1]
    frame = Renderer(prepared_of(room(), view, (lamp,)), "gpu").render()
    surface, casters = frame.surface, RayScene(room())
    mask = surface.valid
    points, normals = surface.position[mask], surface.normal[mask]
    reach = lamp.position_m - points
    cosine = np.einsum("ij,ij->i", reach, normals) / np.linalg.norm(reach, axis=1)

    def visible(at, facing, lamp_position):
        above = np.einsum("ij,ij->i", lamp_position - at, facing) > 0
        return above & casters.is_visible(at + 2e-4 * facing, lamp_position)

    ours = np.asarray(frame.illuminance.lux)[mask].max(axis=1) > 0
    wrong = (cosine > 0.05) & (ours != visible(points, normals, lamp.position_m))
    assert wrong.mean() < 0.02
    edge = shadow_edges(
        points[wrong], normals[wrong], lamp, visible, casters, HARD.map_size, steps=9
    )
    assert np.count_nonzero(~edge) <= 0.01 * np.count_nonzero(wrong)


def test_a_map_is_redrawn_for_the_lamp_that_moves_and_for_no_other():
    still, moving = room_lamps(2, Shadow(256, "none"))

    def at(time_seconds):
        from dataclasses import replace

        shifted = moving.position_m + np.array([0.05 * time_seconds, 0, 0])
        return still, replace(moving, position_m=shifted)

    from dataclasses import replace as changed

    prepared = changed(prepared_of(room(), random_view(1), (still, moving)), lamps=at)
    renderer = Renderer(prepared, "gpu")
    assert [renderer.render(t).report.maps_redrawn for t in (0.0, 0.0, 1.0, 1.0, 0.0)] == [
        2, 0, 1, 0, 1,
    ]  # fmt: skip


def test_a_moved_lamp_and_a_fresh_renderer_agree():
    first, second = room_lamps(2, HARD)
    from dataclasses import replace

    places = {0.0: first.position_m, 1.0: second.position_m}

    def at(time_seconds):
        return (replace(first, position_m=places[time_seconds]),)

    prepared = replace(prepared_of(room(), random_view(2), at(0.0)), lamps=at)
    renderer = Renderer(prepared, "gpu")
    renderer.render(0.0)
    moved = renderer.render(1.0).illuminance.lux
    fresh = Renderer(replace(prepared, lamps=lambda _: at(1.0)), "gpu").render().illuminance.lux
    np.testing.assert_array_equal(moved, fresh)


def test_shadow_maps_of_an_empty_scene_light_everything():
    from dataclasses import replace

    from andon.quantities import Geometry
    from andon.surface.occluder import Occluder

    prepared = prepared_of(open_room(), VIEW, (lamps(HARD)["point"], lamps(HARD)["directional"]))
    nothing = Occluder(Geometry(np.zeros((0, 3)), np.zeros((0, 3), np.int32)), 0, 0.0)
    prepared = replace(prepared, surface=replace(prepared.surface, occluder=nothing))
    fast, slow = (Renderer(prepared, engine).render() for engine in ("gpu", "reference"))
    assert_agree(
        np.asarray(fast.illuminance.lux)[~near_change(slow.surface.valid, 2)],
        np.asarray(slow.illuminance.lux)[~near_change(slow.surface.valid, 2)],
        rtol=5e-3,
        atol=0.5,
        share=0.01,
    )


@pytest.mark.parametrize("seed", [0, 3])
def test_exact_shadows_have_the_triangles_own_edges(seed):
    """Against rays, exact shadows err on far fewer pixels than texels do, and never in the open."""
    from dataclasses import replace

    view, lamp = random_view(seed, 320, 180), room_lamps(1)[0]
    wrong = {}
    for name in ("none", "exact"):
        bulb = replace(lamp, shadow=Shadow(512, name))
        fast, slow = both(room(), view, bulb)
        kept = slow.surface.valid & (np.abs(fast.surface.depth - slow.surface.depth) < 1e-3)
        pair = [np.asarray(f.illuminance.lux).max(axis=-1)[kept] > 0 for f in (fast, slow)]
        wrong[name] = np.mean(pair[0] != pair[1])
    # Few edges of shadows are in view 0: texels err on 27 pixels, and 26 is half of what they would
    # without their lift. View 3 has many.
    most = 26 / (320 * 180) if seed == 0 else 0.5 * wrong["none"]
    assert wrong["exact"] < min(most, wrong["none"]), wrong
    assert wrong["exact"] < 0.005, wrong
