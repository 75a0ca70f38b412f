"""From a scene's tables to geometry in the world: units, axes, placements, normals as pictures."""

import numpy as np
import pytest

from andon.composite.model import Ambient
from andon.engines.prepared import prepare
from andon.errors import InputError
from andon.files.pictures import write_exr, write_png
from andon.pipeline import Renderer
from andon.scene import scene_from_dict
from andon.spaces import View, look_at, rotate
from andon.surface.load import load_surface
from comparison import assert_agree
from worlds import block, sheet, sphere_depth, unit, write_glb, write_obj

VIEW = View("pinhole", 40, 30, 35.0, 35.0, 19.5, 14.5)


def loaded(folder, view=VIEW, **tables):
    scene = scene_from_dict(tables, folder=folder)
    return load_surface(scene, {view.name: view})


def test_obj_in_centimetres_with_z_up(tmp_path):
    """One metre east, two up, three north of the origin: x, y and z of the file differ."""
    write_obj(tmp_path / "room.obj", sheet((100, -300, 200), (10, 0, 0), (0, 0, 20)))
    model = loaded(tmp_path, scene={"unit": "cm", "up": "z"}, surface={"mesh": "room.obj"})
    assert_agree(model.real.positions[0], [1, 2, 3], atol=1e-12)
    # The file's z is the world's +Y, the file's y the world's −Z.
    assert_agree(np.ptp(model.real.positions, axis=0), [0.1, 0.2, 0], atol=1e-12)


def test_a_mesh_is_placed_after_its_units(tmp_path):
    write_obj(tmp_path / "room.obj", sheet((100, 0, 0), (10, 0, 0), (0, 10, 0)))
    place = [[0, 0, 1, 5], [0, 1, 0, 6], [-1, 0, 0, 7], [0, 0, 0, 1]]
    table = {"mesh": "room.obj", "world_from_mesh": place}
    model = loaded(tmp_path, scene={"unit": "cm"}, surface=table)
    assert_agree(model.real.positions[0], [5, 6, 6], atol=1e-12)


def test_a_mirror_does_not_turn_a_mesh_inside_out(tmp_path):
    from andon.rays import face_normals

    write_obj(tmp_path / "box.obj", block((1, 1, 1), (0, 0, 0)))
    mirror = np.diag([-1.0, 1, 1, 1]).tolist()
    model = loaded(tmp_path, surface={"mesh": "box.obj", "world_from_mesh": mirror})
    middle = model.real.positions[model.real.triangles].mean(axis=1)
    assert (np.einsum("ij,ij->i", face_normals(model.real), middle) > 0).all()


def test_reflectance_of_the_scene_wins(tmp_path):
    write_obj(tmp_path / "wall.obj", sheet((-5, -5, -2), (10, 0, 0), (0, 10, 0)))
    model = loaded(tmp_path, surface={"mesh": "wall.obj", "reflectance": [0.1, 0.2, 0.3]})
    assert [m.reflectance for m in model.real.materials] == [(0.1, 0.2, 0.3)]


def test_an_object_is_scaled_turned_and_moved(tmp_path):
    write_glb(tmp_path / "box.glb", block((1, 1, 1), (0, 0.5, 0)), colour=(0.25, 0.5, 0.75))
    quarter = [0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5)]  # about +Y: x goes to −z
    entry = {"mesh": "box.glb", "position": [1, 2, 3], "scale": 0.1, "rotation_xyzw": quarter}
    # glTF is metres and +Y up, whatever the scene says of files that do not define them.
    model = loaded(tmp_path, scene={"unit": "mm", "up": "z"}, object=[entry])
    low, high = model.objects.positions.min(axis=0), model.objects.positions.max(axis=0)
    assert_agree([low, high], [[0.95, 2, 2.95], [1.05, 2.1, 3.05]], atol=1e-7)
    long = {**entry, "transform": [[0, 0, 2, 1], [0, 1, 0, 2], [-1, 0, 0, 3], [0, 0, 0, 1]]}
    for key in ("position", "scale", "rotation_xyzw"):
        del long[key]
    model = loaded(tmp_path, object=[long])
    assert_agree(np.ptp(model.objects.positions, axis=0), [2, 1, 1], atol=1e-6)
    assert_agree(model.objects.materials[0].reflectance, [0.25, 0.5, 0.75], atol=1e-7)


def test_objects_that_cast_no_shadow_are_no_casters(tmp_path):
    write_glb(tmp_path / "box.glb", block((1, 1, 1), (0, 0, 0)))
    both = [{"mesh": "box.glb"}, {"mesh": "box.glb", "name": "ghost", "casts_shadow": False}]
    model = loaded(tmp_path, object=both)
    assert len(model.objects.triangles) == 24
    assert len(model.casters.triangles) == 12
    assert model.objects.material_ids.tolist() == [0] * 12 + [1] * 12


