"""The exact mode: what a lamp of 1 cd makes of its shell, by an energy balance."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from andon.lamps.polygons import vector_area
from andon.lamps.shells.beams import Beam, beam_flux, solid_angles
from andon.lamps.shells.factors import enclosure_factors
from andon.lamps.shells.form import Form, form_of
from andon.lamps.shells.inside import inside_illuminance, spread, vertex_normals
from andon.lamps.shells.lids import fan
from andon.lamps.shells.model import KEPT, Shell
from andon.lamps.shells.pairs import evened
from andon.lamps.shells.radiosity import Balance, balance
from andon.lamps.triangles import triangle_areas

__all__ = ["Solution", "solve_shell"]

Float = NDArray[np.float64]

# A cone that falls between the vertices of the drawn body, up to this share of its flux, is shown
# as wide as the facets that it meets.
SEEN_SHARE = 0.5


@dataclass(frozen=True, eq=False)
class Solution:
    """A luminous body for 1 cd; everything scales with the lamp's candela, channel by channel.

    Attributes
    ----------
    met : share of the lamp's flux that meets the shell, [0, 1].
    facet_cd_m2 : (n, 3) luminance of the outside of each facet.
    lid_cd_m2 : (k, 3) luminance of each lid, by what is reflected inside.
    gap_cd : (3,) intensity of a point lamp that, hidden by the shell, sends the same flux through
        its gaps.
    outside_cd_m2, inside_cd_m2 : (v, 3) at the vertices of the drawn body.
    """

    met: float
    facet_cd_m2: Float
    lid_cd_m2: Float
    gap_cd: Float
    outside_cd_m2: Float
    inside_cd_m2: Float


@lru_cache(maxsize=KEPT)
def solve_shell(shell: Shell, beam: Beam, /) -> Solution:
    """The balance of `shell` with a lamp that shines like `beam`; kept, as it does not move."""
    form = form_of(shell)
    met_lm, incident = _incident(form, beam)
    shares, to_lids = _shares(shell)
    lost = shell.absorptance if form.is_open else None
    channels: dict[float, Balance] = {}
    for t in shell.transmittance.tolist():
        a = 1 - t if lost is None else lost
        channels[t] = balance(incident, shares, t=t, a=a)
    balances = [channels[t] for t in shell.transmittance.tolist()]
    area = triangle_areas(form.facets)
    through = np.stack([b.passes * b.received for b in balances], axis=1) * met_lm
    left = _left(form, shell, balances, to_lids) * met_lm
    lid_areas = [float(np.linalg.norm(vector_area(lid))) for lid in form.lids]
    gap_sr = 4 * np.pi - float(np.abs(solid_angles(form.corners).sum()))
    outside, inside = _at_vertices(form, beam, balances, incident, met_lm, through.sum(axis=0))
    return Solution(
        met_lm / beam.flux_lm,
        evened(through / (np.pi * area[:, None]), area, form.facet_groups),
        left[: len(form.lids)] / (np.pi * np.array(lid_areas)[:, None]),
        left.sum(axis=0) / gap_sr if form.has_gaps else np.zeros(3),
        outside,
        inside,
    )


def _incident(form: Form, beam: Beam) -> tuple[float, Float]:
    """Flux in lm that meets the shell, and the share (n,) of it on each facet.

    The openings say exactly what does not meet it. A facet that turns its outside to the lamp
    hides behind others and takes nothing.
    """
    if form.has_gaps:
        met = float(np.maximum(beam_flux(form.corners, beam), 0).sum())
    else:
        # Both sums have the same error, if any: together they are the whole beam.
        past = max(float(beam_flux(form.covers, beam).sum()), 0.0)
        hit = max(float(beam_flux(form.corners, beam).sum()), 0.0)
        met = beam.flux_lm * hit / (hit + past)
    met = min(met, beam.flux_lm)
    flux = np.maximum(beam_flux(form.facets, beam), 0)
    if met > 0 and not flux.any():  # a beam through a crack that only the fine mesh does not have
        flux = np.maximum(solid_angles(form.facets), 0)
    # What the closed form says left over from rounding is nothing.
    met = met if met > 1e-9 * beam.flux_lm else 0.0
    return met, flux / flux.sum() if met else np.zeros(len(flux))


@lru_cache(maxsize=KEPT)
def _shares(shell: Shell) -> tuple[Float, Float]:
    """Form factors among the facets (n, n), and from them to each lid (n, k)."""
    form = form_of(shell)
    count = len(form.facets)
    if not form.is_open:  # nothing goes round, see `balance`
        return np.zeros((count, count)), np.zeros((count, 0))
    lids = [fan(lid) for lid in form.lids]
    inside = np.concatenate([form.facets, *lids])[:, ::-1]
    shares = enclosure_factors(inside, closed=not form.has_gaps)[:count]
    ends = np.cumsum([count, *(len(lid) for lid in lids)])
    to_lids = [shares[:, a:b].sum(axis=1) for a, b in pairwise(ends.tolist())]
    return shares[:, :count], np.stack(to_lids, axis=1) if lids else np.zeros((count, 0))


def _left(form: Form, shell: Shell, balances: list[Balance], to_lids: Float) -> Float:
    """Flux (k or 1, 3) that leaves through each lid, or through all gaps, per incident flux."""
    if not form.is_open:
        return np.zeros((0, 3))
    columns: list[Float] = []
    for t, b in zip(shell.transmittance.tolist(), balances, strict=True):
        free = max(0.0, 1 - t - shell.absorptance) * float(b.received.any())
        parts = np.ones(1) if form.has_gaps else b.reflects * (b.received @ to_lids)
        columns.append(free * parts / parts.sum() if parts.sum() > 0 else 0 * parts)
    return np.stack(columns, axis=1)


def _at_vertices(
    form: Form,
    beam: Beam,
    balances: list[Balance],
    incident: Float,
    met_lm: float,
    through_lm: Float,
) -> tuple[Float, Float]:
    """Luminance (v, 3) outside and inside, whose flux is what the facets send.

    The lamp's own light is exact at each vertex; what was reflected changes slowly and is spread
    from the facets.
    """
    drawn = form.drawn
    direct = inside_illuminance(drawn, beam)
    area = triangle_areas(form.facets)
    weights = triangle_areas(drawn.positions[drawn.triangles])
    outside, inside = np.zeros((2, len(direct), 3))
    normals = vertex_normals(drawn)
    facet_lux = [(b.received - incident) * met_lm / area for b in balances]
    spreads = spread(drawn.positions, normals, form.facets, np.stack(facet_lux, axis=1))
    if weights @ direct[drawn.triangles].mean(axis=1) < SEEN_SHARE * met_lm:
        facet_lux = (incident * met_lm / area)[:, None]
        direct = spread(drawn.positions, normals, form.facets, facet_lux)[:, 0]
    for channel, b in enumerate(balances):
        lux = direct + np.maximum(spreads[:, channel], 0)
        total = weights @ lux[drawn.triangles].mean(axis=1) * b.passes
        scale = through_lm[channel] / total if total > 0 else 1.0
        outside[:, channel] = scale * b.passes * lux / np.pi
        inside[:, channel] = scale * b.reflects * lux / np.pi
    return outside, inside
