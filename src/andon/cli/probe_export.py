"""``andon probes export``: light of a volume for another program."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from andon.cli.console import check_writable, note
from andon.cli.points import point_of
from andon.errors import InputError, nearest_name

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from andon.files.volumes import ProbeVolume

    Float = NDArray[np.float64]

__all__ = ["ExportOptions", "run"]

# Of the extent: files hold float32.
SAME_PLACE = 1e-6


@dataclass(frozen=True)
class ExportOptions:
    """What was typed."""

    volume: Path
    format: str
    probe: str | None = None
    at: str | None = None
    out: Path | None = None
    state: str | None = None
    blend_state: str | None = None
    blend: float = 0.0
    white_cd_m2: float | None = None
    raw: bool = False
    visibility: bool = True


def run(options: ExportOptions) -> None:
    """Writes the light of one probe, of a point, or of all probes; text without -o is printed."""
    from andon.cli.probe_volume import volume_of
    from andon.files.atomic import write_bytes
    from andon.transport.probes.export import EXPORTS, ExportUnit, exported_lights
    from andon.transport.probes.states import state_coefficients

    if options.format not in EXPORTS:
        near = nearest_name(options.format, list(EXPORTS))
        raise InputError(
            f"must be one of {', '.join(EXPORTS)}, got {options.format!r}",
            field="--format",
            remedy=f"did you mean {near!r}?" if near else None,
        )
    export = EXPORTS[options.format]
    _check_out(options, export.suffix)
    if options.probe is not None and options.at is not None:
        raise InputError("give one of --probe and --at", field="--at")
    point = point_of(options.at, "--at")
    volume = volume_of(options.volume)
    light = state_coefficients(volume, options.state, options.blend_state, options.blend)
    unit = ExportUnit(volume.photometry, options.white_cd_m2)
    lights = exported_lights(
        volume,
        light,
        export,
        probe=options.probe,
        at=point,
        dering=not options.raw,
        visibility=options.visibility,
    )
    data = export.write(lights, unit)
    if options.out is None:
        sys.stdout.write(data.decode())
    else:
        print(write_bytes(options.out, data))
    if point is not None and _is_outside(volume, point):
        note("outside the probes: light of the nearest point of their hull")
    note(f"unit of light: {unit.words}")


def _is_outside(volume: ProbeVolume, point: Float) -> bool:
    """The probes' mix at `point` (3,) is not there: it is elsewhere on their hull."""
    import numpy as np

    from andon.transport.probes.space import ProbeSpace

    space = ProbeSpace(volume)
    found = space.mixed(space.locate(point[None]), volume.positions)[0]
    extent = float(np.ptp(volume.positions, axis=0).max()) + float(np.abs(point).max())
    return float(np.linalg.norm(found - point)) > SAME_PLACE * extent


def _check_out(options: ExportOptions, suffix: str) -> None:
    if options.out is not None:
        check_writable(options.out, (suffix,), "--out")
        if options.out.resolve() == options.volume.resolve():
            raise InputError("is also the input, and would be overwritten", file=options.out)
    elif suffix == ".glb":
        raise InputError(
            f"the format {options.format} is no text", field="--format", remedy="give -o FILE.glb"
        )
