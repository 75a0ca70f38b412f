"""Looking light up between probes: cell, weights and a mix of 27 coefficients, beside SciPy."""

from __future__ import annotations

import importlib
from functools import partial
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from andon.bench.registry import BenchRow, Duel
from andon.errors import MachineError
from andon.transport.probes.delaunay import stretch
from andon.transport.probes.space import ProbeSpace
from andon.verify.probe_sets import clustered, lattice, uniform, volume_of
from andon.verify.registry import NotShown

__all__ = ["ROWS", "coherent_points", "random_points"]

Float = NDArray[np.float64]
Order = Literal["coherent", "random"]
Peer = Literal["find_simplex", "linear_nd"]

WIDTH, HEIGHT = 640, 360
# A point agrees if no coefficient, in [0, 1), is farther off.
NEAR = 1e-5
# Both join the same cells but where only noise decides (see `stretch`).
AGREED = 0.999

SETS = {
    "lattice_512": partial(lattice, 8),
    "uniform_100": partial(uniform, 100),
    "uniform_10000": partial(uniform, 10_000),
    "clustered_1000": partial(clustered, 1_000),
}
BARS: dict[Order, float] = {"coherent": 15.0, "random": 4.0}


def coherent_points() -> Float:
    """(q, 3) what the pixels of a picture see, row by row: a rolling surface in the unit cube."""
    v, u = np.mgrid[0.1 : 0.9 : HEIGHT * 1j, 0.1 : 0.9 : WIDTH * 1j]
    depth = 0.5 + 0.2 * np.sin(5 * u) * np.cos(3 * v)
    return np.stack([u, v, depth], axis=-1).reshape(-1, 3)


def random_points() -> Float:
    """(q, 3) anywhere in the unit cube, seeded."""
    return np.random.default_rng(8).uniform(size=(WIDTH * HEIGHT, 3))


def _duel(kind: str, order: Order, peer: Peer) -> Duel:
    """Ours in float32 by Numba; the peer has its usual float64. Points inside the hull only."""
    try:
        spatial: Any = importlib.import_module("scipy.spatial")
        interpolate: Any = importlib.import_module("scipy.interpolate")
        numba: Any = importlib.import_module("numba")
        positions = SETS[kind]()
        space = ProbeSpace(volume_of(positions))
    except (ImportError, MachineError) as error:
        raise NotShown(f"{error}; pip install andon[probes]") from error
    light = np.random.default_rng(27).uniform(size=(len(positions), 27))
    points = coherent_points() if order == "coherent" else random_points()
    points = points[space.locate(points).cells >= 0]
    # SciPy joins the same cells if it is given stretched points, and its queries likewise.
    seen = points @ stretch().T
    joined = spatial.Delaunay(positions @ stretch().T)
    single = light.astype(np.float32)
    if peer == "find_simplex":
        theirs = partial(_simplex_mix, joined, seen, light)
    else:
        interpolator = interpolate.LinearNDInterpolator(joined, light)
        theirs = partial(interpolator, seen)
    ours = partial(space.lookup, points, single, engine="numba")
    close = np.abs(ours() - theirs()).max(axis=1) <= NEAR
    return Duel(
        ours,
        theirs,
        float(close.mean()),
        AGREED,
        f"Numba {numba.__version__}, {numba.get_num_threads()} threads, {len(points)} points",
        peer_repeats=5,
    )


def _simplex_mix(joined: Any, points: Float, light: Float) -> Float:
    """(q, 27) as SciPy's manual does it: `find_simplex`, `transform`, and a mix in NumPy."""
    simplex = joined.find_simplex(points)
    transform = joined.transform[simplex]
    first = np.einsum("qij,qj->qi", transform[:, :3], points - transform[:, 3])
    weights = np.column_stack([first, 1 - first.sum(axis=1)])
    return np.einsum("qk,qkc->qc", weights, light[joined.simplices[simplex]])


PEERS: dict[Peer, str] = {
    "find_simplex": "SciPy find_simplex, weights and mix in NumPy",
    "linear_nd": "SciPy LinearNDInterpolator",
}

ROWS: tuple[BenchRow, ...] = tuple(
    BenchRow(
        f"probes.lookup.{order}.{kind}.{peer}",
        "probes",
        PEERS[peer],
        WIDTH * HEIGHT,
        partial(_duel, kind, order, peer),
        bar=BARS[order],
    )
    for order in BARS
    for kind in SETS
    for peer in PEERS
)
