"""Real photographs of one thing under different known lights: from one of them, the others.

``psm_uw`` of ``ANDON_DATA`` (README.md there): twelve photographs each of a matte grey sphere and
of a glazed cat, camera fixed, one distant light each, linear 8-bit values. For every ordered pair
(i, j) Andon relights photograph i, as the scene file of a user would: light i, a known source of
E0, is removed; light j is added; the surface is a picture of normals and one of ρ.

===================  ==============================================================================
what                 is known from
===================  ==============================================================================
normals, ρ           photometric stereo on the eleven photographs other than j (i is one of them)
strength of light i  the same fit; the mean strength is 1
strength of light j  nothing: 1 is assumed
`rest_lux`           what those eleven show where their own light does not reach
photograph j         the score alone
===================  ==============================================================================
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from andon.files.pictures import read_picture
from andon.files.pictures.write import write_exr, write_png
from andon.verify.photometric_stereo import photometric_stereo
from andon.verify.registry import NotShown

__all__ = [
    "FOLDER",
    "OBJECTS",
    "Known",
    "Photographs",
    "known_without",
    "photographs",
    "write_pair",
]

Float = NDArray[np.float64]
Bytes = NDArray[np.uint8]

FOLDER = "psm_uw"
OBJECTS = {"sphere": "gray", "cat": "cat"}
DIRECTIONS = "light_directions_from_chrome.txt"
COUNT = 12
# The photographs have no scale: light of mean strength is called this on what faces it, and a white
# that faces it is linear 1. Every lux of the experiment is relative to that.
LIGHT_LUX = 1000.0
# Below this cosine a pixel faces away from a light of which nothing may reach it: the lights have a
# size, and fitted normals err by some degrees.
AWAY = -0.1


@dataclass(frozen=True)
class Photographs:
    """Photographs of one thing, cut to it.

    Attributes
    ----------
    name : ``sphere`` or ``cat``.
    codes : (k, H, W, 3) linear, 0…255.
    mask : (H, W) where the thing is.
    directions : (k, 3) unit, towards the lights; x right, y up, z to the camera, which are the
        world axes of a camera without a pose.
    """

    name: str
    codes: Bytes
    mask: NDArray[np.bool_]
    directions: Float

    @property
    def values(self) -> Float:
        """(k, n, 3) linear, 0…1, of the thing's n pixels."""
        return self.codes[:, self.mask] / 255

    def others(self, target: int, /) -> NDArray[np.intp]:
        """Indices of all photographs but `target`."""
        return np.flatnonzero(np.arange(len(self.codes)) != target)


@dataclass(frozen=True)
class Known:
    """What is known of a thing and its lights without photograph `target`.

    Attributes
    ----------
    normals : (H, W, 3) unit, world; NaN beside the thing.
    reflectance : (H, W, 3) ρ in [0, 1].
    lux : (k,) of the lights on what faces them; the target's is the mean.
    rest_lux : (3,) > 0, of light that comes from no lamp.
    unknown_share : of the pixels, those for which fewer than three photographs agree.
    """

    target: int
    normals: Float
    reflectance: Float
    lux: Float
    rest_lux: Float
    unknown_share: float


def photographs(name: str, /) -> Photographs:
    """The photographs of `name`, a key of `OBJECTS`. Raises `NotShown` where they are missing."""
    root = os.environ.get("ANDON_DATA")
    if not root:
        raise NotShown(f"ANDON_DATA is not set: the folder that holds {FOLDER}")
    folder, stem = Path(root) / FOLDER, OBJECTS[name]
    paths = [folder / stem / f"{stem}.{k}.png" for k in (*range(COUNT), "mask")]
    missing = [path for path in (*paths, folder / DIRECTIONS) if not path.is_file()]
    if missing:
        raise NotShown(f"{missing[0]} is missing")
    *codes, mask = [np.asarray(read_picture(path).values, np.uint8) for path in paths]
    inside = mask[..., 0] > 127
    rows, columns = np.flatnonzero(inside.any(axis=1)), np.flatnonzero(inside.any(axis=0))
    cut = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    directions = np.loadtxt(folder / DIRECTIONS)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return Photographs(name, np.stack([picture[cut] for picture in codes]), inside[cut], directions)


