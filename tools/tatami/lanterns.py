"""Lanterns of their own: shades as one sheet each, a frame, and the CC0 paper lantern in metres.

All have their origin where the bulb is. The sheets are what `shell.mesh` wants: one layer, shared
vertices, counter-clockwise from outside.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.verify import solids
from tatami.files import write_obj, write_room
from tatami.shapes import Part, box, joined

Float = NDArray[np.float64]
Faces = NDArray[np.int64]

# The andon: half of its width, its paper's ends below and above the bulb, the bulb above the mats.
HALF, BELOW, ABOVE, FEET = 0.130, 0.165, 0.205, 0.27
POST, GAP = 0.014, 0.001
PANE = (6, 8)


def write_lanterns(folder: Path, lantern_set: Path) -> None:
    """Writes them all; `lantern_set` is JapaneseLantern/ of the CC0 set."""
    corners = HALF * np.array([(-1, 1), (1, 1), (1, -1), (-1, -1)])
    share = np.arange(PANE[0])[None, :, None] / PANE[0]
    around = corners[:, None] * (1 - share) + np.roll(corners, -1, 0)[:, None] * share
    points, faces = tube(around.reshape(-1, 2), np.linspace(-BELOW, ABOVE, PANE[1] + 1))
    write_obj(folder / "andon_shade.obj", points, faces, comment="four panes, open above and below")
    turn = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    circle = 0.17 * np.stack([np.cos(turn), -np.sin(turn)], -1)
    points, faces = tube(circle, np.linspace(-0.11, 0.11, 9))
    write_obj(folder / "drum_shade.obj", points, faces, comment="a drum, open above and below")
    closed = solids.box((0.24, 0.30, 0.24), (6, 8, 6))
    write_obj(folder / "box_lantern.obj", closed.positions, closed.triangles, comment="closed")
    write_room(folder / "andon_frame.glb", [frame()], {})
    _write_chochin(folder, lantern_set)


def tube(ring: Float, heights: Float) -> tuple[Float, Faces]:
    """A sheet over a ring (n, 2) of x and z, which runs counter-clockwise as seen from above."""
    count = len(ring)
    grid = np.empty((len(heights), count, 3))
    grid[..., [0, 2]] = ring
    grid[..., 1] = heights[:, None]
    i = np.arange(count)
    j = (i + 1) % count
    rows = np.arange(len(heights) - 1)[:, None] * count
    faces = np.stack([rows + i, rows + j, rows + j + count, rows + i + count], axis=-1)
    return grid.reshape(-1, 3), faces.reshape(-1, 4)


def frame() -> Part:
    """Posts, rails outside the paper, and a thin cross below that would hold the bulb."""
    inner = HALF + GAP
    outer = inner + POST
    bars: list[Part] = []
    for x in (-outer, inner):
        for z in (-outer, inner):
            post = ((x, -FEET, z), (x + POST, ABOVE + 0.012, z + POST))
            bars.append(box("frame", *post))
    for y in (-BELOW, ABOVE - 0.010):
        for side in (-outer + 0.002, inner):
            low, high = side, side + POST - 0.002
            bars.append(box("frame", (-inner, y, low), (inner, y + 0.010, high)))
            bars.append(box("frame", (low, y, -inner), (high, y + 0.010, inner)))
    for side in (-outer, inner):
        bars.append(box("frame", (side, -FEET, -inner), (side + POST, -FEET + 0.014, inner)))
    thin = 0.003
    bars.append(box("frame", (-inner, -BELOW, -thin), (inner, -BELOW + 0.006, thin)))
    return joined(bars)


def _write_chochin(folder: Path, source: Path) -> None:
    """The set's paper lantern: centimetres to metres, its middle at the origin."""
    lines = (source / "JapaneseLantern.obj").read_text(encoding="utf-8").splitlines()
    values = np.array([line.split()[1:4] for line in lines if line.startswith("v ")], float)
    values = (values - (values.min(0) + values.max(0)) / 2) * 0.01
    places = iter(values.tolist())
    text: list[str] = []
    for line in lines:
        if line.startswith("v "):
            x, y, z = next(places)
            text.append(f"v {x:.5f} {y:.5f} {z:.5f}")
        else:
            text.append("mtllib chochin.mtl" if line.startswith("mtllib") else line)
    (folder / "chochin.obj").write_text("\n".join(text) + "\n", encoding="utf-8")
    material = (source / "JapaneseLantern.mtl").read_text(encoding="utf-8")
    material = material.replace("JapaneseLantern.jpg", "chochin.jpg").replace(
        "JapaneseLantern.mtl", "chochin.mtl"
    )
    (folder / "chochin.mtl").write_text(material.rstrip() + "\n", encoding="utf-8")
    shutil.copyfile(source / "JapaneseLantern.jpg", folder / "chochin.jpg")
