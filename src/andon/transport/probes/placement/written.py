"""Places as tables of a scene, as locators, and in figures."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import MachineError
from andon.files.meshes.gltf import GltfNode
from andon.transport.probes.placement.model import Placed

__all__ = ["locators", "nearest_distances_m", "place_tables"]

Float = NDArray[np.float64]

# Written to a tenth of a millimetre: less than what makes two probes one.
DECIMALS = 4


def _rounded(point: Float) -> list[float]:
    return [value + 0.0 for value in np.round(point, DECIMALS).tolist()]  # −0 becomes 0


def place_tables(placed: Placed, /) -> list[dict[str, Any]]:
    """The entries of [[probes.place]] that place the same probes by hand; defaults left out."""
    return [_table(placed, index) for index in range(placed.count)]


def _table(placed: Placed, index: int) -> dict[str, Any]:
    position = _rounded(placed.positions[index])
    capture = _rounded(placed.capture_positions[index])
    table: dict[str, Any] = {"name": placed.names[index], "position": position}
    if capture != position:
        table["capture_position"] = capture
    if placed.roles[index] != "general":
        table["role"] = placed.roles[index]
    if np.isfinite(placed.ranges_m[index]):
        table["range_m"] = float(placed.ranges_m[index])
    panorama = placed.panoramas[index]
    if panorama is not None:
        table |= {
            "panorama": panorama.reference,
            "heading_degrees": panorama.heading_degrees,
            "luminance_per_unit": panorama.luminance_per_unit,
            "white": list(panorama.white),
        }
    return table


def locators(placed: Placed, /) -> tuple[GltfNode, ...]:
    """Nodes for a modelling program, whose names say the role; captures elsewhere are children.

    Read again as probes.placement.kind = ``nodes`` they are the same places and roles. Ranges and
    panoramas do not go along.
    """
    nodes: list[GltfNode] = []
    for index, (name, role) in enumerate(zip(placed.names, placed.roles, strict=True)):
        prefix = "probe" if role == "general" else f"probe_{role}"
        is_said = name.lower().startswith(prefix)
        nodes.append(_node(name if is_said else f"{prefix}_{name}", placed.positions[index]))
        if (placed.capture_positions[index] != placed.positions[index]).any():
            parent = len(nodes) - 1
            nodes.append(_node(f"capture_{name}", placed.capture_positions[index], parent))
    return tuple(nodes)


def _node(name: str, position: Float, parent: int = -1) -> GltfNode:
    matrix = np.eye(4)
    matrix[:3, 3] = position
    return GltfNode(name, matrix, parent)


def nearest_distances_m(positions: Float, /) -> Float:
    """(n,) metres from each of `positions` (n, 3), n > 1, to the nearest other one."""
    try:
        spatial: Any = import_module("scipy.spatial")
    except ImportError as error:
        raise MachineError(
            "SciPy is not installed", remedy="pip install 'andon[probes]'"
        ) from error
    distances = spatial.cKDTree(positions).query(positions, k=2)[0]
    return np.asarray(distances, np.float64)[:, 1]
