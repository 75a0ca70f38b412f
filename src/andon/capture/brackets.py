"""Several photographs of one scene at different exposures: which pixels saw it, and how long.

A bracket is what `align` brings into one frame, `merge` makes light of, and exposure fusion makes
a picture of.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError

__all__ = ["Bracket", "border_of", "bracket_of", "check_exposures", "common_rectangle"]

Codes = NDArray[np.uint8]
Mask = NDArray[np.bool_]

# A border is a colour that no light has, along at least this share of one side of the picture.
BORDER_SHARE = 0.5
# Mean codes of two exposures may fall by as much, by noise and veils, though the time grew.
FALLING_CODES = 2.0


@dataclass(frozen=True)
class Bracket:
    """Photographs of one scene.

    Attributes
    ----------
    names : for messages.
    codes : n arrays (H, W, 3) uint8.
    seen : n masks (H, W), pixels that show the scene: no borders, nothing from beyond the edge.
    seconds : (n,) exposure, in seconds at one aperture and sensitivity; None where not known.
    """

    names: tuple[str, ...]
    codes: tuple[Codes, ...]
    seen: tuple[Mask, ...]
    seconds: NDArray[np.float64] | None = None

    @property
    def order(self) -> list[int]:
        """Indices from dark to bright: by exposure, or else by the mean code."""
        if self.seconds is not None:
            return [int(i) for i in np.argsort(self.seconds, kind="stable")]
        means = [codes[seen].mean() for codes, seen in zip(self.codes, self.seen, strict=True)]
        return [int(i) for i in np.argsort(means, kind="stable")]

    @property
    def middle(self) -> int:
        """Index of the reference: the middle one, the brighter of two."""
        return self.order[len(self.codes) // 2]

    def cropped(self, rows: slice, columns: slice) -> Bracket:
        """A rectangle of all photographs."""
        return replace(
            self,
            codes=tuple(codes[rows, columns] for codes in self.codes),
            seen=tuple(seen[rows, columns] for seen in self.seen),
        )


def bracket_of(
    names: Sequence[str], codes: Sequence[Codes], seconds: Sequence[float] | None = None, /
) -> Bracket:
    """The bracket of photographs (H, W, 3) uint8 of one size; borders are found.

    Raises `InputError` for a single photograph, sizes that differ, and a photograph with a border
    that leaves nothing of it.
    """
    if len(codes) < 2:
        raise InputError(
            "is one photograph, and no series of exposures",
            file=names[0] if names else None,
            remedy="name two or more of one scene, with different exposures",
        )
    first = codes[0].shape
    for name, picture in zip(names, codes, strict=True):
        if picture.shape != first:
            raise InputError(
                f"is {picture.shape[1]}×{picture.shape[0]} px but {names[0]} is "
                f"{first[1]}×{first[0]}",
                file=name,
                remedy="photographs of a bracket have one size and one orientation",
            )
    seen = tuple(~border_of(picture) for picture in codes)
    for name, mask in zip(names, seen, strict=True):
        if not mask.any():
            raise InputError("shows nothing but one pure colour", file=name, remedy="leave it out")
    times = None if seconds is None else np.asarray(seconds, np.float64)
    return Bracket(tuple(names), tuple(codes), seen, times)


def border_of(codes: Codes, /) -> Mask:
    """(H, W), pixels of a border that registration left: pure red, green, blue or a sum of two.

    Each channel is at an end of its range and not all at the same, so nothing is lost that says
    anything of light. Only what hangs together with the picture's rim, along half of one of its
    sides at least, is a border: a lamp that burns a channel out inside the picture is none.

    The memorial series of Debevec & Malik 1997 has such a border, in pure blue.
    """
    import cv2

    at_ends = ((codes == 0) | (codes == 255)).all(axis=-1)
    pure = at_ends & (codes.min(axis=-1) != codes.max(axis=-1))
    border = np.zeros(pure.shape, bool)
    for colour in np.unique(codes[_rim(pure)], axis=0) if _rim(pure).any() else ():
        same = (codes == colour).all(axis=-1)
        sides = (same[0], same[-1], same[:, 0], same[:, -1])
        if max(side.mean() for side in sides) < BORDER_SHARE:
            continue
        label: Any = cv2.connectedComponents
        parts: NDArray[np.int32] = label(same.astype(np.uint8), connectivity=8)[1]
        border |= np.isin(parts, np.unique(parts[_rim(same)]))
    return border


def _rim(mask: Mask) -> Mask:
    """The part of the mask that lies in the outermost rows and columns."""
    inside = np.zeros_like(mask)
    inside[1:-1, 1:-1] = True
    return mask & ~inside


def common_rectangle(seen: Sequence[Mask], /) -> tuple[slice, slice]:
    """Rows and columns of a large rectangle that all photographs saw.

    From the whole picture on, the side with the largest share of unseen pixels is taken off, until
    there is none: not always the largest rectangle, but so for borders that lie along the sides.
    Raises `InputError` where nothing is left.
    """
    unseen = ~np.logical_and.reduce(list(seen))
    top, bottom, left, right = 0, unseen.shape[0], 0, unseen.shape[1]
    while bottom > top and right > left:
        part = unseen[top:bottom, left:right]
        if not part.any():
            return slice(top, bottom), slice(left, right)
        shares = [side.mean() for side in (part[0], part[-1], part[:, 0], part[:, -1])]
        # Holes inside are reached from the side that is nearest to them in the end.
        worst = int(np.argmax(shares)) if max(shares) > 0 else _nearest_side(part)
        top, left = top + (worst == 0), left + (worst == 2)
        bottom, right = bottom - (worst == 1), right - (worst == 3)
    raise InputError("the photographs show no common part", remedy="leave out the one that moved")


def _nearest_side(part: Mask) -> int:
    rows, columns = np.flatnonzero(part.any(axis=1)), np.flatnonzero(part.any(axis=0))
    ends = (rows[0], part.shape[0] - 1 - rows[-1], columns[0], part.shape[1] - 1 - columns[-1])
    return int(np.argmin(ends))


def check_exposures(bracket: Bracket, /) -> None:
    """Refuses exposures from which no light can be told. Raises `InputError`.

    They must be known, > 0, not all the same, and agree with the photographs in which is brighter;
    and there must be pixels that are not clipped.
    """
    seconds = bracket.seconds
    if seconds is None:
        raise InputError(
            "exposure times are not known, and light cannot be told without them",
            field="--seconds",
            remedy="give --seconds 1/320,1/80,1/20 in the order of the photographs, or --list FILE",
        )
    if not (np.isfinite(seconds).all() and (seconds > 0).all()):
        raise InputError("exposures must be finite and > 0 s", field="--seconds")
    if seconds.max() <= seconds.min() * 1.01:
        raise InputError(
            f"all photographs are exposed for {seconds[0]:g} s: nothing is gained by them",
            field="--seconds",
            remedy="state the exposures if they differ, or fuse one photograph less",
        )
    both = np.logical_and.reduce(list(bracket.seen))
    _check_order(bracket, both)
    if all(
        _is_clipped(codes[seen]) for codes, seen in zip(bracket.codes, bracket.seen, strict=True)
    ):
        raise InputError("every pixel of every photograph is clipped, white or black")


def _check_order(bracket: Bracket, both: Mask) -> None:
    assert bracket.seconds is not None
    order = bracket.order
    means = [bracket.codes[i][both].mean() if both.any() else 0.0 for i in order]
    for dark, bright in zip(range(len(order) - 1), range(1, len(order)), strict=True):
        a, b = order[dark], order[bright]
        grew = bracket.seconds[b] > bracket.seconds[a] * 1.01
        if grew and means[bright] < means[dark] - FALLING_CODES:
            raise InputError(
                f"is darker (mean code {means[bright]:.1f}) than {bracket.names[a]} "
                f"({means[dark]:.1f}) though it is exposed longer, {bracket.seconds[b]:.4g} s "
                f"against {bracket.seconds[a]:.4g} s",
                file=bracket.names[b],
                remedy="give the exposures in the order of the photographs",
            )


def _is_clipped(codes: Codes) -> bool:
    return bool(((codes == 0) | (codes == 255)).all())
