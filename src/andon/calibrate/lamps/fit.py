"""Lamps fitted to a reference photograph: the order of work."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.lamps.cells import Cells, cells_of
from andon.calibrate.lamps.families import FAMILY, decoded_frame, response_errors
from andon.calibrate.lamps.measures import Measures, best_gain, best_gains, measured
from andon.calibrate.lamps.model import FitSettings, FittedFill, FittedLight, LampFit
from andon.calibrate.lamps.notes import notes_of
from andon.calibrate.lamps.solve import Problem, Solution, solve
from andon.calibrate.lamps.tables import check_lamps, fitted_scene
from andon.calibrate.lamps.target import Target, mask_of, target_of
from andon.calibrate.lamps.terms import Basis, Painter, Term
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
LINEAR_WITHIN, MOST_STEPS, SETTLED = 3e-3, 6, 2e-3


def fit_lamps(
    scene: Scene | Prepared,
    reference: Any,
    /,
    *,
    mask: Any = None,
    settings: FitSettings = FitSettings(),
    progress: Progress | None = None,
) -> LampFit:
    """How much light of which colour makes the scene's photograph look like `reference`.

    Parameters
    ----------
    scene : with a photograph; or what `prepare` made of one.
    reference : path or array (H, W, 3), encoded as the photograph or linear float, of the
        photograph's size and, as the photograph, not yet undistorted.
    mask : path or (H, W) bool; the fit looks at what is white. None: everywhere.
    progress : called with pictures drawn, pictures in all, and the name of the last.

    Raises
    ------
    InputError
        for a reference or mask of another size, a mask that selects nothing, a camera that moved
        too far, and lamps that are not there or add no light.
    """
    fit = _Fit(scene, reference, mask, settings, progress)
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
        self.scene = scene if isinstance(scene, Scene) else None
        if self.scene is not None:
            self.scene = self.scene.steady()
            _check_photograph(self.scene)
            chosen = check_lamps(self.scene, settings.lamps)
        self.prepared = scene if isinstance(scene, Prepared) else prepare(self.scene or scene)
        if self.scene is None:
            chosen = _chosen_of(self.prepared, settings)
        self.frame = self.prepared.frames[_view_name(self.prepared, settings.view)]
        self.view = self._distorted_view()
        self.terms = _terms(chosen, settings, self.prepared)
        self.target = target_of(reference, self.frame, self.view, settings.align)
        self.mask = None if mask is None else mask_of(mask, self.view)
        self._check_response()
        self._drawn, self._progress = 0, progress
        self._pictures = 3 + len(self.terms) * (2 if settings.response else 1)

    def run(self) -> LampFit:
        """Fits, under another response once more if that is better."""
        fitted = self._fitted()
        errors: Mapping[str, float] = {}
        chosen: Response | None = None
        if self.settings.response:
            errors = response_errors(fitted.problem, self.cells, self.frame, self.target)
            chosen = FAMILY[min(errors, key=lambda name: errors[name])]
            if chosen != self.frame.response:
                self._decode(chosen)
                fitted = self._fitted()
        return self._result(fitted, errors, chosen)

    def _fitted(self) -> _Fitted:
        settings = self.settings
        painter = Painter(
            self.prepared, settings.engine, settings.time_seconds, settings.view, self._step
        )
        none = np.zeros((len(self.terms), 3))
        dark = painter.frame(self.terms, none, "without lamps")
        self.cells = self._cells(painter.frame(self.terms, none + 1, "with all lamps"))
        basis = painter.basis(self.terms, dark, self.cells)
        for _ in range(MOST_STEPS):
            problem = self._problem(basis)
            solution = solve(problem)
            frame = painter.frame(basis.terms, solution.amounts, "with what was found")
            drawn = self.cells.of(painter.linear(frame))
            if _relative(drawn - problem.predicted(solution.amounts), drawn) < LINEAR_WITHIN:
                break
            basis = painter.around(basis, solution.amounts, drawn, self.cells)
        return _Fitted(basis, problem, solution, frame)

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
            _free(basis.terms, self.settings),
        )

    def _decode(self, response: Response) -> None:
        self.target = self.target.decoded(self.frame.response, response)
        frame = decoded_frame(self.frame, response)
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
        from andon.calibrate.lamps.values import values_of

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
            measures=self._measures(predicted, holes),
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
        )
        return replace(fit, notes=notes_of(fit))

    def _measures(self, predicted: Float, holes: Mask) -> dict[str, dict[str, Measures]]:
        """Errors by region; gains are the best where the fit may look."""
        photograph = np.asarray(self.frame.linear, np.float64)
        wanted, response = self.target.linear, self.frame.response
        looked = self.target.seen if self.mask is None else self.target.seen & self.mask
        pair = photograph[looked], wanted[looked]
        gains = {
            "gain_one": best_gain(*pair, response),
            "gain_channels": best_gains(*pair, response),
        }
        regions = {"whole": self.target.seen}
        if self.mask is not None:
            regions = {"inside": looked, "outside": self.target.seen & ~self.mask, **regions}
        regions |= {f"{name}_without_holes": region & ~holes for name, region in regions.items()}
        found: dict[str, dict[str, Measures]] = {}
        for name, region in regions.items():
            if not region.any():
                continue
            here = wanted[region]
            found[name] = {
                "fitted": measured(predicted[region], here, response),
                "unchanged": measured(photograph[region], here, response),
                **{
                    key: measured(gain * photograph[region], here, response, gain)
                    for key, gain in gains.items()
                },
            }
        return found

    def _fitted_scene(self, values: Any, chosen: Response | None) -> Scene | None:
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
        )


def _relative(off: Float, values: Float) -> float:
    return float(np.sqrt((off**2).mean() / max((values**2).mean(), 1e-30)))


def _free(terms: tuple[Term, ...], settings: FitSettings) -> Float:
    """(J, 3, P) which parameter is which amount."""
    columns: list[Float] = []
    for index, term in enumerate(terms):
        apart = settings.dimming == "channels" if term.kind == "dimming" else settings.colour
        for channels in [[0], [1], [2]] if apart else [[0, 1, 2]]:
            column = np.zeros((len(terms), 3))
            column[index, channels] = 1
            columns.append(column)
    return np.stack(columns, axis=-1)


def _terms(chosen: tuple[str, ...], settings: FitSettings, prepared: Prepared) -> tuple[Term, ...]:
    terms = [Term("lamp", name) for name in chosen]
    if settings.dimming != "off":
        if not all(prepared.ambient.dimming) or prepared.ambient.dimming_mode != "linear":
            raise InputError(
                "dimming that is fitted starts from light that is left, mode 'linear'",
                field="ambient.dimming",
                remedy="leave it out of the scene",
            )
        terms.append(Term("dimming", "dimming"))
    if settings.bounce:
        lux = float(prepared.ambient.mean_lux.mean())
        terms += [Term("sky", "light from above", lux), Term("ground", "light from below", lux)]
    if not terms:
        raise InputError(
            "there is nothing to fit: the scene has no lamp",
            field="fit_lamps",
            remedy="add a [[lamp]] or --lamp, or ask for dimming or bounce",
        )
    return tuple(terms)


def _chosen_of(prepared: Prepared, settings: FitSettings) -> tuple[str, ...]:
    known = dict.fromkeys(
        lamp.owner or lamp.name
        for lamp in prepared.lamps(settings.time_seconds)
        if lamp.owner not in prepared.sources
    )
    for name in settings.lamps or ():
        if name not in known:
            raise InputError(
                f"there is no lamp {name!r}, there are {', '.join(map(repr, known)) or 'none'}",
                field="fit_lamps",
            )
    return tuple(name for name in known if settings.lamps is None or name in settings.lamps)


def _check_photograph(scene: Scene) -> None:
    if not scene.has_photograph:
        raise InputError(
            "there is no photograph to fit",
            file=scene.file,
            field="capture.source",
            remedy='add [capture] with source = "photo.png"',
        )


def _view_name(prepared: Prepared, view: str | None) -> str:
    if view is None:
        return next(iter(prepared.frames))
    if view not in prepared.frames:
        raise InputError(
            f"there is no view {view!r}, this rig has {' and '.join(prepared.frames)}",
            field="view",
        )
    return view
