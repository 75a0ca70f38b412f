"""What is fitted, as terms whose pictures add: lamps, what is left of E0, light from all sides.

The renderer is a black box in linear light: the picture of a unit of a term is what it draws with
the unit, less what it draws without. That is exact while light adds, which it does but for curves
of surfaces and light that is taken away; there pictures are differences around the present amounts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from andon.calibrate.lamps.cells import Cells
from andon.engines.prepared import Prepared
from andon.errors import InputError
from andon.lamps import Body, HemisphereLamp, Lamp
from andon.lamps.kinds import brightened
from andon.pipeline import EngineName, Frame, Renderer

__all__ = ["FILL_NAME", "Basis", "Painter", "Term", "free_name", "prepared_with"]

Float = NDArray[np.float64]
UP, DARK = np.array([0.0, 1.0, 0.0]), np.zeros(3)
FILL_NAME = "bounce"
# Pictures of lamps are drawn with about as much light as E0, which no texture format rounds away;
# a lamp within this factor of that is drawn as it is.
NEAR_E0 = 10.0
# Of differences, in units: wide enough for what half floats round, narrow for curves.
STEP, LEAST_STEP = 0.1, 0.02


@dataclass(frozen=True)
class Term:
    """One thing that is fitted.

    Attributes
    ----------
    kind : ``lamp``, ``dimming``, or the ``sky`` or ``ground`` of the fill.
    name : of the lamp, or as `kind`.
    unit : one unit is so many times what the scene states of the lamp or of dimming; or so many lx.
    """

    kind: Literal["lamp", "dimming", "sky", "ground"]
    name: str
    unit: float = 1.0


@dataclass(frozen=True, eq=False)
class Basis:
    """Pictures as cells: `offset` (n, 3) of what is not fitted, `pictures` (J, n, 3) of units."""

    terms: tuple[Term, ...]
    offset: Float
    pictures: Float


def prepared_with(prepared: Prepared, terms: Sequence[Term], amounts: Float, /) -> Prepared:
    """The scene with `amounts` (J, 3) of the terms; lamps without light are left out."""
    pairs = [(term, term.unit * amount) for term, amount in zip(terms, amounts, strict=True)]
    factors = {term.name: value for term, value in pairs if term.kind == "lamp"}
    lux = {term.kind: value for term, value in pairs if term.kind != "lamp"}
    dimming = lux.get("dimming", np.ones(3))
    own = tuple(float(share) for share in dimming * np.asarray(prepared.ambient.dimming))

    def lamps(time_seconds: float) -> tuple[Lamp, ...]:
        lit = [
            _scaled(lamp, factors, dimming, prepared.sources)
            for lamp in prepared.lamps(time_seconds)
        ]
        shining = [lamp for lamp in lit if lamp is not None]
        name = free_name(FILL_NAME, [lamp.name for lamp in shining])
        return (*shining, *_filling(name, lux.get("sky", DARK), lux.get("ground", DARK)))

    def bodies(time_seconds: float) -> tuple[Body, ...]:
        return tuple(
            body.brightened(factors.get(body.name, 1.0)) for body in prepared.bodies(time_seconds)
        )

    ambient = replace(prepared.ambient, dimming=own)
    return replace(prepared, ambient=ambient, lamps=lamps, bodies=bodies)


def _scaled(
    lamp: Lamp, factors: dict[str, Float], dimming: Float, sources: tuple[str, ...]
) -> Lamp | None:
    name = lamp.owner or lamp.name
    factor = dimming if name in sources else factors.get(name)
    if factor is None or (factor == 1).all():
        return lamp
    return brightened(lamp, factor) if factor.any() else None


def _filling(name: str, sky_lux: Float, ground_lux: Float) -> tuple[Lamp, ...]:
    if not (sky_lux.any() or ground_lux.any()):
        return ()
    return (HemisphereLamp(name, UP, sky_lux, ground_lux, owner=name),)


def free_name(name: str, taken: Iterable[str], /) -> str:
    """`name`, or with as many primes as make it one that is not taken."""
    others = set(taken)
    while name in others:
        name += "'"
    return name


class Painter:
    """Draws a scene with amounts of terms, and counts what it has drawn.

    Parameters
    ----------
    done : is told after each picture what it was of.
    """

    def __init__(
        self,
        prepared: Prepared,
        engine: EngineName,
        time_seconds: float,
        view: str | None,
        done: Callable[[str], None],
    ) -> None:
        self.prepared = prepared
        self._engine: EngineName = engine
        self._time, self._view, self._done = time_seconds, view, done

    def frame(self, terms: Sequence[Term], amounts: Float, what: str, /) -> Frame:
        """The picture with `amounts` (J, 3)."""
        changed = prepared_with(self.prepared, terms, amounts)
        frame = Renderer(changed, self._engine).render(self._time, self._view)
        self._done(what)
        return frame

    @staticmethod
    def linear(frame: Frame, /) -> Float:
        """(H, W, 3) linear camera values of a frame."""
        cd_m2 = np.asarray(frame.luminance.cd_m2, np.float64)
        return cd_m2 / frame.captured.luminance_per_unit

    def basis(self, terms: Sequence[Term], dark: Frame, cells: Cells, /) -> Basis:
        """The offset and the pictures of all terms; `dark` was drawn without any.

        Raises `InputError` for a lamp that adds no light where the fit looks.
        """
        none = np.zeros((len(terms), 3))
        offset = cells.of(self.linear(dark))
        found = list(terms)
        pictures: list[Float] = []
        for index, term in enumerate(terms):
            amounts = none.copy()
            amounts[index] = 1
            frame = self.frame(terms, amounts, term.name)
            if term.kind == "lamp":
                level = self._level(frame, dark, cells, term.name)
                if not 1 / NEAR_E0 < level < NEAR_E0:
                    found[index] = replace(term, unit=term.unit / level)
                    frame = self.frame(found, amounts, term.name)
            pictures.append(cells.of(self.linear(frame)) - offset)
        return Basis(tuple(found), offset, np.stack(pictures))

    def _level(self, frame: Frame, dark: Frame, cells: Cells, name: str) -> float:
        """What the lamp adds where it adds much, as a share of E0."""
        added = np.asarray(frame.illuminance.lux, np.float64) - dark.illuminance.lux
        looked = (cells.open | cells.white).any(axis=-1)
        level = float(np.percentile(np.abs(added[looked]).max(axis=-1), 99))
        most = float(np.abs(added[looked]).max()) if level == 0 else level
        if most == 0:
            raise InputError(
                f"the lamp {name!r} adds no light to any pixel that the fit may look at",
                field="fit_lamps",
                remedy="leave it out, move it, or widen the mask",
            )
        return most / float(self.prepared.ambient.mean_lux.mean())

    def around(self, basis: Basis, amounts: Float, drawn: Float, cells: Cells, /) -> Basis:
        """The pictures as differences around `amounts` (J, 3), of which `drawn` (n, 3) is drawn."""
        pictures: list[Float] = []
        for index, term in enumerate(basis.terms):
            more = amounts.copy()
            step = np.maximum(STEP * amounts[index], LEAST_STEP)
            more[index] += step
            frame = self.frame(basis.terms, more, term.name)
            pictures.append((cells.of(self.linear(frame)) - drawn) / step)
        stacked = np.stack(pictures)
        offset = drawn - np.einsum("jnc,jc->nc", stacked, amounts)
        return Basis(basis.terms, offset, stacked)
