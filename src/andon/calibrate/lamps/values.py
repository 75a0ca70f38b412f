"""From amounts of terms to what a reader wants to know of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.lamps.model import FittedFill, FittedLight
from andon.calibrate.lamps.solve import Problem, Solution
from andon.calibrate.lamps.terms import Term
from andon.quantities import photometric

__all__ = ["Values", "values_of"]

Float = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Values:
    """The fitted lights, apart by what they are; None: not asked for."""

    lamps: tuple[FittedLight, ...]
    dimming: FittedLight | None
    fill: FittedFill | None


def values_of(terms: tuple[Term, ...], problem: Problem, solution: Solution, /) -> Values:
    """The values of `terms` that `solution` found."""
    shares = _shares(terms, problem, solution)
    lights = [
        FittedLight(
            term.name,
            term.unit * solution.amounts[index],
            term.unit * solution.errors[index],
            shares[index],
            bool(solution.told_apart[index]),
        )
        for index, term in enumerate(terms)
    ]
    of = {kind: [x for t, x in zip(terms, lights, strict=True) if t.kind == kind] for kind in KINDS}
    fill = None
    if of["sky"]:
        (sky,), (ground,) = of["sky"], of["ground"]
        fill = FittedFill(
            sky.factor,
            ground.factor,
            sky.error,
            ground.error,
            sky.share + ground.share,
            sky.told_apart and ground.told_apart,
        )
    return Values(tuple(of["lamp"]), of["dimming"][0] if of["dimming"] else None, fill)


KINDS = ("lamp", "dimming", "sky", "ground")


def _shares(terms: tuple[Term, ...], problem: Problem, solution: Solution) -> list[float]:
    """Of the light that lamps and fill add to the cells, how much is of each; of dimming NaN."""
    sums = np.einsum("jnc,nc->jc", problem.pictures, problem.counts) * solution.amounts
    light = photometric(sums)
    adds = np.array([term.kind != "dimming" for term in terms])
    whole = float(light[adds].sum())
    return [
        float("nan") if not add else float(value / whole) if whole > 0 else 0.0
        for value, add in zip(light, adds, strict=True)
    ]