# ── normals alone ─────────────────────────────────────────────────────────────────────────────

POSE = look_at(np.array([0.0, 1, 2]), np.array([0.5, 0.5, 0]))
CAMERA = View(**{**vars(VIEW), "world_from_camera": POSE})
NORMALS = sphere_depth(CAMERA, (0, 0, 2.0), 0.7)[1]  # of a ball, in OpenCV's camera axes
HOLES = np.isnan(NORMALS[..., 0])
AXES = {
    "opencv": NORMALS,
    "opengl": NORMALS * (1, -1, -1),
    "world": rotate(POSE, NORMALS),
}


def write_normals(path, normals):
    if path.suffix == ".exr":
        write_exr(path, np.nan_to_num(normals).astype(np.float32), unit="1")
        return
    top, kind = (255, np.uint8) if "8bit" in path.name else (65535, np.uint16)
    codes = np.where(HOLES[..., None], 0, (normals + 1) / 2 * top)
    write_png(path, np.rint(codes).astype(kind))


@pytest.mark.parametrize("axes", AXES)
@pytest.mark.parametrize(
    ("name", "precision"), [("n.exr", 1e-6), ("n-16bit.png", 5e-5), ("n-8bit.png", 1e-2)]
)
def test_normals_as_pictures(tmp_path, name, precision, axes):
    write_normals(tmp_path / name, AXES[axes])
    model = loaded(tmp_path, CAMERA, surface={"normals": name, "normals_axes": axes})
    assert model.is_distant_only
    found = model.normals["mono"]
    assert (np.isnan(found[..., 0]) == HOLES).all()
    world = AXES["world"][~HOLES]
    assert_agree(found[~HOLES], world, atol=precision)
    assert_agree(np.linalg.norm(found[~HOLES], axis=-1), np.ones(len(world)), atol=1e-9)


@pytest.mark.parametrize("engine", ["reference", "gpu"])
def test_a_directional_lamp_on_normals_alone(tmp_path, request, engine):
    """E = E₀·max(0, −n·d), and a sky's E·(1 + n·up)/2: two closed forms in one picture."""
    if engine == "gpu":
        request.getfixturevalue("gpu")
    write_normals(tmp_path / "n.exr", AXES["world"])
    write_png(tmp_path / "photo.png", np.full((*CAMERA.shape, 3), 100, np.uint8))
    direction = unit([0.3, -0.8, -0.4])
    scene = scene_from_dict(
        {
            "rig": {"camera": {"fx": 35.0, "world_from_camera": POSE.tolist()}},
            "capture": {"source": "photo.png"},
            "surface": {"normals": "n.exr", "normals_axes": "world"},
            "ambient": {"illuminance_lux": 100},
            "lamp": [
                {"kind": "directional", "direction": direction, "illuminance_lux": 400},
                {"kind": "sky", "illuminance_lux": 50},
            ],
        },
        folder=tmp_path,
    )
    frame = Renderer(scene, engine).render()
    n = AXES["world"][~HOLES]
    expected = 400 * np.maximum(-(n @ direction), 0) + 50 * (1 + n[:, 1]) / 2
    lux = frame.illuminance.lux
    assert_agree(lux[~HOLES], np.repeat(expected[:, None], 3, axis=1), rtol=2e-3, atol=0.05)
    assert (lux[HOLES] == 0).all()
    assert frame.report.hole_pixels == HOLES.sum()
    assert (frame.image.rgb[HOLES] == 100).all()
    assert np.isnan(frame.surface.position).all()


def test_normals_of_a_picture_replace_those_of_the_depth(tmp_path):
    np.save(tmp_path / "depth.npy", np.full(VIEW.shape, 2.0))
    tilted = np.broadcast_to(unit([0.5, 0, -1]), (*VIEW.shape, 3))
    write_exr(tmp_path / "n.exr", tilted.astype(np.float32), unit="1")
    model = loaded(tmp_path, surface={"depth": "depth.npy", "normals": "n.exr"})
    expected = np.broadcast_to(unit([0.5, 0, 1]), (*VIEW.shape, 3))
    assert_agree(model.normals["mono"], expected, atol=1e-6)
    assert not model.is_distant_only
    fitted = loaded(tmp_path, surface={"depth": "depth.npy"}).normals["mono"]
    assert_agree(fitted, np.broadcast_to([0, 0, 1.0], fitted.shape), atol=1e-6)


@pytest.mark.parametrize("fill", [0, 128, 255])
def test_pictures_without_a_normal_are_refused(tmp_path, fill):
    write_png(tmp_path / "n.png", np.full((*VIEW.shape, 3), fill, np.uint8))
    with pytest.raises(InputError, match=r"n\.png: surface\.normals: has no pixel with a unit nor"):
        loaded(tmp_path, surface={"normals": "n.png"})


