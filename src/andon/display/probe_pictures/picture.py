"""From a probe volume and a point of view to a picture."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

from andon.display.probe_pictures.canvas import Canvas, Colour
from andon.display.probe_pictures.legend import STRIP_PX, Entry, legend, round_length
from andon.display.probe_pictures.model import Look, ProbePicture
from andon.display.probe_pictures.solids import (
    RING,
    draw_balls,
    draw_geometry,
    draw_hull,
    shown_light,
)
from andon.display.reference import tone_curve
from andon.errors import InputError
from andon.files.volumes.model import ProbeRole, ProbeVolume, simplex_edges
from andon.harmonics import deringed
from andon.quantities import Geometry
from andon.responses import SRGB, srgb_decode
from andon.spaces import View, look_at, pinhole_view, transform_points

__all__ = ["around_view", "framed_points", "probe_picture"]

Float = NDArray[np.float64]
Code = tuple[int, int, int]

OVERSAMPLING = 2
ROLES: Mapping[ProbeRole, Code] = {
    "general": (214, 210, 200),
    "sky": (98, 176, 255),
    "bounce": (150, 214, 88),
    "bleeding": (255, 120, 150),
}
CELL, HULL, GRAPH = (150, 205, 235), (255, 206, 110), (240, 140, 240)
ZONES: tuple[Code, ...] = ((255, 160, 60), (90, 220, 200), (210, 150, 255), (190, 220, 80))
CELL_PX, HULL_PX, GRAPH_PX, ZONE_PX = 1.1, 1.9, 1.3, 1.7
# Top and bottom of what lies behind everything, linear.
BACKGROUND = ((0.030, 0.036, 0.046), (0.010, 0.011, 0.013))
# Balls: of the usual distance between neighbours, but no more than this of the whole.
BALL_SHARE, BALL_MOST_SHARE = 0.2, 0.028
# Of what the balls show this share is at most as bright as the white that is chosen, and a
# diffuse white is shown a little below the screen's.
WHITE_PERCENTILE, WHITE_VALUE = 97.0, 0.9
FOV_DEGREES = 32.0
UP, BACK, PLAN = (0.0, 1.0, 0.0), (0.0, 0.0, -1.0), 1e-4
SLANT = (0.30, 0.46, 1.0)
# Share of the picture that a fitted view fills, in how many steps, and how near it may come.
FILLED, FIT_STEPS, NEAREST_EYE_M = 0.88, 12, 0.5
DEFAULT = Look()
# A single ball stands in so many times its own size.
LONELY = 4.0
# Sample directions for the exposure: corners, edges and faces of a cube.
_SIDES = np.array([d for d in product((-1.0, 0.0, 1.0), repeat=3) if any(d)])
SIDES = _SIDES / np.linalg.norm(_SIDES, axis=1, keepdims=True)


def around_view(
    points: Float,
    size: tuple[int, int],
    /,
    *,
    eye: Float | None = None,
    target: Float | None = None,
) -> View:
    """A view of `size` (width, height) that has all of `points` (n, 3) in it, or is as stated.

    Parameters
    ----------
    eye, target : (3,) where from and where to, metres; default: from the front, above and a
        little to the right; at the middle.
    """
    width, height = size
    if height <= STRIP_PX:
        raise InputError(f"must be more than {STRIP_PX} px high, got {height}", field="size")
    height -= STRIP_PX
    focal = height / 2 / np.tan(np.radians(FOV_DEGREES) / 2)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    if eye is None:
        back = np.array(SLANT) / np.linalg.norm(SLANT)
        eye, middle = _fitted(points, middle if target is None else target, back, focal, size)
        target = middle if target is None else target
    to = middle if target is None else target
    forward = to - eye
    # Straight up or down there is no upright: then what is at the back is at the top.
    level = np.hypot(forward[0], forward[2]) > PLAN * np.linalg.norm(forward)
    return pinhole_view(width, height, focal, look_at(eye, to, UP if level else BACK))


def framed_points(volume: ProbeVolume, geometry: Geometry | None = None, /) -> Float:
    """(n, 3) what a picture of a volume, and of the scene around it, has to have in it."""
    places = volume.positions
    reach = _radius(places) * (1 + RING) * (LONELY if len(places) == 1 else 1)
    cube = reach * np.array(list(product((-1.0, 1.0), repeat=3)))
    ends = (places[:, None] + cube).reshape(-1, 3)
    if geometry is None or not len(geometry.triangles):
        return ends
    return np.concatenate([ends, geometry.positions])


def _fitted(
    points: Float, target: Float, back: Float, focal: float, size: tuple[int, int]
) -> tuple[Float, Float]:
    """The nearest eye towards `back` that sees all points with a margin, and where it looks.

    Perspective moves the middle of what is seen off the middle of what there is: the target
    follows it.
    """
    frame = look_at(target + back, target)[:3, :3]
    half = FILLED * np.array([size[0], size[1] - STRIP_PX]) / 2 / focal
    middle, eye = target, target + back
    for _ in range(FIT_STEPS):
        x, y, z = ((points - middle) @ frame).T
        reach = np.maximum(np.abs(x) / half[0], np.abs(y) / half[1]) - z
        distance = max(float(reach.max()), NEAREST_EYE_M)
        eye = middle + back * distance
        across, down = x / (z + distance), y / (z + distance)
        aside = [(across.max() + across.min()) / 2, (down.max() + down.min()) / 2]
        middle = middle + frame[:, :2] @ np.array(aside) * distance
    return eye, eye - back


def probe_picture(
    volume: ProbeVolume,
    view: View,
    look: Look = DEFAULT,
    /,
    *,
    geometry: Geometry | None = None,
    state: str | None = None,
    caption: str = "",
) -> ProbePicture:
    """The volume as `view` sees it, with a legend of `STRIP_PX` rows below.

    Each pixel of a ball shows what its probe holds in the direction of the ball's normal there.

    Parameters
    ----------
    view : a pinhole view, of the picture without its legend.
    geometry : the scene around the probes, in plain shades; walls between the eye and the probes
        are left out, so that rooms can be looked into.
    state : of the volume; default: its first. A volume without states has white balls.
    caption : said first in the legend's second line.
    """
    large = view.resized(view.width * OVERSAMPLING, view.height * OVERSAMPLING)
    rows = np.linspace(0, 1, large.height)[:, None, None]
    top, bottom = (np.array(colour) for colour in BACKGROUND)
    canvas = Canvas(large, top + rows * (bottom - top))
    if geometry is not None and len(geometry.triangles):
        draw_geometry(canvas, geometry, volume.positions)
    light, white = _exposed(volume, state, look)
    if volume.cells is not None and "hull" in look.parts:
        draw_hull(canvas, volume.positions, volume.cells.facets, _linear(HULL))
    if "balls" in look.parts:
        rings = [_linear(ROLES[role]) for role in volume.roles]
        radius = look.radius_m or _radius(volume.positions)
        draw_balls(canvas, volume.positions, radius, light, rings, irradiance=look.irradiance)
    _draw_lines(canvas, volume, look)
    height, width = view.shape
    tiles = canvas.colour.reshape(height, OVERSAMPLING, width, OVERSAMPLING, 3)
    codes = SRGB.encode(np.clip(tone_curve(tiles, "hue").mean(axis=(1, 3)), 0, 1))
    picture = np.asarray(codes * 255 + 0.5, np.uint8)
    note = _note(volume, white, look, caption)
    strip = legend(width, _entries(volume, look), note, _scale(volume.positions, view))
    return ProbePicture(np.concatenate([picture, strip]), white)


def _linear(code: Code) -> Colour:
    red, green, blue = srgb_decode(np.array(code) / 255).tolist()
    return red, green, blue


def _exposed(volume: ProbeVolume, state: str | None, look: Look) -> tuple[Float | None, float]:
    """Display values as harmonics (n, k, 3), and the luminance of white in cd/m²."""
    if not volume.states:
        return None, float("nan")
    name = next(iter(volume.states)) if state is None else state
    if name not in volume.states:
        known = ", ".join(volume.states)
        raise InputError(f"there is no state {name!r}", field="state", remedy=f"it has {known}")
    held = volume.states[name]
    if (held[:, 0] >= 0).all():
        held = deringed(held, "irradiance" if look.irradiance else "luminance")
    units = look.units_per_cd_m2
    if units is None:
        shown = [shown_light(one, SIDES, irradiance=look.irradiance).max(axis=-1) for one in held]
        bright = float(np.percentile(np.array(shown), WHITE_PERCENTILE))
        units = WHITE_VALUE / bright if bright > 0 else 1.0
    return held * units, 1 / units


def _radius(positions: Float) -> float:
    """Metres: a share of the median distance to the nearest neighbour, bounded by the whole."""
    size = float(np.linalg.norm(np.ptp(positions, axis=0)))
    if len(positions) < 2 or size <= 0:
        return 0.1
    sample = positions[:: max(1, len(positions) // 512)]
    distance = np.linalg.norm(sample[:, None] - positions[None], axis=2)
    distance[distance <= 0] = np.inf
    usual = float(np.median(distance.min(axis=1)))
    return min(BALL_SHARE * usual, BALL_MOST_SHARE * size)


def _draw_lines(canvas: Canvas, volume: ProbeVolume, look: Look) -> None:
    cells, places = volume.cells, volume.positions
    if cells is not None:
        if "cells" in look.parts and len(cells.corners):
            ends = places[simplex_edges(cells.corners)]
            canvas.lines(ends, _linear(CELL), width_px=CELL_PX * OVERSAMPLING, ink=0.85)
        if "hull" in look.parts and len(cells.facets):
            ends = places[simplex_edges(cells.facets)]
            canvas.lines(ends, _linear(HULL), width_px=HULL_PX * OVERSAMPLING, ink=0.95)
        if "graph" in look.parts and len(cells.corners):
            ends = places[cells.corners].mean(axis=1)[cells.adjacent]
            canvas.lines(ends, _linear(GRAPH), width_px=GRAPH_PX * OVERSAMPLING)
    if "zones" in look.parts:
        for index, zone in enumerate(volume.zones):
            if zone.boxes is not None:
                ends = np.concatenate([_box_edges(box) for box in zone.boxes])
                colour = _linear(ZONES[index % len(ZONES)])
                canvas.lines(ends, colour, width_px=ZONE_PX * OVERSAMPLING)


def _box_edges(box: Float) -> Float:
    """(12, 2, 3) edges of a box (2, 3)."""
    corners = np.array(list(product((0, 1), repeat=3)))
    pairs = [
        (a, b) for a, b in combinations(range(8), 2) if np.abs(corners[a] - corners[b]).sum() == 1
    ]
    places = box[0] + corners * (box[1] - box[0])
    return np.asarray(places[np.array(pairs)], np.float64)


def _entries(volume: ProbeVolume, look: Look) -> list[Entry]:
    """What the first line of the legend says."""
    roles = sorted(set(volume.roles), key=list(ROLES).index)
    count = volume.count
    entries: list[Entry] = [(None, _counted(count, "probe", "probes"))]
    if "balls" in look.parts:
        entries += [(ROLES[role], f"{volume.roles.count(role)} {role}") for role in roles]
    cells = volume.cells
    if cells is not None:
        if "cells" in look.parts and len(cells.corners):
            entries.append((CELL, _counted(len(cells.corners), "tetrahedron", "tetrahedra")))
        if "hull" in look.parts and count > 2:
            entries.append((HULL, f"hull of {_counted(len(cells.facets), 'face', 'faces')}"))
        if "graph" in look.parts:
            pairs = len(cells.adjacent)
            entries.append((GRAPH, _counted(pairs, "pair of neighbours", "pairs of neighbours")))
    if "zones" in look.parts:
        entries += [
            (ZONES[index % len(ZONES)], zone.name)
            for index, zone in enumerate(volume.zones)
            if zone.boxes is not None
        ]
    return entries


def _counted(count: int, one: str, many: str) -> str:
    return f"{count} {one if count == 1 else many}"


def _note(volume: ProbeVolume, white: float, look: Look, caption: str) -> str:
    parts = [caption] if caption else []
    if volume.states:
        what = "irradiance/π" if look.irradiance else "luminance that arrives"
        unit = "cd/m²" if volume.photometry == "absolute" else "cd/m², relative"
        parts.append(
            f"balls: {what} from where they face; white is {float(f'{white:.3g}'):g} {unit}"
        )
    elif "balls" in look.parts:
        parts.append("no light captured yet")
    if volume.cells is None:
        parts.append("not joined to cells")
    return "; ".join(parts)


def _scale(positions: Float, view: View) -> tuple[float, float] | None:
    """Length of the scale bar in metres and in pixels, at the middle of the probes."""
    middle = (positions.min(axis=0) + positions.max(axis=0)) / 2
    depth = float(transform_points(view.camera_from_world, middle)[2])
    if depth <= 0:
        return None
    metres = round_length(0.16 * view.width * depth / view.fx)
    return metres, metres * view.fx / depth
