"""Records what three.js's LightProbeGenerator makes of cube maps, for `andon verify probes.sh`.

    npm install three@0.187.0
    ANDON_DATA=… python tools/three_light_probe.py src/andon/verify/truths/three_light_probe.json

Runs `three_light_probe.mjs` in the working directory, where npm installed three.js.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from andon.harmonics import cube_from_latlong
from andon.verify.panoramas import CC0, panorama
from andon.verify.truths.three_light_probe import SIZE

SCRIPT = Path(__file__).with_suffix(".mjs")


def entry(name: str, folder: Path) -> dict[str, object]:
    """One panorama's cube map, as three.js sees it."""
    faces = cube_from_latlong(panorama(name), SIZE)
    path = folder / "faces.f32"
    path.write_bytes(np.ascontiguousarray(faces, "<f4").tobytes())
    command = ["node", str(SCRIPT), str(path), str(SIZE)]
    printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    means = faces.mean(axis=(1, 2), dtype=np.float64).ravel().tolist()
    return {"panorama": name, "face_means": means, **json.loads(printed)}


def main() -> None:
    """Writes the file that is named."""
    with tempfile.TemporaryDirectory() as folder:
        entries = [entry(name, Path(folder)) for name in CC0]
    Path(sys.argv[1]).write_text(json.dumps(entries, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
