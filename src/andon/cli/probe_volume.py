"""The probe volume that somebody names."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from andon.errors import InputError

if TYPE_CHECKING:
    from andon.files.volumes import ProbeVolume

__all__ = ["volume_of"]


def volume_of(file: Path, /) -> ProbeVolume:
    """Reads a volume. Raises `InputError` where it is none; of a scene it says which it names."""
    from andon.files.volumes import read_volume

    if file.suffix.lower() != ".toml":
        return read_volume(file)
    from andon.scene import load_scene

    scene = load_scene(file)
    if scene.probes is None:
        raise InputError("is a scene, and has no [probes]", file=file, remedy="name a volume, .glb")
    path = scene.path(scene.probes.volume, "probes.volume")
    raise InputError(
        f"is a scene; its volume is {path}",
        file=file,
        remedy=None if path.exists() else f"andon probes bake {file} writes it",
    )
