"""Probes that somebody placed in a modelling program: the nodes of a glTF file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.meshes.gltf import GltfNode, read_gltf_nodes
from andon.files.volumes.model import ProbeRole
from andon.scene import Scene

__all__ = ["NodeProbes", "from_nodes", "role_of"]

Float = NDArray[np.float64]
PREFIX, CAPTURE = "probe", "capture"
ROLES: tuple[ProbeRole, ...] = ("sky", "bounce", "bleeding")


@dataclass(frozen=True, eq=False)
class NodeProbes:
    """Where they count and are captured (n, 3), metres, and their names and roles."""

    positions: Float
    capture_positions: Float
    names: tuple[str, ...]
    roles: tuple[ProbeRole | None, ...]


def role_of(name: str, /) -> ProbeRole | None:
    """The role that a node's name says: ``probe_sky.001`` is for the sky; None: it says none."""
    rest = name.lower().removeprefix(PREFIX).lstrip("_-. ")
    return next((role for role in ROLES if rest.startswith(role)), None)


def from_nodes(scene: Scene, reference: str, /) -> NodeProbes:
    """The nodes of a glTF file whose names begin with ``probe``, in the order of the file.

    Upper and lower case count as one. A node with such nodes below it is their group, and no
    probe. A child whose name begins with ``capture`` is where its parent is captured.

    Raises `InputError` where the file cannot be read or has no such node.
    """
    field = "probes.placement.file"
    path = scene.path(reference, field)
    if path.suffix.lower() not in (".gltf", ".glb"):
        raise InputError(
            f"only glTF files have nodes, got {path.name!r}",
            file=scene.file,
            field=field,
            remedy="use a .gltf or .glb file",
        )
    nodes = read_gltf_nodes(path)
    named = [node.name.lower().startswith(PREFIX) for node in nodes]
    groups = {_named_above(nodes, named, index) for index, is_named in enumerate(named) if is_named}
    chosen = [index for index, is_named in enumerate(named) if is_named and index not in groups]
    if not chosen:
        raise InputError(
            f"none of its {len(nodes)} nodes has a name that begins with {PREFIX!r}",
            file=path,
            remedy="name the locators probe…, probe_sky…, probe_bounce… or probe_bleeding…",
        )
    captured = {
        node.parent: node.position
        for node in reversed(nodes)
        if node.name.lower().startswith(CAPTURE)
    }
    return NodeProbes(
        np.array([nodes[index].position for index in chosen]),
        np.array([captured.get(index, nodes[index].position) for index in chosen]),
        tuple(nodes[index].name for index in chosen),
        tuple(role_of(nodes[index].name) for index in chosen),
    )


def _named_above(nodes: Sequence[GltfNode], named: Sequence[bool], index: int) -> int:
    """The nearest node above `index` that has a probe's name; −1: none."""
    above = nodes[index].parent
    while above >= 0 and not named[above]:
        above = nodes[above].parent
    return above
