"""Conventions of light: each test fails if its convention is turned round."""

import re
from dataclasses import replace

import numpy as np
import pytest

import andon
from andon.composite.model import Ambient
from andon.composite.reference import lamp_luminance, object_luminance, relit_linear
from andon.engines.baked_light import part_of
from andon.engines.prepared import prepare
from andon.errors import InputError
from andon.files.illuminance_maps import (
    geometry_bytes,
    light_bytes,
    read_geometry_picture,
    read_light_picture,
)
from andon.files.pictures import read_picture, write_picture
from andon.glare.kernel import Kernel
from andon.glare.picture import glare_of_picture
from andon.glass.layers import Layers
from andon.glow.model import Glow
from andon.glow.reference import add_glow
from andon.harmonics import basis, irradiance, project_cube
from andon.lamps import (
    DirectionalLamp,
    HemisphereLamp,
    PointLamp,
    PolygonLamp,
    SkyLamp,
    SpotLamp,
    intensity_cd,
    resolve_lamps,
)
from andon.lamps.distributions import spot_attenuation
from andon.lamps.sources import resolve_sources
from andon.observer.spread.family import spread_function
from andon.quantities import CameraFrame, Geometry, photometric
from andon.responses import SRGB
from andon.spaces import View, look_at
from andon.transport.baked import BakedLight, BakedMoment, IlluminanceMap
from andon.transport.baked.radiance import radiance_bundle
from andon.transport.baked.radiance.quality import QUALITIES
from andon.transport.baked.radiance.trace import traced_illuminance
from andon.transport.baked.reference import baked_illuminance
from andon.transport.direct.reference import illuminance

from .settings import ORIGIN, VIEW, WHITE, X, Y, Z, close, grey, lamps_of, relit


def lux_of(lamp, position=ORIGIN, normal=Y):
    return illuminance(lamp, position, normal)


def test_weights():
    close([photometric(channel) for channel in np.eye(3)], [0.2126, 0.7152, 0.0722])


def test_neutral_light():
    (lamp,) = lamps_of({"kind": "point", "position": [0, 0, 0], "intensity_cd": 5})
    close(lamp.intensity_cd, [5, 5, 5])


@pytest.mark.parametrize(
    "colour", [{"temperature_k": 2700}, {"rgb": [1, 0, 0]}, {"chromaticity_xy": [0.2, 0.3]}]
)
def test_lamp_colour(colour):
    (lamp,) = lamps_of({"kind": "point", "position": [0, 0, 0], "intensity_cd": 5} | colour)
    close(photometric(lamp.intensity_cd), 5)
    assert np.ptp(lamp.intensity_cd) > 1


def test_one_candela():
    lamp = PointLamp("lamp", Y, WHITE)
    close(lux_of(lamp), WHITE)
    close(lux_of(replace(lamp, position_m=2 * Y)), WHITE / 4)
    close(lux_of(lamp, normal=-Y), 0)


def test_diffuse_luminance():
    surface = relit(grey()).surface
    white = replace(surface, reflectance=np.ones((*VIEW.shape, 3)))
    added = np.full((*VIEW.shape, 3), 100 * np.pi)
    dark = Ambient(np.full(3, 50.0), (0, 0, 0))
    close(object_luminance(white, dark, added), 100)


def test_flux():
    place = {"position": [0, 0, 0]}
    (point,) = lamps_of({"kind": "point", "flux_lm": 4 * np.pi} | place)
    close(point.intensity_cd, 1)
    cone = {"kind": "spot", "flux_lm": 100, "direction": [0, -1, 0], "outer_degrees": 40}
    (spot,) = lamps_of(cone | place)
    edges = np.linspace(np.cos(spot.outer_radians), 1, 20001)
    share = spot_attenuation(
        (edges[1:] + edges[:-1]) / 2,
        inner_radians=spot.inner_radians,
        outer_radians=spot.outer_radians,
    )
    close(2 * np.pi * share @ np.diff(edges) * spot.intensity_cd[0], 100, rtol=1e-6)


