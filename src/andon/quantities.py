"""What flows through a frame: each arrow of the pipeline is one of these named quantities.

::

    CameraFrame → Surface → Illuminance → Luminance → DisplayImage

All are frozen; arrays are (H, W, …), row 0 on top, and are not to be written to. A photometric
triple has three channels (linear Rec.709) in the same photometric unit; neutral light has equal
channels and the photometric value is 0.2126 R + 0.7152 G + 0.0722 B.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from andon.responses import SRGB, Response
from andon.spaces import View

__all__ = [
    "LUMINANCE_WEIGHTS",
    "MAX_OBJECT_MATERIALS",
    "CameraFrame",
    "DisplayImage",
    "Geometry",
    "Illuminance",
    "Luminance",
    "Material",
    "Photometry",
    "Surface",
    "merged",
    "photometric",
]

Photometry = Literal["absolute", "relative"]

# Rec.709 primaries with D65 (ITU-R BT.709-6, table 1): weights of the photometric value.
LUMINANCE_WEIGHTS = np.array([0.2126, 0.7152, 0.0722])
LUMINANCE_WEIGHTS.flags.writeable = False

# Of all virtual objects of a scene together: a table of 16 bytes a row in the 64 KiB that every
# adapter binds as a uniform buffer (WebGPU, table of limits).
MAX_OBJECT_MATERIALS = 4096


def photometric(triple: NDArray[Any], /) -> NDArray[Any]:
    """Photometric value (...) of a triple (..., 3), in the triple's own unit."""
    return triple @ LUMINANCE_WEIGHTS


@dataclass(frozen=True)
class CameraFrame:
    """What one camera saw, as linear light.

    Attributes
    ----------
    linear : (H, W, 3) float32, g⁻¹ of the sensor values, Rec.709 primaries; 1.0 is the sensor's
        white. Times `luminance_per_unit` it is luminance in cd/m².
    view : the *undistorted* view of the picture.
    response : g, which display applies again.
    luminance_per_unit : cd/m² per linear unit, > 0.
    time_seconds : since the start of the session.
    clipped : (H, W) bool, a channel at the end of the sensor's range.
    code_step : step of the sensor's codes as encoded values, 1/255 or 1/65535; 0: floats.
    """

    linear: NDArray[np.float32]
    view: View
    response: Response = SRGB
    luminance_per_unit: float = 1.0
    time_seconds: float = 0.0
    clipped: NDArray[np.bool_] | None = None
    code_step: float = 0.0


@dataclass(frozen=True)
class Material:
    """How a surface answers light, in glTF's metallic-roughness terms.

    Attributes
    ----------
    name : for messages.
    reflectance : (3,) diffuse reflectance ρ in [0, 1], linear Rec.709 (glTF base colour).
    texture : (h, w, 3) uint8 sRGB or float linear, multiplies `reflectance`; row 0 is v = 0.
    emissive_cd_m2 : (3,) luminance that the surface emits by itself.
    metallic, roughness : [0, 1], of highlights.
    metallic_stated : the file states `metallic` for the whole surface: no default, no texture.
    two_sided : bool, lit from both sides.
    extensions : glTF extensions as read, kept for later stages.
    """

    name: str = ""
    reflectance: tuple[float, float, float] = (0.5, 0.5, 0.5)
    texture: NDArray[Any] | None = None
    emissive_cd_m2: tuple[float, float, float] = (0.0, 0.0, 0.0)
    metallic: float = 0.0
    roughness: float = 1.0
    two_sided: bool = True
    extensions: dict[str, Any] = field(default_factory=dict)
    metallic_stated: bool = False


@dataclass(frozen=True)
class Geometry:
    """Triangles in the world.

    Attributes
    ----------
    positions : (n, 3) float64, metres, world.
    triangles : (m, 3) int32 indices into `positions`, counter-clockwise from outside.
    normals : (n, 3) float64 unit shading normals, or None for flat shading.
    uvs : (n, 2) float64 texture coordinates, glTF's (v down), or None.
    material_ids : (m,) int32 indices into `materials`.
    materials : at least one.
    """

    positions: NDArray[np.float64]
    triangles: NDArray[np.int32]
    normals: NDArray[np.float64] | None = None
    uvs: NDArray[np.float64] | None = None
    material_ids: NDArray[np.int32] | None = None
    materials: tuple[Material, ...] = (Material(),)


