"""What a killed bake has left half-written in its folder goes with the next; nothing else does."""

from pathlib import Path

import pytest

from andon.bake.tasks import Store
from andon.files.atomic import write_atomically

KEY = "ab" * 32


class Killed(BaseException):
    """Stands for a kill: nothing after it runs but what Python itself unwinds."""


def leave_half(path, monkeypatch):
    """Begins to write a file and is killed before the rename; what then lies in the folder."""

    def fill(temporary):
        temporary.write_bytes(b"half")
        raise Killed

    before = set(path.parent.iterdir())
    with monkeypatch.context() as patched:
        patched.setattr(Path, "unlink", lambda *_, **__: None)
        with pytest.raises(Killed):
            write_atomically(path, fill)
    (left,) = set(path.parent.iterdir()) - before
    return left


@pytest.mark.parametrize("name", [f"{KEY}.exr", "plan.json", "maps.json", "writable"])
def test_half_written_files_go(name, tmp_path, monkeypatch):
    left = leave_half(tmp_path / name, monkeypatch)
    store = Store(tmp_path, beside=("maps.json", "writable"))
    assert left.exists()
    with store.locked():
        assert not left.exists()


def test_other_peoples_files_stay(tmp_path, monkeypatch):
    others = [tmp_path / name for name in ("maps.json", ".maps.json.swp", ".plan.tmp", "a.tmp.exr")]
    for path in others:
        path.write_bytes(b"theirs")
    others.append(leave_half(tmp_path / "picture.png", monkeypatch))
    with Store(tmp_path, beside=("maps.json",)).locked():
        assert all(path.exists() for path in others)
