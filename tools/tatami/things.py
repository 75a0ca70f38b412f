"""What stands in the room: a low table with tea things, cushions, a vase with a branch."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.verify.solids import Solid, icosphere, lathe
from tatami.building import ALCOVE_FLOOR
from tatami.shapes import Part, box, disc, smooth

Float = NDArray[np.float64]

TABLE = (0.02, 0.0, -0.12)
TABLE_RADIUS, TABLE_HEIGHT, BOARD = 0.44, 0.325, 0.028
CUSHIONS = (((-0.76, 0.0, 0.05), 84.0), ((0.62, 0.0, -0.66), -37.0))


def things() -> list[Part]:
    """All things, each where it stands."""
    top = (TABLE[0], TABLE_HEIGHT, TABLE[2])
    return [
        *_table(),
        *(_cushion().moved(at, yaw_degrees=yaw) for at, yaw in CUSHIONS),
        *(part.moved(_offset(top, 0.02, -0.05)) for part in _teapot()),
        *(part.moved(_offset(top, -0.20, 0.08)) for part in _bowl()),
        *(part.moved(_offset(top, 0.21, 0.12)) for part in _bowl()),
        *(part.moved((0.80, ALCOVE_FLOOR, -1.66)) for part in _vase()),
        _jar().moved((1.60, 0.802, -1.80)),
    ]


def _offset(at: tuple[float, float, float], x: float, z: float) -> Float:
    return np.asarray(at) + np.array([x, 0, z])


def _table() -> list[Part]:
    board = disc("wood.zelkova", TABLE_RADIUS, BOARD, 96).moved(
        (TABLE[0], TABLE_HEIGHT - BOARD, TABLE[2]), yaw_degrees=20
    )
    parts = [board]
    reach, under = 0.27, TABLE_HEIGHT - BOARD
    for sx in (-1, 1):
        x = sx * reach
        rail = box("wood.zelkova", (x - 0.011, under - 0.055, -reach), (x + 0.011, under, reach))
        parts.append(rail)
        across = box("wood.zelkova", (-reach, under - 0.05, x - 0.011), (reach, under, x + 0.011))
        parts.append(across)
        for sz in (-1, 1):
            z = sz * reach
            leg = box("wood.zelkova", (x - 0.024, 0.0, z - 0.024), (x + 0.024, under, z + 0.024))
            parts.append(leg)
    return [board, *(part.moved(TABLE, yaw_degrees=20) for part in parts[1:])]


def _cushion(side: float = 0.56, thick: float = 0.10, cells: int = 26) -> Part:
    """A zabuton: two puffed squares sewn at the edge, with a tuft in the middle."""
    s = np.linspace(-1, 1, cells + 1)
    s = (s + np.sin(np.pi / 2 * s)) / 2  # finer towards the seams
    x, z = np.meshgrid(s, s)
    puff = ((1 - x**4) * (1 - z**4)) ** 0.65
    tuft = 1 - 0.34 * np.exp(-(x**2 + z**2) / 0.02)
    pinch = 1 - 0.035 * (np.cos(np.pi * x / 2) + np.cos(np.pi * z / 2))
    height = thick / 2 * puff * tuft
    grid = np.stack([x * side / 2 * pinch, height, z * side / 2 * pinch], -1).reshape(-1, 3)
    below = grid * [1, -1, 1]
    index = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    # Diagonals run into the corners, where else both sheets would share a triangle.
    half = np.arange(cells) < cells / 2
    inward = (half[:, None] == half[None, :])[..., None]
    first = np.where(inward, np.stack([a, c, b], -1), np.stack([a, d, b], -1))
    second = np.where(inward, np.stack([a, d, c], -1), np.stack([b, d, c], -1))
    up = np.concatenate([first.reshape(-1, 3), second.reshape(-1, 3)])
    triangles = np.concatenate([up, up[:, ::-1] + len(grid)]).astype(np.int32)
    solid = Solid(np.concatenate([grid, below]) + np.array([0, thick / 2 - 0.004, 0]), triangles)
    return smooth("cloth.indigo", _welded(solid))


def _welded(solid: Solid) -> Solid:
    from andon.verify.solids import weld

    return Solid(*weld(solid.positions, solid.triangles), curved=True)


def _bowl() -> list[Part]:
    """A tea bowl, open, with tea in it."""
    radii = [0, 0.026, 0.028, 0.027, 0.029, 0.044, 0.053, 0.057, 0.058, 0.0575, 0.0545, 0.0525]
    heights = [0, 0.0, 0.001, 0.007, 0.009, 0.021, 0.038, 0.056, 0.070, 0.0715, 0.0705, 0.055]
    radii += [0.049, 0.040, 0.022, 0]
    heights += [0.036, 0.021, 0.013, 0.012]
    tea = disc("tea", 0.0495, 0.001, 40).moved((0, 0.038, 0))
    return [smooth("raku", lathe(radii, heights, 40)), tea]


def _teapot() -> list[Part]:
    """A side-handled pot: body with lid, spout, handle."""
    profile = [(0, 0.002), (0.040, 0.002), (0.056, 0.014), (0.066, 0.036), (0.064, 0.058)]
    profile += [(0.050, 0.074), (0.036, 0.080), (0.034, 0.084), (0.018, 0.089), (0.008, 0.091)]
    profile += [(0.011, 0.098), (0.009, 0.104), (0, 0.106)]
    body = smooth("raku", lathe(*np.array(profile).T, 44))
    spout = _tube([(0.055, 0.042, 0), (0.085, 0.060, 0), (0.108, 0.078, 0)], [0.015, 0.010, 0.007])
    handle = _tube([(0, 0.045, 0.058), (0, 0.062, 0.10), (0, 0.068, 0.145)], [0.009, 0.010, 0.013])
    turned = [part.moved((0, 0, 0), yaw_degrees=150) for part in (spout, handle)]
    return [body, *turned]


def _tube(
    path: list[tuple[float, float, float]],
    radii: list[float],
    material: str = "raku",
    sides: int = 14,
) -> Part:
    """A round bar along a polyline, its ends closed in points."""
    points = np.asarray(path, float)
    along = np.gradient(points, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    points, along = (np.concatenate([row[:1], row, row[-1:]]) for row in (points, along))
    sizes = np.array([0.0, *radii, 0.0])
    side = np.cross(along, [0.31, 0.0, 0.95])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    other = np.cross(along, side)
    turn = np.linspace(0, 2 * np.pi, sides + 1)[None, :, None]
    rings = side[:, None] * np.cos(turn) + other[:, None] * np.sin(turn)
    grid = points[:, None] + sizes[:, None, None] * rings
    index = np.arange(len(points) * (sides + 1)).reshape(len(points), sides + 1)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    triangles = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).reshape(-1, 3)
    return smooth(material, _welded(Solid(grid.reshape(-1, 3), triangles.astype(np.int32))))


def _vase() -> list[Part]:
    """A celadon vase with a plum branch."""
    profile = [(0, 0.0), (0.042, 0.0), (0.046, 0.006), (0.062, 0.05), (0.070, 0.095), (0.062, 0.14)]
    profile += [(0.036, 0.178), (0.022, 0.205), (0.021, 0.235), (0.028, 0.252), (0.024, 0.252)]
    profile += [(0.017, 0.235), (0.016, 0.20), (0, 0.195)]
    vase = smooth("celadon", lathe(*np.array(profile).T, 44))
    main = [(0.0, 0.20, 0.0), (0.025, 0.32, 0.01), (0.09, 0.42, 0.03), (0.12, 0.53, 0.02)]
    main += [(0.20, 0.60, 0.05), (0.25, 0.70, 0.04)]
    twig = [(0.09, 0.42, 0.03), (0.03, 0.50, 0.05), (-0.01, 0.60, 0.03), (-0.07, 0.66, 0.06)]
    small = [(0.12, 0.53, 0.02), (0.13, 0.62, 0.0), (0.10, 0.72, 0.01)]
    branches = [
        _tube(main, [0.008, 0.0075, 0.0065, 0.005, 0.004, 0.002], "bark", 7),
        _tube(twig, [0.0045, 0.004, 0.003, 0.0015], "bark", 6),
        _tube(small, [0.0035, 0.0025, 0.0012], "bark", 6),
    ]
    generator = np.random.default_rng(21)
    places = np.concatenate([_along(line) for line in (main[1:], twig[1:], small[1:])])
    chosen = places[generator.permutation(len(places))[:22]]
    blossoms = [
        smooth("blossom", icosphere(generator.uniform(0.006, 0.013), 2)).moved(
            place + generator.normal(0, 0.005, 3)
        )
        for place in chosen
    ]
    return [vase, *branches, *blossoms]


def _along(path: list[tuple[float, float, float]], steps: int = 7) -> Float:
    points = np.asarray(path)
    share = np.linspace(0, len(points) - 1, steps * (len(points) - 1))
    return np.stack([np.interp(share, np.arange(len(points)), points[:, k]) for k in range(3)], -1)


def _jar() -> Part:
    profile = [
        (0, 0.0),
        (0.030, 0.0),
        (0.034, 0.004),
        (0.046, 0.035),
        (0.044, 0.062),
        (0.030, 0.078),
    ]
    profile += [(0.031, 0.082), (0.033, 0.088), (0.020, 0.096), (0, 0.099)]
    return smooth("celadon", lathe(*np.array(profile).T, 36))
