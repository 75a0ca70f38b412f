"""Probe volumes from strangers: GLB files with the extension of ``docs/probe-volume.md``."""

from __future__ import annotations

from pathlib import Path
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits, check_at_most
from andon.files.meshes.gltf.buffers import BufferStore
from andon.files.meshes.gltf.container import Document, open_document
from andon.files.tree import Tree
from andon.files.volumes.check import check_volume
from andon.files.volumes.layout import (
    CONVENTIONS,
    EXTENSION,
    MAX_SQUARE_PX,
    MAX_STATES,
    MAX_ZONES,
    ROLES,
    VERSION,
)
from andon.files.volumes.model import Cells, Distances, ProbeRole, ProbeVolume, Zone
from andon.quantities import Photometry

__all__ = ["read_volume"]

Float = NDArray[np.float64]
Int = NDArray[np.int32]
MAX_VERSION = 2**31
MAX_ORDER = 4


def read_volume(path: str | Path, *, limits: Limits = DEFAULT_LIMITS) -> ProbeVolume:
    """The probe volume of a .glb file, checked.

    Raises
    ------
    InputError
        if the file is damaged, has no probes, is of a newer version or other conventions, or
        breaks a rule of `check_volume`; it names the place and the rule.
    """
    document = open_document(path, limits)
    table = _extension(document)
    volume = _Reader(document, table).volume()
    check_volume(volume, file=str(path), limits=limits)
    return volume


def _extension(document: Document) -> Tree:
    extensions = document.root.get("extensions")
    table = extensions.get(EXTENSION) if extensions is not None else None
    if table is None:
        raise InputError(
            f"is a glTF file without probes: it has no extension {EXTENSION}",
            file=document.path,
            remedy="name a file that andon probes bake wrote",
        )
    version = table.at("version").integer(1, MAX_VERSION)
    if version > VERSION:
        raise table.error(
            f"is version {version} of the probe volume format, this Andon reads up to {VERSION}",
            "update Andon, or write the volume again with this one",
        )
    stated = table.at("conventions")
    for key, meaning in CONVENTIONS.items():
        found = stated.at(key)
        if found.text() != meaning:
            raise found.error(f"must be {meaning!r}, other conventions are not read here")
    return table


