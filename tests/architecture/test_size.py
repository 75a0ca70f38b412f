"""Size is visible: files and functions stay short enough to be read whole."""

import ast
import statistics

import pytest

from .tree import PACKAGE, source_files

MAX_FILE_LINES, MEDIAN_FILE_LINES, MAX_WGSL_LINES = 400, 150, 150
MAX_FUNCTION_LINES, P90_FUNCTION_LINES = 60, 25
# The options of a command are its signature, one to three lines each, and say what help prints.
DECLARATIONS = {"cli/app.py": {"relight"}}


def lines_of(path):
    return len(path.read_text(encoding="utf-8").splitlines())


def function_lines():
    """(lines without the docstring, name, file) of every function."""
    for path in source_files():
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                continue
            lines = node.end_lineno - node.lineno + 1
            if ast.get_docstring(node) is not None:
                docstring = node.body[0]
                lines -= docstring.end_lineno - docstring.lineno + 1
            yield lines, node.name, str(path.relative_to(PACKAGE))


@pytest.mark.parametrize("path", source_files(), ids=lambda p: str(p.relative_to(PACKAGE)))
def test_file(path):
    assert lines_of(path) <= MAX_FILE_LINES


def test_median_file():
    assert statistics.median(lines_of(path) for path in source_files()) <= MEDIAN_FILE_LINES


def test_functions():
    long = [
        entry
        for entry in function_lines()
        if entry[0] > MAX_FUNCTION_LINES and entry[1] not in DECLARATIONS.get(entry[2], ())
    ]
    assert long == []


def test_most_functions():
    lengths = sorted(lines for lines, _, _ in function_lines())
    assert lengths[int(len(lengths) * 0.9)] <= P90_FUNCTION_LINES


@pytest.mark.parametrize(
    "path", sorted(PACKAGE.rglob("*.wgsl")), ids=lambda p: str(p.relative_to(PACKAGE))
)
def test_shader(path):
    assert lines_of(path) <= MAX_WGSL_LINES
