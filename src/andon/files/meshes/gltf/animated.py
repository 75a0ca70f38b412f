"""A glTF mesh that moves: its vertices at any time of a clip."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError, nearest_name
from andon.files.meshes.gltf.bound import BoundMesh
from andon.files.meshes.gltf.clips import Clip
from andon.files.meshes.gltf.motion import NodeTree
from andon.quantities import Geometry

__all__ = ["AnimatedMesh"]

Float = NDArray[np.float64]


class AnimatedMesh:
    """Triangles, materials and texture coordinates that stay, and vertices that move.

    Attributes
    ----------
    file : where it was read from.
    geometry : the pose of the file: metres, +Y up.
    clips : its animations, in the order of the file; each has a `name` and `duration_seconds`.
    """

    def __init__(
        self,
        file: str,
        geometry: Geometry,
        clips: tuple[Clip, ...],
        mesh: BoundMesh,
        tree: NodeTree,
    ) -> None:
        self.file, self.geometry, self.clips = file, geometry, clips
        self._mesh, self._tree = mesh, tree

    def clip(self, name: str, /) -> Clip:
        """The clip of a name, else that of a number from 0 as text.

        Raises `InputError` that lists the names there are.
        """
        named = [clip for clip in self.clips if clip.name == name]
        if named:
            return named[0]
        if name.isascii() and name.isdigit() and int(name) < len(self.clips):
            return self.clips[int(name)]
        names = [clip.name for clip in self.clips]
        if not names:
            raise InputError("the file has no animation", file=self.file)
        near = nearest_name(name, names)
        listed = ", ".join(repr(known) for known in names)
        raise InputError(
            f"there is no animation {name!r}, the file has {listed}",
            file=self.file,
            remedy=f"did you mean {near!r}?" if near else "give one of them, or its number from 0",
        )

    def pose(self, clip: Clip, seconds: float, /) -> tuple[Float, Float | None]:
        """(n, 3) positions in metres and unit normals (n, 3) of all vertices, in file's world.

        `seconds` are those of the clip: before its first and after its last key it is held. No
        normals: triangles are flat. Where a vertex is flattened to nothing its normal is that of
        the pose of the file. Raises `InputError` where a position is not finite.
        """
        positions, normals = self._mesh.posed(*self._tree.at(clip, seconds))
        if not np.isfinite(positions).all():
            raise InputError(
                f"positions must be finite, at {seconds:g} s of {clip.name!r} one is not",
                file=self.file,
            )
        if normals is None:
            return positions, None
        length = np.sqrt(np.einsum("ni,ni->n", normals, normals))
        sound = (length > 0) & np.isfinite(length)
        if not sound.all():
            assert self.geometry.normals is not None
            normals = np.where(sound[:, None], normals, self.geometry.normals)
            length = np.where(sound, length, 1.0)
        return positions, normals / length[:, None]
