"""Radiance's own programs, from the wheel `pyradiance`: found, run, their failures told."""

from __future__ import annotations

import os
import shutil
import subprocess
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

from andon.errors import MachineError

__all__ = ["package_folder", "radiance_version", "run_radiance"]

_INSTALL_REMEDY = "install it with: pip install 'andon[radiance]'"


def package_folder() -> Path:
    """Where the `pyradiance` wheel lies; it is found, not imported (0.3 s, and not needed)."""
    spec = find_spec("pyradiance")
    if spec is None or spec.origin is None:
        raise MachineError("Radiance's programs are missing", remedy=_INSTALL_REMEDY)
    return Path(spec.origin).parent


def radiance_version() -> str:
    """Of the wheel, "none" without it: what another version computes may differ."""
    try:
        return metadata.version("pyradiance")
    except metadata.PackageNotFoundError:
        return "none"


def run_radiance(
    program: str, arguments: list[str], feed: bytes, limit: float, *, cwd: Path | None = None
) -> bytes:
    """What one of Radiance's programs answers to `feed`.

    Parameters
    ----------
    program : its name, without a path.
    arguments : of its command line.
    feed : its standard input.
    limit : seconds that it may take.
    cwd : where it runs and looks for files without a path, before Radiance's own; None: here, and
        it finds Radiance's own alone.

    Raises `MachineError` if it is missing, cannot be started, fails or takes too long.
    """
    folder = package_folder()
    path = shutil.which(program, path=str(folder / "bin"))
    if path is None:
        raise MachineError(
            f"Radiance's {program} is not in {folder / 'bin'}", remedy=_INSTALL_REMEDY
        )
    try:
        done = subprocess.run(
            [path, *arguments],
            input=feed,
            capture_output=True,
            env=_environment(folder, cwd),
            timeout=limit,
            cwd=cwd,
        )
    except subprocess.TimeoutExpired as error:
        raise MachineError(
            f"Radiance's {program} took more than {limit:g} s", remedy="ask for fewer points"
        ) from error
    except OSError as error:
        raise MachineError(f"Radiance's {program} cannot be started: {error}") from error
    if done.returncode != 0:
        raise MachineError(f"Radiance's {program} {_how_it_ended(done.returncode, done.stderr)}")
    return done.stdout


def _environment(folder: Path, cwd: Path | None) -> dict[str, str]:
    # Radiance looks for names without a path in RAYPATH alone, so "." has to be named.
    path = [str(folder / "lib")] if cwd is None else [".", str(folder / "lib")]
    return dict(os.environ, RAYPATH=os.pathsep.join(path))


def _how_it_ended(code: int, errors: bytes) -> str:
    if code < 0:
        return f"was killed by signal {-code}"
    lines = errors.decode(errors="replace").split("\n")
    message = " ".join(line.strip() for line in lines if line.strip())
    return f"failed ({code}): {message[:300]}"
