"""Imports point one way, references know no GPU, and a word of help costs nothing."""

import ast
import json
import re
import subprocess
import sys
import tomllib

import pytest

from .tree import PACKAGE, ROOT, source_files

# What `import andon` may not load: everything that is heavier than NumPy.
HEAVY = {
    "cv2", "embreex", "fast_simplification", "mitsuba", "OpenEXR", "PIL", "pydantic", "pyradiance",
    "rich", "scipy", "typer", "wgpu", "yaml",
}  # fmt: skip


def contracts():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    return settings["tool"]["importlinter"]["contracts"]


def test_contracts_are_kept():
    check = (
        "import sys; from importlinter.cli import lint_imports; "
        "sys.exit(lint_imports(config_filename='pyproject.toml', cache_dir=None))"
    )
    done = subprocess.run([sys.executable, "-c", check], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"{len(contracts())} kept, 0 broken" in done.stdout


def test_architecture_tells_the_same_layers():
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    told = re.search(r"```text layers\n(.*?)```", text, re.DOTALL)
    assert told, "ARCHITECTURE.md has a block ```text layers"
    lines = [line.strip() for line in told[1].strip().splitlines()]
    layers = next(c for c in contracts() if c["type"] == "layers")["layers"]
    assert lines == [layer for layer in layers if layer != "__main__"]


@pytest.mark.parametrize(
    "path", sorted(PACKAGE.rglob("reference.py")), ids=lambda p: str(p.relative_to(PACKAGE))
)
def test_reference_names_no_gpu(path):
    imported = set(imports(path))
    gpu = {name for name in imported if re.match(r"(andon\.gpu|andon\.gbuffer|wgpu)\b", name)}
    stage = {name for name in imported if name.endswith(".stage")}
    assert not gpu | stage


def imports(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module or ""
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def test_absolute_imports_only():
    relative = [
        f"{path.relative_to(PACKAGE)}:{node.lineno}"
        for path in source_files()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ImportFrom) and node.level
    ]
    assert relative == []


def loaded_by(code):
    """Top-level names of the modules that a fresh interpreter has after `code`."""
    report = "\nimport json, sys; print('\\n' + json.dumps(sorted(sys.modules)))"
    done = subprocess.run(
        [sys.executable, "-c", code + report], capture_output=True, text=True, check=True
    )
    return {name.partition(".")[0] for name in json.loads(done.stdout.splitlines()[-1])}


def test_import_loads_nothing():
    assert not loaded_by("import andon") & (HEAVY | {"numpy"})


@pytest.mark.parametrize("name", ["View", "look_at", "Response", "Surface", "photometric"])
def test_light_names_load_numpy_only(name):
    loaded = loaded_by(f"from andon import {name}")
    assert "numpy" in loaded
    assert not loaded & HEAVY


def test_lamps_need_no_scene():
    assert not loaded_by("from andon import PointLamp, SpotLamp, SkyLamp") & HEAVY


@pytest.mark.parametrize("words", [["--help"], ["relight", "--help"], ["--version"]])
def test_help_loads_no_arrays(words):
    code = f"from andon.cli import main\ntry: main({words!r})\nexcept SystemExit: pass"
    # typer and rich print the help, and typer loads pydantic where it is installed
    assert not loaded_by(code) & (HEAVY - {"typer", "rich", "pydantic"} | {"numpy"})
