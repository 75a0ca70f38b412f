"""Illuminance by `rtrace`, the same to the last bit in every run.

::

    all points ──scene.oct, -ab 0──────────────────▶ straight from lamps ──┐
                                                                           × ──┐
    some points ──detail.oct and scene.oct, -ab 0──▶ smoothed, quotient ───┘   + ──▶ lux
    some points ──bounce.oct, -ab N less -ab 0──▶ reflected ──smoothed to all──┘

How much of an area lamp a thing close to it takes is seen by hundreds of tiles alone, and is about
the same for neighbours: it is asked at some points. The edges of shadows are of every point.

W/m² of each channel times 179 are lux. The program runs in the folder, so that the scene's files
have names without a path. One process computes in one order, and random numbers begin alike; what
else runs on the machine does not matter. Which points are asked together does: they are each
other's neighbours.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError, MachineError
from andon.files.radiance_programs import run_radiance
from andon.transport.baked.model import Part
from andon.transport.baked.radiance.quality import Quality
from andon.transport.baked.radiance.scene import BOUNCE_OCTREE, DETAIL_OCTREE, OCTREE
from andon.transport.baked.radiance.smoothing import chosen_points, lonely_points, smoothed
from andon.transport.baked.radiance.text import LUMENS_PER_WATT

__all__ = ["traced_illuminance"]

Float = NDArray[np.float64]

# Many tiles give no more than this times the light of few: things close to a lamp take light. Where
# few see next to nothing, or shine on what touches the lamp, their quotient is chance: with 2 a
# room with a lantern is 7 % too bright on the mean, all of it on the lantern's frame.
MOST = 1.25
# Of the points that are traced, as many may be added where neighbours are too few.
MORE = 0.3
# What is the same in every quality. Every lamp is tested (-dt, -dc), at its centre (-dj); there are
# no mirrors, so no virtual lamps (-dr). One process, and random numbers that begin alike: with -u+,
# the default, the clock chooses them.
FIXED = ("-h", "-w", "-fdd", "-n", "1", "-u-", "-dt", "0", "-dc", "1", "-dj", "0", "-dr", "0")


def traced_illuminance(
    folder: Path,
    position: NDArray[Any],
    normal: NDArray[Any],
    /,
    *,
    quality: Quality,
    bounces: int,
    part: Part = "all",
    direct_bounces: int = 0,
    time_limit_seconds: float = 3600.0,
) -> NDArray[np.float32]:
    """(n, 3) lux on surfaces at `position` (n, 3) metres that face `normal` (n, 3).

    Parameters
    ----------
    folder : with the octrees ``scene.oct`` and ``bounce.oct``, and the files that they name.
    position, normal : finite; normals of any length but 0. Light is measured 0.1 mm above. From
        1000 points on they are smoothed as parts of one picture.
    bounces : how often surfaces reflect the light, ≥ 0.
    part : "all", or "bounce": all less the light that comes straight from the lamp.
    direct_bounces : ``-ab`` at which the lamp's own light is complete: 0, but 1 of a sky of glow,
        which rays of the hemisphere find: the scene must have no other lamps then.
    time_limit_seconds : for each run of `rtrace`.

    Raises
    ------
    InputError : points or normals that are no such arrays, bounces < 0.
    MachineError : Radiance's programs are missing, fail, take too long or answer nonsense.
    """
    places, facing = _triples(position, "position"), _directions(normal, "normal")
    _check(places, facing, "normal", bounces)
    rays = np.concatenate([places, facing], axis=1)
    chosen = _chosen(places, facing, quality)
    alone = len(chosen) == len(places)

    def ask(octree: str, asked: Float, most: int) -> Float:
        words = ["-I", *FIXED, *quality.options(most, alone=alone)]
        return _traced(folder, words, asked, time_limit_seconds, octree)

    def everywhere(found: Float) -> Float:
        if alone:
            return found
        return smoothed(places, facing, chosen, found, neighbours=quality.neighbours)

    result = np.zeros_like(places)
    # What lamps give by themselves, if `rtrace` finds them everywhere without chance.
    if part == "all" and not direct_bounces:
        detailed = (folder / DETAIL_OCTREE).exists()
        result = ask(DETAIL_OCTREE if detailed and alone else OCTREE, rays, 0)
        if detailed and not alone:
            both = np.concatenate([ask(DETAIL_OCTREE, rays[chosen], 0), result[chosen]], axis=1)
            result = result * _quotient(everywhere(both))
    if bounces or (direct_bounces and part == "all"):
        found = ask(BOUNCE_OCTREE, rays[chosen], bounces + direct_bounces)
        if part == "bounce" or not direct_bounces:
            found -= ask(BOUNCE_OCTREE, rays[chosen], direct_bounces)
        result = result + everywhere(np.maximum(found, 0))  # a difference's rounding
    return result.astype(np.float32)


def _chosen(places: Float, facing: Float, quality: Quality) -> NDArray[np.intp]:
    """Where reflected light is traced: evenly, and more where surfaces are thin."""
    count = quality.traced(len(places))
    first = chosen_points(places, facing, count)
    if len(first) == len(places):
        return first
    more = lonely_points(
        places, facing, first, neighbours=quality.neighbours, most=round(MORE * count)
    )
    return np.union1d(first, more)


def _quotient(both: Float) -> Float:
    """(n, 3) of the first three columns and the last; 1 where there is no light."""
    many, few = both[:, :3], both[:, 3:]
    return np.clip(np.divide(many, few, out=np.ones_like(few), where=few > 0), 0, MOST)


def _triples(values: NDArray[Any], field: str) -> Float:
    triples = np.asarray(values, np.float64)
    if triples.ndim != 2 or triples.shape[1] != 3 or not np.isfinite(triples).all():
        raise InputError(f"must be finite (n, 3), got shape {triples.shape}", field=field)
    return triples


def _directions(values: NDArray[Any], field: str) -> Float:
    triples = _triples(values, field)
    length = np.linalg.norm(triples, axis=1, keepdims=True)
    if not (length > 0).all():
        # A zero direction tells rtrace to flush its output, it would give no number at all.
        raise InputError("must not be zero", field=field)
    return triples / length


def _check(places: Float, facing: Float, field: str, bounces: int) -> None:
    if places.shape != facing.shape:
        raise InputError(f"must have shape {places.shape}, got {facing.shape}", field=field)
    if bounces < 0:
        raise InputError(f"must be ≥ 0, got {bounces}", field="bounces")


def _traced(folder: Path, words: list[str], rays: Float, limit: float, octree: str) -> Float:
    """(n, 3) photometric answers of `rtrace` to rays (n, 6)."""
    if len(rays) == 0:
        return np.empty((0, 3))
    answer = run_radiance("rtrace", [*words, octree], rays.tobytes(), limit, cwd=folder)
    if len(answer) != 24 * len(rays):
        raise MachineError(
            f"rtrace answered {len(answer)} bytes instead of {24 * len(rays)}",
            remedy="check that memory has room",
        )
    watts = np.frombuffer(answer, np.float64).reshape(-1, 3)
    if not np.isfinite(watts).all():
        count = int((~np.isfinite(watts)).any(axis=1).sum())
        raise MachineError(
            f"rtrace answered no finite numbers for {count} of {len(watts)} points",
            remedy="check the scene's materials and lamps",
        )
    return watts * LUMENS_PER_WATT
