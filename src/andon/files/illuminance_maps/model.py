"""What a folder of baked illuminance maps holds, and what must be true of it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.quantities import Photometry
from andon.spaces import View

__all__ = ["MOST_BOUNCES", "BakedLamp", "IlluminanceMap", "Manifest", "MapFile", "Part"]

Floats = NDArray[np.floating[Any]]

# What of a lamp's light is in its maps: all of it, or what surfaces reflect of it alone.
Part = Literal["all", "bounce"]

MOST_BOUNCES = 16
_SUM = re.compile(r"[0-9a-f]{64}")
_CONTROL = re.compile(r"[\x00-\x1f\x7f]")


@dataclass(frozen=True)
class MapFile:
    """A picture of the folder, and what tells it from a damaged or a half-written one.

    Attributes
    ----------
    name : relative path in the folder, with ``/``.
    sha256 : 64 hexadecimal digits, small, of its bytes.
    size : bytes.
    """

    name: str
    sha256: str
    size: int


@dataclass(frozen=True)
class BakedLamp:
    """A lamp of the scene by its name, and which part of its light the maps hold."""

    name: str
    part: Part


@dataclass(frozen=True, eq=False)
class Manifest:
    """Which maps there are, and what they say.

    Maps may be missing, as while a bake is going on or where a task of it failed: `missing` tells.

    Attributes
    ----------
    cameras : where the maps are seen from; names differ, none is distorted.
    moments : seconds, rising.
    lamps : names differ.
    geometry : (camera, moment) → what the camera sees then; numbers count in the lists above.
    light : (lamp's name, camera, moment) → its illuminance.
    quality, bounces : how Radiance computed.
    photometry : of the lux.
    facts : what the light depends on → how it was, for people; compared with a scene's they say
        what changed since the bake.
    generator : which program wrote it.
    """

    cameras: tuple[View, ...]
    moments: tuple[float, ...]
    lamps: tuple[BakedLamp, ...]
    geometry: Mapping[tuple[int, int], MapFile]
    light: Mapping[tuple[str, int, int], MapFile]
    quality: str = "normal"
    bounces: int = 0
    photometry: Photometry = "absolute"
    facts: Mapping[str, str] = field(default_factory=dict[str, str])
    generator: str = "Andon"

    def __post_init__(self) -> None:
        _check_names("cameras", [view.name for view in self.cameras])
        _check_names("lamps", [lamp.name for lamp in self.lamps])
        for number, view in enumerate(self.cameras):
            if view.distortion:
                raise _refusal(f"cameras[{number}]", "must not be distorted")
        times = np.asarray(self.moments, np.float64)
        if not len(times) or not np.isfinite(times).all() or (np.diff(times) <= 0).any():
            raise _refusal("moments_seconds", "must be one or more finite, rising numbers")
        if not 0 <= self.bounces <= MOST_BOUNCES:
            raise _refusal("bounces", f"must be 0…{MOST_BOUNCES}, got {self.bounces}")
        for camera, moment in self.geometry:
            self._check_place("geometry", camera, moment)
        lamps = {lamp.name for lamp in self.lamps}
        for lamp, camera, moment in self.light:
            self._check_place("light", camera, moment)
            if lamp not in lamps:
                raise _refusal("light", f"names a lamp {lamp[:80]!r} that lamps does not list")
        self._check_files()

    def _check_place(self, what: str, camera: int, moment: int) -> None:
        if not 0 <= camera < len(self.cameras):
            raise _refusal(what, f"camera must be 0…{len(self.cameras) - 1}, got {camera}")
        if not 0 <= moment < len(self.moments):
            raise _refusal(what, f"moment must be 0…{len(self.moments) - 1}, got {moment}")

    def _check_files(self) -> None:
        known: dict[str, MapFile] = {}
        for file in (*self.geometry.values(), *self.light.values()):
            if not _SUM.fullmatch(file.sha256):
                raise _refusal("sha256", f"must be 64 hexadecimal digits, got {file.sha256[:80]!r}")
            if file.size < 1:
                raise _refusal("bytes", f"must be > 0, got {file.size}")
            if known.setdefault(file.name, file) != file:
                raise _refusal("file", f"{file.name[:80]!r} must have one sum and one size")

    def missing(self) -> Iterator[str]:
        """What is not there of all lamps, cameras and moments, in words."""
        for moment, seconds in enumerate(self.moments):
            for camera, view in enumerate(self.cameras):
                where = f"{view.name}, {seconds:g} s"
                if (camera, moment) not in self.geometry:
                    yield f"geometry of {where}"
                for lamp in self.lamps:
                    if (lamp.name, camera, moment) not in self.light:
                        yield f"light of {lamp.name}, {where}"


@dataclass(frozen=True, eq=False)
class IlluminanceMap:
    """Illuminance on the surface that one camera sees at one moment.

    Attributes
    ----------
    view : where its pixels look; never distorted.
    depth_m : (h, w) float32, as `Surface.depth` (planar for a pinhole, else distance); NaN where
        there is no surface.
    normal : (h, w, 3) float32 unit, world, towards the camera; NaN as `depth_m`.
    lux : lamp name → (h, w, 3) float32 in lx, ≥ 0; 0 where there is no surface.
    """

    view: View
    depth_m: Floats
    normal: Floats
    lux: Mapping[str, Floats]


def _check_names(what: str, names: list[str]) -> None:
    if not names:
        raise _refusal(what, "must have one or more")
    for number, name in enumerate(names):
        if not 1 <= len(name) <= 200 or _CONTROL.search(name):
            raise _refusal(f"{what}[{number}].name", "must be 1…200 characters, none of control")
        if name in names[:number]:
            raise _refusal(f"{what}[{number}].name", f"must differ from the others, got {name!r}")


def _refusal(field_name: str, rule: str) -> InputError:
    return InputError(rule, field=field_name)
