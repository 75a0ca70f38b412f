"""From what is known to scale and shift, with what is not determined said."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.depth.least_squares import Solution, huber_cost, jacobian, minimise
from andon.calibrate.depth.model import DepthFit, Knowledge, RelativeDepth, Row
from andon.calibrate.depth.planes import shifts_to_try
from andon.calibrate.depth.problem import Problem, problem_of
from andon.errors import InputError

__all__ = ["CONTRADICTION_SHARE", "fit_depth"]

Float = NDArray[np.float64]

# A constraint that is so far off after the fit (radians, of angles) is noted, or ends it: no tape
# errs by a fifth, so some stated pixel or number is not what it is taken for.
NOTED_SHARE, CONTRADICTION_SHARE = 0.05, 0.2
# A standard error of the ratio of the farthest to the nearest depth above which the shift is
# undetermined: it says no more than that one of them is up to 1.6 times too far.
UNDETERMINED_SHARE = 0.5
STARTS = 4
# That r runs the other way is believed where this way costs what three standard deviations do, or
# where the fit escapes into a shift beside which there is no relief.
DIRECTION_COST, LEAST_RELIEF = 4.5, 0.01
# The two ends of the picture, and its middle, in percent of its pixels.
PERCENTILES = (2.0, 50.0, 98.0)


def fit_depth(relative: RelativeDepth, knowledge: Knowledge, /) -> DepthFit:
    """Scale and shift that agree best with what is known.

    Raises
    ------
    InputError
        where nothing gives the scale, a pixel is outside or in a hole, a plane has no pixels, what
        is known contradicts itself by more than `CONTRADICTION_SHARE`, or r runs the other way.
    """
    _check_scale(knowledge)
    problem = problem_of(relative, knowledge)
    solution = _best(problem)
    _check_direction(problem, solution)
    if solution is None:
        raise InputError(
            "no scale and shift puts all stated pixels before the camera",
            remedy="the other --kind, or pixels on nearer surfaces",
        )
    assumed = _shift_is_undetermined(problem, solution)
    if assumed:
        solution = _without_shift(problem)
    log_scale, ratio = float(solution.values[0]), float(solution.values[1])
    rows = tuple(problem.rows(log_scale, ratio))
    _check_contradictions(rows)
    return _described(problem, solution, rows, assumed=assumed)


def _check_scale(knowledge: Knowledge) -> None:
    has_height = knowledge.floor is not None and knowledge.floor.height_m is not None
    if knowledge.lengths or knowledge.points or has_height or knowledge.known_m is not None:
        return
    raise InputError(
        "nothing that is stated has a size: the scale is undetermined",
        remedy="add --length X1,Y1,X2,Y2=METRES, --at X,Y=METRES, --floor and --height, or --known",
    )


def _scales(problem: Problem, ratio: float) -> list[float]:
    """log a of everything that has a size, were the shift ratio right; empty where it cannot be."""
    with np.errstate(invalid="ignore", divide="ignore"):
        sizes = [row.found / row.stated for row in problem.rows(0.0, ratio) if row.unit == "m"]
    towards = 1.0 if problem.relative.kind == "inverse" else -1.0
    found = [towards * float(np.log(size)) for size in sizes if size > 0]
    if problem.line is not None:
        found += [-float(np.log(problem.line.alpha))] if problem.line.alpha > 0 else []
    return found


def _best(problem: Problem) -> Solution | None:
    """The best of many starts; None where every one has a stated pixel behind the camera."""
    values = problem.relative.values[np.isfinite(problem.relative.values)]
    ratios = shifts_to_try(values)
    ratios = np.concatenate([ratios, *_ratios_of_groups(problem)])
    starts: list[tuple[float, Float]] = []
    for ratio in ratios:
        scales = _scales(problem, float(ratio))
        if scales:
            start = np.array([float(np.median(scales)), ratio])
            starts.append((huber_cost(problem.residuals(start)), start))
    starts = sorted((s for s in starts if np.isfinite(s[0])), key=lambda s: s[0])[:STARTS]
    found = [minimise(problem.residuals, start) for _, start in starts]
    return min(found, key=lambda solution: solution.cost, default=None)


def _ratios_of_groups(problem: Problem) -> list[Float]:
    known = [] if problem.line is None else [problem.line.ratio]
    flat = [f.shift[0] for f in problem.flats if f.shift and np.isfinite(f.shift[1])]
    return [np.array(known + flat)]


def _check_direction(problem: Problem, solution: Solution | None) -> None:
    """Refuses r that falls where the kind says that it rises; `solution` is the best that rises."""
    cost = float("inf") if solution is None else solution.cost
    if (
        solution is not None
        and cost <= DIRECTION_COST
        and _relief(problem, solution) > LEAST_RELIEF
    ):
        return
    turned = _best(problem.turned())
    if turned is not None and turned.cost < cost / 4:
        kind = problem.relative.kind
        raise InputError(
            f"what is known asks for a scale below 0: r does not grow as kind {kind!r} says",
            field="--kind",
            remedy="try --kind " + ("depth" if kind == "inverse" else "inverse"),
        )


def _relief(problem: Problem, solution: Solution) -> float:
    """How much farther the far end of the picture is than the near one, relative."""
    low, high = np.nanpercentile(problem.relative.values, [PERCENTILES[0], PERCENTILES[2]])
    return float((high - low) / abs(high + solution.values[1]))


def _shift_is_undetermined(problem: Problem, solution: Solution) -> bool:
    values = problem.relative.values
    far, near = np.nanpercentile(values, [PERCENTILES[0], PERCENTILES[2]]) + solution.values[1]
    variance = _variance(solution)[1, 1]
    # The change of log(z_far/z_near) with s; a far end behind the camera is any distance away.
    change = 1 / far - 1 / near if far > 0 else float("inf")
    return not np.sqrt(variance) * abs(change) <= UNDETERMINED_SHARE


def _variance(solution: Solution, *, shift: bool = True) -> Float:
    """(2, 2) of (log a, s): of the stated precision, or of the scatter if that is worse."""
    used = solution.jacobian if shift else solution.jacobian[:, :1]
    scale = np.linalg.norm(used, axis=0)
    if not (scale > 0).all():
        return np.full((2, 2), np.inf)
    information = (used / scale).T @ (used / scale)
    if np.linalg.cond(information) > 1e13:
        return np.full((2, 2), np.inf)
    freedom = len(solution.residuals) - used.shape[1]
    worse = max(1.0, float((solution.residuals**2).sum()) / freedom) if freedom > 0 else 1.0
    found = np.zeros((2, 2))
    found[: len(scale), : len(scale)] = np.linalg.inv(information) / np.outer(scale, scale) * worse
    return found


def _without_shift(problem: Problem) -> Solution:
    """The scale alone, with b = 0."""
    scales = _scales(problem, 0.0)
    start = np.array([float(np.median(scales)) if scales else np.nan])

    def residuals(unknowns: Float) -> Float:
        return problem.residuals(np.array([unknowns[0], 0.0]))

    if not scales or not np.isfinite(residuals(start)).all():
        raise InputError(
            "the shift is undetermined, and with none a stated pixel is not before the camera",
            remedy="add a second --length, --at, --floor or --known",
        )
    found = minimise(residuals, start)
    unknowns = np.array([found.values[0], 0.0])
    return Solution(unknowns, found.residuals, jacobian(problem.residuals, unknowns), found.cost)


def _check_contradictions(rows: tuple[Row, ...]) -> None:
    worst = max(rows, key=lambda row: abs(row.share), default=None)
    if worst is None or abs(worst.share) <= CONTRADICTION_SHARE:
        return
    listed = "; ".join(f"{row.name} {_difference(row)}" for row in rows)
    raise InputError(f"what is known contradicts itself: {listed}", remedy="check pixels and sizes")


def _difference(row: Row) -> str:
    unit = "°" if row.unit == "degrees" else " m"
    share = "" if row.unit == "degrees" else f" ({row.share:+.1%})"
    return f"is {row.found:.4g}{unit}, stated {row.stated:.4g}{unit}{share}"


def _described(
    problem: Problem, solution: Solution, rows: tuple[Row, ...], *, assumed: bool
) -> DepthFit:
    relative = problem.relative
    log_scale, ratio = float(solution.values[0]), float(solution.values[1])
    scale = float(np.exp(log_scale))
    depth = relative.metric(scale, scale * ratio)
    if not np.isfinite(depth).any():
        raise InputError("no pixel would have a depth above 0", remedy="try the other --kind")
    percentiles = np.nanpercentile(depth, PERCENTILES)
    variance = _variance(solution, shift=not assumed)
    modelled = 1 / percentiles if relative.kind == "inverse" else percentiles
    # log z = ±(log a + log(r + s)), and r + s = modelled/a.
    slopes = np.stack([np.ones(3), scale / modelled], axis=1)
    errors = np.sqrt(np.einsum("ni,ij,nj->n", slopes, variance, slopes))
    notes = [f"{row.name} {_difference(row)}" for row in rows if abs(row.share) > NOTED_SHARE]
    flatness = [
        (_rms(flat.departure(_depth_of(flat.values, problem, scale, ratio), m)), flat.name)
        for flat in problem.flats
        for m in [flat.plane(log_scale, ratio)]
    ]
    known = _on_known(problem, depth)
    behind = int((np.isfinite(relative.values) & np.isnan(depth)).sum())
    return DepthFit(
        scale,
        scale * ratio,
        assumed,
        tuple(errors.tolist()),
        tuple(percentiles.tolist()),
        rows,
        tuple(flatness),
        *known,
        behind,
        tuple(notes),
    )


def _depth_of(values: Float, problem: Problem, scale: float, ratio: float) -> Float:
    modelled = scale * (values + ratio)
    with np.errstate(divide="ignore"):
        return 1 / modelled if problem.relative.kind == "inverse" else modelled


def _rms(values: Float) -> float:
    return float(np.sqrt(np.nanmean(values[np.isfinite(values)] ** 2)))


def _on_known(problem: Problem, depth: Float) -> tuple[float | None, float | None]:
    if problem.line is None:
        return None, None
    off = np.abs(depth[problem.line.chosen] / problem.line.metres - 1)
    return float(np.nanmedian(off)), problem.line.outlier_share
