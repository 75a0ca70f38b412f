"""Every stage climbs three rungs: physics, parity, image; and argues in its docstring."""

import ast
import importlib

import pytest

from .tree import PACKAGE, TESTS

RUNGS = ("physics", "parity", "image")
# Shorter than this no package has said what, why, and instead of what.
ARGUMENT_CHARACTERS = 400


def stages():
    """Folders with a slow and a fast way of the same thing: they can be held against each other."""
    slow = {path.parent for path in PACKAGE.rglob("reference.py")}
    fast = {path.parent for path in PACKAGE.rglob("stage.py")}
    return sorted(slow & fast)


def test_the_stages_are_found():
    assert {"surface", "direct", "composite"} <= {folder.name for folder in stages()}


@pytest.mark.parametrize("rung", RUNGS)
@pytest.mark.parametrize("folder", stages(), ids=lambda folder: folder.name)
def test_rung(folder, rung):
    # Beside the tests of all other stages, or where the stage lies in the package.
    places = TESTS / folder.name, TESTS.joinpath(*folder.relative_to(PACKAGE).parts)
    paths = [place / f"test_{rung}.py" for place in places]
    path = next((path for path in paths if path.is_file()), None)
    assert path, f"{paths[1].relative_to(TESTS)} is missing"
    functions = [
        node
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")
    ]
    assert functions, "no test in it"
    for function in functions:
        assert can_fail(function), f"{function.name} asserts nothing"


def can_fail(function):
    """It has an assertion, expects an exception, or calls a helper that asserts."""
    for node in ast.walk(function):
        if isinstance(node, ast.Assert):
            return True
        if isinstance(node, ast.Call):
            name = ast.unparse(node.func).rpartition(".")[2]
            if name.startswith("assert") or name == "raises":
                return True
    return False


@pytest.mark.parametrize("folder", stages(), ids=lambda folder: folder.name)
def test_argument(folder):
    name = ".".join(["andon", *folder.relative_to(PACKAGE).parts])
    docstring = importlib.import_module(name).__doc__ or ""
    assert len(docstring) > ARGUMENT_CHARACTERS, f"{name} says what, but not why"
