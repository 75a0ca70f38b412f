"""Which parts of a picture change as things move, so that the rest of it can stay as it is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.composite.lamp_pictures import body_rectangle
from andon.quantities import Geometry
from andon.spaces import View

__all__ = ["Changes", "Rectangle", "joined"]

Rectangle = tuple[int, int, int, int]


class Changes:
    """What has to be drawn of one view: at first all that matters, then what moving things touch.

    A pixel changes only where something moved away, came, or turned before the eye: within the
    rectangles of where it was when the view was drawn last, and of where it is now. What a thing
    does to the picture elsewhere (shadows) is not in such a picture.

    Parameters
    ----------
    view : stands still.
    still : (n, 3) world positions, metres, of each thing that stands still and matters.
    """

    def __init__(self, view: View, still: Sequence[NDArray[np.float64]]) -> None:
        self._view = view
        found = [body_rectangle(view, positions) for positions in still if len(positions)]
        self._first = [rectangle for rectangle in found if rectangle is not None]
        self._corners: list[NDArray[np.int32]] = []
        self._shown: list[tuple[Geometry, Rectangle | None]] = []
        self._begun = False

    def since_last(self, moving: Sequence[Geometry], /) -> list[Rectangle]:
        """(x, y, width, height) in pixels of all that changed since the last call; maybe none.

        `moving` are the things that move, where they are now: the same ones at each call, with
        the same triangles.
        """
        if not self._begun:
            self._begun = True
            # Files may hold vertices that no triangle has.
            self._corners = [np.unique(thing.triangles) for thing in moving]
            self._shown = [(thing, self._place(n, thing)) for n, thing in enumerate(moving)]
            return joined([*self._first, *_seen([place for _, place in self._shown])])
        touched: list[Rectangle | None] = []
        for number, ((before, place), now) in enumerate(zip(self._shown, moving, strict=True)):
            if not _same(before, now):
                here = self._place(number, now)
                touched += [place, here]
                self._shown[number] = (now, here)
        return joined(_seen(touched))

    def _place(self, number: int, thing: Geometry) -> Rectangle | None:
        corners = self._corners[number]
        return body_rectangle(self._view, thing.positions[corners]) if len(corners) else None


def _same(before: Geometry, now: Geometry) -> bool:
    if before is now:
        return True
    if before.normals is None or now.normals is None:
        turned = before.normals is not now.normals
    else:
        turned = not np.array_equal(before.normals, now.normals)
    return not turned and np.array_equal(before.positions, now.positions)


def _seen(rectangles: Sequence[Rectangle | None]) -> list[Rectangle]:
    return [rectangle for rectangle in rectangles if rectangle is not None]


def joined(rectangles: Sequence[Rectangle], /) -> list[Rectangle]:
    """The same pixels, or some more, in as many draws as cost least.

    Two rectangles become the one around both where that has no more pixels than they have
    together.
    """
    found: list[Rectangle] = []
    for rectangle in rectangles:
        own = rectangle
        partner = _partner(own, found)
        while partner is not None:
            found.remove(partner)
            own = _around(own, partner)
            partner = _partner(own, found)
        found.append(own)
    return found


def _partner(own: Rectangle, others: Sequence[Rectangle]) -> Rectangle | None:
    """One of the others that is better drawn together with `own`."""
    for other in others:
        if _area(_around(own, other)) <= _area(own) + _area(other):
            return other
    return None


def _around(a: Rectangle, b: Rectangle) -> Rectangle:
    left, top = min(a[0], b[0]), min(a[1], b[1])
    right, bottom = max(a[0] + a[2], b[0] + b[2]), max(a[1] + a[3], b[1] + b[3])
    return left, top, right - left, bottom - top


def _area(rectangle: Rectangle) -> int:
    return rectangle[2] * rectangle[3]
