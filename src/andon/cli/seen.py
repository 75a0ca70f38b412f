"""``--seen`` of ``andon relight``: what the eye gets through an optical see-through display."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from andon.cli.console import check_writable
from andon.errors import InputError

if TYPE_CHECKING:
    from andon.display.model import Seen

__all__ = ["check_seen", "notes_on_seen", "write_seen"]


def check_seen(path: Path | None, scene: Any) -> None:
    """Refuses a simulated view of a display that shows the picture itself, before any work."""
    if path is None:
        return
    check_writable(path, (".png", ".jpg", ".jpeg", ".exr"), "--seen")
    if scene.display.mode != "ost":
        raise InputError(
            "simulates an optical see-through display, and this one is video see-through: its "
            "picture is what is seen",
            field="--seen",
            remedy='state display.mode = "ost" and display.peak_luminance_cd_m2 in a scene file',
        )


def write_seen(path: Path, seen: Seen) -> None:
    """EXR: cd/m²; PNG, JPEG: at the exposure and with the tone of the scene."""
    from andon.files.pictures import write_exr, write_picture

    if path.suffix.lower() == ".exr":
        values = np.asarray(seen.luminance.cd_m2, np.float32)
        write_exr(path, values, unit="cd/m2", photometry=seen.luminance.photometry)
    else:
        write_picture(path, seen.image.rgb)


def notes_on_seen(seen: Seen | None) -> list[str]:
    """How much of the picture the display cannot show."""
    if seen is None:
        return []
    unit = "cd/m²" if seen.luminance.photometry == "absolute" else "cd/m² (relative)"
    return [
        f"out of the display's reach: {seen.dark_share:.1%} of the pixels should be darker than "
        f"the real light that passes, {seen.bright_share:.1%} brighter than it can add; mean error "
        f"{seen.mean_error_cd_m2:.3g} of {seen.mean_wanted_cd_m2:.3g} {unit}"
    ]
