"""Bounces of probes: through the probes themselves and by Radiance, against the truth."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from andon.errors import MachineError
from andon.verify.probe_bounces import BounceErrors, By, bounce_errors, furnace_error
from andon.verify.registry import NotShown, Row

__all__ = ["ROWS"]

# Of the light in the rows; more takes minutes.
BOUNCES = 2
TRUTH = (
    "rtrace at the probes, all bands; box with coloured walls and a block, 4 places × 24 "
    f"directions, light reflected at most {BOUNCES} times"
)


def _shown(measure: Callable[[], float]) -> Callable[[], float]:
    """Raises `NotShown` where Radiance's programs are missing."""

    def figure() -> float:
        try:
            return 100 * measure()
        except MachineError as error:
            raise NotShown(str(error)) from error

    return figure


def _box(by: By, **own: Any) -> BounceErrors:
    return bounce_errors(by, BOUNCES, **own)


def _row(
    name: str, bar: float | None, unit: str, against: str, measure: Callable[[], float]
) -> Row:
    return Row(f"probes.bounces.{name}", "probes", bar, unit, against, _shown(measure))


MEAN, ADDED = "RMSE, % of the mean", "RMSE, % of what bounce 2 adds"
SPARSE, DENSE = {"side": 2, "reach": 0.8}, {"side": 4, "reach": 0.95}

ROWS: tuple[Row, ...] = (
    _row(
        "furnace.radiance",
        5,
        "% of the light",
        f"ε·(1 + ρ + ρ²) with ρ = 0.6, closed box that emits; quality draft, {BOUNCES} bounces",
        lambda: furnace_error("radiance", BOUNCES),
    ),
    _row("radiance", 3, MEAN, f"{TRUTH}; quality draft", lambda: _box("radiance").rms),
    _row("radiance.added", 5, ADDED, TRUTH, lambda: _box("radiance").added_rms),
    _row(
        "probes",
        None,
        MEAN,
        f"{TRUTH}; and a lattice of 4³ probes, to 95 % of the way to the walls",
        lambda: _box("probes", **DENSE).rms,
    ),
    _row(
        "probes.added",
        None,
        ADDED,
        f"{TRUTH}; 4³ probes",
        lambda: _box("probes", **DENSE).added_rms,
    ),
    _row(
        "probes.sparse",
        None,
        MEAN,
        f"{TRUTH}; and a lattice of 2³ probes, to 80 % of the way to the walls",
        lambda: _box("probes", **SPARSE).rms,
    ),
    _row(
        "probes.sparse.added",
        None,
        ADDED,
        f"{TRUTH}; 2³ probes",
        lambda: _box("probes", **SPARSE).added_rms,
    ),
)
