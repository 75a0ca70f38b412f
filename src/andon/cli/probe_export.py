"""``andon probes export``: light of a volume for another program."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from andon.cli.console import check_writable, note, printable
from andon.errors import InputError, nearest_name

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from andon.files.volumes import ProbeVolume
    from andon.transport.probes.export import ProbeLight

__all__ = ["ExportOptions", "run"]


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


def run(options: ExportOptions) -> None:
    """Writes the light of one probe, of a point, or of all probes; text without -o is printed."""
    from andon.files.atomic import write_bytes
    from andon.files.volumes import read_volume
    from andon.transport.probes.export import EXPORTS, ExportUnit
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
    volume = read_volume(options.volume)
    light = state_coefficients(volume, options.state, options.blend_state, options.blend)
    unit = ExportUnit(volume.photometry, options.white_cd_m2)
    data = export.write(_lights(volume, light, options), unit)
    if options.out is None:
        sys.stdout.write(data.decode())
    else:
        print(write_bytes(options.out, data))
    note(f"unit of light: {unit.words}")


def _check_out(options: ExportOptions, suffix: str) -> None:
    if options.out is not None:
        check_writable(options.out, (suffix,), "--out")
        if options.out.resolve() == options.volume.resolve():
            raise InputError("is also the input, and would be overwritten", file=options.out)
    elif suffix == ".glb":
        raise InputError(
            f"the format {options.format} is no text", field="--format", remedy="give -o FILE.glb"
        )


def _lights(
    volume: ProbeVolume, light: NDArray[np.float64], options: ExportOptions
) -> tuple[ProbeLight, ...]:
    from andon.transport.probes.export import ProbeLight, chosen_probe, probe_lights

    if options.at is not None:
        point = _point(options.at)
        return (ProbeLight(f"light at {options.at}", point, _light_at(volume, light, point)),)
    lights = probe_lights(volume, light)
    if options.probe is None:
        return lights
    number = chosen_probe(volume.names, options.probe)
    return (lights[number],)


def _point(typed: str) -> NDArray[np.float64]:
    import numpy as np

    try:
        point = np.array([float(part) for part in typed.split(",")])
    except ValueError:
        point = np.zeros(0)
    if point.shape != (3,) or not np.isfinite(point).all():
        raise InputError(
            f"must be three numbers x,y,z in metres, got {printable(typed)!r}", field="--at"
        )
    return point


def _light_at(
    volume: ProbeVolume, light: NDArray[np.float64], point: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(k, 3) between the probes; walls are not asked."""
    from andon.transport.probes.space import ProbeSpace

    space = ProbeSpace(volume)
    mixed = space.mixed(space.locate(point[None]), light.reshape(volume.count, -1))
    found: NDArray[np.float64] = mixed[0].reshape(light.shape[1:])
    return found
