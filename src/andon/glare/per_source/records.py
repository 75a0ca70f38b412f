"""Host structs of sources, and what is drawn of them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.glare.model import Source
from andon.glare.per_source.coordinates import chord
from andon.glare.per_source.halos import HALO_STEPS
from andon.glare.per_source.reference import long_axes
from andon.glare.per_source.rings import Rings
from andon.glare.per_source.tables import COLUMNS, EDGE, EDGES, FAR_COLUMNS, ROWS, VeilTable
from andon.gpu.layout import HostStruct

__all__ = ["FAR", "HALO", "MIDDLE", "NEAR", "STRUCTS", "VEIL_SOURCE", "constants", "pack_source"]

# Rings, and the halo, as instances name them.
NEAR, MIDDLE, FAR, HALO = 0, 1, 2, 3

VEIL_SOURCE = HostStruct(
    "VeilSource",
    (
        ("direction", "vec3f"),  # unit, camera
        ("per_step", "f32"),  # 1/s
        ("right", "vec3f"),  # unit, along the long axis
        ("focus", "f32"),  # f
        ("down", "vec3f"),
        ("edge", "f32"),  # m0 of a circle
        ("light", "vec3f"),  # lx in units of the picture
        ("per_octave", "f32"),
        ("halo", "vec3f"),  # light of its ring
        ("row", "f32"),  # of a circle: row of the atlas, between two radii; else the first
        ("starts", "vec4f"),  # chords at which near, middle, far and halo start
        ("ends", "vec4f"),  # … and end
        ("samples", "vec4f"),  # along a side of a pixel
        ("edge_row", "f32"),  # of the texture of edges
        ("halo_end", "f32"),  # radians from the outline
    ),
)

STRUCTS = {VEIL_SOURCE.name: VEIL_SOURCE}


def constants() -> str:
    """WGSL that stands in for constants.wgsl."""
    numbers = {
        "EDGE": EDGE,
        "LAST_COLUMN": COLUMNS - 1,
        "FAR_COLUMNS": FAR_COLUMNS,
        "ROWS": ROWS,
        "EDGES": EDGES,
        "HALO_LAST": HALO_STEPS - 1,
    }
    return "\n".join(f"const {name}: f32 = {float(value)!r};" for name, value in numbers.items())


def pack_source(
    source: Source,
    table: VeilTable,
    rings: Rings,
    /,
    *,
    rows: tuple[float, float],
    halo: tuple[NDArray[np.float64], float, int],
    luminance_per_unit: float,
) -> NDArray[Any]:
    """One `VEIL_SOURCE`.

    Parameters
    ----------
    rows : of the atlas and of the edges' texture.
    halo : share of its ring per channel, the angle from the outline at which that ends (radians),
        samples along a side of a pixel.
    """
    right, down = long_axes(source, table)
    light = source.illuminance_lux / luminance_per_unit
    near, middle, far = rings.ends
    share, end, samples = halo
    reached = chord(min(float(source.outline.radii_radians.max()) + end, np.pi))
    return VEIL_SOURCE.pack(
        direction=source.direction,
        per_step=1 / table.step,
        right=right,
        focus=table.frame.focus,
        down=down,
        edge=table.edge[0],
        light=light,
        per_octave=table.per_octave,
        halo=light * share,
        row=rows[0],
        starts=(-1.0, near, middle, -1.0),
        ends=(near, middle, far, float(reached)),
        samples=(*rings.samples, samples),
        edge_row=rows[1],
        halo_end=max(end, 1e-6),
    )
