"""Test vectors of the lookup for other implementations: docs/vectors/probes-lookup.json.

Whoever looks light up in another tongue (a shader, TypeScript) reads the same volumes, asks at the
same points, and must get the same coefficients and the same irradiance, whichever cell it finds.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.files.volumes.model import Cells, ProbeVolume, Zone, plain_volume
from andon.harmonics import irradiance
from andon.transport.probes.cells import build_cells
from andon.transport.probes.space import ProbeSpace

__all__ = ["lookup_vectors", "publish"]

Float = NDArray[np.float64]

VERSION = 1
# Decimals of what is expected; others may compute in float32.
DECIMALS = 9
TOLERANCES = {"float64": 1e-8, "float32": 2e-5}


def publish(folder: Path) -> dict[Path, str]:
    """The published files in `folder` (docs) and their contents; nothing is written."""
    return {folder / "vectors" / "probes-lookup.json": _text(lookup_vectors())}


def lookup_vectors() -> dict[str, Any]:
    """The vectors as JSON values; docs/vectors/README.md says what they mean."""
    return {
        "format": "andon.probes.lookup",
        "version": VERSION,
        "tolerance": TOLERANCES,
        "volumes": [_volume(*entry) for entry in _volumes()],
    }


def _volumes() -> list[tuple[str, Float, tuple[Zone, ...]]]:
    axis = np.array([0.0, 1.0, 2.5])
    lattice = np.stack(np.meshgrid(axis, axis - 1, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    free = np.round(np.random.default_rng(4).uniform(-2, 2, (24, 3)), 3)
    plane = np.array([[x, 1 + 0.5 * x, z] for x in (0.0, 1, 2) for z in (0.0, 1, 3)])
    rooms = np.array(
        [[x, y, z] for x in (-1.5, -0.5, 0.5, 1.5) for y in (0.5, 2.0) for z in (-1.0, 1.0)]
    )
    number = np.arange(16, dtype=np.int32)
    boxes = np.array([[[-2.0, 0, -2], [0, 2.5, 2]], [[0.0, 0, -2], [2, 2.5, 2]]])
    return [
        ("tetrahedron", np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]]), ()),
        ("lattice", lattice, ()),
        ("free", free, ()),
        ("plane", plane, ()),
        ("line", np.outer([0.0, 1, 4], [1, 0, 0.5]), ()),
        ("single", np.array([[1.0, 2, 3]]), ()),
        (
            "two zones",
            rooms,
            (Zone("west", number[:8], boxes[:1]), Zone("east", number[8:], boxes[1:])),
        ),
    ]


def _volume(name: str, positions: Float, given: tuple[Zone, ...]) -> dict[str, Any]:
    count = len(positions)
    zones = given or (Zone("all", np.arange(count, dtype=np.int32)),)
    random = np.random.default_rng(len(name))
    light = np.round(random.normal(size=(count, 9, 3)), 3)
    light[:, 0] = np.round(np.abs(light[:, 0]) + 2, 3)
    cells = build_cells(positions, zones)
    volume = plain_volume(positions, light, zones=zones, cells=cells)
    return {
        "name": name,
        "positions": positions.tolist(),
        "coefficients": light.tolist(),
        "zones": [_zone(zone) for zone in zones],
        "cells": {key: getattr(cells, key).tolist() for key in Cells.__dataclass_fields__},
        "queries": _queries(volume, random),
    }


def _zone(zone: Zone) -> dict[str, Any]:
    boxes = None if zone.boxes is None else zone.boxes.tolist()
    return {"name": zone.name, "probes": zone.probes.tolist(), "boxes": boxes}


def _queries(volume: ProbeVolume, random: np.random.Generator) -> list[dict[str, Any]]:
    """What is expected at points in, on and outside the cells, and at the probes."""
    space, light = ProbeSpace(volume), volume.states["default"]
    points = _points(space, random)
    drawn: Float = random.normal(size=points.shape)
    normals = _unit(np.round(_unit(drawn), 6))
    mix = space.locate(points, engine="numpy")
    mixed = space.mixed(mix, light)
    columns = {
        "point": points,
        "inside": mix.cells >= 0,
        "normal": normals,
        "coefficients": np.round(mixed, DECIMALS),
        "irradiance": np.round(irradiance(mixed, normals), DECIMALS),
    }
    return [
        dict(zip(columns, row, strict=True))
        for row in zip(*(column.tolist() for column in columns.values()), strict=True)
    ]


def _unit(vectors: Float) -> Float:
    """Vectors (q, 3) at length 1."""
    length: Float = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / length


def _points(space: ProbeSpace, random: np.random.Generator) -> Float:
    """Multiples of 1/1024, so that float32 holds them; probes and middles of faces among them."""
    at, extent = space.positions, float(space.zone_extents.max())
    low, high = at.min(axis=0), at.max(axis=0)
    near = random.uniform(low - 0.1, high + 0.1, (8, 3))
    around = random.uniform(low - 1.5 * extent, high + 1.5 * extent, (8, 3))
    middles = at[space.facets[:3]].mean(axis=1)
    edges = at[space.facets[-3:, :2]].mean(axis=1)
    far = (low + high) / 2 + 100 * extent * np.array([[1, 0.25, -0.5], [-0.25, -1, 0.5]])
    return np.round(np.concatenate([near, around, middles, edges, at[:2], far]) * 1024) / 1024


def _text(vectors: dict[str, Any]) -> str:
    """JSON with one line a probe and a query: small differences stay small."""

    def lines(value: Any, depth: int) -> str:
        if depth == 0 or not isinstance(value, dict | list) or not value:
            return json.dumps(value)
        pad = "\n" + " " * (5 - depth)
        if isinstance(value, dict):
            items: dict[str, Any] = value  # pyright: ignore[reportUnknownVariableType]
            parts = [f"{json.dumps(key)}: {lines(item, depth - 1)}" for key, item in items.items()]
            return "{" + pad + ("," + pad).join(parts) + pad[:-1] + "}"
        entries: list[Any] = value  # pyright: ignore[reportUnknownVariableType]
        return "[" + pad + ("," + pad).join(lines(e, depth - 1) for e in entries) + pad[:-1] + "]"

    return lines(vectors, 4) + "\n"
