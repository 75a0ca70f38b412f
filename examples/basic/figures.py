"""Remakes figures 10 to 14 of the paper on the scene Basic, and a walk past its walls.

python examples/basic/figures.py -o OUT
"""

from __future__ import annotations

import argparse
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import andon
from andon.bake.to_file import bake_file
from andon.display.false_colour import contact_sheet
from andon.display.probe_pictures import Look, around_view, framed_points, probe_picture
from andon.files.pictures import write_png
from andon.files.volumes import read_volume
from andon.surface.still import still_geometry

HERE = Path(__file__).resolve().parent
Rgb = NDArray[np.uint8]

SIZE = {"width": 960, "height": 540}
# Seconds of the walk at which the mannequin stands beside the red, the green and the blue wall.
MOMENTS = (0.0, 1.2, 3.6, 4.6, 5.9)
CAMERA = {"hfov_degrees": 54.0, "position": [0.5, 1.7, 5.4], "look_at": [0.0, 0.95, 0.0]}
# Light of the probes alone, on white walls: no lamp, and what would be white in their light.
PROBES_ALONE = {
    "lamp": [],
    "surface": {"mesh": "room.glb", "reflectance": 0.8},
    "capture": {"luminance_per_unit": 6000.0},
    "display": {"tone": "hue"},
}


def volume_of(name: str) -> andon.Scene:
    """The scene of a file beside this one, its volume baked."""
    scene = andon.load_scene(HERE / name)
    bake_file(scene)
    return scene


def placement(name: str) -> Rgb:
    """Probes as balls, cells as wires, amid the walls."""
    scene = volume_of(name)
    assert scene.probes is not None
    geometry = still_geometry(scene)
    volume = read_volume(HERE / scene.probes.volume)
    view = around_view(framed_points(volume, geometry), (SIZE["width"], SIZE["height"]))
    return probe_picture(volume, view, Look(), geometry=geometry, caption=name).rgb


def walkers(engine: str, **changes: Any) -> Rgb:
    """The mannequin at five moments of its walk, in one picture.

    `changes` are tables of the scene that stand in for those of walk.toml.
    """
    tables = tomllib.loads((HERE / "walk.toml").read_text(encoding="utf-8"))
    walker, *_ = tables["object"]
    still = andon.load_scene(HERE / "walk.toml").object[0]
    tables["object"] = [_standing(walker, still, moment) for moment in MOMENTS]
    tables["rig"] = {"camera": SIZE | CAMERA}
    for table, value in changes.items():
        tables[table] = value
    if "probes" in changes and changes["probes"] is None:
        del tables["probes"]
    scene = andon.scene_from_dict(tables, folder=HERE)
    return andon.render(scene, engine=engine).image.rgb  # type: ignore[arg-type]


def _standing(walker: dict[str, Any], table: Any, moment: float) -> dict[str, Any]:
    """The walker as it is at `moment`, and stays."""
    from andon.scene.keyframes import object_at

    matrix = object_at(table, moment)
    entry = {key: value for key, value in walker.items() if key != "key"}
    return entry | {
        "name": f"walker at {moment:g} s",
        "transform": matrix.tolist(),
        "animation_start_seconds": -moment,
    }


def lamps_alone() -> list[dict[str, Any]]:
    """What a scene without probes has: the sun, and a hemisphere of sky and ground."""
    tables = tomllib.loads((HERE / "walk.toml").read_text(encoding="utf-8"))
    sun = next(lamp for lamp in tables["lamp"] if lamp["kind"] == "directional")
    ambient = {
        "name": "hemisphere",
        "kind": "hemisphere",
        "illuminance_lux": 10000.0,
        "ground_illuminance_lux": 5000.0,
    }
    return [sun, ambient]


def main() -> None:
    """Writes figure10.png to figure14.png, basic.png."""
    parser = argparse.ArgumentParser(description="Remakes the figures.")
    parser.add_argument("-o", "--out", type=Path, required=True, help="folder to write to")
    parser.add_argument("--engine", default="auto", help="auto, gpu or reference")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    pictures = {
        "figure10": placement("basic-lattice.toml"),
        "figure11": placement("basic.toml"),
        "figure12": walkers(arguments.engine),
        "figure13": walkers(arguments.engine, **PROBES_ALONE),
        "figure14": walkers(arguments.engine, probes=None, lamp=lamps_alone()),
    }
    sheet = [
        ("(a) thirteen probes", pictures["figure11"]),
        ("(b) their light alone, on white walls", pictures["figure13"]),
        ("(c) sun and probes", pictures["figure12"]),
        ("(d) sun and a hemisphere lamp", pictures["figure14"]),
    ]
    pictures["basic"] = contact_sheet(sheet, columns=2)
    for name, picture in pictures.items():
        print(write_png(arguments.out / f"{name}.png", picture))


if __name__ == "__main__":
    main()
