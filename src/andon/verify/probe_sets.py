"""Sets of probes that lookups are shown on: kind ones, and all that go wrong elsewhere."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.files.volumes import plain_volume
from andon.files.volumes.model import ProbeVolume, Zone

__all__ = ["clustered", "degenerate_sets", "full_sets", "lattice", "uniform", "volume_of"]

Float = NDArray[np.float64]


def lattice(side: int, /) -> Float:
    """(side³, 3) in the unit cube."""
    axis = np.linspace(0, 1, side)
    return np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)


def uniform(count: int, /) -> Float:
    """(count, 3) in the unit cube, seeded."""
    return np.random.default_rng(count).uniform(size=(count, 3))


def clustered(count: int, /) -> Float:
    """(count, 3) as an artist's: nine of ten around ten places, some of them tight."""
    generator = np.random.default_rng(count)
    places = generator.uniform(0.2, 0.8, (10, 3))
    sizes = 10.0 ** generator.uniform(-2.5, -1, (10, 1))
    number = generator.integers(0, 10, count)
    around = places[number] + sizes[number] * generator.normal(size=(count, 3))
    spread = generator.uniform(size=(count, 3))
    return np.where(generator.uniform(size=(count, 1)) < 0.9, np.clip(around, 0, 1), spread)


def volume_of(positions: Float, zones: tuple[Zone, ...] = (), /) -> ProbeVolume:
    """A volume of `positions` (n, 3) with random light in [0, 1) cd/m², seeded."""
    light = np.random.default_rng(27).uniform(size=(len(positions), 9, 3))
    return plain_volume(positions, light, zones=zones)


def _turn() -> Float:
    """A rotation about no axis in particular."""
    return np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]


def full_sets() -> dict[str, Float]:
    """Sets that fill space."""
    turned = lattice(6) @ _turn().T
    sphere = np.random.default_rng(6).normal(size=(400, 3))
    angles = np.arange(24) * np.pi / 12
    ring = np.column_stack([np.cos(angles), np.sin(angles)])
    drum = np.concatenate([np.column_stack([ring, np.full(24, z)]) for z in range(4)])
    return {
        "tetrahedron": np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]]),
        "cube": lattice(2),
        "lattice": lattice(7),
        "long lattice": lattice(5) * [100, 1, 3],
        "turned lattice": turned,
        "sphere": sphere / np.linalg.norm(sphere, axis=1, keepdims=True),
        "drum": drum,
        "uniform": uniform(500),
        "clustered": clustered(500),
    }


def degenerate_sets() -> dict[str, Float]:
    """Sets without volume, few probes, and a lattice that was rounded to float32."""
    turn = _turn().T
    plane = lattice(5)[:25] @ turn
    line = np.linspace(0, 1, 9)[:, None] ** 2 * turn[0]
    rounded = (lattice(6) @ turn + 3).astype(np.float32).astype(np.float64)
    return {
        "one": np.array([[1.0, 2, 3]]),
        "two": np.array([[1.0, 2, 3], [1, 2, 4]]),
        "three": uniform(3),
        "three in a row": np.array([[0.0, 0, 0], [2, 0, 0], [1, 0, 0]]),
        "plane": plane,
        "circle": np.column_stack([np.cos(np.arange(12)), np.sin(np.arange(12)), np.zeros(12)]),
        "line": line,
        "rounded lattice": rounded,
    }
