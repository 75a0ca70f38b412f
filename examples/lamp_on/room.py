"""Writes the room of this example: two photographs, the depth, and the scene of them.

python room.py FOLDER
"""

from __future__ import annotations

import sys
from pathlib import Path

from andon.verify.lamp_on_room import write_lamp_scene


def main(folder: str = "room") -> None:
    """Writes off.png, on.png, depth.png and lamp_on.toml into `folder`."""
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    scene = write_lamp_scene(place)
    (place / "lamp_on.toml").write_text(scene.to_toml(), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
