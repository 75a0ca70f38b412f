"""Which light of a volume is exported: of probes, or of a point between them, as frames see it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.volumes import ProbeVolume
from andon.harmonics import heat_factors, order_of, smoothing, to_order
from andon.transport.probes.export.model import (
    Export,
    PlacedLight,
    chosen_probe,
    probe_lights,
)
from andon.transport.probes.light import light_between, probe_coefficients

__all__ = ["exported_lights"]

Float = NDArray[np.float64]

# Of the formats that leave bands out.
ORDER = 2


def exported_lights(
    volume: ProbeVolume,
    coefficients: Float,
    export: Export,
    /,
    *,
    probe: str | None = None,
    at: Float | None = None,
    dering: bool = True,
    visibility: bool = True,
) -> tuple[PlacedLight, ...]:
    """Light of one probe, of a point, or of all probes, for a format.

    Parameters
    ----------
    coefficients : (n, k, 3) of the state that is exported, cd/m².
    probe : name or number of one.
    at : (3,) metres, world; beyond the hull its closest point counts.
    dering : smooth each probe as little as keeps its irradiance from going negative, with all its
        bands and with those that the format holds.
    visibility : at a point, walls hide probes, where the volume has distances.

    Raises
    ------
    InputError : `probe` is none or several; or `at` is given, too.
    """
    if probe is not None and at is not None:
        raise InputError("give one of probe and at", field="at")
    if dering:
        coefficients = _without_rings(coefficients, cut=export.cuts_bands)
    if at is None:
        lights = probe_lights(volume, coefficients)
        return lights if probe is None else (lights[chosen_probe(volume.names, probe)],)
    between = light_between(volume, coefficients, visibility=visibility)
    name = f"light at {' '.join(f'{value:g}' for value in at.tolist())}"
    return (PlacedLight(name, at, probe_coefficients(between, at[None])[0]),)


def _without_rings(coefficients: Float, *, cut: bool) -> Float:
    """Smoothed; a series may ring less than its first bands alone, so the stronger need counts."""
    order = order_of(coefficients.shape[1])
    share = smoothing(coefficients)
    if cut and order > ORDER:
        share = np.minimum(share, smoothing(to_order(coefficients, ORDER)))
    return coefficients * heat_factors(share, order)[..., None]
