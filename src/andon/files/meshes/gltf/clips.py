"""glTF's animations as tracks of keyframes (glTF 2.0, section 3.11)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.files.limits import check_at_most
from andon.files.meshes.gltf.buffers import BufferStore
from andon.files.meshes.gltf.container import Document
from andon.files.meshes.gltf.keys import Interpolation, Track
from andon.files.tree import Tree

__all__ = ["Clip", "read_clips"]

Float = NDArray[np.float64]

WIDTHS = {"translation": 3, "rotation": 4, "scale": 3, "weights": 1}
KINDS: tuple[Interpolation, ...] = ("LINEAR", "STEP", "CUBICSPLINE")
# A path that an extension points with (KHR_animation_pointer); it has no node, which glTF says to
# leave out.
POINTER = "pointer"


@dataclass(frozen=True)
class Clip:
    """An animation of a file.

    Attributes
    ----------
    name : as in the file; of one without a name, its number from 0.
    duration_seconds : its last key; it begins at 0.
    tracks : what its nodes do.
    """

    name: str
    duration_seconds: float
    tracks: tuple[Track, ...]


def read_clips(
    document: Document, buffers: BufferStore, places: dict[int, int]
) -> tuple[Clip, ...]:
    """All animations of a file; `places`: number of a node in the file → its place.

    Nodes outside the scene, and channels without a node, move nothing (3.11). Raises `InputError`
    for times that do not rise, missing samplers, unknown paths and values that do not fit.
    """
    reader = _Reader(document, buffers)
    clips: list[Clip] = []
    for number, entry in enumerate(document.root.list_of("animations")):
        stated = entry.get("name")
        name = stated.text() if stated is not None and stated.text() else str(number)
        clips.append(_clip(name, reader.channels(entry), places))
    return tuple(clips)


@dataclass(frozen=True)
class _Channel:
    """One thing that one node does; channels of equal times share one array of them."""

    node: int
    path: str
    times: Float
    interpolation: Interpolation
    values: Float


def _clip(name: str, channels: list[_Channel], places: dict[int, int]) -> Clip:
    """Channels of the same times, path and interpolation become one track."""
    alike: dict[tuple[Any, ...], list[_Channel]] = {}
    for channel in channels:
        if channel.node in places:
            key = (channel.path, channel.interpolation, id(channel.times), channel.values.shape)
            alike.setdefault(key, []).append(channel)
    tracks = [
        Track(
            group[0].path,
            group[0].interpolation,
            group[0].times,
            np.array([places[channel.node] for channel in group]),
            np.stack([channel.values for channel in group], axis=-2),
        )
        for group in alike.values()
    ]
    # Also of nodes outside the scene: a clip is as long as the file says.
    return Clip(name, max((float(c.times[-1]) for c in channels), default=0.0), tuple(tracks))


class _Reader:
    """Reads the samplers of all clips, times that several share once."""

    def __init__(self, document: Document, buffers: BufferStore) -> None:
        self._document, self._buffers = document, buffers
        self._times: dict[int, Float] = {}
        self._equal: dict[bytes, Float] = {}
        self._numbers = 0

    def channels(self, entry: Tree) -> list[_Channel]:
        """The channels of an animation that have a node."""
        channels: list[_Channel] = []
        taken: set[tuple[int, str]] = set()
        most = len(self._document.root.list_of("nodes")) - 1
        samplers = entry.at("samplers").elements()
        if not samplers:
            raise entry.error("must have samplers, has none")
        for channel in entry.at("channels").elements():
            target = channel.at("target")
            path, node = target.at("path").text(), target.get("node")
            if path not in (*WIDTHS, POINTER):
                known = ", ".join(WIDTHS)
                raise target.error(f"must have a path of {known}, has {path[:20]!r}")
            sampler = samplers[channel.at("sampler").integer(0, len(samplers) - 1)]
            if node is None or path == POINTER:
                continue
            number = node.integer(0, most)
            if (number, path) in taken:
                raise target.error(f"must be the only one that moves the {path} of its node")
            taken.add((number, path))
            channels.append(self._channel(sampler, number, path))
        return channels

    def _channel(self, sampler: Tree, node: int, path: str) -> _Channel:
        stated = sampler.get("interpolation")
        wanted = stated.text() if stated is not None else "LINEAR"
        kind: Interpolation | None = next((k for k in KINDS if k == wanted), None)
        if kind is None:
            raise sampler.error(f"must be one of {', '.join(KINDS)}, is {wanted[:20]!r}")
        times = self._key_times(sampler.at("input"))
        values = self._values(sampler.at("output"), path, len(times), kind)
        return _Channel(node, path, times, kind, values)

    def _count(self, numbers: int) -> None:
        # The same bytes may stand behind many samplers: what they add up to is counted.
        self._numbers += numbers
        most = self._document.limits.max_vertices
        check_at_most(self._numbers, most, "numbers in animations", self._document.path)

    def _key_times(self, index: Tree) -> Float:
        """(k,) seconds; one array for all accessors of equal contents."""
        key = index.integer(0, 2**31)
        if key not in self._times:
            stored = self._buffers.accessor(index, ("SCALAR",))
            self._count(stored.size)
            times = _floats(stored, index)[:, 0]
            if times[0] < 0 or not (np.diff(times) > 0).all():
                raise index.error("must be times ≥ 0 that rise from key to key")
            self._times[key] = self._equal.setdefault(times.tobytes(), times)
        return self._times[key]

    def _values(self, index: Tree, path: str, keys: int, kind: Interpolation) -> Float:
        """(keys, w), or (keys, 3, w) for CUBICSPLINE."""
        width = WIDTHS[path]
        stored = self._buffers.accessor(index, ("SCALAR" if width == 1 else f"VEC{width}",))
        self._count(stored.size)
        rows = keys * (3 if kind == "CUBICSPLINE" else 1)
        # Weights have as many numbers a key as there are targets.
        fits = len(stored) % rows == 0 if path == "weights" else len(stored) == rows
        if not fits:
            raise index.error(f"must have {rows} values of {keys} keys, has {len(stored)}")
        shape = (keys, 3, -1) if kind == "CUBICSPLINE" else (keys, -1)
        values = _floats(stored, index).reshape(shape)
        if path == "rotation":
            length = np.linalg.norm(values[:, 1] if values.ndim == 3 else values, axis=-1)
            if not ((length > 1e-6) & (length < 1e6)).all():
                raise index.error("must be unit quaternions, one is not")
        return values


def _floats(stored: NDArray[Any], index: Tree) -> Float:
    if stored.dtype.kind != "f":
        raise index.error("must be floats, or normalised integers")
    if not np.isfinite(stored).all():
        raise index.error("must be finite")
    return np.ascontiguousarray(stored, np.float64)
