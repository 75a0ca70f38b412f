"""Probe volumes: light probes and the space between them, in one open file.

A binary glTF 2.0 file. Any viewer opens it and shows the probes as points and the cells as lines;
what the light is stands in an extension of our own, `ANDON_light_probes`, specified in
``docs/probe-volume.md``.

============================ =========================================================
alternative                  why not
============================ =========================================================
JSON and a binary beside it  two files that can be parted, and no viewer shows them
NumPy's .npz                 no browser reads it without a library, nothing says units
a lattice in a 3-D texture   probes stand where light changes, not on a lattice
EXT_lights_image_based       one light of the whole scene, with no place and no unit
============================ =========================================================

`model` says what a volume holds, `check` what must be true of it, `write` and `read` are the two
ways, `rounded` is what float32 makes of it.
"""

from __future__ import annotations

from andon.files.reader import Reader
from andon.files.volumes.check import check_volume
from andon.files.volumes.model import (
    Cells,
    Distances,
    ProbeRole,
    ProbeVolume,
    Zone,
    plain_volume,
)
from andon.files.volumes.read import read_volume
from andon.files.volumes.rounded import rounded
from andon.files.volumes.write import write_volume

__all__ = [
    "VOLUME_READERS",
    "Cells",
    "Distances",
    "ProbeRole",
    "ProbeVolume",
    "Zone",
    "check_volume",
    "plain_volume",
    "read_volume",
    "rounded",
    "write_volume",
]

VOLUME_READERS = (Reader("volume.glb", (".glb",), read_volume),)
