"""Lamps and objects that move and change: the value between two keyframes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.quaternions import slerp
from andon.scene.lamp_base import LampKey, LampTable
from andon.scene.objects import SceneObject

__all__ = ["lamp_at", "object_at"]

Float = NDArray[np.float64]
L = TypeVar("L", bound=LampTable)


def lamp_at(lamp: L, time_seconds: float) -> L:
    """The lamp at one moment, without keyframes.

    Each quantity runs through the keys that set it: linear between them (directions turn on the
    great circle at a constant rate), constant before the first and after the last.
    Raises `InputError` if `time_seconds` is not finite.
    """
    _check_time(time_seconds)
    if not lamp.key:
        return lamp
    values: dict[str, Any] = {"key": ()}
    for name in {name for key in lamp.key for name in key.animated}:
        keys = [key for key in lamp.key if getattr(key, name) is not None]
        values[name] = _value(keys, name, time_seconds)
    return lamp.model_copy(update=values)


def object_at(entry: SceneObject, time_seconds: float) -> Float:
    """(4, 4) world_from_object at one moment, metres.

    Position and rotation each run through the keys that set them: straight, and the shorter way at
    a constant rate; constant before the first and after the last. What no key sets is the object's
    own. Raises `InputError` if `time_seconds` is not finite.
    """
    _check_time(time_seconds)
    values: dict[str, Any] = {}
    for name in ("position", "rotation_xyzw"):
        keys = [key for key in entry.key if getattr(key, name) is not None]
        if keys:
            times = np.array([key.time_seconds for key in keys])
            stated = np.array([getattr(key, name) for key in keys])
            values[name] = tuple(_along(times, stated, time_seconds, name).tolist())
    return entry.model_copy(update=values).world_from_object()


def _along(times: Float, stated: Float, time_seconds: float, name: str) -> Float:
    """One of `stated` (n, w) at `times` (n,), or what lies between two of them."""
    after = int(np.searchsorted(times, time_seconds, side="right"))
    if after == 0 or after == len(times):
        return stated[max(0, after - 1)]
    span = times[after] - times[after - 1]
    share = float((time_seconds - times[after - 1]) / span)
    first, second = stated[after - 1], stated[after]
    if name == "rotation_xyzw":
        return slerp(first, second, share)
    return (1 - share) * first + share * second


def _check_time(time_seconds: float) -> None:
    if not np.isfinite(time_seconds):
        raise InputError(f"must be finite, got {time_seconds}", field="time_seconds")


def _value(keys: Sequence[LampKey], name: str, time_seconds: float) -> Any:
    times = np.array([key.time_seconds for key in keys])
    values = np.array([getattr(key, name) for key in keys], dtype=np.float64)
    if name == "direction":
        return tuple(_turn(times, values, time_seconds).tolist())
    if values.ndim == 1:
        return float(np.interp(time_seconds, times, values))
    return tuple(float(np.interp(time_seconds, times, values[:, axis])) for axis in range(3))


def _turn(times: Float, directions: Float, time_seconds: float) -> Float:
    """Unit direction (3,) at one moment, from directions (n, 3) at times (n,)."""
    directions = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    after = int(np.clip(np.searchsorted(times, time_seconds, side="right"), 1, len(times) - 1))
    if len(times) == 1:
        return directions[0]
    a, b = directions[after - 1], directions[after]
    span = times[after] - times[after - 1]
    share = float(np.clip((time_seconds - times[after - 1]) / span, 0, 1))
    # atan2 of sine and cosine keeps small angles exact, where acos loses half the digits.
    angle = float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))
    if angle < 1e-12:
        return a
    return (np.sin((1 - share) * angle) * a + np.sin(share * angle) * b) / np.sin(angle)