def test_normals_of_another_size_are_refused(tmp_path):
    write_png(tmp_path / "n.png", np.zeros((4, 5, 3), np.uint8))
    with pytest.raises(InputError, match="is 5×4 px but the camera is 40×30"):
        loaded(tmp_path, surface={"normals": "n.png"})


def test_objects_need_a_surface_with_a_place(tmp_path):
    write_normals(tmp_path / "n.exr", NORMALS)
    write_glb(tmp_path / "box.glb", block((1, 1, 1), (0, 0, 0)))
    with pytest.raises(InputError, match=r"object\[0\]: needs a surface with a place"):
        loaded(tmp_path, CAMERA, surface={"normals": "n.exr"}, object=[{"mesh": "box.glb"}])


def test_one_picture_of_normals_is_refused_for_two_eyes(tmp_path):
    write_normals(tmp_path / "n.exr", NORMALS)
    scene = scene_from_dict({"surface": {"normals": "n.exr"}}, folder=tmp_path)
    views = {name: View(**{**vars(CAMERA), "name": name}) for name in ("left", "right")}
    with pytest.raises(InputError, match=r"surface\.normals: is one picture for two eyes; give a"):
        load_surface(scene, views)


# ── materials ─────────────────────────────────────────────────────────────────────────────────


def write_many_materials(path, count, picture=None):
    """An OBJ of `count` triangles of as many materials; its .mtl beside it."""
    lines, looks = [f"mtllib {path.stem}.mtl"], []
    for index in range(count):
        lines += [f"v {index} 0 -3", f"v {index} 1 -3", f"v {index + 1} 0 -3"]
        lines += ["vt 0 0", "vt 0 1", "vt 1 0"]
        a = 3 * index + 1
        lines += [f"usemtl m{index}", f"f {a}/{a} {a + 1}/{a + 1} {a + 2}/{a + 2}"]
        looks += [f"newmtl m{index}", f"Kd {index / count} 0.5 0.5"]
        looks += [f"map_Kd {picture}"] if picture else []
    path.write_text("\n".join(lines))
    path.with_suffix(".mtl").write_text("\n".join(looks))


def test_objects_share_no_slots(tmp_path):
    """Numbers of materials in the G-buffer tell whose pixel it is, also after 300 of them."""
    write_many_materials(tmp_path / "many.obj", 300)
    write_glb(tmp_path / "lamp.glb", block((1, 1, 1), (0, 0, 0)), emissive=(1.0, 0.5, 0.25))
    model = loaded(tmp_path, object=[{"mesh": "many.obj"}, {"mesh": "lamp.glb"}])
    objects, (many, lamp) = model.objects, model.objects_table
    assert (many.name, many.first_slot, many.slots, many.triangles) == ("object[0]", 0, 300, 300)
    assert (lamp.first_slot, lamp.slots, lamp.triangles) == (300, 1, 12)
    assert model.object_of_slot.tolist() == [0] * 300 + [1]
    assert_agree(model.still_middles, [[150, 0.5, -3], [0, 0, 0]], atol=1e-6)
    assert len(objects.materials) == 301
    assert any(objects.materials[300].emissive_cd_m2)
    assert (objects.material_ids[300:] == 300).all()
    reds = [objects.materials[i].reflectance[0] for i in objects.material_ids[:300]]
    assert_agree(reds, np.arange(300) / 300, atol=1e-6)


def test_too_many_materials_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("andon.surface.objects.MAX_OBJECT_MATERIALS", 2)
    write_glb(tmp_path / "lamp.glb", block((1, 1, 1), (0, 0, 0)), emissive=(1.0, 0.5, 0.25))
    lamps = [{"mesh": "lamp.glb", "name": f"l{index}"} for index in range(3)]
    assert loaded(tmp_path, object=lamps[:2]).objects.materials
    with pytest.raises(InputError, match="object: virtual objects have 3 materials, at most 2 "):
        loaded(tmp_path, object=lamps)


@pytest.mark.parametrize("what", ["object", "surface"])
def test_too_many_textures_are_refused(tmp_path, monkeypatch, what):
    monkeypatch.setattr("andon.surface.meshes.MAX_TEXTURES", 3)
    write_png(tmp_path / "t.png", np.full((2, 2, 3), 99, np.uint8))
    write_many_materials(tmp_path / "many.obj", 4, "t.png")
    entry = {"mesh": "many.obj"}
    with pytest.raises(InputError, match="has 4 materials with a texture, at most 3 can be drawn"):
        loaded(tmp_path, **{what: [entry] if what == "object" else entry})


