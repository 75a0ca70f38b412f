"""The engine peer: its units, its shadows, and the means to compare."""

import numpy as np
import pytest

from andon.bench.peers.pygfx_room import PygfxRoom, agreement
from andon.errors import InputError, MachineError
from andon.quantities import Geometry, Material
from andon.responses import srgb_encode
from andon.spaces import View, look_at
from andon.verify.solids import box, panel
from requirements import missing

# pygfx draws on an adapter or not at all.
pytestmark = pytest.mark.usefixtures("gpu")

RHO = np.array([0.6, 0.3, 0.1])


def view_from(eye, target, up=(0, 1, 0), width=128, height=72):
    return View(
        "pinhole",
        width,
        height,
        fx=100.0,
        fy=100.0,
        cx=(width - 1) / 2,
        cy=(height - 1) / 2,
        world_from_camera=look_at(np.array(eye), np.array(target), up),
    )


def drawn(geometry, view, position, intensity, **settings):
    peer = PygfxRoom(geometry, view, [position], [intensity], **settings)
    try:
        return peer.luminance()
    finally:
        peer.close()


def plane_points(view, height=0.0):
    """(H, W, 3) where the view's rays meet the plane y = height."""
    origin, directions = view.rays_world()
    return origin + directions * ((height - origin[1]) / directions[..., 1])[..., None]


def floor(half=6.0):
    face = panel((-half, 0, half), (2 * half, 0, 0), (0, 0, -2 * half), (4, 4))
    return Geometry(
        face.positions, face.triangles, materials=(Material(reflectance=tuple(RHO.tolist())),)
    )


def with_box(geometry, size, at):
    solid = box(size).moved(at)
    return Geometry(
        np.concatenate([geometry.positions, solid.positions]),
        np.concatenate([geometry.triangles, solid.triangles + len(geometry.positions)]),
        materials=geometry.materials,
    )


def lambert(points, position, intensity, normal=(0.0, 1.0, 0.0)):
    to_lamp = np.asarray(position) - points
    distance = np.linalg.norm(to_lamp, axis=-1)
    lux = (to_lamp @ np.asarray(normal) / distance**3)[..., None] * np.asarray(intensity)
    return RHO * lux / np.pi


def test_units_are_candela_and_cd_per_square_metre():
    view = view_from((0.2, 3.0, 1.0), (0.0, 0.0, 0.0))
    position, intensity = (0.4, 1.5, -0.3), (90.0, 70.0, 40.0)
    expected = lambert(plane_points(view), position, intensity)
    white = expected.max() * 1.02
    got = drawn(floor(), view, position, intensity, white_cd_m2=white, shadows="none")
    steps = 255 * (srgb_encode(got / white) - srgb_encode(expected / white))
    # Half a step of rounding; a quarter more for the driver's own sRGB and the grazing term. A
    # factor of 1.01 in the units would move the mean by 0.6 steps.
    assert np.abs(steps).max() < 0.75
    assert np.abs(steps.mean(axis=(0, 1))).max() < 0.2, "the units carry a factor"
    assert agreement(expected, got, white_cd_m2=white) == 1.0


@pytest.mark.parametrize("shadows", ["drawn", "kept"])
def test_an_occluder_casts_its_shadow_downwards(shadows):
    geometry = with_box(floor(), (1.0, 0.2, 1.0), (0.0, 1.1, 0.0))
    view = view_from((0.0, 0.5, 3.5), (0.0, 0.0, 0.0))
    position, intensity = (0.0, 2.2, 0.0), (50.0, 50.0, 50.0)
    got = drawn(geometry, view, position, intensity, white_cd_m2=10.0, shadows=shadows)
    assert_shadow(got, plane_points(view), position, intensity, half_width=1.1)


def test_an_occluder_casts_its_shadow_upwards():
    low = floor()
    ceiling = Geometry(
        low.positions * (1, 1, -1) + (0, 3, 0), low.triangles, materials=low.materials
    )
    geometry = with_box(ceiling, (1.0, 0.2, 1.0), (0.0, 1.9, 0.0))
    view = view_from((0.0, 2.5, 3.5), (0.0, 3.0, 0.0))
    position, intensity = (0.0, 0.8, 0.0), (50.0, 50.0, 50.0)
    got = drawn(geometry, view, position, intensity, white_cd_m2=10.0)
    points = plane_points(view, 3.0)
    assert_shadow(got, points, position, intensity, half_width=1.1, normal=(0.0, -1.0, 0.0))


