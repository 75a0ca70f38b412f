"""The light of points by Radiance: what one task of a bake of probes does, on whatever machine."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.bake.tasks import Bundle
from andon.engines.cubes_radiance import EMITTED, LAMPS, SeenPoints
from andon.files.pictures import npy_bytes
from andon.transport.baked.radiance.quality import QUALITIES, Quality
from andon.transport.baked.radiance.trace import traced_illuminance

__all__ = ["VERSION", "WORK", "gathered", "points_bundle", "traced_points"]

Float = NDArray[np.float64]

# Of what is computed here: results of another version are computed again.
VERSION = 1
# What a worker calls.
WORK = "andon.bake.radiance_points:traced_points"
POINTS = "points.npy"


def gathered(
    folders: Mapping[str, Path],
    position: Float,
    normal: Float,
    /,
    *,
    quality: Quality,
    bounces: int,
) -> Float:
    """(n, 3) lux at points after at least one reflection, and of what emits.

    `folders` are those of `light_scenes`; light that leaves the points again has been reflected at
    most `bounces` times then. Raises `MachineError` as `traced_illuminance` does.
    """
    total = np.zeros((len(position), 3))
    if LAMPS in folders:
        total += traced_illuminance(
            folders[LAMPS], position, normal, quality=quality, bounces=bounces - 1, part="bounce"
        )
    if EMITTED in folders:
        # What emits is met by rays of the hemisphere: one more of Radiance's bounces finds it.
        total += traced_illuminance(
            folders[EMITTED], position, normal, quality=quality, bounces=bounces - 1,
            direct_bounces=1,
        )  # fmt: skip
    return total


def traced_points(inputs: Mapping[str, Path], settings: Mapping[str, Any], /) -> bytes:
    """A `Work`: the lux (n, 3) of `gathered` as .npy.

    `inputs` has the folder ``points`` with ``points.npy``, (n, 6) float64 positions and normals,
    beside those of `light_scenes`; `settings` the names ``quality`` and ``bounces``.
    """
    points = np.load(inputs["points"] / POINTS, allow_pickle=False)
    folders = {name: path for name, path in inputs.items() if name in (LAMPS, EMITTED)}
    lux = gathered(
        folders,
        points[:, :3],
        points[:, 3:],
        quality=QUALITIES[settings["quality"]],
        bounces=int(settings["bounces"]),
    )
    return npy_bytes(lux)


def points_bundle(points: SeenPoints, /) -> Bundle:
    """The folder ``points`` of a task."""
    return {POINTS: npy_bytes(np.concatenate([points.position, points.normal], axis=1))}
