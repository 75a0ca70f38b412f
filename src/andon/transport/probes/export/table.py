"""CSV: a line for each probe, units in the names of the columns."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence

from andon.harmonics import order_of
from andon.transport.probes.export.model import ExportUnit, PlacedLight

__all__ = ["csv_text"]


def csv_text(lights: Sequence[PlacedLight], unit: ExportUnit) -> bytes:
    """Name, position in metres, and all coefficients with Andon's own meaning and order."""
    suffix = "cd_m2" if unit.white_cd_m2 is None else f"per_{unit.white_cd_m2:g}_cd_m2"
    if unit.photometry == "relative":
        suffix += "_relative"
    order = order_of(lights[0].coefficients.shape[0])
    columns = [
        f"L{band}_{m}_{channel}_{suffix}"
        for band in range(order + 1)
        for m in range(-band, band + 1)
        for channel in ("red", "green", "blue")
    ]
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(["name", "x_m", "y_m", "z_m", *columns])
    for light in lights:
        values = (unit.scale * light.coefficients).ravel().tolist()
        writer.writerow([light.name, *light.position_m.tolist(), *values])
    return stream.getvalue().encode()
