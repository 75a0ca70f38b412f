"""The veil of known sources in float64."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glare.kernel import Kernel
from andon.glare.model import Source
from andon.glare.per_source.coordinates import chord
from andon.glare.per_source.halos import HaloTable, halo_table
from andon.glare.per_source.model import PerSource
from andon.glare.per_source.rings import halo_samples, offsets, reach_chord, rings_of
from andon.glare.per_source.tables import VeilTable, table_of
from andon.glare.pixels import pixel_radians
from andon.observer.spread.model import SpreadFunction
from andon.spaces import View

__all__ = ["halos_of_sources", "has_core", "veil_of_sources", "veil_share"]

Float = NDArray[np.float64]


def has_core(view: View, kernel: Kernel, /) -> bool:
    """Whether pixels of `view` are finer than θ_min, so that the core is seen apart."""
    return pixel_radians(view) < np.radians(kernel.minimum_degrees)


def veil_share(view: View, kernel: Kernel, /) -> float:
    """Share of a source's light that `veil_of_sources` scatters: k, and the core where it is."""
    return kernel.share + (kernel.core_share if has_core(view, kernel) else 0.0)


def veil_of_sources(
    sources: Sequence[Source],
    view: View,
    kernel: Kernel,
    /,
    *,
    halo: SpreadFunction | None = None,
    weights: Sequence[float] | None = None,
    settings: PerSource | None = None,
) -> Float:
    """(H, W, 3) cd/m² that `sources` add to each pixel of `view`, as the mean over the pixel.

    Parameters
    ----------
    halo : the model whose ring is drawn around sources, too; None: no rings.
    weights : of the ring of each source, 0…1 (`andon.glare.gate`); None: 1.

    Raises `InputError` for weights that are not one for each source, or a `halo` without a ring.
    """
    settings = PerSource() if settings is None else settings
    core = has_core(view, kernel) if settings.core is None else settings.core
    shares = checked_weights(sources, weights)
    ring = None if halo is None else halo_table(halo)
    total = np.zeros((*view.shape, 3))
    for source, share in zip(sources, shares, strict=True):
        table = table_of(kernel, source.outline, core=core, bloom=settings.bloom)
        if settings.bloom_drawn:
            total += _veil(source, view, kernel, table, settings.least_cd_m2)
        if ring is not None and share > 0:
            total += share * _ring(source, view, table, ring)
    return total


def halos_of_sources(
    sources: Sequence[Source],
    view: View,
    kernel: Kernel,
    halo: SpreadFunction,
    /,
    *,
    weights: Sequence[float] | None = None,
) -> Float:
    """(H, W, 3) cd/m² of the rings alone, as `veil_of_sources` draws them on top of the veil."""
    ring = halo_table(halo)
    total = np.zeros((*view.shape, 3))
    for source, share in zip(sources, checked_weights(sources, weights), strict=True):
        if share > 0:
            table = table_of(kernel, source.outline, core=has_core(view, kernel), bloom=None)
            total += share * _ring(source, view, table, ring)
    return total


def checked_weights(sources: Sequence[Source], weights: Sequence[float] | None, /) -> Float:
    """(n,) weights of the sources' halos; raises `InputError`."""
    shares = np.ones(len(sources)) if weights is None else np.asarray(weights, np.float64)
    if shares.shape != (len(sources),) or not np.all((shares >= 0) & (shares <= 1)):
        raise InputError("must be one for each source, 0…1", field="glare.halo weights")
    return shares


def _veil(source: Source, view: View, kernel: Kernel, table: VeilTable, least: float) -> Float:
    reach = reach_chord(table, float(source.illuminance_lux.max()), least)
    rings = rings_of(view, kernel, source.outline, reach)
    away = np.linalg.norm(view.directions() - source.direction, axis=-1)
    veil, start = np.zeros(view.shape), -1.0
    for end, samples in zip(rings.ends, rings.samples, strict=True):
        veil += _averaged(source, view, table, (away >= start) & (away < end), samples, table.at)
        start = end
    return veil[..., None] * source.illuminance_lux


def _ring(source: Source, view: View, table: VeilTable, ring: HaloTable) -> Float:
    widest = float(source.outline.radii_radians.max())
    away = np.linalg.norm(view.directions() - source.direction, axis=-1)
    reached = away < chord(min(widest + ring.end, np.pi))

    def light(x: Float, y: Float) -> Float:
        return ring.at(table.beyond_at(x, y))

    mean = _averaged(source, view, table, reached, halo_samples(view), light)
    return mean * ring.weakening(source.outline) * source.illuminance_lux


def _averaged(
    source: Source,
    view: View,
    table: VeilTable,
    where: NDArray[np.bool_],
    samples: int,
    light: Callable[[Float, Float], Float],
) -> Float:
    """(H, W, …) mean of `light` at places of the chart over pixels `where` (H, W), 0 elsewhere."""
    pixels = view.pixel_grid()[where]
    values = [
        light(*chart(source, table, view.directions_at(pixels + offset)))
        for offset in offsets(samples)
    ]
    mean = np.mean(values, axis=0)
    whole = np.zeros((*view.shape, *mean.shape[1:]))
    whole[where] = mean
    return whole


def chart(source: Source, table: VeilTable, directions: Float, /) -> tuple[Float, Float]:
    """x and y (...) of unit `directions` (..., 3) in Lambert's chart, x along the long axis."""
    right, down = long_axes(source, table)
    off = directions - source.direction
    # |p| is the chord, along (x, y)/cos(θ/2) of the sphere's own x and y.
    scale = 1 / np.sqrt(np.maximum(1 - np.sum(off * off, axis=-1) / 4, 1e-12))
    return (off @ right) * scale, (off @ down) * scale


def long_axes(source: Source, table: VeilTable, /) -> tuple[Float, Float]:
    """Unit vectors along the long axis of the source's outline, and across."""
    right, down = source.axes
    cosine, sine = np.cos(table.frame.axis_radians), np.sin(table.frame.axis_radians)
    return cosine * right + sine * down, cosine * down - sine * right
