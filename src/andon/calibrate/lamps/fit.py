"""Lamps fitted to a reference photograph: the order of work."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.lamps.asked import (
    check_photograph,
    chosen_lamps,
    free_amounts,
    ridge_of,
    settled,
    terms_of,
    view_name,
)
from andon.calibrate.lamps.cells import Cells, cells_of
from andon.calibrate.lamps.families import best_response, decoded_frame, response_errors
from andon.calibrate.lamps.model import FitSettings, LampFit
from andon.calibrate.lamps.notes import notes_of
from andon.calibrate.lamps.regions import errors_by_region
from andon.calibrate.lamps.shades import white_of_shades
from andon.calibrate.lamps.solve import Problem, Solution, solve
from andon.calibrate.lamps.tables import check_lamps, fitted_scene
from andon.calibrate.lamps.target import mask_of, target_of
from andon.calibrate.lamps.terms import Basis, Painter
from andon.calibrate.lamps.values import Values, values_of
from andon.engines.prepared import Prepared, prepare
from andon.engines.reading import read_pictures, view_of
from andon.errors import InputError
from andon.lamps import GoniometricLamp
from andon.pipeline import Frame
from andon.quantities import CameraFrame, photometric
from andon.responses import Response
from andon.scene import Scene
from andon.spaces import View

__all__ = ["fit_lamps"]

Float = NDArray[np.float64]
Mask = NDArray[np.bool_]
Progress = Callable[[int, int, str], None]

# Side of the grid of squares that err together.
TILES = 12
# Where the drawn picture is further from the sum of pictures (root mean square, of its own), light
# does not simply add, and the fit goes on around what it found; half floats round to 5e-4.
LINEAR_WITHIN, MOST_STEPS = 3e-3, 6


def fit_lamps(
    scene: Scene | Prepared,
    reference: Any,
    /,
    *,
    mask: Any = None,
    settings: FitSettings | None = None,
    progress: Progress | None = None,
) -> LampFit:
    """How much light of which colour makes the scene's photograph look like `reference`.

    Parameters
    ----------
    scene : with a photograph; or what `prepare` made of one.
    reference : path or array (H, W, 3), encoded as the photograph or linear float, of the
        photograph's size and, as the photograph, not yet undistorted.
    mask : path or (H, W) bool; the fit looks at what is white. None: everywhere.
    settings : what is free; None: flux and colour of all lamps.
    progress : called with pictures drawn, pictures in all, and the name of the last.

    Raises
    ------
    InputError
        for a reference or mask of another size, a mask that selects nothing, a camera that moved
        too far, and lamps that are not there or add no light.
    """
    fit = _Fit(scene, reference, mask, settings or FitSettings(), progress)
    return fit.run()


@dataclass(frozen=True, eq=False)
class _Fitted:
    """What the squares gave, and of what."""

    basis: Basis
    problem: Problem
    solution: Solution
    frame: Frame


class _Fit:
    """One run; what is read once stands here."""

    def __init__(
        self,
        scene: Scene | Prepared,
        reference: Any,
        mask: Any,
        settings: FitSettings,
        progress: Progress | None,
    ) -> None:
        self.settings = settings
        if isinstance(scene, Prepared):
            self.scene, self.prepared = None, scene
        else:
            check_photograph(scene)
            check_lamps(scene, settings.lamps)  # before files are read
            self.scene = scene.steady()
            self.prepared = prepare(self.scene)
        chosen = chosen_lamps(self.scene, self.prepared, settings)
        self.frame = self.prepared.frames[view_name(self.prepared, settings.view)]
        self.view = self._distorted_view()
        self.target = target_of(reference, self.frame, self.view, settings.align)
        self.settings = settings = settled(settings, self.prepared, self.frame, self.target)
        self.terms = terms_of(chosen, settings, self.prepared)
        self.mask = None if mask is None else mask_of(mask, self.view)
        self._check_response()
        self._drawn, self._progress = 0, progress
        self.white_cd_m2: float | None = None
        self._pictures = 3 + len(self.terms) * (2 if settings.response else 1)

    def run(self) -> LampFit:
        """Fits, under another response once more if that is better."""
        fitted = self._fitted()
        errors: Mapping[str, float] = {}
        chosen: Response | None = None
        if self.settings.response:
            kept = fitted.solution.kept
            errors = response_errors(fitted.problem, kept, self.cells, self.frame, self.target)
            chosen = best_response(errors, self.frame.response)
            if chosen != self.frame.response:
                self._decode(chosen)
                fitted = self._fitted()
        return self._result(self._with_white(fitted), errors, chosen)

    def _with_white(self, fitted: _Fitted) -> _Fitted:
        """The same in front of the white that lit shades tell, where the scene states none."""
        capture = None if self.scene is None else self.scene.capture
        if capture is None or capture.luminance_per_unit:
            return fitted
        self.white_cd_m2 = white_of_shades(fitted.frame, self.target.linear, self.target.seen)
        if self.white_cd_m2 is None:
            return fitted
        self._reframe(replace(self.frame, luminance_per_unit=self.white_cd_m2))
        painter = self._painter()
        terms, amounts = fitted.basis.terms, fitted.solution.amounts
        return replace(fitted, frame=painter.frame(terms, amounts, "with the white of shades"))

    def _fitted(self) -> _Fitted:
        painter = self._painter()
        none = np.zeros((len(self.terms), 3))
        dark = painter.frame(self.terms, none, "without lamps")
        self.cells = self._cells(painter.frame(self.terms, none + 1, "with all lamps"))
        basis = painter.basis(self.terms, dark, self.cells)
        step = 0
        while True:
            step += 1
            problem = self._problem(basis)
            solution = solve(problem)
            frame = painter.frame(basis.terms, solution.amounts, "with what was found")
            drawn = self.cells.of(painter.linear(frame))
            off = _relative(drawn - problem.predicted(solution.amounts), drawn)
            if off < LINEAR_WITHIN or step == MOST_STEPS:
                return _Fitted(basis, problem, solution, frame)
            basis = painter.around(basis, solution.amounts, drawn, self.cells)

    def _painter(self) -> Painter:
        settings = self.settings
        return Painter(
            self.prepared, settings.engine, settings.time_seconds, settings.view, self._step
        )

    def _step(self, what: str) -> None:
        self._drawn += 1
        self._pictures = max(self._pictures, self._drawn)
        if self._progress is not None:
            self._progress(self._drawn, self._pictures, what)

    def _cells(self, lit: Frame) -> Cells:
        """Cells of what lamps light, no lamps themselves, where both photographs say how bright."""
        surface, captured = lit.surface, lit.captured
        looked = surface.valid & ~surface.is_object & self.target.seen
        if lit.bodies is not None:
            looked &= ~(lit.bodies.cd_m2 > 0).any(axis=-1)
        if captured.clipped is not None:
            looked &= ~captured.clipped
        if self.mask is not None:
            looked &= self.mask
        if not looked.any():
            raise InputError(
                "there is no pixel to fit: where the mask selects, all are holes, clipped in the "
                "photograph, or not shown by the reference"
                if self.mask is not None
                else "there is no pixel to fit: all are holes or clipped",
                field="fit_mask" if self.mask is not None else "reference",
                remedy="select some of the lit surface",
            )
        white = self.target.white & looked[..., None]
        return cells_of(looked[..., None] & ~white, white)

    def _problem(self, basis: Basis) -> Problem:
        cells = self.cells
        height, width = cells.kept.shape[1:]
        places = (cells.rows * TILES // height) * TILES + cells.columns * TILES // width
        tiles = np.unique(places, return_inverse=True)[1]
        return Problem(
            basis.pictures,
            basis.offset,
            cells.of(self.target.linear),
            cells.of(np.asarray(self.frame.linear, np.float64)),
            cells.counts,
            cells.is_white,
            tiles,
            free_amounts(basis.terms, self.settings),
            ridge_of(basis.terms),
        )

    def _decode(self, response: Response) -> None:
        self.target = self.target.decoded(self.frame.response, response)
        self._reframe(decoded_frame(self.frame, response))

    def _reframe(self, frame: CameraFrame) -> None:
        name = frame.view.name
        self.prepared = replace(self.prepared, frames={**self.prepared.frames, name: frame})
        self.frame = frame

    def _distorted_view(self) -> View:
        """Where the pixels of the files look."""
        if self.scene is None:
            return self.frame.view
        return view_of(self.scene, self.frame.view.name, self.frame.view.shape)

    def _check_response(self) -> None:
        if not self.settings.response:
            return
        curves = self.scene is not None and self.scene.surface and self.scene.surface.response
        pictures = {} if self.scene is None else read_pictures(self.scene)
        encoded = all(picture.encoding == "srgb" for picture in pictures.values())
        if curves or not encoded or not self.target.is_encoded:
            raise InputError(
                "curves of surfaces belong to one response"
                if curves
                else "a picture of light has no response to choose",
                field="fit_response",
                remedy="leave it out",
            )

    def _result(
        self, fitted: _Fitted, errors: Mapping[str, float], chosen: Response | None
    ) -> LampFit:
        predicted = Painter.linear(fitted.frame)
        values = values_of(fitted.basis.terms, fitted.problem, fitted.solution)
        holes = ~fitted.frame.surface.valid
        fit = LampFit(
            lamps=values.lamps,
            dimming=values.dimming,
            fill=values.fill,
            response=self.frame.response,
            responses=errors,
            motion=self.target.motion,
            measures=errors_by_region(
                np.asarray(self.frame.linear, np.float64),
                predicted,
                self.target,
                self.mask,
                holes,
                self.frame.response,
            ),
            photograph=np.asarray(self.frame.linear, np.float64),
            reference=self.target.linear,
            predicted=predicted,
            mask=self.mask,
            compared=self.target.seen,
            holes=holes,
            rejected_share=fitted.solution.rejected_share,
            frame=fitted.frame,
            scene=self._fitted_scene(values, chosen),
            photometry=self.prepared.photometry,
            notes=(),
            luminance_per_unit=self.white_cd_m2,
        )
        return replace(fit, notes=notes_of(fit))

    def _fitted_scene(self, values: Values, chosen: Response | None) -> Scene | None:
        if self.scene is None:
            return None
        peaks = {
            lamp.owner: float(photometric(lamp.intensity_cd))
            for lamp in self.prepared.lamps(self.settings.time_seconds)
            if isinstance(lamp, GoniometricLamp)
        }
        fill = values.fill
        return fitted_scene(
            self.scene,
            {light.name: light.factor for light in values.lamps},
            peaks,
            fill_lux=None if fill is None else (fill.sky_lux, fill.ground_lux),
            dimming=None if values.dimming is None else values.dimming.factor,
            response=chosen,
            luminance_per_unit=self.white_cd_m2,
        )


def _relative(off: Float, values: Float) -> float:
    return float(np.sqrt((off**2).mean() / max((values**2).mean(), 1e-30)))
