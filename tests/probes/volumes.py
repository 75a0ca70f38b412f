"""Small probe volumes for tests."""

import numpy as np

from andon.files.volumes import Distances, plain_volume
from andon.transport.probes.light import probe_light
from andon.transport.probes.visibility import distance_map
from worlds import unit

__all__ = ["POSITIONS", "light_of", "random_volume", "unit_vectors", "volume_at"]

FAR_M = 12.0


def unit_vectors(count, seed=0):
    return unit(np.random.default_rng(seed).normal(size=(count, 3)))


def lattice(count=4, spacing=1.0):
    steps = np.arange(count) * spacing
    return np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)


def scattered(count=60, seed=2):
    return np.random.default_rng(seed).uniform(0, 4, (count, 3))


POSITIONS = {
    "lattice": lattice(),
    "random": scattered(),
    "planar": scattered() * [1, 0, 1] + [0, 1.2, 0],
    "line": np.linspace(0, 1, 6)[:, None] * [3.0, 0.6, 1.1],
    "single": np.array([[1.0, 2.0, 0.5]]),
}


def volume_at(positions, coefficients, distances=None, zones=None):
    """`distances` are cube maps (n, 6, s, s) in metres."""
    pictures = None
    if distances is not None:
        pictures = Distances(*distance_map(distances, far_m=FAR_M), FAR_M)
    return plain_volume(positions, coefficients, state="day", zones=zones or (), distances=pictures)


def random_volume(positions, order=2, seed=0, zones=None):
    """Light and distances that differ from probe to probe, and nothing physical."""
    generator = np.random.default_rng(seed)
    count = len(positions)
    coefficients = generator.normal(size=(count, (order + 1) ** 2, 3)) * 30
    coefficients[:, 0] = generator.uniform(200, 300, (count, 3))
    distances = generator.uniform(0.5, 4, (count, 6, 8, 8))
    return volume_at(positions, coefficients, distances, zones)


def light_of(volume, *, walls=True):
    return probe_light(volume, dering=False, visibility=walls)
