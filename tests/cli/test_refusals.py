"""Bad input: one line that names file, field, rule and remedy; exit code 2; nothing written."""

import struct
import zlib

import numpy as np
import pytest

from andon.files.pictures import write_exr, write_png
from worlds import block, write_glb, write_obj, write_relight_files

from .command import PHOTOGRAPHED, run_andon, run_refused

POINT = "kind=point,position=0,0,-1,intensity_cd=50"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    write_relight_files(tmp_path)
    (tmp_path / "scene.toml").write_text(PHOTOGRAPHED)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def refused(capfd, folder):
    """Refuses `andon relight` with these options instead of those that are right."""

    def run(*more, photo="photo.png", out="out.png", **changed):
        given = {"depth": "depth.npy", "camera": "camera.toml", "engine": "reference"} | changed
        words = ["relight", photo, "-o", out, *more]
        for name, value in given.items():
            words += [f"--{name.replace('_', '-')}", value] if value is not None else []
        return run_refused(capfd, folder, *words)

    return run


@pytest.fixture
def refused_scene(capfd, folder):
    """Refuses the scene file with `text` added, or with parts of it exchanged."""

    def run(text="", *more, without=None, **exchanged):
        scene = (folder / "scene.toml").read_text()
        scene = scene if without is None else scene.replace(without, "")
        for old, new in exchanged.items():
            assert old in scene
            scene = scene.replace(old, new)
        (folder / "scene.toml").write_text(scene + text)
        words = ["relight", "photo.png", "--scene", "scene.toml", "-o", "out.png"]
        return run_refused(capfd, folder, *words, "--engine", "reference", *more)

    return run


# ── files ─────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("option", ["depth", "camera"])
def test_missing_files(refused, option):
    line = refused(**{option: f"nothing.{'npy' if option == 'depth' else 'toml'}"})
    assert "nothing." in line
    assert "must exist" in line


def test_a_missing_photo(refused):
    assert "nothing.png: must exist" in refused(photo="nothing.png")


def test_a_missing_scene(capfd, folder):
    line = run_refused(capfd, folder, "relight", "photo.png", "--scene", "no.toml", "-o", "out.png")
    assert "no.toml: cannot be read" in line


def test_a_photo_that_is_none(refused, folder):
    (folder / "photo.png").write_bytes(b"not a picture at all" * 9)
    assert "photo.png: must be a PNG or JPEG" in refused()


