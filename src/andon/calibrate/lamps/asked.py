"""What is to be fitted: lamps by name, terms, and which of their amounts are free."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.lamps.model import FitSettings
from andon.calibrate.lamps.tables import check_lamps
from andon.calibrate.lamps.target import Target
from andon.calibrate.lamps.terms import Term
from andon.engines.prepared import Prepared
from andon.errors import InputError
from andon.quantities import CameraFrame, photometric
from andon.scene import Scene

__all__ = [
    "check_photograph",
    "chosen_lamps",
    "free_amounts",
    "ridge_of",
    "settled",
    "terms_of",
    "view_name",
]

Float = NDArray[np.float64]

# Of the diagonal of the normal equations. Lamps at one place share their light evenly; where E0 is
# the same everywhere, light from all sides is dimming, which holes get as well.
RIDGE, RIDGE_OF_FILL = 1e-9, 1e-5
# Of ``auto``: squares of so many pixels, brighter than this share of white, of which at least a
# twentieth is darker in the reference than noise and alignment make it.
SQUARE_PX, LEAST_LEVEL, LEAST_DARKER, DARKER = 16, 0.01, 0.05, 0.93


def settled(
    settings: FitSettings, prepared: Prepared, frame: CameraFrame, target: Target, /
) -> FitSettings:
    """`settings` with what ``auto`` is: dimming by one factor where the reference is darker."""
    if settings.dimming != "auto":
        return settings
    is_left = all(prepared.ambient.dimming) and prepared.ambient.dimming_mode == "linear"
    return replace(settings, dimming="one" if is_left and _is_darker(frame, target) else "off")


def _is_darker(frame: CameraFrame, target: Target) -> bool:
    """Squares of the reference are darker than in the photograph: it was exposed less."""
    known = target.seen & ~target.white.any(axis=-1)
    if frame.clipped is not None:
        known &= ~frame.clipped
    share = _squares(known.astype(np.float64))
    before, after = (
        _squares(np.where(known, photometric(np.asarray(picture, np.float64)), 0.0))
        for picture in (frame.linear, target.linear)
    )
    told = (share > 0.5) & (before > LEAST_LEVEL * share)
    return bool(told.any() and np.mean(after[told] < DARKER * before[told]) > LEAST_DARKER)


def _squares(picture: Float) -> Float:
    """Means of squares; the rest at the right and at the bottom is left out."""
    rows, columns = (max(size // SQUARE_PX, 1) for size in picture.shape)
    height, width = picture.shape[0] // rows, picture.shape[1] // columns
    part: Any = picture[: rows * height, : columns * width]
    return part.reshape(rows, height, columns, width).mean(axis=(1, 3))


def free_amounts(terms: tuple[Term, ...], settings: FitSettings, /) -> Float:
    """(J, 3, P) which parameter is which amount."""
    columns: list[Float] = []
    for index, term in enumerate(terms):
        apart = settings.dimming == "channels" if term.kind == "dimming" else settings.colour
        for channels in [[0], [1], [2]] if apart else [[0, 1, 2]]:
            column = np.zeros((len(terms), 3))
            column[index, channels] = 1
            columns.append(column)
    return np.stack(columns, axis=-1)


def ridge_of(terms: tuple[Term, ...], /) -> Float:
    """(J,) how much less than their pictures allow terms are given."""
    return np.array([RIDGE_OF_FILL if term.kind in ("sky", "ground") else RIDGE for term in terms])


def terms_of(
    chosen: tuple[str, ...], settings: FitSettings, prepared: Prepared
) -> tuple[Term, ...]:
    """The terms of a fit. Raises `InputError` where there are none, and for no dimming to fit."""
    terms = [Term("lamp", name) for name in chosen]
    if settings.dimming != "off":
        if not all(prepared.ambient.dimming) or prepared.ambient.dimming_mode != "linear":
            raise InputError(
                "dimming that is fitted starts from light that is left, mode 'linear'",
                field="ambient.dimming",
                remedy="leave it out of the scene",
            )
        terms.append(Term("dimming", "dimming"))
    if settings.bounce:
        lux = float(prepared.ambient.mean_lux.mean())
        terms += [Term("sky", "light from above", lux), Term("ground", "light from below", lux)]
    if not terms:
        raise InputError(
            "there is nothing to fit: the scene has no lamp",
            field="fit_lamps",
            remedy="add a [[lamp]] or --lamp, or ask for dimming or bounce",
        )
    return tuple(terms)


def chosen_lamps(
    scene: Scene | None, prepared: Prepared, settings: FitSettings, /
) -> tuple[str, ...]:
    """Names of the lamps to fit, of `scene` or of arrays. Raises `InputError` for others."""
    if scene is not None:
        return check_lamps(scene, settings.lamps)
    known = dict.fromkeys(
        lamp.owner or lamp.name
        for lamp in prepared.lamps(settings.time_seconds)
        if lamp.owner not in prepared.sources
    )
    for name in settings.lamps or ():
        if name not in known:
            raise InputError(
                f"there is no lamp {name!r}, there are {', '.join(map(repr, known)) or 'none'}",
                field="fit_lamps",
            )
    return tuple(name for name in known if settings.lamps is None or name in settings.lamps)


def check_photograph(scene: Scene, /) -> None:
    """Refuses a scene without a photograph. Raises `InputError`."""
    if not scene.has_photograph:
        raise InputError(
            "there is no photograph to fit",
            file=scene.file,
            field="capture.source",
            remedy='add [capture] with source = "photo.png"',
        )


def view_name(prepared: Prepared, view: str | None, /) -> str:
    """The view that is asked for; None: the first. Raises `InputError` for none of the rig."""
    if view is None:
        return next(iter(prepared.frames))
    if view not in prepared.frames:
        raise InputError(
            f"there is no view {view!r}, this rig has {' and '.join(prepared.frames)}",
            field="view",
        )
    return view
