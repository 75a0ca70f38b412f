"""Fitted light as a scene file states it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.lamps.terms import FILL_NAME, free_name
from andon.errors import InputError, nearest_name
from andon.lamps.colour import NEUTRAL, factors_from_rgb
from andon.lamps.tables import colour_of
from andon.quantities import photometric
from andon.responses import Response
from andon.scene import Scene
from andon.scene.lamp import HemisphereTable

__all__ = ["check_lamps", "fill_table", "fitted_lamp", "fitted_scene"]

Float = NDArray[np.float64]


def check_lamps(scene: Scene, names: tuple[str, ...] | None, /) -> tuple[str, ...]:
    """The names of the lamps to fit, in the order of the scene.

    Raises `InputError` for a name that no lamp has, and for lamps whose light is in maps, moves or
    is none.
    """
    known = [table.name for table in scene.lamp]
    if names is not None:
        _check_known(names, known, scene.file)
    chosen = tuple(name for name in known if names is None or name in names)
    for index, table in enumerate(scene.lamp):
        if table.name in chosen:
            _check_lamp(table, f"lamp[{index}]", scene.file)
    return chosen


def _check_known(names: tuple[str, ...], known: list[str], file: str) -> None:
    for name in names:
        if name not in known:
            near = nearest_name(name, known)
            listed = ", ".join(map(repr, known)) if known else "none"
            raise InputError(
                f"there is no lamp {name!r}, there are {listed}",
                file=file,
                field="fit_lamps",
                remedy=f"did you mean {near!r}?" if near else None,
            )


def _check_lamp(table: Any, place: str, file: str) -> None:
    if table.transport != "direct":
        raise InputError(
            f"its transport is {table.transport!r}: light of maps cannot be fitted",
            file=file,
            field=place,
            remedy='state transport = "direct", or leave it out of the fit',
        )
    light = table.light
    animated = {key for step in table.key for key in step.animated}
    moving = animated & {light, "temperature_k", "chromaticity_xy", "rgb"}
    if moving:
        raise InputError(
            f"its keys animate {', '.join(sorted(map(str, moving)))}: a photograph has one light",
            file=file,
            field=place,
            remedy="leave the keys out, or the lamp out of the fit",
        )
    if light is not None and getattr(table, light) == 0:
        raise InputError(
            f"{light} is 0: there is no light whose form could be fitted",
            file=file,
            field=place,
            remedy="state any light, the fit finds how much",
        )


def fitted_lamp(table: Any, factor: Float, stated: float | None = None, /) -> Any:
    """A [[lamp]] with `factor` (3,) times its light, as light and rgb.

    `stated` is the peak in cd of a luminaire whose table states none.
    """
    key = table.light or "intensity_cd"
    value = float(getattr(table, key) if table.light else stated or 0.0)
    light = value * colour_of(table) * factor
    changes: dict[str, Any] = {key: float(photometric(light)), **_coloured(light, table)}
    if table.kind == "hemisphere":
        ground = factors_from_rgb(np.array(table.ground_rgb)) if table.ground_rgb else None
        own = colour_of(table) if ground is None else ground
        ground_light = table.ground_illuminance_lux * own * factor
        changes["ground_illuminance_lux"] = float(photometric(ground_light))
        changes["ground_rgb"] = _ratio(ground_light)
    return table.model_copy(update=changes)


def _coloured(light: Float, table: Any) -> dict[str, Any]:
    """The keys of a lamp's colour; of a lamp that gives nothing it stays."""
    ratio = _ratio(light)
    if ratio is None:
        return {}
    others = dict.fromkeys(("chromaticity_xy", "temperature_k"))
    if np.allclose(ratio, NEUTRAL, rtol=0, atol=1e-12):
        return {**others, "daylight": False, "rgb": None}
    return {**others, "daylight": False, "rgb": ratio}


def _ratio(light: Float) -> tuple[float, float, float] | None:
    value = float(photometric(light))
    if not value > 0:
        return None
    red, green, blue = (light / value).tolist()
    return red, green, blue


def fill_table(sky_lux: Float, ground_lux: Float, taken: tuple[str, ...], /) -> Any:
    """The fill as a [[lamp]] of kind ``hemisphere``, with a name that is not taken."""
    sky, ground = _ratio(sky_lux), _ratio(ground_lux)
    return HemisphereTable(
        kind="hemisphere",
        name=free_name(FILL_NAME, taken),
        illuminance_lux=float(photometric(sky_lux)),
        rgb=sky,
        ground_illuminance_lux=float(photometric(ground_lux)),
        ground_rgb=ground,
    )


def fitted_scene(
    scene: Scene,
    factors: Mapping[str, Float],
    stated: Mapping[str, float],
    /,
    *,
    fill_lux: tuple[Float, Float] | None,
    dimming: Float | None,
    response: Response | None,
    luminance_per_unit: float | None = None,
) -> Scene:
    """`scene` with the fitted values in its tables.

    `stated` are the peaks of luminaires whose tables state none; None leaves what stands there.
    """
    lamps: list[Any] = [
        fitted_lamp(table, factors[table.name], stated.get(table.name))
        if table.name in factors
        else table
        for table in scene.lamp
    ]
    if fill_lux is not None and (fill_lux[0].any() or fill_lux[1].any()):
        lamps.append(fill_table(*fill_lux, tuple(table.name for table in scene.lamp)))
    changes: dict[str, Any] = {"lamp": tuple(lamps)}
    if dimming is not None and scene.ambient is not None:
        own = np.broadcast_to(np.asarray(scene.ambient.dimming, float), 3) * dimming
        left = tuple(float(share) for share in own)
        changes["ambient"] = scene.ambient.model_copy(update={"dimming": left})
    capture: dict[str, Any] = {} if response is None else {"response": _table_of(response)}
    capture |= {} if luminance_per_unit is None else {"luminance_per_unit": luminance_per_unit}
    if capture and scene.capture is not None:
        changes["capture"] = scene.capture.model_copy(update=capture)
    return scene.model_copy(update=changes)


def _table_of(response: Response) -> Any:
    from andon.scene.capture import ResponseTable

    gamma = response.gamma if response.kind == "gamma" else None
    return ResponseTable(kind=response.kind, gamma=gamma)