def test_a_photo_cut_short(refused, folder):
    data = (folder / "photo.png").read_bytes()
    (folder / "photo.png").write_bytes(data[: len(data) // 2])
    assert "photo.png" in refused()


def chunk(kind, body):
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def test_a_photo_of_60000_by_60000(refused, folder):
    header = struct.pack(">IIBBBBB", 60000, 60000, 8, 2, 0, 0, 0)
    pixels = zlib.compress(b"\0" * 100)
    (folder / "photo.png").write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", pixels) + chunk(b"IEND", b"")
    )
    line = refused()
    assert "photo.png: must have sides of at most 32768" in line
    assert "60000×60000" in line


def test_a_depth_of_60000_by_60000(refused, folder):
    header = "{'descr': '<f4', 'fortran_order': False, 'shape': (60000, 60000), }"
    header = header.ljust(117) + "\n"
    (folder / "depth.npy").write_bytes(
        b"\x93NUMPY\x01\x00" + struct.pack("<H", 118) + header.encode()
    )
    assert "depth.npy: must have sides of at most 32768" in refused()


def test_a_photo_of_an_unknown_kind(refused, folder):
    (folder / "photo.gif").write_bytes(b"GIF89a" + b"\0" * 40)
    assert "photo.gif" in refused(photo="photo.gif")


def test_a_camera_that_is_no_toml(refused, folder):
    (folder / "camera.toml").write_text("width = = 3")
    assert "camera.toml: must be sound TOML" in refused()


def test_a_camera_of_another_picture(refused, folder):
    (folder / "camera.toml").write_text("width = 640\nheight = 480\nfx = 500\n")
    line = refused()
    assert "64×48" in line
    assert "640×480" in line


# ── depth ─────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("value", [np.nan, 0.0, -1.0, np.inf])
def test_a_depth_without_any_depth(refused, folder, value):
    np.save(folder / "depth.npy", np.full((48, 64), value))
    line = refused()
    assert "depth.npy: surface.depth: has no pixel with a depth above 0" in line
    assert "check kind, scale_to_m and invalid" in line


def test_a_depth_of_another_size(refused, folder):
    np.save(folder / "depth.npy", np.ones((64, 48)))
    assert "depth.npy: surface.depth: is 48×64 px but the camera is 64×48" in refused()


def test_a_depth_of_pickles(refused, folder):
    np.save(folder / "depth.npy", np.array([[{}]], dtype=object), allow_pickle=True)
    assert "depth.npy" in refused()


def test_a_photograph_given_as_depth(refused):
    line = refused(depth="photo.png")
    assert "photo.png: must be a gray PNG, whose numbers are depths; this one has colour" in line
    assert "export the depth itself, as 16-bit gray PNG" in line


def test_disparity_without_a_baseline(refused):
    assert "surface.depth.baseline_m: kind 'disparity' needs it" in refused(depth_kind="disparity")


def test_depth_options_without_a_depth(refused):
    assert "--depth: scale_to_m without --depth" in refused(depth=None, depth_scale_to_m="0.001")


def test_neither_depth_nor_mesh(refused):
    assert "--depth: is missing: light needs geometry to fall on" in refused(depth=None)


def test_both_depth_and_mesh(refused):
    assert "--depth: give one of --depth and --mesh" in refused(mesh="room.obj")


def test_no_camera(refused):
    assert "--camera: is missing" in refused(camera=None)


# ── normals ───────────────────────────────────────────────────────────────────────────────────


def test_normals_that_are_zero(refused_scene, folder):
    write_exr(folder / "n.exr", np.zeros((48, 64, 3), np.float32), unit="1")
    line = refused_scene(**{'depth = "depth.npy"': 'normals = "n.exr"'})
    assert "n.exr: surface.normals: has no pixel with a unit normal" in line


@pytest.mark.parametrize("kind", ["point", "spot"])
def test_a_lamp_with_a_place_on_normals_alone(refused_scene, folder, kind):
    normals = np.zeros((48, 64, 3), np.float32)
    normals[..., 2] = -1
    write_exr(folder / "n.exr", normals, unit="1")
    lamp = f'[[lamp]]\nname = "near"\nkind = "{kind}"\nposition = [0, 0, -1]\nflux_lm = 9.0\n'
    lamp += "direction = [0, 0, -1]\nouter_degrees = 30.0\n" if kind == "spot" else ""
    line = refused_scene(lamp, **{'depth = "depth.npy"': 'normals = "n.exr"'})
    assert "lamp[0].kind: the lamp 'near' has a place, but a normals-only surface has none" in line
    assert "directional" in line


# ── meshes ────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    "text", ["", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "f 1 2 3\n", "v 0 0 0\nf 1 2 9\n"]
)
def test_meshes_without_faces(refused, folder, text):
    (folder / "room.obj").write_text(text)
    assert "room.obj" in refused(depth=None, mesh="room.obj")


def test_an_object_that_is_missing(refused):
    assert "nothing.glb: must exist" in refused("--object", "nothing.glb")


def test_an_object_cut_short(refused, folder):
    write_glb(folder / "box.glb", block((1, 1, 1), (0, 0, 0)))
    data = (folder / "box.glb").read_bytes()
    (folder / "box.glb").write_bytes(data[:-60])
    assert "box.glb" in refused("--object", "box.glb")


def test_a_lamp_inside_a_wall(refused, folder):
    write_obj(folder / "room.obj", block((4, 3, 6), (0, 0, 0)))
    lamp = "kind=point,name=lost,position=0,0,-9,intensity_cd=5"
    line = refused("--lamp", lamp, depth=None, mesh="room.obj")
    assert "--lamp 1: position: the lamp 'lost' at (0, 0, -9) is inside a wall; move it" in line


# ── lamps ─────────────────────────────────────────────────────────────────────────────────────

