"""The response of a camera that nobody measured, chosen by how well light then explains pictures.

Under a wrong response light does not add: the same lamp seems brighter on dark things than on
bright ones. So each response of a family decodes both photographs, the fit is made again, and the
error is measured in codes, which are the same whatever the response.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.lamps.cells import Cells
from andon.calibrate.lamps.measures import encoded
from andon.calibrate.lamps.solve import Problem, solve
from andon.calibrate.lamps.target import Target
from andon.quantities import CameraFrame
from andon.responses import LINEAR, SRGB, Response

__all__ = ["FAMILY", "best_response", "decoded_frame", "response_errors"]

Float = NDArray[np.float64]
Mask = NDArray[np.bool_]

GAMMAS = (1.4, 1.6, 1.8, 2.0, 2.2, 2.4, 2.6)
FAMILY: dict[str, Response] = {
    "srgb": SRGB,
    "linear": LINEAR,
    **{f"gamma:{gamma:g}": Response("gamma", gamma=gamma) for gamma in GAMMAS},
}
# A photograph darker than this says nothing of a ratio.
LEAST_LIGHT = 1e-6
# Another response than the one that is stated has to be better by this: E0 that is not as stated
# looks a little like a response.
NOTABLE = 0.03


def decoded_frame(frame: CameraFrame, response: Response, /) -> CameraFrame:
    """The photograph with its codes meant by another response."""
    codes = np.clip(frame.response.encode(np.asarray(frame.linear, np.float64)), 0, 1)
    return replace(frame, linear=response.decode(codes).astype(np.float32), response=response)


def best_response(errors: Mapping[str, float], stated: Response, /) -> Response:
    """The response with the least of `errors`; the one that is stated unless that is worse."""
    best = min(errors, key=lambda name: errors[name])
    family = _family(stated)
    own = next(name for name, response in family.items() if response is stated)
    return stated if errors[own] <= errors[best] * (1 + NOTABLE) else family[best]


def _family(stated: Response) -> dict[str, Response]:
    """The family with the stated response in it, under its own name or as ``stated``."""
    own = next((name for name, response in FAMILY.items() if response == stated), "stated")
    return {**FAMILY, own: stated}


def response_errors(
    problem: Problem, kept: Mask, cells: Cells, frame: CameraFrame, target: Target, /
) -> dict[str, float]:
    """RMSE in encoded values that the fit leaves under each response of the family, by name.

    `kept` (n, 3) are the cells that count: what moved tells nothing of a response.
    Of real surfaces a picture of light is the photograph times a ratio, which does not depend on
    the response: so no picture is drawn again.
    """
    return {
        name: _error(_under(problem, cells, frame, target, response), kept, response)
        for name, response in _family(frame.response).items()
    }


def _under(
    problem: Problem, cells: Cells, frame: CameraFrame, target: Target, response: Response
) -> Problem:
    photograph = cells.of(np.asarray(decoded_frame(frame, response).linear, np.float64))
    ratio = photograph / np.maximum(problem.photograph, LEAST_LIGHT)
    return replace(
        problem,
        pictures=problem.pictures * ratio,
        offset=problem.offset * ratio,
        wanted=cells.of(target.decoded(frame.response, response).linear),
        photograph=photograph,
    )


def _error(problem: Problem, kept: Mask, response: Response) -> float:
    predicted = problem.predicted(solve(problem).amounts)
    off = encoded(problem.wanted, response) - encoded(predicted, response)
    counts = problem.counts * kept
    return float(np.sqrt((counts * off**2).sum() / counts.sum()))
