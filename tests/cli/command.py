"""Runs the command line in this process, as a shell would see it."""

import os
from dataclasses import dataclass

import pytest

__all__ = ["PHOTOGRAPHED", "Outcome", "run_andon", "run_refused"]

# A scene of the files that `worlds.write_relight_files` writes.
PHOTOGRAPHED = """
[rig.camera]
fx = 57.6
[capture]
source = "photo.png"
[surface]
depth = "depth.npy"
[ambient]
illuminance_lux = 200.0
"""


@dataclass(frozen=True)
class Outcome:
    """Exit code, and what was printed."""

    code: int
    out: str
    err: str


def run_andon(capfd, *words):
    """`andon WORD…`; output is read from the file descriptors, so libraries' prints count too."""
    from andon.cli import main

    capfd.readouterr()
    with pytest.raises(SystemExit) as stop:
        main([str(word) for word in words])
    out, err = capfd.readouterr()
    return Outcome(stop.value.code or 0, out, err)


def run_refused(capfd, folder, *words, code=2):
    """The one line of a refusal: exit code 2, no traceback, and no file written or changed."""
    before = snapshot(folder)
    outcome = run_andon(capfd, *words)
    assert outcome.code == code, outcome.err
    lines = outcome.err.splitlines()
    assert len(lines) == 1, outcome.err
    assert lines[0].startswith("andon: "), lines[0]
    assert "Traceback" not in outcome.err
    assert outcome.out == ""
    assert snapshot(folder) == before, "something was written"
    return lines[0]


def snapshot(folder):
    """Every file below `folder` with its time and size."""
    found = {}
    for root, folders, files in os.walk(folder):
        for name in (*folders, *files):
            path = os.path.join(root, name)
            state = os.lstat(path)
            found[path] = (state.st_mtime_ns, state.st_size)
    return found
