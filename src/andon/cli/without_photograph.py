"""What the commands say, and guard, of the photographs of a scene and of scenes without one."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from andon.errors import InputError

if TYPE_CHECKING:
    from andon.engines.prepared import Prepared
    from andon.scene import Scene

__all__ = ["refuse_photograph", "white_text"]


def white_text(scene: Scene, prepared: Prepared, /) -> str | None:
    """How bright the screen's white is, and who says so; None where a photograph does."""
    if scene.has_photograph:
        return None
    exposure = prepared.exposure.units_per_cd_m2
    white = next(iter(prepared.frames.values())).luminance_per_unit
    if exposure is not None:
        white, reason = 1 / exposure, "as the exposure states"
    elif scene.capture is not None and scene.capture.luminance_per_unit:
        reason = "as capture.luminance_per_unit states"
    else:
        reason = f"chosen: a white wall in {_rounded(np.pi * white)} lx, distant lamps and E0"
    unit = "cd/m²" if prepared.photometry == "absolute" else "cd/m² (relative)"
    return f"{_rounded(white)} {unit}, {reason}"


def _rounded(value: float) -> str:
    return f"{float(f'{value:.4g}'):g}"


def refuse_photograph(out: Path, scene: Scene, /) -> None:
    """Raises `InputError` if writing to `out` would overwrite a photograph of `scene`."""
    from andon.engines.reading import source_of

    names = [name for name, _ in scene.rig.cameras] if scene.rig is not None else []
    if scene.has_photograph and any(
        Path(source_of(scene, name)[0]).resolve() == out.resolve() for name in names
    ):
        raise InputError(
            "is also the scene's photograph, and would be overwritten",
            file=out,
            field="--out",
            remedy="give it another name",
        )
