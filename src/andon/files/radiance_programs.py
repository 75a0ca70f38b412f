"""Radiance's own programs, from the wheel `pyradiance`: found, run, their failures told."""

from __future__ import annotations

import os
import shutil
import subprocess
from importlib.util import find_spec
from pathlib import Path

from andon.errors import MachineError

__all__ = ["package_folder", "run_radiance"]

_INSTALL_REMEDY = "install it with: pip install 'andon[radiance]'"


def package_folder() -> Path:
    """Where the `pyradiance` wheel lies; it is found, not imported (0.3 s, and not needed)."""
    spec = find_spec("pyradiance")
    if spec is None or spec.origin is None:
        raise MachineError("Radiance's programs are missing", remedy=_INSTALL_REMEDY)
    return Path(spec.origin).parent


def run_radiance(program: str, arguments: list[str], feed: bytes, limit: float) -> bytes:
    """What one of Radiance's programs answers to `feed`.

    Raises `MachineError` if it is missing, fails or takes more than `limit` seconds.
    """
    folder = package_folder()
    path = shutil.which(program, path=str(folder / "bin"))
    if path is None:
        raise MachineError(
            f"Radiance's {program} is not in {folder / 'bin'}", remedy=_INSTALL_REMEDY
        )
    environment = dict(os.environ, RAYPATH=str(folder / "lib"))
    try:
        done = subprocess.run(
            [path, *arguments], input=feed, capture_output=True, env=environment, timeout=limit
        )
    except subprocess.TimeoutExpired as error:
        raise MachineError(
            f"Radiance's {program} took more than {limit:g} s", remedy="ask for fewer points"
        ) from error
    if done.returncode != 0:
        lines = done.stderr.decode(errors="replace").split("\n")
        message = " ".join(line.strip() for line in lines if line.strip())
        raise MachineError(f"Radiance's {program} failed ({done.returncode}): {message[:300]}")
    return done.stdout