def test_spot():
    cone = {"inner_radians": np.radians(20), "outer_radians": np.radians(40)}
    lamp = SpotLamp("lamp", Y, WHITE, direction=-Y, **cone)
    close(lux_of(lamp), WHITE)  # on the axis: the intensity itself
    shares = spot_attenuation(np.cos(np.radians([19.9, 30, 40.1])), **cone)
    middle = (np.cos(np.radians(30)) - np.cos(cone["outer_radians"])) / np.ptp(
        np.cos(list(cone.values()))
    )
    close(shares, [1, middle**2, 0])


def test_directional():
    lamp = DirectionalLamp("sun", -Y, 1000 * WHITE)
    close(lux_of(lamp), 1000)  # light that travels down falls on what faces up
    close(lux_of(lamp, normal=-Y), 0)


def lamp_of(folder=".", **table):
    scene = andon.scene_from_dict({"lamp": [table]}, folder=folder)
    return resolve_lamps(scene, 0.0)


def test_area_lamps():
    """A square metre of 100 cd/m² has 100 cd along its normal and 100·π lm, on both sides twice."""
    flat = {"kind": "rectangle", "position": [0, 0, 0], "direction": [0, 0, 1]}
    flat |= {"width_m": 2.0, "height_m": 0.5}
    for light in ({"luminance_cd_m2": 100}, {"intensity_cd": 100}, {"flux_lm": 100 * np.pi}):
        close(lamp_of(**flat, **light)[0].luminance_cd_m2, 100)
    (both,) = lamp_of(**flat, flux_lm=200 * np.pi, two_sided=True)
    close(both.luminance_cd_m2, 100)
    ball = {"kind": "sphere", "position": [0, 0, 0], "radius_m": 0.5}
    close(lamp_of(**ball, intensity_cd=25 * np.pi)[0].luminance_cd_m2, 100)
    close(lamp_of(**ball, flux_lm=100 * np.pi**2)[0].luminance_cd_m2, 100)
    # From afar it is a point of its own intensity.
    far = lux_of(lamp_of(**flat, intensity_cd=100)[0], position=100 * Z, normal=-Z)
    close(far, 100 / 100**2, rtol=1e-4)


def test_polygon_side():
    """Counter-clockwise as seen from +Z: it shines towards +Z."""
    square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0.0]])
    front, back = PolygonLamp("p", WHITE, square), PolygonLamp("p", WHITE, square[::-1])
    assert lux_of(front, position=Z, normal=-Z)[0] > 0.5
    assert lux_of(back, position=Z, normal=-Z)[0] == 0


def test_shells():
    """Of 100 cd in a closed ball of t = 0.3, 30 cd come out; its luminance is t·I/(π r²)."""
    table = {"kind": "point", "position": [0, 0, 0], "intensity_cd": 100}
    (ball,) = lamp_of(**table, shell={"radius_m": 0.5, "transmittance": 0.3})
    close(ball.luminance_cd_m2, 30 / (np.pi * 0.25))
    paper = {"radius_m": 0.5, "transmittance": 0.3, "mode": "paper"}
    (point,) = lamp_of(**table, shell=paper)
    close(point.intensity_cd, 30)


def test_luminaires(tmp_path):
    """Looking down, γ = 0 is −Y and C = 0 is +X; a roll of 90° brings C = 0 to C = 90."""
    numbers = "1 1000 1 3 5 1 2 0 0 0\n1 1 100\n0 90 180\n0 90 180 270 360"
    planes = "10 20 0\n10 0 0\n10 0 0\n10 0 0\n10 20 0"
    text = f"IESNA:LM-63-2002\nTILT=NONE\n{numbers}\n{planes}\n"
    (tmp_path / "a.ies").write_text(text)
    table = {"kind": "ies", "position": [0, 0, 0], "file": "a.ies"}
    (lamp,) = lamp_of(tmp_path, **table)
    close([intensity_cd(lamp, d)[0] for d in (-Y, X, -X)], [10, 20, 0], atol=1e-9)
    (rolled,) = lamp_of(tmp_path, **table, roll_degrees=90)
    ninety = np.cross(lamp.right, lamp.direction)  # C = 90 of the lamp before
    close(intensity_cd(rolled, ninety)[0], 20, rtol=1e-6)


