"""What the tests of this folder look at: the files of the repository and the modules of Andon."""

import importlib
import pkgutil
import subprocess
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "src" / "andon"
TESTS = ROOT / "tests"


@cache
def source_files():
    """The package's Python files."""
    return tuple(sorted(PACKAGE.rglob("*.py")))


@cache
def module_names():
    """All modules of the package; `andon.__main__` would run."""
    import andon

    found = pkgutil.walk_packages(andon.__path__, "andon.")
    return tuple(m.name for m in found if not m.name.endswith("__main__"))


@cache
def modules():
    return tuple(importlib.import_module(name) for name in module_names())


@cache
def repository_files():
    """Files of the repository: tracked, or new and not ignored; in an archive: all."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    try:
        listed = subprocess.run(command, cwd=ROOT, capture_output=True, check=True).stdout
        names = [name for name in listed.decode().split("\0") if name]
    except (OSError, subprocess.CalledProcessError):
        names = [str(p.relative_to(ROOT)) for folder in ("src", "tests", "docs")
                 for p in (ROOT / folder).rglob("*") if "__pycache__" not in p.parts]  # fmt: skip
    return tuple(path for path in (ROOT / name for name in names) if path.is_file())
