"""What may not stand in a tracked file."""

import re

import pytest

from .tree import ROOT, repository_files

# A path that only exists on somebody's machine. Preceded by a letter, a digit, a dot or a colon it
# is a part of a longer name or of an address.
MACHINE_PATH = re.compile(
    r"(?<![\w.:/~}$])/(?:home|root|Users|work|workspace|tmp|opt|mnt)/[\w.-]+|\b[A-Z]:\\Users\\"
)
UNFINISHED = re.compile(r"\b(?:TO" + r"DO|FIX" + r"ME|X" + r"XX)\b")


def texts():
    for path in repository_files():
        try:
            yield path, path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue  # a picture or a mesh


def places(pattern, *, inside=""):
    return [
        f"{path.relative_to(ROOT)}:{number}: {line.strip()[:100]}"
        for path, text in texts()
        if str(path.relative_to(ROOT)).startswith(inside)
        for number, line in enumerate(text.splitlines(), start=1)
        if pattern.search(line)
    ]


def test_repository_is_seen():
    names = {str(path.relative_to(ROOT)) for path, _ in texts()}
    assert {"pyproject.toml", "README.md", "dev", "src/andon/pipeline.py"} <= names


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("open('/" + "home/ann/photo.png')", True),
        ("C:" + "\\Users\\ann", True),
        ("https://example.org/home/ann", False),
        ("~/photo.png", False),
        ("usr/share/opt/x", False),
    ],
)
def test_the_pattern(line, expected):
    assert bool(MACHINE_PATH.search(line)) is expected


def test_no_machine_paths():
    assert places(MACHINE_PATH) == []


def test_nothing_is_left_unfinished():
    assert places(UNFINISHED, inside="src") == []