def test_sky():
    sky = SkyLamp("sky", Y, 100 * WHITE)
    close([lux_of(sky, normal=n)[0] for n in (Y, X, -Y)], [100, 50, 0])
    dome = HemisphereLamp("dome", Y, 100 * WHITE, 40 * WHITE)
    close([lux_of(dome, normal=n)[0] for n in (Y, X, -Y)], [100, 70, 40])


def test_visible_lamps():
    lamp = PointLamp("lamp", -Z, 3 * WHITE, visible_radius_m=0.2)
    close(lamp_luminance(lamp, ORIGIN), 3 / (np.pi * 0.04))
    hidden, shown = (
        relit(grey(0), [replace(lamp, visible_radius_m=radius)]) for radius in (0.0, 0.2)
    )
    close(hidden.illuminance.lux, shown.illuminance.lux)
    assert hidden.luminance.cd_m2[1, 2].max() == 0
    close(shown.luminance.cd_m2[1, 2], 3 / (np.pi * 0.04))
    behind = replace(lamp, position_m=-3 * Z)
    assert relit(grey(0), [behind]).luminance.cd_m2.max() == 0


@pytest.mark.parametrize("word", ["absolute", "relative"])
def test_photometry(word):
    frame = relit(grey(), photometry=word)
    words = {frame.illuminance.photometry, frame.luminance.photometry, frame.report.photometry}
    assert words == {word}


def test_ambient_is_stated(tmp_path):
    write_picture(tmp_path / "a.png", grey())
    np.save(tmp_path / "d.npy", np.full(VIEW.shape, 2.0))
    tables = {
        "rig": {"camera": {"fx": 4.0}},
        "capture": {"source": "a.png"},
        "surface": {"depth": "d.npy"},
    }
    with pytest.raises(InputError, match="E0") as refused:
        prepare(andon.scene_from_dict(tables, folder=tmp_path))
    assert refused.value.field == "ambient"


def test_luminance_per_unit():
    frame = relit(grey(255), ambient_lux=100 * np.pi)
    close(frame.captured.luminance_per_unit, 100)
    close(frame.luminance.cd_m2, 100, rtol=1e-6)


def test_identity():
    photo = np.random.default_rng(0).integers(0, 256, (*VIEW.shape, 3), dtype=np.uint8)
    np.testing.assert_array_equal(relit(photo).image.rgb, photo)


def test_doubling():
    """As much light again as there was: twice the linear value."""
    lamp = HemisphereLamp("dome", Y, 100 * WHITE, 100 * WHITE)
    frame = relit(grey(), [lamp], ambient_lux=100)
    twice = SRGB.encode(2 * SRGB.decode(grey() / 255))
    close(frame.image.rgb, np.round(twice * 255), atol=0.5)


def test_light_in_holes():
    depth = np.full(VIEW.shape, 2.0)
    depth[0, 0] = np.nan
    lamp = HemisphereLamp("dome", Y, 100 * WHITE, 100 * WHITE)
    frame = relit(grey(), [lamp], depth=depth)
    assert frame.illuminance.lux[0, 0].max() == 0
    assert (frame.image.rgb[0, 0] == 128).all()
    assert (frame.image.rgb[1, 1] > 128).all()
    dimmed = relit(grey(), [lamp], depth=depth, dimming=0.5)
    close(dimmed.luminance.cd_m2[0, 0], frame.luminance.cd_m2[0, 0] / 2, rtol=1e-6)


