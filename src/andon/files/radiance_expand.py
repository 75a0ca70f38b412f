"""Runs the programs that a trusted scene file of Radiance starts, and gives what they write."""

from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path

from andon.errors import InputError, MachineError
from andon.files.limits import Limits
from andon.files.radiance_programs import package_folder

__all__ = ["expanded"]

# Programs that write scenes take moments.
LIMIT_SECONDS = 300.0


def expanded(data: bytes, path: Path, limits: Limits) -> bytes:
    """The text `data` of the file `path` with the output of its programs in their place.

    They run once, in the folder of the file, and find Radiance's programs.

    Raises
    ------
    MachineError
        if Radiance is not installed.
    InputError
        if a program fails, takes too long, or writes too much.
    """
    folder = package_folder()
    environment = dict(
        os.environ,
        PATH=os.pathsep.join([str(folder / "bin"), os.environ.get("PATH", os.defpath)]),
        RAYPATH=os.pathsep.join([".", str(folder / "lib")]),
    )
    try:
        process = subprocess.Popen(
            [str(folder / "bin" / "xform")],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            cwd=path.parent,
            env=environment,
            start_new_session=True,
        )
    except OSError as error:
        raise MachineError(f"Radiance's xform cannot be started: {error}") from error
    try:
        out, errors = process.communicate(data, timeout=LIMIT_SECONDS)
    except subprocess.TimeoutExpired as error:
        raise InputError(
            f"must start programs that take less than {LIMIT_SECONDS:g} s", file=path
        ) from error
    finally:
        _end(process)
    _check(out, errors, process.returncode, path, limits)
    return out


def _end(process: subprocess.Popen[bytes]) -> None:
    """Ends what is left of it and of the programs that it started."""
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def _check(out: bytes, errors: bytes, code: int, path: Path, limits: Limits) -> None:
    # xform goes on when a program fails, and only mentions it.
    message = " ".join(errors.decode(errors="replace").split())
    if code != 0 or message:
        raise InputError(f"starts programs that fail: {message[:200] or f'code {code}'}", file=path)
    if len(out) > limits.max_text_bytes:
        raise InputError(
            f"must start programs that write at most {limits.max_text_bytes} bytes, "
            f"they wrote {len(out)}",
            file=path,
        )