def known_without(shots: Photographs, target: int, /) -> Known:
    """Geometry, reflectance and lights by the photographs other than `target`."""
    others = shots.others(target)
    values, directions = shots.values[others], shots.directions[others]
    stereo = photometric_stereo(values, directions)
    lux = np.full(len(shots.codes), LIGHT_LUX)
    lux[others] *= stereo.strengths
    normals = np.full((*shots.mask.shape, 3), np.nan)
    normals[shots.mask] = stereo.normals
    reflectance = np.zeros((*shots.mask.shape, 3))
    reflectance[shots.mask] = np.clip(stereo.reflectance, 0, 1)
    away = directions @ stereo.normals.T < AWAY
    rest = _rest(values, reflectance[shots.mask], away)
    unknown = float(1 - stereo.is_known.mean())
    return Known(target, normals, reflectance, lux, rest * LIGHT_LUX, unknown)


def _rest(values: Float, reflectance: Float, away: NDArray[np.bool_]) -> Float:
    """(3,) light on pixels that face away from their lamp, of a lamp's; half a code at least.

    The median: at rims, where normals are worst, many pixels are lit that should not be.
    """
    seen = values / np.maximum(reflectance, 1 / 255)
    return np.maximum(np.median(seen[away], axis=0) if away.any() else 0.0, 0.5 / 255)


def write_pair(
    folder: Path, shots: Photographs, known: Known, source: int, /, *, with_map: bool = True
) -> Path:
    """Writes the scene that relights photograph `source` as `known.target`; returns its path.

    Pictures that are there already are kept: all pairs of one target share them. Without `with_map`
    nothing but the photograph tells what the surface reflects.
    """
    folder.mkdir(parents=True, exist_ok=True)
    target = known.target
    photo, normals = f"{shots.name}.{source}.png", f"normals-{target}.exr"
    reflectance = f"reflectance-{target}.exr"
    if not (folder / photo).exists():
        write_png(folder / photo, shots.codes[source])
    if not (folder / normals).exists():
        write_exr(folder / normals, known.normals, unit="1", photometry="relative")
        write_exr(folder / reflectance, known.reflectance, unit="1", photometry="relative")
    rho = f'reflectance_map = "{reflectance}"' if with_map else ""
    path = folder / f"{shots.name}-{source}-{target}{'' if with_map else '-ratio'}.toml"
    path.write_text(
        _SCENE.format(
            photo=photo,
            per_unit=LIGHT_LUX / np.pi,
            rest=_numbers(known.rest_lux),
            from_light=_numbers(-shots.directions[source]),
            from_lux=known.lux[source],
            normals=normals,
            reflectance=rho,
            to_light=_numbers(-shots.directions[target]),
            to_lux=known.lux[target],
        )
    )
    return path


def _numbers(values: Sequence[float] | Float) -> str:
    return "[" + ", ".join(f"{value:.6f}" for value in values) + "]"


# A distant light needs no camera but its axes: any angle of view gives the same picture.
_SCENE = """\
[scene]
photometry = "relative"

[rig.camera]
hfov_degrees = 10.0

[capture]
source = "{photo}"
luminance_per_unit = {per_unit:.6f}  # a white that faces a lamp is white
response = {{ kind = "linear" }}

[ambient]
rest_lux = {rest}
removed = ["from"]

[[ambient.source]]
name = "from"
kind = "directional"
direction = {from_light}
illuminance_lux = {from_lux:.3f}

[surface]
normals = "{normals}"
normals_axes = "world"
{reflectance}

[[lamp]]
name = "to"
kind = "directional"
direction = {to_light}
illuminance_lux = {to_lux:.3f}
"""
