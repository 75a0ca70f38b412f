"""Textured surfaces as Radiance is told them: a mesh, and a picture that is looked up on it.

::

    u ──frac·w──▶ ┌─┬───────┬─┐     A rim of one pixel of the other side: Radiance's pictures are
                  ├─┼───────┼─┤     not repeated, so the lookup crosses the seam as
                  │ │ w × h │ │     `andon.surface.textures.sample_bilinear` does.
                  ├─┼───────┼─┤
                  └─┴───────┴─┘     RGBE pixels: off by at most 0.4 % of their largest channel.

Radiance's pictures begin below; from one end to the other, which are the *middles* of the outermost
pixels, the shorter side is 1 and the longer one their ratio (measured: a ramp comes out exact).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.quantities import Geometry
from andon.responses import srgb_decode
from andon.transport.baked.radiance.text import joined

__all__ = [
    "TEXTURE_CAL",
    "TEXTURE_FILE",
    "mesh_obj",
    "picture_bytes",
    "picture_size",
    "texture_text",
]

Float = NDArray[np.float64]

# Pixels beyond these are averaged: what is reflected does not show them, and pictures travel to
# every worker. More than so many along a side, and finer than so many metres on the surface: in a
# room of photographed mats that is 49 MB less of 66, and 0.1 % of the light (median, most 0.9 %).
MOST_PX = 1024
FINEST_M = 0.005

# A1 and A2 are width and height of the picture without its rim, A3 the shorter side with it.
TEXTURE_FILE = "texture.cal"
TEXTURE_CAL = """{ Coordinates in a picture with a rim of one pixel, u to the right, v down. }
tex_frac(a) = a - floor(a);
tex_ends(a, n) = (a*n + 0.5) / (n + 1);
tex_u = tex_ends(tex_frac(Lu), A1) * (A1 + 2) / A3;
tex_v = (1 - tex_ends(tex_frac(Lv), A2)) * (A2 + 2) / A3;
tex_r(r, g, b) = r;
tex_g(r, g, b) = g;
tex_b(r, g, b) = b;
"""


def texture_text(name: str, size: tuple[int, int], picture: str) -> str:
    """Definition of the pattern `name` that looks up the file `picture` of `size`, rows first."""
    height, width = size
    sides = joined(np.array([width, height, min(width, height) + 2]))
    return (
        f"void colorpict {name} 7 tex_r tex_g tex_b {picture} {TEXTURE_FILE} tex_u tex_v "
        f"0 3 {sides}\n"
    )


def picture_size(
    texture: NDArray[Any], geometry: Geometry, triangles: NDArray[np.int32]
) -> tuple[int, int]:
    """Rows and columns of the picture of a texture (h, w, 3) that `triangles` (m, 3) have.

    No more than the texture has, and as many as `FINEST_M` takes where it is stretched the most.
    """
    height, width = texture.shape[:2]
    columns, rows = np.ceil(np.minimum(_stretch(geometry, triangles) / FINEST_M, MOST_PX))
    return min(height, max(int(rows), 1)), min(width, max(int(columns), 1))


def _stretch(geometry: Geometry, triangles: NDArray[np.int32]) -> Float:
    """(2,) metres for which u and v change by 1, the most of all triangles.

    Infinite where a triangle is a line or point in the texture but not in the world.
    """
    assert geometry.uvs is not None
    corners, uvs = geometry.positions[triangles], geometry.uvs[triangles].astype(np.float64)
    along, across = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    (u1, v1), (u2, v2) = (uvs[:, 1] - uvs[:, 0]).T, (uvs[:, 2] - uvs[:, 0]).T
    area = (u1 * v2 - u2 * v1)[:, None]
    by_u = np.linalg.norm(along * v2[:, None] - across * v1[:, None], axis=1, keepdims=True)
    by_v = np.linalg.norm(across * u1[:, None] - along * u2[:, None], axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        metres = np.hstack([by_u, by_v]) / np.abs(area)
    seen = np.linalg.norm(np.cross(along, across), axis=1) > 0
    found: Float = np.where(np.isfinite(metres), metres, np.inf)[seen].max(axis=0, initial=0.0)
    return found


def picture_bytes(
    texture: NDArray[Any], size: tuple[int, int], most: Float, field: str = "texture"
) -> bytes:
    """A Radiance picture of a texture (h, w, 3), linear, with its rim; no channel above `most`.

    `size` : rows and columns without the rim; pixels are averaged.
    """
    if texture.ndim != 3 or texture.shape[2] < 3 or 0 in texture.shape:
        raise InputError(f"must be (h, w, 3), got {texture.shape}", field=field)
    colours = texture[..., :3]
    linear = srgb_decode(colours / 255.0) if colours.dtype == np.uint8 else colours
    linear = np.clip(np.nan_to_num(np.asarray(linear, np.float64)), 0, most)
    height, width = size
    if linear.shape[:2] != size:
        import cv2

        linear = np.asarray(
            cv2.resize(linear, (width, height), interpolation=cv2.INTER_AREA), np.float64
        ).reshape(height, width, 3)
    rimmed = np.pad(linear, ((1, 1), (1, 1), (0, 0)), mode="wrap")
    header = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height + 2} +X {width + 2}\n"
    return header.encode("ascii") + _rgbe(rimmed).tobytes()


def _rgbe(linear: Float) -> NDArray[np.uint8]:
    """(h, w, 4) mantissas and exponent. Readers add half a step: rounding down is right."""
    largest = linear.max(axis=-1)
    mantissa, exponent = np.frexp(largest)
    dark = largest < 1e-32
    scale = np.where(dark, 0, mantissa * 256 / np.where(dark, 1, largest))
    codes = np.empty((*linear.shape[:2], 4), np.uint8)
    codes[..., :3] = np.clip(linear * scale[..., None], 0, 255)
    codes[..., 3] = np.where(dark, 0, exponent + 128)
    return codes


def mesh_obj(geometry: Geometry, triangles: NDArray[np.int32]) -> bytes:
    """Wavefront text of some of a geometry's triangles (m, 3), for `obj2mesh`; empty without any.

    Triangles without area are left out, and so are vertices that none has.
    """
    corners = geometry.positions[triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    kept = triangles[np.linalg.norm(across, axis=1) > 0]
    if len(kept) == 0:
        return b""
    used, index = np.unique(kept, return_inverse=True)
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in (geometry.positions[used] + 0.0).tolist()]
    if geometry.uvs is not None:
        lines += [f"vt {u!r} {v!r}" for u, v in (geometry.uvs[used] + 0.0).tolist()]
        corner = "{0}/{0} {1}/{1} {2}/{2}"
    else:
        corner = "{0} {1} {2}"
    lines += ["f " + corner.format(*row) for row in (index.reshape(-1, 3) + 1).tolist()]
    return ("\n".join(lines) + "\n").encode("ascii")
