"""What ``andon glare komorebi`` does: reads leaves, draws moments, writes a film."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from andon.cli.console import note
from andon.cli.film import check_film, frame_moments, write_film
from andon.cli.glare import GlareOptions
from andon.cli.glare_komorebi import KomorebiOptions
from andon.cli.glare_typed import exposure_of, eye_of, gaze_of, model_of, view_of
from andon.errors import InputError, MachineError

if TYPE_CHECKING:
    from collections.abc import Callable

    from andon.glare.komorebi import Canopy, Komorebi
    from andon.glare.komorebi.seen import Seen
    from andon.lamps.flicker import Flicker

__all__ = ["canopy_of", "drawn_by", "run"]

# Size of the picture of a list of gaps.
LISTED_PX = (960, 540)


def run(options: KomorebiOptions) -> None:
    """Reads, draws, writes. Raises `InputError` before anything is drawn."""
    times = _check(options)
    canopy = canopy_of(options)
    seen = _seen(options, canopy)
    scale = exposure_of(options.exposure)
    if scale is None:
        # The sky between the leaves is just white.
        scale = 1 / max(canopy.sky_cd_m2, 1e-30)
    _tell(seen.komorebi, scale)
    height, width = canopy.view.shape

    picture = drawn_by(seen, options.engine)

    def draw(time_seconds: float) -> NDArray[np.uint8]:
        from andon.cli.glare_outputs import exposed

        return exposed(picture(time_seconds), scale, "reinhard")

    write_film(options.out, draw, times, options.frames_per_second, 3 * height * width)
    print(options.out)


def _check(options: KomorebiOptions) -> list[float]:
    """The frames' times; all else that can be refused before the picture is read."""
    if not options.seconds > 0:
        raise InputError(f"must be > 0, got {options.seconds:g}", field="--seconds")
    check_film(options.out, options.frames_per_second)
    times = frame_moments(0.0, options.seconds, options.frames_per_second, end="--seconds")
    if options.gaps is not None and options.gaps < 1:
        raise InputError(f"must be ≥ 1, got {options.gaps}", field="--gaps")
    eye_of(_of_glare(options), options.age, None)
    model_of(options.model)
    exposure_of(options.exposure)
    _flicker(options, 1)
    return times


def _of_glare(options: KomorebiOptions) -> GlareOptions:
    """What both commands have, for what checks it."""
    return GlareOptions(
        options.leaves,
        options.out,
        projection=options.projection,
        hfov_degrees=options.hfov_degrees,
        pigment=options.pigment,
        pupil=options.pupil,
        glasses=options.glasses,
    )


def _listed(options: KomorebiOptions) -> Canopy:
    """Of a list, which has neither pixels nor leaves."""
    from andon.files.gaps import read_gap_list
    from andon.glare.calibration import DEFAULT_HFOV_DEGREES, projected
    from andon.glare.komorebi import canopy_of_list

    hfov = DEFAULT_HFOV_DEGREES if options.hfov_degrees is None else options.hfov_degrees
    view = projected("pinhole", hfov, *LISTED_PX)
    assert view is not None
    return canopy_of_list(read_gap_list(options.leaves), view, most=options.gaps or 500)


def canopy_of(options: KomorebiOptions) -> Canopy:
    """Leaves and gaps of the options' picture or list. Raises `InputError` where it has none."""
    if options.leaves.suffix.lower() in (".csv", ".json"):
        return _listed(options)
    from andon.files.pictures import read_picture
    from andon.glare.calibration import calibrated
    from andon.glare.cleaning import cleaned
    from andon.glare.komorebi import canopy_of_mask, canopy_of_picture
    from andon.glare.komorebi.canopy import SKY_CD_M2
    from andon.lamps.flicker.gaps import is_open

    picture = read_picture(options.leaves)
    read = calibrated(
        picture,
        view=view_of(_of_glare(options), picture),
        cd_m2_per_unit=options.luminance_scale,
        file=str(options.leaves),
    )
    sun = gaze_of(options.sun_at, read.view)
    light = cleaned(read.luminance_cd_m2, read.view, read.shows).light
    if read.photometry == "relative":
        # White is the sky.
        light = light * (SKY_CD_M2 if read.clipped is not None else SKY_CD_M2 / _sky(light))
    most = options.gaps
    try:
        if picture.encoding == "srgb" and not np.ptp(picture.values, axis=2).any():
            return canopy_of_mask(is_open(picture), read.view, most=most or 500)
        return canopy_of_picture(light, read.view, most=most or 40, sun=sun)
    except InputError as error:
        raise InputError(error.rule, file=options.leaves, remedy=error.remedy) from error


def _sky(light: NDArray[np.float64]) -> float:
    """What is bright in a picture, but not the sun: of 1 % of its pixels."""
    from andon.quantities import photometric

    return max(float(np.percentile(photometric(light), 99)), 1e-30)


def _flicker(options: KomorebiOptions, streams: int) -> Flicker:
    from andon.lamps.flicker import Flicker

    return Flicker(options.seed, options.z, options.steps_per_second, streams)


def _seen(options: KomorebiOptions, canopy: Canopy) -> Seen:
    from andon.glare.komorebi import Komorebi, Sun
    from andon.glare.komorebi.seen import Seen, ambient_of

    flicker = _flicker(options, len(canopy))
    sun = Sun(options.sun_lux, options.through)
    shown = Komorebi(canopy, sun, flicker, exposure_seconds=1 / options.frames_per_second)
    eye = eye_of(_of_glare(options), options.age, ambient_of(canopy))
    return Seen(shown, eye, options.model, options.seed)


def drawn_by(seen: Seen, engine: str) -> Callable[[float], NDArray[np.float64]]:
    """What draws moments: the GPU where there is one, unless the reference is asked for."""
    if engine == "reference":
        return seen.picture
    from andon.glare.komorebi.stage import SeenStage
    from andon.gpu.device import open_gpu

    try:
        return SeenStage(open_gpu(), seen).picture
    except MachineError:
        if engine == "gpu":
            raise
        return seen.picture


def _tell(shown: Komorebi, scale: float) -> None:
    canopy = shown.canopy
    lux = shown.flicker.mean * canopy.solid_angles_sr.sum() * shown.luminance_cd_m2
    from andon.quantities import photometric

    note(
        f"{len(canopy)} gaps, through which {float(photometric(lux)):.0f} lx of sun come in the "
        f"mean; exposure {scale:.3g} per cd/m²"
    )
