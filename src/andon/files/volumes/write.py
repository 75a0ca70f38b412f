"""A probe volume as a GLB file: the format of ``docs/probe-volume.md``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.atomic import write_bytes
from andon.files.volumes.check import check_volume
from andon.files.volumes.glb import ATTRIBUTES, INDICES, GlbArrays
from andon.files.volumes.layout import CONVENTIONS, EXTENSION, ROLES, VERSION
from andon.files.volumes.model import Cells, Distances, ProbeVolume
from andon.files.volumes.rounded import rounded

__all__ = ["volume_bytes", "write_volume"]

UNLIT = "KHR_materials_unlit"
POINTS, LINES = 0, 1  # mesh.primitive.mode


def write_volume(path: str | Path, volume: ProbeVolume) -> Path:
    """Writes a probe volume; the same volume gives the same bytes. Returns the path.

    Numbers are stored as float32; what is read again equals `rounded(volume)`.

    Raises
    ------
    InputError
        if the suffix is not ``.glb``, or the volume, rounded, breaks a rule of `check_volume`.
    MachineError
        if it cannot be written.
    """
    if Path(path).suffix.lower() != ".glb":
        raise InputError("a probe volume must have the suffix .glb", file=path)
    return write_bytes(path, volume_bytes(volume))


def volume_bytes(volume: ProbeVolume) -> bytes:
    """The bytes of the file that `write_volume` writes."""
    volume = rounded(volume)
    check_volume(volume)
    arrays = GlbArrays()
    positions = arrays.add(_float32(volume.positions), target=ATTRIBUTES, bounds=True)
    primitives = _primitives(volume, positions, arrays)
    return arrays.document(
        {
            "asset": {"version": "2.0", "generator": "Andon"},
            "extensionsUsed": [EXTENSION, UNLIT],
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"name": "light probes", "mesh": 0}],
            "meshes": [{"name": "light probes", "primitives": primitives}],
            "materials": [{"name": "light probes", "extensions": {UNLIT: {}}}],
            "extensions": {EXTENSION: _extension(volume, positions, arrays)},
        }
    )


def _float32(values: NDArray[Any]) -> NDArray[np.float32]:
    return np.ascontiguousarray(values, np.float32)


def _int32(values: NDArray[Any]) -> NDArray[np.int32]:
    return np.ascontiguousarray(values, np.int32)


def _extension(volume: ProbeVolume, positions: int, arrays: GlbArrays) -> dict[str, Any]:
    table: dict[str, Any] = {
        "version": VERSION,
        "conventions": CONVENTIONS,
        "photometry": volume.photometry,
        "order": volume.order,
        "positions": positions,
    }
    if not np.array_equal(volume.capture_positions, volume.positions):
        table["capturePositions"] = arrays.add(_float32(volume.capture_positions))
    roles = np.array([ROLES.index(role) for role in volume.roles], np.uint8)
    table |= {"names": list(volume.names), "roleNames": list(ROLES), "roles": arrays.add(roles)}
    limited = np.isfinite(volume.ranges_m)
    if limited.any():
        table["ranges"] = arrays.add(_float32(np.where(limited, volume.ranges_m, 0.0)))
    table["states"] = [
        {"name": name, "coefficients": arrays.add(_float32(values.reshape(-1, 3)))}
        for name, values in volume.states.items()
    ]
    table["zones"] = _zones(volume, arrays)
    if volume.cells is not None:
        table["cells"] = _cells(volume.cells, arrays)
    if volume.distances is not None:
        table["distances"] = _distances(volume.distances, arrays)
    table["notes"] = dict(volume.notes)
    return table


def _zones(volume: ProbeVolume, arrays: GlbArrays) -> list[dict[str, Any]]:
    tables: list[dict[str, Any]] = []
    for number, zone in enumerate(volume.zones):
        table: dict[str, Any] = {"name": zone.name, "probes": arrays.add(_int32(zone.probes))}
        if zone.boxes is not None:
            table["boxes"] = zone.boxes.tolist()
        if volume.cells is not None:
            table["cells"] = volume.cells.zone_cells[number].tolist()
            table["facets"] = volume.cells.zone_facets[number].tolist()
        tables.append(table)
    return tables


def _cells(cells: Cells, arrays: GlbArrays) -> dict[str, int]:
    table: dict[str, int] = {}
    if len(cells.corners):  # an accessor has one element or more
        table["corners"] = arrays.add(_int32(cells.corners))
        table["neighbours"] = arrays.add(_int32(cells.neighbours))
    table["facets"] = arrays.add(_int32(cells.facets))
    table["facetNeighbours"] = arrays.add(_int32(cells.facet_neighbours))
    table["facetCells"] = arrays.add(_int32(cells.facet_cells))
    return table


def _distances(distances: Distances, arrays: GlbArrays) -> dict[str, Any]:
    moments = np.stack([distances.mean_m, distances.mean_square_m2], axis=-1)
    return {
        "size": distances.mean_m.shape[-1],
        "far": distances.far_m,
        "moments": arrays.add(_float32(moments.reshape(-1, 2))),
    }


def _primitives(volume: ProbeVolume, positions: int, arrays: GlbArrays) -> list[dict[str, Any]]:
    """What any viewer shows: a coloured point for each probe, a line for each edge."""
    colours = arrays.add(_colours(volume), target=ATTRIBUTES)
    shared = {"attributes": {"POSITION": positions, "COLOR_0": colours}, "material": 0}
    primitives: list[dict[str, Any]] = [{**shared, "mode": POINTS}]
    if volume.cells is not None:
        edges = volume.cells.edges.astype(np.uint32)
        if len(edges):
            indices = arrays.add(edges.ravel(), target=INDICES)
            primitives.append({**shared, "mode": LINES, "indices": indices})
    return primitives


def _colours(volume: ProbeVolume) -> NDArray[np.float32]:
    """(n, 3) in 0…1: L/(L + the probes' median luminance), L the mean luminance of each channel.

    The mean over the sphere is L00·Y00 = L00/√(4π). For eyes only: nothing reads it again.
    """
    first = next(iter(volume.states.values()))
    mean = first[:, 0] / np.sqrt(4 * np.pi)
    middle = float(np.median(mean.mean(axis=1)))
    return _float32(mean / (mean + middle) if middle > 0 else np.where(mean > 0, 1.0, 0.0))
