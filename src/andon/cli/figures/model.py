"""What all figures share: what was asked for, and what one of them is made of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.scatter import EngineName
from andon.observer.presets import adaptation_of
from andon.observer.pupil import watson_yellott_mm
from andon.observer.spread.model import Eye, Glasses

__all__ = ["FINER", "Asked", "Draw", "Figure", "Panel"]

Rgb = NDArray[np.uint8]

# So many pixels are drawn for one, each way: edges are smooth, and needles as thin as they are.
FINER = 2


@dataclass(frozen=True)
class Asked:
    """What the figures are drawn for.

    Attributes
    ----------
    width : pixels of a panel.
    engine : of what both engines can.
    age_years, glasses, glasses_dioptres : of the eye.
    seed : of its needles, and of leaves.
    model : name of its spread function.
    """

    width: int
    engine: EngineName = "auto"
    age_years: float = 25.0
    glasses: Glasses = "none"
    glasses_dioptres: float = 0.0
    seed: int = 0
    model: str = "cie135"

    def eye(self, level_cd_m2: float, /) -> Eye:
        """The eye, adapted to a luminance in cd/m²."""
        return Eye(
            self.age_years,
            pupil_mm=float(watson_yellott_mm(level_cd_m2, age_years=self.age_years)),
            glasses=self.glasses,
            glasses_dioptres=self.glasses_dioptres,
            adaptation=adaptation_of(level_cd_m2),
        )


@dataclass(frozen=True, eq=False)
class Panel:
    """One picture.

    Attributes
    ----------
    name : of its file.
    caption : above it on the sheet.
    picture : (H, W, 3) sRGB.
    """

    name: str
    caption: str
    picture: Rgb


@dataclass(frozen=True, eq=False)
class Figure:
    """One figure of the paper, or one beside it.

    Attributes
    ----------
    name : of the file with all its panels.
    title, term : in English, and the paper's own word.
    panels : in the order in which they stand on the sheet, side by side; all of one size.
    """

    name: str
    title: str
    term: str
    panels: tuple[Panel, ...]


# Draws figures that belong together; it calls its argument after each step.
Draw = Callable[[Asked, Callable[[], None]], tuple[Figure, ...]]
