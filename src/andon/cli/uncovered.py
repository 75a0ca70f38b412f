"""``--uncovered`` of ``andon relight``: where no illuminance map sees the surface."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from andon.cli.console import check_writable
from andon.errors import InputError

if TYPE_CHECKING:
    from andon.transport.baked.model import BakedSeen

__all__ = ["check_uncovered", "write_uncovered"]


def check_uncovered(path: Path | None, scene: Any) -> None:
    """Refuses to show gaps of maps that a scene has not, before any work."""
    if path is None:
        return
    check_writable(path, (".png",), "--uncovered")
    if scene.baked is None or not scene.baked.lamps:
        raise InputError(
            "shows where no illuminance map sees the surface, and the scene has none",
            field="--uncovered",
            remedy="leave it out, or add [baked] to a scene file",
        )


def write_uncovered(path: Path, rgb: Any, baked: BakedSeen) -> None:
    """The picture in dark grey, what no map sees in magenta."""
    from andon.display.gaps import marked
    from andon.files.pictures import write_picture

    write_picture(path, marked(rgb, baked.uncovered))
