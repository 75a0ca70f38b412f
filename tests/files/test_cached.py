"""Files are read once, and again when they change."""

import os

import pytest

from andon.errors import InputError
from andon.files.cached import file_stamp, read_cached


def test_once_until_it_changes(tmp_path):
    calls = []

    def reader(path):
        calls.append(path)
        return path.read_text(encoding="utf-8")

    path = tmp_path / "a.txt"
    path.write_text("one", encoding="utf-8")
    assert [read_cached(reader, path), read_cached(reader, path)] == ["one", "one"]
    assert len(calls) == 1
    path.write_text("three", encoding="utf-8")
    assert read_cached(reader, path) == "three"
    before = file_stamp(path)
    os.utime(path, ns=(1, 1))
    assert file_stamp(path) == (1, 5) != before
    read_cached(reader, path)
    assert len(calls) == 3
    assert read_cached(os.path.getsize, path) == 5


def test_errors_and_missing_files_are_not_kept(tmp_path):
    path, calls = tmp_path / "a.txt", []

    def refuse(path):
        calls.append(path)
        raise InputError("must be better", file=path)

    assert file_stamp(path) is None
    for _ in range(2):
        with pytest.raises(InputError, match="must be better"):
            read_cached(refuse, path)
    path.write_text("x", encoding="utf-8")
    for _ in range(2):
        with pytest.raises(InputError, match="must be better"):
            read_cached(refuse, path)
    assert len(calls) == 4