LAMPS = [
    ("kind=point,position=0,0,-1,intensity_cd=-5", "--lamp 1: intensity_cd: must be ≥ 0 cd"),
    ("kind=point,position=0,0,-1,flux_lm=nan", "--lamp 1: flux_lm: must be finite"),
    ("kind=point,position=0,0,-1,flux_lm=inf", "--lamp 1: flux_lm: must be finite"),
    ("kind=point,position=0,0,-1,intensty_cd=5", "did you mean 'intensity_cd'?"),
    ("kind=pont,position=0,0,-1,flux_lm=5", "--lamp 1: kind: must be one of point"),
    ("kind=pont,position=0,0,-1,flux_lm=5", "did you mean 'point'?"),
    ("kind=point,position=0,0,flux_lm=5", "--lamp 1: position"),
    ("kind=point,flux_lm=5", "--lamp 1: position: is required"),
    ("kind=point,position=0,0,-1", "--lamp 1: intensity_cd or flux_lm is required"),
    ("position=0,0,-1,flux_lm=5", "--lamp 1: kind is required"),
    ("", "--lamp"),
    ("kind=sphere,position=0,0,-1,flux_lm=5", "--lamp 1: radius_m: is required"),
    ("kind=ies,position=0,0,-1,file=a.ies,direction=0,-1,0", "a.ies: must exist"),
    ("kind=point,position=0,0,-1,flux_lm=5,shell.radius_m=0", "--lamp 1: shell.radius_m"),
    ("kind=point,position=0,0,-1,flux_lm=5,shell.transmittance=0.5", "radius_m, mesh"),
    ("kind=point,position=0,0,-1,flux_lm=1.7e308,rgb=0,0,1", "too large"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "message"), LAMPS)
def test_lamps(refused, text, message):
    assert message in refused("--lamp", text)


ADDED = '[[lamp]]\nkind = "sky"\nname = "sky"\nilluminance_lux = 9.0\n'
TYPED = [
    ("kind=point,position=0,0,-1,flux_lm=-1", "andon: --lamp 2: flux_lm: must be ≥ 0 lm, got -1"),
    ("kind=point,flux_lm=5", "andon: --lamp 2: position: is required; add position=…"),
    ("kind=point,position=0,0,-1,flux_lm=5,name=sky", "--lamp 2: name: the name 'sky' is taken"),
    ("kind=point,position=0,0,-1,flux_lm=5,name=a", "'a' is taken by --lamp 1; names are unique"),
    ("kind=point,position=0,0,-1,flux_lm=5,path=a.csv", "--lamp 2: path: motion from a file"),
    ("kind=pont,flux_lm=5", "--lamp 2: kind: must be one of point"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "message"), TYPED)
def test_lamps_are_counted_as_they_are_typed(refused_scene, text, message):
    line = refused_scene(ADDED, "--lamp", POINT + ",name=a", "--lamp", text)
    assert message in line
    assert "scene.toml" not in line


def test_lamps_of_the_scene_keep_their_place(refused_scene):
    bad = ADDED.replace("9.0", "-9.0")
    line = refused_scene(bad, "--lamp", POINT)
    assert "scene.toml: lamp[0].illuminance_lux: must be ≥ 0 lx" in line


# ── the light of the photograph ───────────────────────────────────────────────────────────────

MAP = {"illuminance_lux = 200.0": 'map = "e0.exr"'}


def test_an_e0_map_of_another_size(refused_scene, folder):
    write_exr(folder / "e0.exr", np.ones((64, 48, 3), np.float32), unit="lx")
    line = refused_scene(**MAP)
    assert "e0.exr: ambient.map: must be a linear 64×48 picture, got 48×64 linear" in line


@pytest.mark.parametrize("bad", [0.0, -3.0, np.nan, np.inf])
def test_an_e0_map_with_a_pixel_in_the_dark(refused_scene, folder, bad):
    lux = np.ones((48, 64, 3), np.float32)
    lux[3, 4, 1] = bad
    write_exr(folder / "e0.exr", lux, unit="lx")
    line = refused_scene(**MAP)
    assert "e0.exr: ambient.map: E0 must be finite and > 0 everywhere, 1 values are not" in line


def test_an_e0_map_of_codes(refused_scene, folder):
    write_png(folder / "e0.png", np.full((48, 64, 3), 9, np.uint8))
    line = refused_scene(**{"illuminance_lux = 200.0": 'map = "e0.png"'})
    assert "e0.png: ambient.map: must be a linear 64×48 picture" in line