# ── depth with a distorted lens ───────────────────────────────────────────────────────────────


def test_depth_is_undistorted_with_its_picture(tmp_path):
    """A wall at a slant through a lens: ideal pixels see a plane again, the rim nothing."""
    normal = unit([0.3, 0.1, -1])
    view = View(**{**vars(VIEW), "distortion": (0.3, 0.0, 0.0, 0.0)})
    import cv2

    k = np.array([[35.0, 0, 19.5], [0, 35, 14.5], [0, 0, 1]])
    pixels = VIEW.pixel_grid().reshape(-1, 1, 2)
    flat = cv2.undistortPoints(pixels, k, np.array([0.3, 0, 0, 0])).reshape(*VIEW.shape, 2)
    rays = np.dstack([flat, np.ones(VIEW.shape)])
    np.save(tmp_path / "depth.npy", -2 / (rays @ normal))
    model = loaded(tmp_path, view, surface={"depth": "depth.npy"})
    depth = model.depth["mono"]
    assert np.isnan(depth[0, 0])
    seen = np.isfinite(depth)
    assert seen.mean() > 0.8
    # Nearest pixel: at most half a pixel of the plane's slope.
    assert_agree(depth[seen], (-2 / (VIEW.rays_planar() @ normal))[seen], rtol=0.5 / 35 * 0.5)


@pytest.mark.parametrize("kind", ["distance", "z"])
def test_the_lens_comes_before_the_kind_of_depth(tmp_path, kind):
    """Numbers of a captured pixel belong to the ray that its lens had, whatever they measure.

    The same slanted wall as distances and as depths through a strong lens: both give its plane,
    everywhere alike. Distances turned into depth by the *captured* pixels' directions would be
    wrong by 4 % at the rim.
    """
    import cv2

    normal = unit([0.1, 0.05, -1])
    large = View("pinhole", 160, 120, 80.0, 80.0, 79.5, 59.5)
    lens = (0.25, 0.05, 0.0, 0.0)
    k = np.array([[80.0, 0, 79.5], [0, 80, 59.5], [0, 0, 1]])
    pixels = large.pixel_grid().reshape(-1, 1, 2)
    flat = cv2.undistortPoints(pixels, k, np.array(lens)).reshape(*large.shape, 2)
    rays = np.dstack([flat, np.ones(large.shape)])
    captured = -2 / (rays @ normal)
    if kind == "distance":
        captured = captured * np.linalg.norm(rays, axis=-1)
    np.save(tmp_path / "depth.npy", captured)
    view = View(**{**vars(large), "distortion": lens})
    model = loaded(tmp_path, view, surface={"depth": {"file": "depth.npy", "kind": kind}})
    depth = model.depth["mono"]
    seen = np.isfinite(depth)
    assert seen.mean() > 0.6
    # Nearest pixel: half a pixel of the slope of the plane, and of the distance at the rim.
    assert_agree(depth[seen], (-2 / (large.rays_planar() @ normal))[seen], rtol=0.01)


def test_lonely_depths_are_refused(tmp_path):
    depth = np.zeros(VIEW.shape)
    depth[::3, ::3] = 2.0
    np.save(tmp_path / "depth.npy", depth)
    with pytest.raises(InputError, match=r"depth\.npy: surface\.depth: no three neighbouring"):
        loaded(tmp_path, surface={"depth": "depth.npy"})


def test_an_ambient_map_through_a_lens_leaves_no_nan(tmp_path, request):
    """Where the lens saw nothing there is no E0 either: those pixels stay black, not NaN."""
    write_png(tmp_path / "photo.png", np.full((*VIEW.shape, 3), 100, np.uint8))
    write_exr(tmp_path / "e0.exr", np.full((*VIEW.shape, 3), 50, np.float32), unit="lx")
    np.save(tmp_path / "depth.npy", np.full(VIEW.shape, 2.0))
    scene = scene_from_dict(
        {
            "rig": {"camera": {"fx": 35.0, "distortion": [0.3, 0, 0, 0]}},
            "capture": {"source": "photo.png"},
            "surface": {"depth": "depth.npy"},
            "ambient": {"map": "e0.exr"},
            "lamp": [{"kind": "sky", "illuminance_lux": 50}],
        },
        folder=tmp_path,
    )
    ambient: Ambient = prepare(scene).ambient
    assert np.isfinite(ambient.illuminance_lux).all()
    request.getfixturevalue("gpu")
    for engine in ("reference", "gpu"):
        frame = Renderer(scene, engine).render()
        assert np.isfinite(frame.luminance.cd_m2).all()
        assert (frame.image.rgb[0, 0] == 0).all()
        assert (frame.image.rgb[15, 20] > 105).all()
