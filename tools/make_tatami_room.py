"""Makes examples/tatami: a tatami room, its lanterns, its photograph and the light in it.

    PYTHONPATH=src:tools python tools/make_tatami_room.py SET examples/tatami [--preview]

SET is the folder of the CC0 objects of Debian's sweethome3d-furniture (tatami/, JapaneseLantern/).
Needs Radiance's programs (`pip install 'andon[radiance]'`). Everything is deterministic.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from tatami.building import assembled, building
from tatami.files import write_room
from tatami.materials import texture_files
from tatami.things import things


def main() -> None:
    """Writes all files."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("set", type=Path)
    parser.add_argument("out", type=Path)
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    parts = assembled([*building(arguments.set / "tatami" / "tatami.obj"), *things()])
    count = write_room(arguments.out / "room.glb", parts, texture_files(arguments.set / "tatami"))
    print(f"room.glb: {count} triangles")


if __name__ == "__main__":
    main()
