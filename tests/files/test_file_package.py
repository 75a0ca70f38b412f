"""The package itself: cheap to import, one registry, explicit names."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import andon.files
from andon.errors import InputError
from andon.files import READERS, reader_for

HEAVY = ("cv2", "PIL", "OpenEXR", "yaml", "pydantic", "wgpu", "trimesh")


def test_importing_the_package_loads_no_heavy_library() -> None:
    code = f"import sys, andon.files; print([m for m in {HEAVY} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_public_names_are_sorted_and_exist() -> None:
    names = andon.files.__all__
    assert names == sorted(names, key=lambda name: (not name.isupper(), name[0].islower(), name))
    assert all(hasattr(andon.files, name) for name in names)


def test_reader_names_are_unique_and_suffixes_unambiguous_within_a_kind() -> None:
    names = [reader.name for reader in READERS]
    assert len(set(names)) == len(names)
    for kind in ("picture", "depth", "mesh", "camera"):
        suffixes = [s for reader in READERS if reader.kind == kind for s in reader.suffixes]
        assert len(set(suffixes)) == len(suffixes)


def test_reader_for_ignores_case_and_names_the_accepted_suffixes() -> None:
    assert reader_for("A.PNG", "picture").name == "picture.png"
    assert reader_for(Path("a.png"), "depth").name == "depth.png"
    with pytest.raises(InputError, match=r"of a mesh file must be one of \.glb, \.gltf, \.obj"):
        reader_for("a.stl", "mesh")
    with pytest.raises(InputError, match="got none"):
        reader_for("a", "mesh")
