"""Many maps of many sizes on few pictures of one size: shelves, highest maps first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from andon.errors import MachineError

__all__ = ["Atlas", "Place", "atlas_of"]


@dataclass(frozen=True)
class Place:
    """Where a map lies: on which page, and its top left texel there."""

    page: int
    x: int
    y: int


@dataclass(frozen=True)
class Atlas:
    """Pages of one size, and where each map lies, in the order of the maps."""

    width: int
    height: int
    pages: int
    places: tuple[Place, ...]


def atlas_of(sizes: Sequence[tuple[int, int]], most_px: int, /) -> Atlas:
    """Places for maps of (height, width) texels on pages of at most `most_px` a side.

    Raises `MachineError` where a map alone is larger than a page.
    """
    largest = max((max(size) for size in sizes), default=1)
    if largest > most_px:
        raise MachineError(
            f"a baked map of {largest} px exceeds the adapter's {most_px} px",
            remedy="bake smaller maps (baked.map_size_px), or use --engine reference",
        )
    area = sum(height * width for height, width in sizes)
    across = min(max(largest, round(area**0.5)), most_px)
    order = sorted(range(len(sizes)), key=lambda i: (-sizes[i][0], -sizes[i][1], i))
    places: dict[int, Place] = {}
    page, x, y, shelf, width, height = 0, 0, 0, 0, 1, 1
    for index in order:
        own_height, own_width = sizes[index]
        if x + own_width > across:
            x, y, shelf = 0, y + shelf, 0
        if y + own_height > most_px:
            page, x, y, shelf = page + 1, 0, 0, 0
        places[index] = Place(page, x, y)
        x, shelf = x + own_width, max(shelf, own_height)
        width, height = max(width, x), max(height, y + own_height)
    return Atlas(width, height, page + 1, tuple(places[i] for i in range(len(sizes))))
