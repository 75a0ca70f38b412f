"""When maps are made: once of a still scene, else as often as [baked] says."""

from __future__ import annotations

from typing import Any

from andon.errors import InputError
from andon.lamps.resolve_areas import AREA_KINDS
from andon.scene import Scene

__all__ = ["MOST_MOMENTS", "moments_of", "moving_things"]

# An hour of 2 maps a second; a slip in duration_seconds should not plan for a year.
MOST_MOMENTS = 7200
# Moments nearer to each other than this are one, as shares of the time between them.
SAME = 1e-6


def moments_of(scene: Scene, /) -> tuple[float, ...]:
    """Seconds of the session at which maps are made, increasing; of a still scene 0 alone.

    Where something moves: every 1/``baked.frames_per_second`` from 0 to the scene's duration, and
    its end. Raises `InputError` where these are more than `MOST_MOMENTS`.
    """
    duration = scene.scene.duration_seconds
    if duration == 0 or not moving_things(scene):
        return (0.0,)
    stated = scene.baked.frames_per_second if scene.baked is not None else None
    rate = scene.scene.frames_per_second if stated is None else stated
    if duration * rate > MOST_MOMENTS:
        raise InputError(
            f"{duration:g} s with {rate:g} maps a second are more than {MOST_MOMENTS} moments",
            file=scene.file,
            field="baked.frames_per_second",
            remedy="light between moments is interpolated: state fewer, for example 2",
        )
    steps = int(duration * rate + SAME)
    times = [step / rate for step in range(steps + 1)]
    if duration * rate - steps > SAME:
        times.append(duration)
    return tuple(times)


def moving_things(scene: Scene, /) -> tuple[str, ...]:
    """Where the tables of what moves and matters for baked light stand, as fields of the scene.

    Objects that are lit or cast shadows, baked lamps, and the bodies of other lamps, which stand in
    the light.
    """
    objects = [
        f"object[{index}]"
        for index, entry in enumerate(scene.object)
        if (entry.key or entry.animation is not None) and (entry.casts_shadow or entry.lit_by_lamps)
    ]
    baked = scene.baked.lamps if scene.baked is not None else ()
    lamps = [
        f"lamp[{index}]"
        for index, table in enumerate(scene.lamp)
        if (table.key or table.path is not None) and (table.name in baked or _has_body(table))
    ]
    return (*objects, *lamps)


def _has_body(table: Any) -> bool:
    shown = table.kind in AREA_KINDS and table.drawn
    return shown or getattr(table, "shell", None) is not None