@pytest.mark.parametrize("lux", ["0", "-5", "nan", "inf"])
def test_an_e0_that_is_none(refused, lux):
    assert "ambient.illuminance_lux: must be" in refused(ambient_lux=lux)


@pytest.mark.parametrize("dimming", ["-0.5", "nan"])
def test_a_dimming_that_is_none(refused, dimming):
    assert "ambient.dimming: must be" in refused(dimming=dimming)


def test_a_scene_without_ambient(refused_scene):
    line = refused_scene(without="[ambient]\nilluminance_lux = 200.0\n")
    assert "scene.toml: ambient: is missing: without E0" in line


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--tone", "reinhart"], "andon: --tone: must be one of 'none', 'hue', 'reinhard', "),
        (["--tone", "reinhart"], "got 'reinhart'; did you mean 'reinhard'?"),
        (["--exposure", "-1"], "andon: --exposure: must be > 0, got -1.0"),
    ],
)
def test_tones_and_exposures_that_are_none(refused, options, message):
    assert message in refused(*options)


def test_a_tone_of_the_scene_is_the_scenes(refused_scene):
    line = refused_scene("[display]\ntone = 'reinhart'\n", "--exposure", "1")
    assert "scene.toml: display.tone: must be one of" in line


# ── outputs ───────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("out", ["out.gif", "out", "out.png.txt", "out.hdr"])
def test_a_suffix_that_nobody_writes(refused, out):
    assert f"--out: must end in .png, .jpg, .jpeg, .exr, got '{out}'" in refused(out=out)


def test_a_suffix_of_the_map(refused):
    line = refused("--illuminance-map", "lux.jpg")
    assert "--illuminance-map: must end in .exr, .png, got 'lux.jpg'" in line


@pytest.mark.parametrize("option", ["--out", "--illuminance-map"])
def test_a_folder_that_is_missing(refused, option):
    path = "no/such/folder/lux.exr"
    line = refused(out=path) if option == "--out" else refused(option, path)
    assert f"{option}: the folder 'no/such/folder' does not exist; make it" in line


@pytest.mark.parametrize("option", ["--out", "--illuminance-map"])
def test_an_output_that_is_a_folder(refused, folder, option):
    (folder / "taken.exr").mkdir()
    line = refused(out="taken.exr") if option == "--out" else refused(option, "taken.exr")
    assert f"taken.exr: {option}: must be a file, not a folder" in line


# ── scenes ────────────────────────────────────────────────────────────────────────────────────


def test_an_unknown_key(refused_scene):
    line = refused_scene("[atmosphere]\nmsit = 0.1\n")
    assert "scene.toml: atmosphere.msit: unknown key 'msit'; did you mean 'mist'?" in line


def test_an_unknown_table(refused_scene):
    assert "unknown key 'lmap'; did you mean 'lamp'?" in refused_scene("[[lmap]]\nkind = 'point'\n")


def test_a_scene_that_is_no_toml(refused_scene):
    assert "scene.toml: line 10" in refused_scene("[[lamp]\n")


def test_a_view_that_is_not_there(refused):
    line = refused(view="left")
    assert "--view: there is no view 'left', this rig has mono; leave --view out" in line
    assert "[rig.left] and [rig.right]" in line


@pytest.mark.parametrize(
    "reference", ["../depth.npy", "/etc/passwd", "file:///etc/passwd", "a\\0b"]
)
def test_references_that_leave_the_folder(refused_scene, reference):
    line = refused_scene(
        **{'"depth.npy"': repr(reference) if "\\" not in reference else '"a\\u0000b"'}
    )
    assert "scene.toml: surface.depth.file: a reference must" in line


def test_what_is_settled_and_not_drawn_yet(refused_scene, folder):
    (folder / "path.csv").write_text("")
    line = refused_scene(**{"[rig.camera]": '[rig.trajectory]\nfile = "path.csv"\n[rig.camera]'})
    assert "rig.trajectory: is in the schema but not rendered yet" in line
    assert "in the schema but not rendered yet" in line


