"""Pictures on glass and behind it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.cached import read_cached
from andon.glass.model import Backdrop, Sticker

if TYPE_CHECKING:
    from andon.scene import Scene
    from andon.scene.objects import Background, Glass

__all__ = ["backdrop_of", "sticker_of"]

Float = NDArray[np.float64]

# An up closer to the normal than this leaves the picture's sides to rounding.
LEAST_SINE = 1e-6


def sticker_of(scene: Scene, glass: Glass, field: str, /) -> Sticker | None:
    """What sticks to a body; None: nothing."""
    if glass.texture is None:
        return None
    path = scene.path(glass.texture, f"{field}.texture")
    return Sticker(read_cached(_reflectance, path), glass.texture_transmittance)


def backdrop_of(scene: Scene, background: Background, field: str, /) -> Backdrop:
    """What is seen through a body; its plane's axes are unit vectors times half its sides.

    Raises `InputError` where the picture's up is along its normal.
    """
    if background.distance_m is not None:
        return Backdrop("frame", background.distance_m)
    if background.file is None:
        return Backdrop()
    picture = read_cached(_light, scene.path(background.file, f"{field}.file"))
    normal, up = _unit(background.normal), _unit(background.up)
    right = np.cross(up, normal)
    if np.linalg.norm(right) < LEAST_SINE:
        raise InputError(
            "must not be along the normal",
            file=scene.file,
            field=f"{field}.up",
            remedy="state the direction of the picture's upper edge",
        )
    right = _unit(right)
    upwards = _unit(np.cross(normal, right))
    return Backdrop(
        "texture",
        picture=picture,
        centre_m=np.array(background.position),
        right_m=right * background.width_m / 2,
        up_m=upwards * background.height_m / 2,
    )


def _unit(vector: Any) -> Float:
    # Over its largest number first: a square of the length overflows before the length does.
    found = np.asarray(vector, np.float64) / np.abs(vector).max()
    return found / np.linalg.norm(found)


def _light(path: Path) -> NDArray[np.float32]:
    """(h, w, 3) linear, ≥ 0; 1 is white."""
    from andon.files.pictures import read_picture

    return _checked(read_picture(path).linear(), path)


def _reflectance(path: Path) -> NDArray[np.float32]:
    """(h, w, 4) diffuse reflectance, linear, and cover, both in [0, 1]."""
    from andon.files.pictures import read_picture

    picture = read_picture(path)
    values = picture.linear()
    cover = np.ones(picture.shape) if picture.alpha is None else picture.alpha.astype(np.float64)
    if picture.encoding == "linear" and picture.alpha is not None:
        # EXR colour is premultiplied (CONVENTIONS, "alpha"); what sticks has a colour of its own.
        values = np.divide(
            values, cover[..., None], out=np.zeros_like(values), where=cover[..., None] > 0
        )
    return _checked(np.concatenate([values, cover[..., None]], axis=-1), path, most=1.0)


def _checked(values: Float, path: Path, most: float = np.inf) -> NDArray[np.float32]:
    if not (np.isfinite(values).all() and (values >= 0).all() and (values <= most + 1e-6).all()):
        rule = "values must be finite and ≥ 0" if most == np.inf else "values must be in 0…1"
        raise InputError(rule, file=path, remedy="export it anew, or use a PNG")
    found = np.ascontiguousarray(np.minimum(values, most), np.float32)
    found.flags.writeable = False  # one picture for all who name it
    return found