def assert_shadow(got, points, position, intensity, half_width, normal=(0.0, 1.0, 0.0)):
    """Dark inside the square of ± half_width, lit outside; the view must not see the occluder."""
    facing = np.isfinite(points).all(axis=-1) & (np.abs(points) < 5).all(axis=-1)
    reach = np.abs(points[..., [0, 2]]).max(axis=-1)
    # In front of the occluder's picture only: rows that look at z > 1.2 or its deep shadow.
    dark = facing & (reach < half_width - 0.1) & (points[..., 2] > 0.7)
    lit = facing & (reach > half_width + 0.1) & (points[..., 2] > 0.7) & (reach < 3)
    assert dark.sum() > 100
    assert lit.sum() > 100
    assert (got[dark] == 0).all()
    expected = lambert(points, position, intensity, normal)
    np.testing.assert_allclose(got[lit], expected[lit], rtol=0.15, atol=0.01)


def test_read_back_has_the_view_s_shape_and_names_the_adapter():
    view = view_from((0.2, 3.0, 1.0), (0.0, 0.0, 0.0), width=64, height=48)
    try:
        peer = PygfxRoom(floor(), view, [(0, 2, 0)], [(9, 9, 9)], white_cd_m2=1.0)
    except MachineError as error:
        missing(f"no adapter: {error}")
    pixels = peer.render()
    assert pixels.shape == (48, 64, 4)
    assert pixels.dtype == np.uint8
    assert peer.adapter_name
    peer.close()


def test_agreement_counts_pixels():
    ours = np.full((10, 10, 3), 4.0)
    assert agreement(ours, ours, white_cd_m2=10) == 1
    assert agreement(ours, ours * 1.04, white_cd_m2=10) == 1
    assert agreement(ours, ours * 1.08, white_cd_m2=10) == 0
    peer = ours.copy()
    peer[:3, 0, 1] *= 2
    assert agreement(ours, peer, white_cd_m2=10) == pytest.approx(0.97)


def test_agreement_clips_both_at_white_and_grants_half_a_step_in_the_dark():
    bright = np.full((2, 2, 3), 50.0)
    assert agreement(bright, np.full((2, 2, 3), 10.0), white_cd_m2=10) == 1
    dark = np.full((2, 2, 3), 10 / 255 / 12.92)
    assert agreement(dark, dark * 1.4, white_cd_m2=10) == 1
    assert agreement(dark, dark * 1.9, white_cd_m2=10) == 0


def test_agreement_with_nan_or_another_shape():
    ours = np.ones((2, 2, 3))
    peer = ours.copy()
    peer[0, 0, 0] = np.nan
    assert agreement(ours, peer, white_cd_m2=10) == 0.75
    with pytest.raises(InputError, match="one shape"):
        agreement(ours, np.ones((3, 2, 3)), white_cd_m2=10)


@pytest.mark.parametrize(
    ("change", "rule"),
    [
        ({"white_cd_m2": 0.0}, "white"),
        ({"lamp_intensities_cd": [(1.0, -1.0, 1.0)]}, "> 0 cd"),
        ({"lamp_positions": [(0.0, np.nan, 0.0)]}, "finite"),
        ({"lamp_positions": [(0.0, 1.0)]}, "both be"),
        ({"view": View("latlong", 64, 32)}, "pinhole"),
        ({"view": View("pinhole", 64, 32, fx=50, fy=50, cx=0, cy=0)}, "central"),
        ({"geometry": Geometry(np.eye(3), np.array([(0, 1, 2)], np.int32),
                               materials=(Material(texture=np.zeros((1, 1, 3))),))}, "textures"),
    ],
)  # fmt: skip
def test_what_the_peer_cannot_draw_is_refused(change, rule):
    good = {
        "geometry": floor(),
        "view": view_from((0.2, 3.0, 1.0), (0.0, 0.0, 0.0)),
        "lamp_positions": [(0.0, 2.0, 0.0)],
        "lamp_intensities_cd": [(1.0, 1.0, 1.0)],
        "white_cd_m2": 1.0,
    }
    with pytest.raises(InputError, match=rule):
        PygfxRoom(**(good | change))
