"""Coefficients by three.js's own LightProbeGenerator, as it printed them.

``tools/three_light_probe.py`` records them, by `three_light_probe.mjs` beside it: three.js r187 in
Node, on cube maps of 128² made from CC0 panoramas. Nothing of three.js is needed to compare.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from importlib import resources

import numpy as np
from numpy.typing import NDArray

__all__ = ["SIZE", "Recorded", "recorded"]

Float = NDArray[np.float64]

SIZE = 128


@dataclass(frozen=True, eq=False)
class Recorded:
    """What three.js made of one cube map.

    Attributes
    ----------
    panorama : its folder and name.
    revision : of three.js.
    face_means : (6, 3) of the cube map, to recognise it.
    target : (9, 3) by `fromCubeRenderTarget`, of float light.
    texture : (9, 3) by `fromCubeTexture`, of the same light as 8-bit sRGB.
    """

    panorama: str
    revision: str
    face_means: Float
    target: Float
    texture: Float


@cache
def recorded() -> tuple[Recorded, ...]:
    """All that was recorded."""
    path = resources.files("andon.verify.truths") / "three_light_probe.json"
    entries = json.loads(path.read_text(encoding="utf-8"))
    return tuple(
        Recorded(
            entry["panorama"],
            entry["three"],
            np.reshape(entry["face_means"], (6, 3)),
            np.reshape(entry["target"], (9, 3)),
            np.reshape(entry["texture"], (9, 3)),
        )
        for entry in entries
    )