def merged(*parts: Geometry) -> Geometry:
    """One geometry from several; normals, textures and materials are left behind."""
    offsets = np.cumsum([0, *(len(part.positions) for part in parts)])
    return Geometry(
        np.concatenate([np.zeros((0, 3)), *(part.positions for part in parts)]),
        np.concatenate(
            [
                np.zeros((0, 3), np.int32),
                *(part.triangles + offset for part, offset in zip(parts, offsets, strict=False)),
            ]
        ).astype(np.int32),
    )


@dataclass(frozen=True)
class Surface:
    """The illuminated surface as one view sees it (a G-buffer).

    Attributes
    ----------
    position : (H, W, 3) float64 metres, world; NaN in holes.
    normal : (H, W, 3) float64 unit, world, turned towards the camera; NaN in holes.
    depth : (H, W) float64 metres along the optical axis (distance for fisheye and latlong).
    valid : (H, W) bool; False is a hole, whose pixels stay unchanged.
    is_object : (H, W) bool, the pixel shows a virtual object, not the real surface.
    reflectance : (H, W, 3) float64, ρ of virtual objects (and of real meshes that state it).
    material_id : (H, W) int32, −1 in holes and on depth images.
    emitted_cd_m2 : (H, W, 3) float64, what the surface emits by itself.
    view : where the pixels look.
    body_id : (H, W) int32, which of the luminous bodies is seen, −1 elsewhere; None: nowhere.
    cover : (H, W) depth of what a small hole is taken to hide, of its farther rim; inf elsewhere.
        Virtual things behind it are not drawn; light is not added. None: holes hide nothing.
    shell_id : (H, W) int32, of the luminous bodies: the real shell that a pixel of the photograph
        shows, −1 elsewhere; None: nowhere.
    shell_cd_m2 : (H, W, 3) float64, the light of real shells themselves, added to what the
        photograph shows; 0 where a virtual thing is before it. None: there is none.
    """

    position: NDArray[np.float64]
    normal: NDArray[np.float64]
    depth: NDArray[np.float64]
    valid: NDArray[np.bool_]
    is_object: NDArray[np.bool_]
    reflectance: NDArray[np.float64]
    material_id: NDArray[np.int32]
    emitted_cd_m2: NDArray[np.float64]
    view: View
    body_id: NDArray[np.int32] | None = None
    cover: NDArray[np.float64] | None = None
    shell_id: NDArray[np.int32] | None = None
    shell_cd_m2: NDArray[np.float64] | None = None

    @classmethod
    def of_points(cls, position: NDArray[np.float64], normal: NDArray[np.float64], /) -> Surface:
        """A row of points (n, 3) with unit normals (n, 3), as if a view saw them."""
        count = len(position)
        row, nothing = (1, count), np.zeros((1, count, 3))
        return cls(
            position[None],
            normal[None],
            np.ones(row),
            np.ones(row, bool),
            np.ones(row, bool),
            nothing,
            np.zeros(row, np.int32),
            nothing,
            View("latlong", count, 1),
        )

    @property
    def holes(self) -> int:
        """Pixels without geometry."""
        return int(self.valid.size - np.count_nonzero(self.valid))

    @property
    def distance_m(self) -> NDArray[np.float64]:
        """(H, W) from the camera; in holes that of their cover, or inf."""
        distance = np.linalg.norm(self.position - self.view.position, axis=-1)
        known = self.valid & np.isfinite(distance)
        if self.cover is None:
            return np.where(known, distance, np.inf)
        along = np.linalg.norm(self.view.rays_planar(), axis=-1)
        return np.where(known, distance, np.where(self.valid, np.inf, self.cover * along))


@dataclass(frozen=True)
class Illuminance:
    """What arrives on a surface, (H, W, 3) float in lux; never divided by π.

    `photometry` says whether the numbers are absolute or relative to the light of the photograph.
    """

    lux: NDArray[np.floating[Any]]
    photometry: Photometry = "absolute"


@dataclass(frozen=True)
class Luminance:
    """What leaves towards the camera: `cd_m2` (H, W, 3) float in cd/m²; `photometry` as above."""

    cd_m2: NDArray[np.floating[Any]]
    photometry: Photometry = "absolute"


@dataclass(frozen=True)
class DisplayImage:
    """What a screen is sent: `rgb` (H, W, 3) uint8.

    Encoded with the camera's response for video see-through; sRGB, black adds nothing, for optical.
    """

    rgb: NDArray[np.uint8]