def test_a_lamp_with_a_baked_transport(refused_scene):
    lamp = '[[lamp]]\nname="l"\nkind="point"\nposition=[0,0,-1]\nflux_lm=1.0\ntransport="baked"\n'
    line = refused_scene(lamp + '[baked]\nfolder = "maps"\nlamps = ["l"]\n')
    assert "baked.folder" in line
    assert "andon bake scene.toml makes them" in line


# ── the command line itself ───────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["relihgt"], "No such command 'relihgt'"),
        (["relight"], "out"),
        (["relight", "-o", "o.png"], "PHOTO: is missing: there is no picture to relight"),
        (["relight", "photo.png"], "out"),
        (["relight", "photo.png", "-o", "o.png", "--dpth", "x"], "No such option"),
        (["relight", "photo.png", "-o", "o.png", "--ambient-lux", "bright"], "number"),
        (
            ["relight", "photo.png", "-o", "o.png", "--engine", "cuda"],
            "--engine: must be one of auto, gpu, reference, got 'cuda'; gpu draws on every adapter",
        ),
        (
            ["demo", "phto"],
            "there is no demonstration 'phto', there is photo, glass, glare; did you mean 'photo'?",
        ),
    ],
)
def test_words_that_are_none(capfd, folder, words, message):
    assert message in run_refused(capfd, folder, *words)


def test_no_adapter_is_the_machines_fault(capfd, folder, monkeypatch):
    from andon.gpu import device

    monkeypatch.setattr(device, "_request_adapter", lambda: None)
    monkeypatch.setattr("andon.engines.gpu.open_gpu", device.open_gpu.__wrapped__)
    words = ["relight", "photo.png", "--scene", "scene.toml", "-o", "out.png", "--engine"]
    line = run_refused(capfd, folder, *words, "gpu", code=3)
    assert "no GPU adapter found" in line
    assert "--engine reference" in line
    outcome = run_andon(capfd, *words, "auto")
    assert outcome.code == 0
    assert "reference" in outcome.err


def test_a_folder_that_cannot_be_written_is_the_machines_fault(capfd, folder, monkeypatch):
    from pathlib import Path

    def full(self, data):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    words = ["relight", "photo.png", "--scene", "scene.toml", "-o", "out.png"]
    line = run_refused(capfd, folder, *words, "--engine", "reference", code=3)
    assert "out.png: cannot be written: No space left on device" in line


def interrupted(*_, **__):
    raise KeyboardInterrupt


def broken(*_, **__):
    raise RuntimeError("two\nlines")


def test_interrupted(capfd, folder, monkeypatch):
    monkeypatch.setattr("andon.pipeline.Renderer.render", interrupted)
    words = ["relight", "photo.png", "--scene", "scene.toml", "-o", "out.png"]
    line = run_refused(capfd, folder, *words, "--engine", "reference", code=130)
    assert line == "andon: interrupted"


def test_a_bug_of_ours_is_one_line_and_asks_for_a_report(capfd, folder, monkeypatch):
    monkeypatch.setattr("andon.pipeline.Renderer.render", broken)
    words = ["relight", "photo.png", "--scene", "scene.toml", "-o", "out.png"]
    line = run_refused(capfd, folder, *words, "--engine", "reference", code=1)
    assert line.endswith("please report it with the output of --debug: RuntimeError: two lines")


def test_debug_shows_where(folder, monkeypatch):
    from andon.cli import main

    monkeypatch.setattr("andon.pipeline.Renderer.render", broken)
    words = ["relight", "photo.png", "--scene", "scene.toml", "-o", "out.png", "--debug"]
    with pytest.raises(RuntimeError, match="two"):
        main([*words, "--engine", "reference"])


def test_a_response_file_that_is_missing_or_falls(refused_scene, folder):
    source = 'source = "photo.png"'
    curve = f'{source}\nresponse = {{kind = "curve", file = "curve.csv"}}'
    assert "curve.csv: must exist" in refused_scene(**{source: curve})
    (folder / "curve.csv").write_text("encoded,linear_r,linear_g,linear_b\n0,0,1,0\n1,1,0,1\n")
    assert "curve.csv: response.linear: must be finite and strictly increasing" in refused_scene()