def test_sources():
    """Half of E0 is a lamp: without it half is left, and never less than nothing."""
    source = {"kind": "point", "position": [0, 0, 0], "intensity_cd": 100, "name": "bulb"}
    ambient = {"illuminance_lux": 100.0, "source": [source], "removed": ["bulb"], "dimming": 0.5}
    scene = andon.scene_from_dict({"ambient": ambient})
    (gone,) = resolve_sources(scene, 0.0, ())
    close(gone.intensity_cd, -50)
    frame = CameraFrame(SRGB.decode(grey() / 255).astype(np.float32), VIEW)
    settings = Ambient(np.full(3, 100.0), (0.5, 0.5, 0.5))
    some, all_ = (np.full((*VIEW.shape, 3), lux) for lux in (-25.0, -80.0))
    close(relit_linear(frame, settings, some), frame.linear * 0.25, rtol=1e-6)
    assert relit_linear(frame, settings, all_).max() == 0
    kept = andon.scene_from_dict({"ambient": ambient | {"removed": []}})
    assert resolve_sources(kept, 0.0, ()) == ()
    now, before = resolve_sources(kept, 0.0, ["objects"])
    close(now.intensity_cd, -before.intensity_cd)
    assert before.shadow.through == {"objects"}
    assert now.shadow.through == set()


def test_glow():
    bodies = np.zeros((*VIEW.shape, 3))
    bodies[1, 2] = 90.0
    picture = bodies + 10
    settings = Glow(sigma_radians=0.5 / VIEW.fx, fraction=0.4)
    lit = add_glow(picture, bodies, settings, VIEW)
    close(lit.sum(), picture.sum(), rtol=0.02)  # but for what falls beyond the border
    assert 10 + 0.6 * 90 < lit[1, 2, 0] < 100
    assert lit[1, 1, 0] > 10


def test_glare():
    kernel = Kernel(spread_function("cie135"))
    # The CIE's own value at 1°; the kernel takes radians.
    close(kernel.per_sr(np.radians(1.0)), 18.8647, rtol=1e-3)
    sphere = View("latlong", 64, 32)
    light = np.full((*sphere.shape, 3), 1e-3)
    light[20, 10] = 1e4
    sent = light.sum(axis=-1) * sphere.solid_angles()
    result = glare_of_picture(light, sphere, engine="reference", with_stars=False)
    # 60° from the light: a cosine would halve it.
    seen, source = sphere.directions()[20, [22, 10]]
    lux = 1e4 * sphere.solid_angles()[20, 10]
    close(result.veil[20, 22, 1], kernel.per_sr(np.arccos(seen @ source)) * lux, rtol=0.02)
    total = (result.picture.sum(axis=-1) * sphere.solid_angles()).sum()
    close(total, sent.sum(), rtol=0.005)


def test_dimming_is_linear():
    linear = SRGB.decode(grey() / 255).astype(np.float32)
    frame = CameraFrame(linear, VIEW)
    none = np.zeros(linear.shape)
    ambient = Ambient(np.full(3, 100.0), (0.5, 0.25, 1.0))
    close(relit_linear(frame, ambient, none), linear * [0.5, 0.25, 1.0], rtol=1e-6)
    # It dims E0 and not ΔE.
    close(relit_linear(frame, ambient, none + 100), linear * [1.5, 1.25, 2.0], rtol=1e-6)
    paper = relit_linear(frame, replace(ambient, dimming_mode="paper"), none)
    close(SRGB.encode(paper), grey() / 255 * [0.5, 0.25, 1.0], rtol=1e-5)


def test_radiance():
    """1 cd is 1/179 W/sr in each channel of Radiance."""
    from andon.transport.baked.radiance.luminaires import POINT_RADIUS_M, point_text

    lamp = PointLamp("lamp", ORIGIN, np.array([1.0, 2, 3]))
    text, _ = point_text(lamp, "lamp", hides=True, radius_m=POINT_RADIUS_M)
    radiance = [float(word) for word in re.search(r"0 0 3 (\S+) (\S+) (\S+)", text).groups()]
    close(radiance, np.array([1, 2, 3]) / (np.pi * POINT_RADIUS_M**2) / 179, rtol=1e-6)


