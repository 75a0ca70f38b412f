"""``--confidence`` of ``andon relight``: how far each pixel may be trusted, and why not."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from andon.cli.console import check_writable
from andon.errors import InputError

if TYPE_CHECKING:
    from andon.composite.confidence import Cause, Confidence
    from andon.scene import Scene

__all__ = ["check_confidence", "notes_on_confidence", "write_confidence"]

# Of the picture: smaller shares nobody finds.
NOTABLE_SHARE = 0.002
# Codes at the end of the picture's scale, which begins at a hundredth of it: a photograph's own 8
# bits err by 0.3.
TOP_CODES = 20.0
# Of causes whose error is not on the scale, in flat colours that it has not; and all in words.
COLOURS = {
    "CLIPPED": (0, 190, 210),
    "BEYOND": (120, 190, 90),
    "HOLE": (60, 60, 60),
    "VIRTUAL": (225, 225, 225),
    "UNCOVERED": (255, 0, 255),
    "GLASS": (90, 130, 230),
}
TEXTS = {
    "SOUND": "sound",
    "AMPLIFIED": "steps and noise brightened to more than {bar:.1f} codes",
    "CLIPPED": "clipped in the photograph, a bound is known",
    "BEYOND": "outside the measured range of its surface's curve",
    "HOLE": "hole, no light added",
    "VIRTUAL": "virtual",
    "UNCOVERED": "seen by no illuminance map",
    "GLASS": "behind glass",
}


def check_confidence(path: Path | None, scene: Scene) -> None:
    """Refuses it where there is no photograph whose errors would be in the frame."""
    if path is None:
        return
    check_writable(path, (".png", ".exr"), "--confidence")
    if not scene.has_photograph:
        raise InputError(
            "shows what a photograph's errors become, and the scene has none",
            field="--confidence",
            remedy="leave it out",
        )


def write_confidence(path: Path, confidence: Confidence) -> None:
    """EXR: four channels of numbers; PNG: expected error in false colours, causes in flat ones."""
    from andon.composite.confidence import Cause
    from andon.files.pictures import write_exr_channels, write_picture

    if path.suffix.lower() == ".png":
        write_picture(path, _picture(confidence))
        return
    write_exr_channels(
        path,
        {
            "expected_error": confidence.expected_error_codes,
            "relative_error": confidence.relative_error,
            "confidence": confidence.confidence,
            "cause": confidence.cause,
        },
        units={"expected_error": "codes", "relative_error": "1", "confidence": "1", "cause": "id"},
        attributes={
            "andon:causes": ", ".join(f"{cause.value} {cause.name.lower()}" for cause in Cause)
        },
    )


def _picture(confidence: Confidence) -> NDArray[np.uint8]:
    """(H + legend, W + scale, 3)."""
    from andon.composite.confidence import Cause
    from andon.display.false_colour import false_colour
    from andon.display.legend import Part, with_legend

    error = confidence.expected_error_codes
    parts: list[Part] = []
    for cause in Cause:
        share, mask = confidence.share(cause), confidence.cause == cause
        if not mask.any():
            continue
        if cause.name in COLOURS:
            parts.append(Part(_text(cause, share), COLOURS[cause.name], mask))
        else:
            middle = np.full((1, 1), np.median(error[mask]))
            r, g, b = false_colour(middle, "", top=TOP_CODES)[0, 0].tolist()
            parts.append(Part(_text(cause, share), (r, g, b)))
    return with_legend(false_colour(error, "codes", top=TOP_CODES), parts)


def _text(cause: Cause, share: float) -> str:
    from andon.composite.confidence import BAR_CODES

    return f"{share:.1%} {TEXTS[cause.name].format(bar=BAR_CODES)}"


def notes_on_confidence(confidence: Confidence) -> list[str]:
    """Shares of the picture that are not sure, and why."""
    from andon.composite.confidence import Cause

    sure = (Cause.SOUND, Cause.VIRTUAL)
    shares = {cause: confidence.share(cause) for cause in Cause if cause not in sure}
    return [
        f"confidence: of the pixels {_text(cause, share)}"
        for cause, share in shares.items()
        if share >= NOTABLE_SHARE
    ]