class _Reader:
    """Takes the parts of a volume from the extension's table and the file's arrays."""

    def __init__(self, document: Document, table: Tree) -> None:
        self._table, self._limits, self._file = table, document.limits, document.path
        self._buffers = BufferStore(document)
        self._taken = 0

    def volume(self) -> ProbeVolume:
        table = self._table
        positions = self._floats(table.at("positions"), "VEC3")
        count = len(positions)
        check_at_most(count, self._limits.max_probes, "probes", self._file)
        captured = table.get("capturePositions")
        ranges = table.get("ranges")
        zones = table.at("zones").elements()
        _check_count(table.at("zones"), len(zones), MAX_ZONES)
        return ProbeVolume(
            positions,
            positions if captured is None else self._floats(captured, "VEC3"),
            tuple(name.text() for name in table.at("names").elements()),
            self._roles(),
            np.full(count, np.inf) if ranges is None else self._ranges(ranges),
            self._states(count),
            tuple(self._zone(zone) for zone in zones),
            self._cells(zones),
            self._distances(count),
            self._photometry(),
            {key: value.text() for key, value in _entries(table.get("notes"))},
        )

    def _floats(self, index: Tree, kind: str) -> Float:
        """(count, width) float64 of a float accessor."""
        values = self._counted(self._buffers.accessor(index, (kind,)))
        if values.dtype.kind != "f":
            raise index.error("must be an accessor of floats")
        return values.astype(np.float64, copy=False)

    def _ints(self, index: Tree, kind: str) -> Int:
        """(count, width) of an accessor of uint32, whose bits are those of int32."""
        values = self._counted(self._buffers.accessor(index, (kind,)))
        if values.dtype != np.uint32:
            raise index.error("must be an accessor of component type 5125 (unsigned int)")
        return np.ascontiguousarray(values).view(np.int32)

    def _counted(self, values: NDArray[Any]) -> NDArray[Any]:
        """Arrays may share bytes in the file but not in memory: what they add up to counts."""
        self._taken += values.size
        check_at_most(self._taken, self._limits.max_pixels, "numbers in its arrays", self._file)
        return values

    def _roles(self) -> tuple[ProbeRole, ...]:
        known: dict[str, ProbeRole] = {role: role for role in ROLES}
        names: list[ProbeRole] = []
        for item in self._table.at("roleNames").elements():
            if item.text() not in known:
                raise item.error(f"must be one of {', '.join(ROLES)}, is {item.text()[:40]!r}")
            names.append(known[item.text()])
        index = self._table.at("roles")
        numbers: NDArray[Any] = self._buffers.accessor(index, ("SCALAR",))
        if numbers.dtype != np.uint8:
            raise index.error("must be an accessor of component type 5121 (unsigned byte)")
        if int(numbers.max()) >= len(names):
            raise index.error(f"must be below {len(names)}, the number of roleNames")
        return tuple(names[int(number)] for number in numbers[:, 0])

    def _ranges(self, index: Tree) -> Float:
        """(n,) metres; 0 stands for no limit, since glTF's floats are finite."""
        stored = self._floats(index, "SCALAR")[:, 0]
        return np.where(stored == 0, np.inf, stored)

    def _states(self, count: int) -> dict[str, Float]:
        terms = (self._table.at("order").integer(0, MAX_ORDER) + 1) ** 2
        entries = self._table.at("states").elements()
        _check_count(self._table.at("states"), len(entries), MAX_STATES)
        states: dict[str, Float] = {}
        for entry in entries:
            name, index = entry.at("name").text(), entry.at("coefficients")
            if name in states:
                raise entry.error(f"must have a name of its own, {name[:40]!r} is there already")
            values = self._floats(index, "VEC3")
            if len(values) != count * terms:
                raise index.error(
                    f"must have {count * terms} elements, {terms} for each of {count} probes, "
                    f"has {len(values)}"
                )
            states[name] = values.reshape(count, terms, 3)
        return states

    def _zone(self, entry: Tree) -> Zone:
        boxes = entry.get("boxes")
        corners = None
        if boxes is not None:
            listed = [[p.numbers(3) for p in _pair(box)] for box in boxes.elements()]
            corners = np.array(listed, np.float64).reshape(-1, 2, 3)
        probes = self._ints(entry.at("probes"), "SCALAR")[:, 0]
        return Zone(entry.at("name").text(), probes, corners)

    def _cells(self, zones: list[Tree]) -> Cells | None:
        table = self._table.get("cells")
        if table is None:
            return None
        none = np.zeros((0, 4), np.int32)
        has_cells = "corners" in table
        return Cells(
            self._ints(table.at("corners"), "VEC4") if has_cells else none,
            self._ints(table.at("neighbours"), "VEC4") if has_cells else none,
            self._ints(table.at("facets"), "VEC3"),
            self._ints(table.at("facetNeighbours"), "VEC3"),
            self._ints(table.at("facetCells"), "SCALAR")[:, 0],
            np.array([_run(zone.at("cells")) for zone in zones], np.int32),
            np.array([_run(zone.at("facets")) for zone in zones], np.int32),
        )

    def _distances(self, count: int) -> Distances | None:
        table = self._table.get("distances")
        if table is None:
            return None
        side = table.at("size").integer(1, MAX_SQUARE_PX)
        index = table.at("moments")
        moments = self._floats(index, "VEC2")
        if len(moments) != count * side * side:
            raise index.error(
                f"must have {count * side * side} elements, {side}×{side} for each of {count} "
                f"probes, has {len(moments)}"
            )
        mean, square = (
            moments[:, i].astype(np.float32).reshape(count, side, side) for i in range(2)
        )
        return Distances(mean, square, table.at("far").number(0.0))

    def _photometry(self) -> Photometry:
        entry = self._table.at("photometry")
        for word in get_args(Photometry):
            if entry.text() == word:
                return word
        raise entry.error(f"must be absolute or relative, is {entry.text()[:40]!r}")


def _check_count(place: Tree, count: int, most: int) -> None:
    if not 1 <= count <= most:
        raise place.error(f"must be 1…{most}, are {count}")


def _entries(table: Tree | None) -> list[tuple[str, Tree]]:
    return [] if table is None else [(key, table.at(key)) for key in table.table()]


def _pair(box: Tree) -> list[Tree]:
    corners = box.elements()
    if len(corners) != 2:
        raise box.error(f"must be two corners, are {len(corners)}")
    return corners


def _run(entry: Tree) -> tuple[int, int]:
    """The first and the count of a zone's cells."""
    numbers = [item.integer(0, 2**31 - 1) for item in entry.elements()]
    if len(numbers) != 2:
        raise entry.error(f"must be two numbers, first and count, are {len(numbers)}")
    return numbers[0], numbers[1]
