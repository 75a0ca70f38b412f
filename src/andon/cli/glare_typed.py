"""What was typed for ``andon glare``, checked: eyes, models, projections, gazes, exposures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from andon.errors import InputError, nearest_name

if TYPE_CHECKING:
    from andon.cli.glare import GlareOptions
    from andon.files.pictures import Picture
    from andon.observer.spread.model import Eye
    from andon.spaces import View

__all__ = ["GLASSES", "ages_of", "eye_of", "gaze_of", "model_of", "one_of", "view_of"]

# What is typed, and its name among the observer's presets.
GLASSES = {"none": "none", "myopic": "short-sighted", "contact": "contact-lenses"}
MOST_AGES = 8


def one_of(value: str, known: Sequence[str], field: str) -> str:
    """`value` if it is one of `known`; otherwise an error that names the nearest."""
    if value in known:
        return value
    near = nearest_name(value, list(known))
    raise InputError(
        f"must be one of {', '.join(known)}, got {value[:40]!r}",
        field=field,
        remedy=f"perhaps {near}" if near else None,
    )


def ages_of(typed: str) -> tuple[float, ...]:
    """``20,45,70`` as years."""
    ages = tuple(_number(part, "--age", 0, 120) for part in typed.split(","))
    if len(ages) > MOST_AGES:
        raise InputError(f"must be at most {MOST_AGES} ages, got {len(ages)}", field="--age")
    return ages


def eye_of(options: GlareOptions, age: float, level_cd_m2: float | None) -> Eye:
    """The eye of one age; `level_cd_m2` is what it is adapted to, None where that is not known."""
    from andon.observer.presets import EYE_COLOURS, WORN, adaptation_of
    from andon.observer.pupil import watson_yellott_mm
    from andon.observer.spread.model import Eye

    pigment = EYE_COLOURS.get(options.pigment)
    if pigment is None:
        names = f"{', '.join(EYE_COLOURS)} or "
        pigment = _number(options.pigment, "--pigment", 0, 1.2, names)
    glasses, dioptres = WORN[GLASSES[one_of(options.glasses, list(GLASSES), "--glasses")]]
    if options.pupil != "auto":
        pupil = _number(options.pupil, "--pupil", 1, 10, "auto or ")
    elif level_cd_m2 is None:
        pupil = Eye().pupil_mm
    else:
        pupil = float(watson_yellott_mm(level_cd_m2, age_years=age))
    adaptation = Eye().adaptation if level_cd_m2 is None else adaptation_of(level_cd_m2)
    mist = _finite(options.mist, "--mist")
    return Eye(age, pigment, pupil, glasses, dioptres, mist, adaptation)


def model_of(name: str) -> str:
    """The name of a spread function, checked."""
    from andon.observer.spread.family import ALIASES, NAMES

    return one_of(name, [*ALIASES, *NAMES], "--model")


def view_of(options: GlareOptions, picture: Picture) -> View | None:
    """The view that the options state; None: they leave it to the picture."""
    from andon.files.cameras import read_camera
    from andon.glare.calibration import projected

    height, width = picture.shape
    if options.camera is not None:
        if options.projection is not None or options.hfov_degrees is not None:
            raise InputError(
                "states the projection and the angle",
                file=options.camera,
                field="--camera",
                remedy="leave --projection and --hfov-degrees out",
            )
        return read_camera(options.camera, size=(width, height))
    projection: Any = options.projection
    if projection is not None:
        one_of(projection, ("pinhole", "fisheye", "latlong"), "--projection")
    if projection == "pinhole" and options.hfov_degrees is None:
        # The angle of the header or of EXIF, but for certain no panorama.
        return projected("pinhole", picture.hfov_degrees or 60.0, width, height)
    return projected(projection, options.hfov_degrees, width, height)


def gaze_of(typed: str | None, view: View) -> Any:
    """(3,) unit direction of the pixel ``X,Y``; None: straight ahead."""
    if typed is None:
        return None
    parts = typed.split(",")
    if len(parts) != 2:
        raise InputError(f"must be X,Y in pixels, got {typed[:40]!r}", field="--gaze")
    x = _number(parts[0], "--gaze", 0, view.width - 1)
    y = _number(parts[1], "--gaze", 0, view.height - 1)
    return view.directions()[round(y), round(x)]


def exposure_of(typed: str) -> float | None:
    """Screen value per cd/m²; None: auto."""
    if typed == "auto":
        return None
    try:
        value = float(typed)
    except ValueError:
        value = math.nan
    if not 0 < value < math.inf:
        raise InputError(
            f"must be auto or a number > 0, got {typed.strip()[:40]!r}", field="--exposure"
        )
    return value


def _number(text: str, field: str, least: float, most: float, words: str = "") -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not least <= value <= most or math.isinf(value):
        raise InputError(
            f"must be {words}{least:g}…{most:g}, got {text.strip()[:40]!r}", field=field
        )
    return value


def _finite(value: float, field: str) -> float:
    if not (math.isfinite(value) and value >= 0):
        raise InputError(f"must be ≥ 0, got {value:g}", field=field)
    return value
