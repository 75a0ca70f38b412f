"""docs/probe-volume.md: its example is what is written, its tables are what the code has."""

import json
import re
import struct
from pathlib import Path

import numpy as np
import pytest

from andon.files.volumes import Cells, ProbeVolume, Zone, read_volume
from andon.files.volumes.layout import (
    CONVENTIONS,
    EXTENSION,
    MAX_SQUARE_PX,
    MAX_STATES,
    MAX_ZONES,
    ROLES,
    VERSION,
)
from andon.files.volumes.write import volume_bytes
from volume_files import two_rooms

from .specimens import glb

MANUAL = Path(__file__).parents[2] / "docs" / "probe-volume.md"
EXAMPLE = re.compile(r"(<!-- example.*?-->\n```json\n)(.*?)(```)", re.DOTALL)


def example():
    """One tetrahedron over the origin, lit from all sides with 1, 2, 3 and 4 cd/m²."""
    positions = np.array([[1, 0, 0], [0, 0, 1], [0, 1, 0], [0, 0, 0]], float)
    turned = np.array([[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]], np.int32)
    if np.linalg.det((positions[:3] - positions[3]).T) < 0:
        positions[[0, 1]] = positions[[1, 0]]
    beyond = [[next(g for g in range(4) if g != f and edge <= set(turned[g].tolist()))
               for edge in ({*face} - {corner} for corner in face)]
              for f, face in enumerate(turned.tolist())]  # fmt: skip
    cells = Cells(
        np.array([[0, 1, 2, 3]], np.int32),
        np.array([[-1, -2, -3, -4]], np.int32),
        turned,
        np.array(beyond, np.int32),
        np.zeros(4, np.int32),
        np.array([[0, 1]], np.int32),
        np.array([[0, 4]], np.int32),
    )
    mean = np.arange(1, 5)[:, None, None] * np.ones((4, 1, 3))
    return ProbeVolume(
        positions,
        positions,
        ("a", "b", "c", "d"),
        ("general", "general", "general", "sky"),
        np.full(4, np.inf),
        {"default": mean * np.sqrt(4 * np.pi)},
        (Zone("all", np.arange(4, dtype=np.int32)),),
        cells,
        notes={"made": "by hand"},
    )


def document_of(data):
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def printed(document):
    """JSON with one line for each accessor, view and short list."""
    text = json.dumps(document, indent=1, ensure_ascii=False)
    return re.sub(r"[\[{][^\[\]{}]{0,120}[\]}]", lambda m: re.sub(r"\n\s*", " ", m[0]), text) + "\n"


def test_the_example_is_what_is_written(regenerate):
    text = MANUAL.read_text(encoding="utf-8")
    document, binary = document_of(volume_bytes(example()))
    found = EXAMPLE.search(text)
    assert found is not None
    if regenerate:
        text = text[: found.start(2)] + printed(document) + text[found.end(2) :]
        MANUAL.write_text(text, encoding="utf-8")
        return
    assert json.loads(found[2]) == document
    assert f"chunk behind it has {len(binary)} bytes" in text.replace("\n", " ")


def test_the_example_can_be_read(tmp_path):
    """From the page: its JSON, with the binary chunk that belongs to it."""
    found = EXAMPLE.search(MANUAL.read_text(encoding="utf-8"))
    assert found is not None
    path = tmp_path / "a.glb"
    path.write_bytes(glb(json.loads(found[2]), document_of(volume_bytes(example()))[1]))
    volume = read_volume(path)
    assert volume.names == ("a", "b", "c", "d")
    np.testing.assert_allclose(
        volume.states["default"][:, 0, 0] / np.sqrt(4 * np.pi), [1, 2, 3, 4], rtol=1e-7
    )


def test_every_key_is_explained_and_nothing_else():
    text = MANUAL.read_text(encoding="utf-8")
    section = text.partition("## The extension")[2].partition("## Conventions")[0]
    explained = set()
    for cell in re.findall(r"^\| (`[^|]*) \|", section, re.MULTILINE):
        explained |= set(re.findall(r"`([^`]+)`", cell))
    written = set()
    table = document_of(volume_bytes(two_rooms()))[0]["extensions"][EXTENSION]
    for key, value in table.items():
        written.add(key)
        if isinstance(value, dict) and key not in ("conventions", "notes"):
            written |= {f"{key}.{inner}" for inner in value}
        if isinstance(value, list) and isinstance(value[0], dict):
            written |= {f"{key}[].{inner}" for inner in value[0]}
    assert explained == written


@pytest.mark.parametrize(("key", "value"), CONVENTIONS.items())
def test_conventions_are_those_of_the_page(key, value):
    assert f"| `{key}` | `{value}` |" in MANUAL.read_text(encoding="utf-8")


def test_numbers_of_the_page():
    text = MANUAL.read_text(encoding="utf-8")
    assert f"format, version {VERSION}\n" in text
    for part in (f"| 1…{MAX_STATES} objects", f"| 1…{MAX_ZONES} objects", f"1…{MAX_SQUARE_PX} |"):
        assert part in text
    assert ", ".join(f"`{role}`" for role in ROLES) in text
