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

__all__ = ["TEXTURE_CAL", "TEXTURE_FILE", "mesh_obj", "picture_bytes", "texture_text"]

Float = NDArray[np.float64]

# More pixels than this along a side are averaged: what is reflected does not show them, and
# pictures travel to every worker.
MOST_PX = 1024

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


def texture_text(name: str, texture: NDArray[Any], picture: str) -> str:
    """Definition of the pattern `name` that looks a texture up in the file `picture`."""
    height, width = _size(texture)
    sides = joined(np.array([width, height, min(width, height) + 2]))
    return (
        f"void colorpict {name} 7 tex_r tex_g tex_b {picture} {TEXTURE_FILE} tex_u tex_v "
        f"0 3 {sides}\n"
    )


def _size(texture: NDArray[Any]) -> tuple[int, int]:
    return min(texture.shape[0], MOST_PX), min(texture.shape[1], MOST_PX)


def picture_bytes(texture: NDArray[Any], most: Float, field: str = "texture") -> bytes:
    """A Radiance picture of a texture (h, w, 3), linear, with its rim; no channel above `most`."""
    if texture.ndim != 3 or texture.shape[2] < 3 or 0 in texture.shape:
        raise InputError(f"must be (h, w, 3), got {texture.shape}", field=field)
    colours = texture[..., :3]
    linear = srgb_decode(colours / 255.0) if colours.dtype == np.uint8 else colours
    linear = np.clip(np.nan_to_num(np.asarray(linear, np.float64)), 0, most)
    height, width = _size(texture)
    if linear.shape[:2] != (height, width):
        import cv2

        linear = np.asarray(
            cv2.resize(linear, (width, height), interpolation=cv2.INTER_AREA), np.float64
        )
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
