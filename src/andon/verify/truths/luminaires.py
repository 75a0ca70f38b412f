"""Candela of a photometric file as Radiance understands it: `ies2rad`, then rays at its lamp.

`ies2rad -i r` writes the distribution on a sphere of radius r around the origin, aimed along −Z
with C = 0 along +X: the frame of `andon.lamps.goniometry`. Seen from a direction the sphere has
the radiance I/(πr²·179). It multiplies by the file's multiplier, the ballast factor, for files of
1986 and 1991 the second factor, and its own ``-m``; lumens per lamp do not enter. Its data files
have six digits. Type A it refuses, and directions outside the file's angles it extrapolates.
"""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from andon.files.radiance_programs import run_radiance
from andon.transport.baked.radiance.text import LUMENS_PER_WATT

__all__ = ["radiance_candela"]

Float = NDArray[np.float64]

RADIUS_M = 0.05
LIMIT_SECONDS = 60.0


def radiance_candela(file: Path, directions: Float, /, *, multiplier: float = 1.0) -> Float:
    """(n,) cd towards unit directions (n, 3) in the luminaire's frame.

    Raises `MachineError` where Radiance is missing or refuses the file.
    """
    rays = np.concatenate([directions * 2, -directions], axis=1)
    feed = "\n".join(" ".join(map(repr, ray)) for ray in rays.tolist()).encode()
    with TemporaryDirectory() as name:
        folder = Path(name)
        lamp = ["-i", repr(RADIUS_M), "-t", "default", "-m", repr(multiplier), "-o", "lamp"]
        run_radiance("ies2rad", [*lamp, str(file.resolve())], b"", LIMIT_SECONDS, cwd=folder)
        # An illum is seen through, a light is not; only its place and size are wanted here.
        scene = (folder / "lamp.rad").read_text().replace(" illum ", " light ")
        (folder / "lamp.rad").write_text(scene)
        octree = run_radiance("oconv", ["lamp.rad"], b"", LIMIT_SECONDS, cwd=folder)
        (folder / "lamp.oct").write_bytes(octree)
        words = ["-h", "-ab", "0", "lamp.oct"]
        out = run_radiance("rtrace", words, feed, LIMIT_SECONDS, cwd=folder)
    radiance = np.array([line.split() for line in out.decode().splitlines()], np.float64)
    return radiance[:, 1] * np.pi * RADIUS_M**2 * LUMENS_PER_WATT
