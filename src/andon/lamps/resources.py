"""Files that lamps name, read once: a frame does not read them again."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.cached import file_stamp, read_cached
from andon.lamps.coarse import coarse_corners
from andon.lamps.shells.model import KEPT, Drum, Shell
from andon.lamps.triangles import WELD, triangle_areas, welded
from andon.quantities import Geometry, photometric

if TYPE_CHECKING:
    from andon.scene import Scene
    from andon.scene.lamp_parts import Drum as DrumTable
    from andon.scene.lamp_parts import Shell as ShellTable

__all__ = ["Emitters", "lamp_emitters", "lamp_texture", "mesh_in_metres", "shell_of"]

Float = NDArray[np.float64]

# OBJ and PLY know no units and axes: theirs are the scene's. glTF is metres, +Y up.
UNITLESS_SUFFIXES = {".obj", ".ply"}
Y_UP_FROM_Z_UP = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
# A glowing picture is blurred by all that it lights: more texels cost memory and show nothing.
MAX_TEXTURE = 256
# Triangles that stand for a mesh as a lamp. A shell has 64 of luminances of their own; here flat
# neighbours shine alike, and most edges between them cost nothing.
MAX_FACETS = 96

# Transmittance, absorptance and mode of a shell.
_Paper = tuple[tuple[float, float, float], float, Literal["exact", "paper"]]


@dataclass(frozen=True, eq=False)
class Emitters:
    """A mesh as a lamp.

    Attributes
    ----------
    geometry : what is drawn, metres and world axes, its origin where it was.
    corners : (n, 3, 3) the triangles that shine for it.
    area_m2 : of `geometry`, one side.
    """

    geometry: Geometry
    corners: Float
    area_m2: float


class _Source(NamedTuple):
    """A mesh file as it is now, and how its numbers become metres with +Y up."""

    path: str
    stamp: tuple[int, int] | None
    scale: float
    z_up: bool


def _source(scene: Scene, reference: str, field: str) -> _Source:
    path = scene.path(reference, field)
    unitless = path.suffix.lower() in UNITLESS_SUFFIXES
    scale = scene.scene.metres_per_unit if unitless else 1.0
    return _Source(str(path), file_stamp(path), scale, unitless and scene.scene.up != "y")


def mesh_in_metres(scene: Scene, reference: str, field: str, /) -> Geometry:
    """A mesh file in its pose of rest, in metres with +Y up; not to be written to."""
    return _geometry(_source(scene, reference, field))


def lamp_emitters(scene: Scene, reference: str, field: str, /) -> Emitters:
    """A mesh file as a lamp. Raises `InputError` for one without area, or with tiny parts only."""
    return _emitters(_source(scene, reference, field))


def shell_of(scene: Scene, table: ShellTable, field: str, /) -> Shell:
    """The shell of a table; the same one as long as neither table nor file changes."""
    source = None if table.mesh is None else _source(scene, table.mesh, f"{field}.mesh")
    paper = table.transmittance, table.absorptance, table.mode
    return _shell(source, table.radius_m, _drum(table.drum), paper, table.real, table.margin_m)


def _drum(table: DrumTable | None) -> Drum | None:
    if table is None:
        return None
    top = table.radius_m if table.top_radius_m is None else table.top_radius_m
    drop = table.height_m / 2 if table.drop_m is None else table.drop_m
    return Drum(table.radius_m, top, table.height_m, drop)


def lamp_texture(scene: Scene, reference: str, field: str, /) -> Float:
    """(h, w, 3) linear factors whose photometric mean is 1, row 0 on top.

    Raises `InputError` for a black picture.
    """
    path = scene.path(reference, field)
    return read_cached(_texture, path)


@lru_cache(maxsize=KEPT)
def _geometry(source: _Source) -> Geometry:
    from andon.files.meshes import read_mesh

    read = read_mesh(source.path).geometry
    turn = Y_UP_FROM_Z_UP if source.z_up else np.eye(3)
    normals = None if read.normals is None else read.normals @ turn.T
    return replace(read, positions=source.scale * read.positions @ turn.T, normals=normals)


@lru_cache(maxsize=KEPT)
def _emitters(source: _Source) -> Emitters:
    geometry = _geometry(source)
    size = float(np.ptp(geometry.positions, axis=0).max())
    points, index = welded(geometry.positions, WELD * size)
    whole = triangle_areas(points[index[geometry.triangles]])
    if not whole.sum() > 0:
        raise InputError("has no triangle with an area", file=source.path)
    triangles = index[geometry.triangles][whole > 0]
    corners = coarse_corners(points, triangles, MAX_FACETS)
    return Emitters(geometry, corners, float(whole.sum()))


@lru_cache(maxsize=KEPT)
def _shell(
    source: _Source | None,
    radius_m: float | None,
    drum: Drum | None,
    paper: _Paper,
    real: bool,
    margin_m: float | None,
) -> Shell:
    mesh = None if source is None else _geometry(source)
    transmittance, absorptance, mode = paper
    t = np.array(transmittance)
    return Shell(radius_m, mesh, t, absorptance, mode, drum, real, margin_m)


def _texture(path: Path) -> Float:
    from andon.files.pictures import read_picture

    values = read_picture(path).linear()
    if not (np.isfinite(values).all() and (values >= 0).all()):
        raise InputError("has values that are negative or not finite", file=path)
    small = _smaller(values)
    mean = float(photometric(small).mean())
    if not mean > 0:
        raise InputError("is black: nothing on it can shine", file=path)
    return small / mean


def _smaller(values: Float) -> Float:
    """(h, w, 3) with means over equal blocks, such that no side exceeds `MAX_TEXTURE`."""
    down = _averaged(values) if len(values) > MAX_TEXTURE else values
    across = down.swapaxes(0, 1)
    return (_averaged(across) if len(across) > MAX_TEXTURE else across).swapaxes(0, 1)


def _averaged(values: Float) -> Float:
    """(`MAX_TEXTURE`, w, 3) means of equal shares of the rows (n, w, 3)."""
    count = len(values)
    ends = np.linspace(0, count, MAX_TEXTURE + 1)
    # The integral up to each end, with a share of the row in which the end lies.
    summed = np.zeros((count + 1, *values.shape[1:]))
    np.cumsum(values, axis=0, out=summed[1:])
    whole = np.minimum(ends.astype(int), count - 1)
    share = (ends - whole)[:, None, None]
    up_to = summed[whole] + share * (summed[whole + 1] - summed[whole])
    return np.diff(up_to, axis=0) * (MAX_TEXTURE / count)