def test_illuminance_maps(tmp_path):
    """A floor seen from 2 m above at 45°: what is written at a pixel is found at its point."""
    view = View("pinhole", 41, 41, 40.0, 40.0, 20.0, 20.0, world_from_camera=look_at(
        np.array([0.0, 2, 2]), ORIGIN))  # fmt: skip
    rays = view.rays_planar() @ view.world_from_camera[:3, :3].T
    depth = -2 / rays[..., 1]
    position = view.position + depth[..., None] * rays
    lux = np.stack([100 + 20 * position[..., 0], 200 + 0 * depth, 0 * depth], axis=-1)
    (tmp_path / "g.exr").write_bytes(geometry_bytes(depth, np.broadcast_to(Y, lux.shape)))
    (tmp_path / "l.exr").write_bytes(light_bytes(lux))
    assert read_picture(tmp_path / "l.exr").attributes["andon:unit"] == "lx"
    seen = IlluminanceMap(view, *read_geometry_picture(tmp_path / "g.exr"),
                          {"lantern": read_light_picture(tmp_path / "l.exr")[0]})  # fmt: skip
    points = np.array([[0.4, 0, 0.3], [0.4, 0, 0.3], [0.4, 0.5, 0.3]])
    normals = np.array([Y, -Y, Y])  # the floor, its underside, and a table where there is none
    moment = BakedMoment(0.0, (seen,))
    found, covered = baked_illuminance(moment, points, normals, shares={"lantern": 0.5})
    assert covered.tolist() == [True, False, False]
    close(found[0], [54, 100, 0], rtol=1e-5)


def test_counted_once(tmp_path):
    """Before a grey wall: all light of a lamp less what is reflected of it is its direct light."""
    wall = [[-2, 0, -1], [2, 0, -1], [2, 3, -1], [-2, 3, -1]]
    floor = [[-2, 0, 2], [2, 0, 2], [2, 0, -1], [-2, 0, -1]]
    sides = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]], np.int32)
    lamp = PointLamp("lamp", np.array([0.0, 2, 0]), np.array([60.0, 80, 100]))
    bundle = radiance_bundle([Geometry(np.array([*wall, *floor], float), sides)], [lamp])
    for name, contents in bundle.items():
        (tmp_path / name).write_bytes(contents)
    options = {"quality": QUALITIES["draft"], "bounces": 2}
    every, bounce = (
        traced_illuminance(tmp_path, ORIGIN[None], Y[None], part=part_of(transport), **options)
        for transport in ("baked", "direct+bounce")
    )
    assert part_of("direct") is None
    assert (bounce > 1).all()
    close(every - bounce, [lamp.intensity_cd / 4], rtol=1e-3)


def test_moments():
    light = BakedLight((1.0, 3.0), lambda _: None, lambda _: {})
    assert light.around(1.5) == (0, 1, 0.25)
    assert light.around(0.0) == (0, 0, 0.0)
    assert light.around(9.0) == (1, 1, 0.0)


def test_alpha(tmp_path):
    import OpenEXR

    plane = np.full((2, 2), 0.25, np.float32)
    channels = {"R": plane, "G": plane, "B": plane, "A": 2 * plane}
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, channels).write(str(tmp_path / "a.exr"))
    close(read_picture(tmp_path / "a.exr").values, 0.25)


def test_spherical_harmonics():
    root = np.sqrt(3 / (4 * np.pi))
    close(basis(np.eye(3), 1)[:, 1:], root * np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]]))
    sky = project_cube(np.full((6, 4, 4, 3), 7.0), 1)  # cd/m² from all sides
    close(sky[0], 7 * np.sqrt(4 * np.pi))
    close(irradiance(sky, Y), 7 * np.pi)


def test_cover_of_glass():
    one, none = np.ones((1, 1)), np.zeros((1, 1))
    share = (1 - 0.8) * 0.5  # a texture of 80 % transmittance that covers half of the pixel
    layers = Layers(
        one, np.full((1, 1, 3), 100.0), np.full((1, 1, 3), share * 40.0), share * one,
        np.full((1, 1, 3), 7.0), none, none, none,
    )  # fmt: skip
    seen = layers.over(np.full((1, 1, 3), 1e6))
    np.testing.assert_allclose(seen, 0.1 * 40 + 0.9 * 100 + 7)
