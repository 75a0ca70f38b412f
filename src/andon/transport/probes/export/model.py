"""What is exported: light at places, in a unit that the other program likes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError, nearest_name
from andon.files.volumes import ProbeVolume
from andon.quantities import Photometry

__all__ = ["Export", "ExportUnit", "PlacedLight", "chosen_probe", "probe_lights"]

Float = NDArray[np.float64]

# Names that a message lists before it goes on with "…".
SHOWN_NAMES = 16


@dataclass(frozen=True, eq=False)
class PlacedLight:
    """Light at one place: `name`, `position_m` (3,), `coefficients` (k, 3) in cd/m²."""

    name: str
    position_m: Float
    coefficients: Float


@dataclass(frozen=True)
class ExportUnit:
    """In which unit numbers leave.

    Attributes
    ----------
    photometry : of the volume.
    white_cd_m2 : the luminance that becomes 1.0, as engines like it: a white diffuse surface that
        is lit from all sides with this luminance has the value 1. None: cd/m², as measured.
    """

    photometry: Photometry = "absolute"
    white_cd_m2: float | None = None

    def __post_init__(self) -> None:
        white = self.white_cd_m2
        if white is not None and not (np.isfinite(white) and white > 0):
            raise InputError(f"must be > 0 cd/m², got {white:g}", field="white_cd_m2")

    @property
    def scale(self) -> float:
        """What luminance in cd/m² is multiplied by."""
        return 1.0 if self.white_cd_m2 is None else 1 / self.white_cd_m2

    @property
    def words(self) -> str:
        """For whoever opens the file."""
        if self.white_cd_m2 is not None:
            return f"1.0 is a luminance of {self.white_cd_m2:g} cd/m² ({self.photometry})"
        return f"cd/m² ({self.photometry})"


@dataclass(frozen=True)
class Export:
    """A format.

    Attributes
    ----------
    suffix : of its files.
    write : gives their bytes.
    cuts_bands : bands above 2 are left out.
    """

    suffix: str
    write: Callable[[Sequence[PlacedLight], ExportUnit], bytes]
    cuts_bands: bool = True


def probe_lights(volume: ProbeVolume, coefficients: Float) -> tuple[PlacedLight, ...]:
    """Every probe of a volume with its light (n, k, 3) of one state."""
    return tuple(
        PlacedLight(name, position, light)
        for name, position, light in zip(volume.names, volume.positions, coefficients, strict=True)
    )


def chosen_probe(names: Sequence[str], typed: str) -> int:
    """The number of the probe that `typed` names, or is.

    Raises
    ------
    InputError
        if none has that name or number, or several have that name.
    """
    found = [number for number, name in enumerate(names) if name == typed]
    if len(found) == 1:
        return found[0]
    if found:
        raise InputError(
            f"{len(found)} probes are called {typed!r}",
            field="probe",
            remedy=f"give a number: {', '.join(map(str, found[:8]))}",
        )
    if typed.isdecimal() and len(typed) < 10:
        number = int(typed)
        if number < len(names):
            return number
        raise InputError(f"must be 0…{len(names) - 1}, got {number}", field="probe")
    known = list(dict.fromkeys(names))
    near = nearest_name(typed, known)
    listed = ", ".join(map(repr, known[:SHOWN_NAMES])) + (", …" if len(known) > SHOWN_NAMES else "")
    raise InputError(
        f"no probe is called {typed!r}",
        field="probe",
        remedy=f"did you mean {near!r}?"
        if near
        else f"give one of {listed}, or a number 0…{len(names) - 1}",
    )
