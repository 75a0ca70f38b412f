"""Makes examples/tatami: a tatami room, its lanterns, its photograph and the light in it.

    PYTHONPATH=src:tools python tools/make_tatami_room.py SET examples/tatami [--no-photo]

SET is the folder of the CC0 objects of Debian's sweethome3d-furniture (tatami/, JapaneseLantern/).
Needs Radiance's programs (`pip install 'andon[radiance]'`) and some minutes on one core. Everything
is deterministic.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from tatami import camera
from tatami.building import assembled, building
from tatami.files import write_room
from tatami.lanterns import write_lanterns
from tatami.materials import texture_files
from tatami.photograph import photograph, write_photograph
from tatami.things import things

from andon.files.meshes import read_mesh


def main() -> None:
    """Writes all files."""
    parser = argparse.ArgumentParser(description="Makes examples/tatami.")
    parser.add_argument("set", type=Path, help="folder of the CC0 objects")
    parser.add_argument("out", type=Path, help="folder to write to")
    parser.add_argument("--no-photo", action="store_true", help="meshes only")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    room = arguments.out / "room.glb"
    parts = assembled([*building(arguments.set / "tatami" / "tatami.obj"), *things()])
    count = write_room(room, parts, texture_files(arguments.set / "tatami"))
    print(f"room.glb: {count} triangles")
    write_lanterns(arguments.out, arguments.set / "JapaneseLantern")
    if not arguments.no_photo:
        view = camera.view()
        picture = photograph(read_mesh(room).geometry, view)
        write_photograph(arguments.out, picture, view)
        print(f"e0.exr: {picture.e0.min():.3g}…{picture.e0.max():.4g} lx")


if __name__ == "__main__":
    main()
