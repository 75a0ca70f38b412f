"""Luminaires as measured: how much light goes into which direction, in candela.

Two formats carry nearly all of what manufacturers publish:

======== ========== ================================================================
format   suffix     says
======== ========== ================================================================
LM-63    ``.ies``   IES, North America: candela, photometric types A, B and C
EULUMDAT ``.ldt``   Stockmar 1990, Europe: candela per 1000 lm of the lamps, type C
======== ========== ================================================================

The readers are ours: the parsers of renderers take what they need and guess the rest, which is how
a ballast factor gets lost, a floodlight of type B is drawn as if it were of type C, or a file cut
in half becomes a lamp with half of its light. Here every number is checked, candela stay *linear*
(some viewers store their roots), and what a file claims is compared with what it holds before
anything is allocated.

Sources: ANSI/IES LM-63-19 and its predecessors of 1986, 1991, 1995, 2002; Stockmar (1990),
EULUMDAT; EN 13032-1 and CIE 121 for the systems of planes.
"""

from __future__ import annotations

from pathlib import Path

from andon.files.limits import DEFAULT_LIMITS, Limits
from andon.files.photometry.eulumdat import read_ldt
from andon.files.photometry.lm63 import read_ies
from andon.files.photometry.model import Distribution, Tilt
from andon.files.reader import Reader, choose_reader

__all__ = ["PHOTOMETRY_READERS", "Distribution", "Tilt", "read_photometry"]

PHOTOMETRY_READERS = (
    Reader("photometry.ies", (".ies",), read_ies),
    Reader("photometry.ldt", (".ldt",), read_ldt),
)


def read_photometry(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> Distribution:
    """The distribution of an IES LM-63 or EULUMDAT file, chosen by its suffix.

    Raises
    ------
    InputError
        if the suffix is another, the file is cut short, an angle or a candela is impossible, or
        a count is wrong or too large; it names the file, the line and the rule.
    """
    found: Distribution = choose_reader(path, PHOTOMETRY_READERS, "photometric file").read(
        path, limits=limits
    )
    return found
