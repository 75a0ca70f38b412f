"""Real glass: whole pictures that Mitsuba's path tracer takes through a thin lens.

What is seen through the glass shines by itself, as a picture on a plane does in Andon; lamps are
luminous balls as wide as the lobe of the glass's highlights, so that glass mirrors them, and light
the label; the rest of the surroundings is of one luminance. Light that lamps send through glass
(caustics) is left out: nothing in these pictures is diffuse but the label.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glass.model import Backdrop, Ball, Solid
from andon.lamps import PointLamp
from andon.spaces import View
from andon.verify.truths.mitsuba_glass import mitsuba, rectangle, sensor_of, shape_of

__all__ = ["Surroundings", "path_traced"]

Float = NDArray[np.float64]

# A label floats this far above the glass, metres. Mitsuba moves the starts of its rays by 0.1 mm,
# so a nearer one would let rays into the glass without refraction.
LABEL_M = 4e-4
MAX_DEPTH = 12


@dataclass(frozen=True)
class Surroundings:
    """What is around the glass besides its backdrop.

    Attributes
    ----------
    lamps : point lamps, cd.
    white_cd_m2 : luminance of 1 in the backdrop's picture.
    environment_cd_m2 : (3,) of everything else; E0/π of E0 from all sides.
    """

    lamps: Sequence[PointLamp] = ()
    white_cd_m2: float = 1.0
    environment_cd_m2: tuple[float, float, float] = (0.0, 0.0, 0.0)


def path_traced(
    solids: Sequence[Solid],
    view: View,
    around: Surroundings,
    /,
    *,
    pupil_m: float,
    focus_dioptres: float,
    samples: int,
    seed: int = 0,
) -> Float:
    """(H, W, 3) luminance in cd/m² of `solids` as one eye sees them.

    Parameters
    ----------
    solids : nested ones inside their predecessors; the backdrop is the first's, of kind texture.
        Labels are on balls only, two-interface glass only, without absorption.
    view : of the eye, a pinhole, of the size that is wanted (`View.resized`).
    pupil_m, focus_dioptres : diameter of the pupil; vergence of what is sharp, along the axis, > 0.
    samples : paths a pixel.

    Raises `NotShown` where Mitsuba is not installed, `InputError` for what it is not told.
    """
    mi = mitsuba()
    scene = mi.load_dict(_document(solids, around))
    sensor = sensor_of(view, aperture_radius=pupil_m / 2, focus_distance=1 / focus_dioptres)
    return np.array(mi.render(scene, sensor=sensor, spp=samples, seed=seed), np.float64)[..., :3]


def _document(solids: Sequence[Solid], around: Surroundings) -> dict[str, Any]:
    environment = {"type": "rgb", "value": list(around.environment_cd_m2)}
    document: dict[str, Any] = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": MAX_DEPTH},
        "backdrop": _shining(solids[0].backdrop, around.white_cd_m2),
        "environment": {"type": "constant", "radiance": environment},
    }
    outside = 1.0
    for number, solid in enumerate(solids):
        if solid.is_dispersive or any(solid.absorption_per_m) or solid.interfaces != 2:
            raise InputError("must be plain two-interface glass for the path tracer", field="glass")
        glass = {"type": "dielectric", "int_ior": solid.index[0], "ext_ior": outside}
        document[f"solid{number}"] = shape_of(solid, glass)
        outside = solid.index[0]
        if solid.sticker is not None:
            document[f"label{number}"] = _label(solid)
    for number, lamp in enumerate(around.lamps):
        radius = _lamp_radius_m(lamp, solids[0])
        light = np.asarray(lamp.intensity_cd) / (np.pi * radius**2)
        document[f"lamp{number}"] = {
            "type": "sphere",
            "radius": radius,
            "center": np.asarray(lamp.position_m, float).tolist(),
            "emitter": {"type": "area", "radiance": {"type": "rgb", "value": light.tolist()}},
        }
    return document


def _lamp_radius_m(lamp: PointLamp, solid: Solid) -> float:
    """Of a ball whose solid angle is that of Phong's lobe, 2π/(m + 1), seen from the glass."""
    distance = float(np.linalg.norm(lamp.position_m - solid.world_from_glass[:3, 3]))
    return distance * float(np.sqrt(2 / (solid.highlight_exponent + 1)))


def _shining(backdrop: Backdrop, white_cd_m2: float) -> dict[str, Any]:
    if backdrop.picture is None:
        raise InputError("must be of kind texture for the path tracer", field="background.kind")
    if not backdrop.picture.any():
        return rectangle(backdrop)  # an emitter without light makes the path tracer divide by 0
    # Mitsuba's rectangle has row 0 at its lower edge.
    radiance = _texture(white_cd_m2 * backdrop.picture[::-1].astype(np.float64))
    return rectangle(backdrop) | {"emitter": {"type": "area", "radiance": radiance}}


def _texture(values: Float) -> dict[str, Any]:
    """A picture (h, w, c), linear, row 0 at v = 0."""
    bitmap = mitsuba().Bitmap(np.ascontiguousarray(values, np.float32))
    return {"type": "bitmap", "bitmap": bitmap, "raw": True, "wrap_mode": "clamp"}


def _label(solid: Solid) -> dict[str, Any]:
    """A diffuse shell around a ball, of which α = (1 − transmittance)·cover is there."""
    sticker = solid.sticker
    assert sticker is not None
    if not isinstance(solid.shape, Ball):
        raise InputError("must be a ball to have a label for the path tracer", field="shape")
    # Mitsuba's ball turns its coordinates about +z from +x, the label about +y from +z.
    axes = np.eye(4)
    axes[:3, :3] = np.eye(3)[:, [2, 0, 1]]
    around = np.roll(sticker.picture, sticker.picture.shape[1] // 2, axis=1).astype(np.float64)
    alpha = (1 - sticker.transmittance) * around[..., 3:]
    paint = {
        "type": "twosided",
        "bsdf": {"type": "diffuse", "reflectance": _texture(around[..., :3])},
    }
    mask = {"type": "mask", "opacity": _texture(alpha), "bsdf": paint}
    turned = Solid(solid.name, solid.shape, solid.world_from_glass @ axes)
    return shape_of(turned, mask, grown_m=LABEL_M)
