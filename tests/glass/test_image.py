"""Golden pictures of glass in front of a photographed board: whole frames, two a picture."""

import numpy as np
import pytest

from andon.pipeline import Renderer
from comparison import assert_golden
from glass.rays import smooth_ball
from glass_worlds import BACKDROP, BALL, glass_scene, write_glass_files
from worlds import block, write_obj

LABELLED = BALL | {"texture": "label.png", "texture_transmittance": 0.4}
LENS = {
    "shape": "lens", "radius_m": 0.07, "curvature_m": [0.16, 0.2], "thickness_m": 0.034,
    "background": BACKDROP,
}  # fmt: skip
SLAB = {
    "shape": "slab", "size_m": [0.14, 0.09, 0.05], "absorption_per_m": [12.0, 3.0, 3.0],
    "rotation_xyzw": [0.0, np.sin(0.35), 0.0, np.cos(0.35)], "background": BACKDROP,
}  # fmt: skip
# Water in a shell of glass, and a bubble beside its middle.
SHELL = BALL | {"name": "shell"}
WATER = {"shape": "sphere", "radius_m": 0.066, "index": 1.333, "background": BACKDROP}
BUBBLE = WATER | {"radius_m": 0.02, "index": 1.0, "position": [0.02, 0.01, 0.0]}
# One corner of the cube looks at the eye.
CUBE = {
    "shape": "mesh", "mesh": "cube.obj", "background": BACKDROP,
    "rotation_xyzw": [0.2798, 0.3647, 0.1159, 0.8805],
}  # fmt: skip
SMOOTH = {"shape": "mesh", "mesh": "smooth.obj", "background": BACKDROP}
PRISM = {"cauchy_b_um2": 0.03, "index": 1.6}
OTHER = {"kind": "surface"}
AT_BOARD = {"kind": "frame", "distance_m": 0.6}
LAMP = {"kind": "point", "position": [-0.2, 0.3, 0.3], "intensity_cd": 6.0, "shadow": False}


def looking(at="surface", blur="optical"):
    return {"gaze": {"source": at, "blur": blur}}


SHARP = looking(blur="off")
# name → two frames, each its bodies and other tables of the scene.
PICTURES = {
    "ball": [([LABELLED], looking("surface")), ([LABELLED], looking("background"))],
    "modes": [
        ([LABELLED], looking("background", "gaussian")),
        ([LABELLED], looking("surface", "paper")),
    ],
    "off": [([LABELLED], SHARP), ([LABELLED | {"interfaces": 1}], SHARP)],
    "shapes": [([LENS], SHARP), ([SLAB], looking("surface"))],
    "nested": [([SHELL, WATER], SHARP), ([WATER, BUBBLE, SHELL], SHARP)],
    "meshes": [([CUBE], SHARP), ([SMOOTH], SHARP)],
    "dispersion": [([LENS | PRISM], SHARP), ([SLAB | PRISM], SHARP)],
    "backdrops": [
        ([BALL | {"background": OTHER}], SHARP),
        ([BALL | {"background": AT_BOARD}], looking("surface")),
    ],
    "lamp": [
        ([LABELLED | {"highlight_exponent": 200.0}], SHARP | {"lamp": [LAMP]}),
        ([BALL | {"highlight_exponent": 200.0}], SHARP | {"lamp": [LAMP]}),
    ],
}


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("glass")
    write_glass_files(folder)
    write_obj(folder / "cube.obj", block((0.09, 0.09, 0.09), (0, 0, 0)))
    geometry = smooth_ball(0.06, 3).geometry
    lines = [f"v {x:.7f} {y:.7f} {z:.7f}" for x, y, z in geometry.positions]
    lines += [f"vn {x:.7f} {y:.7f} {z:.7f}" for x, y, z in geometry.normals]
    lines += [f"f {a}//{a} {b}//{b} {c}//{c}" for a, b, c in geometry.triangles + 1]
    (folder / "smooth.obj").write_text("\n".join(lines) + "\n")
    return folder


@pytest.mark.parametrize("name", PICTURES)
def test_frames(files, name, engine, tmp_path):
    frames = [
        Renderer(glass_scene(files, *glass, **tables), engine).picture()
        for glass, tables in PICTURES[name]
    ]
    picture = np.concatenate(frames, axis=1)
    assert_golden(picture, f"glass-{name}", tmp_path, written=engine == "reference")
