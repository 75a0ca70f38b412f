"""Host structs: what the shaders know of a view, and how a G-buffer is packed."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.gpu.layout import HostStruct
from andon.octahedra import directions_of, square_of
from andon.quantities import Surface
from andon.spaces import View

__all__ = [
    "BODY_LIGHT",
    "BODY_SHIFT",
    "MAX_BODIES",
    "NEAR_M",
    "OBJECT",
    "STRUCTS",
    "VALID",
    "VERTEX",
    "VIEW_RECORD",
    "pack_surface",
    "pack_view",
    "projection_variant",
    "unpack_surface",
]

# Nothing nearer than this to an eye is drawn: the near plane, in metres. The depth buffer is
# reversed and infinite (near/z in float32), so a small value costs no precision.
NEAR_M = 0.01

# The projection that view.wgsl is compiled with.
_PROJECTION = "andon/gbuffer/projections/{}.wgsl"

VIEW_RECORD = HostStruct(
    "ViewRecord",
    (
        # columns of world_from_camera: directions need no 4×4 product
        ("world_right", "vec3f"),
        ("world_down", "vec3f"),
        ("world_forward", "vec3f"),
        ("position", "vec3f"),
        # pinhole: world ray per unit of depth = ray_origin + column·ray_column + row·ray_row
        ("ray_origin", "vec3f"),
        ("ray_column", "vec3f"),
        ("ray_row", "vec3f"),
        ("focal", "vec2f"),  # pixels
        ("centre", "vec2f"),  # pixels, GPU convention: pixel centres at +0.5
        ("size", "vec2f"),  # pixels
        ("near_m", "f32"),
        ("camera_from_world", "mat4x4f"),
    ),
)

STRUCTS = {VIEW_RECORD.name: VIEW_RECORD}

# Flags in the fourth word of the G-buffer.
VALID, OBJECT, MATERIAL_SHIFT, BODY_SHIFT = 1, 2, 8, 24
# Materials have 16 bits, bodies 8.
MAX_BODIES = 255


# Vertices of what is drawn, and the cd/m² of a luminous body's vertex from outside and inside.
VERTEX = np.dtype(
    [("position", "<f4", 3), ("normal", "<f4", 3), ("uv", "<f4", 2), ("material", "<u4")]
)
BODY_LIGHT = np.dtype([("outside", "<f4", 3), ("inside", "<f4", 3)])


def pack_view(view: View, /) -> NDArray[Any]:
    """One `VIEW_RECORD`. The GPU's half-pixel shift is made here and nowhere else."""
    rotation = view.world_from_camera[:3, :3]
    column = rotation[:, 0] / view.fx if view.fx else np.zeros(3)
    row = rotation[:, 1] / view.fy if view.fy else np.zeros(3)
    return VIEW_RECORD.pack(
        ray_origin=rotation[:, 2] - (view.cx + 0.5) * column - (view.cy + 0.5) * row,
        ray_column=column,
        ray_row=row,
        world_right=rotation[:, 0],
        world_down=rotation[:, 1],
        world_forward=rotation[:, 2],
        position=view.position,
        focal=(view.fx, view.fy),
        centre=(view.cx + 0.5, view.cy + 0.5),
        size=(view.width, view.height),
        near_m=NEAR_M,
        camera_from_world=view.camera_from_world,
    )


def projection_variant(view: View, /) -> dict[str, str]:
    """`variants` of a shader that imports view.wgsl, for this view's projection."""
    return {_PROJECTION.format("pinhole"): _PROJECTION.format(view.projection)}


def pack_surface(surface: Surface, /) -> NDArray[np.uint32]:
    """(H, W, 4) uint32: depth bits, octahedral normal, reflectance, flags (see gbuffer.wgsl)."""
    packed = np.zeros((*surface.view.shape, 4), np.uint32)
    # Of holes: how near their cover is, 0 for none.
    cover = np.inf if surface.cover is None else surface.cover
    depth = np.where(surface.valid, surface.depth, np.where(np.isfinite(cover), cover, 0.0))
    packed[..., 0] = depth.astype(np.float32).view(np.uint32)
    packed[..., 1] = _octahedral(np.where(surface.valid[..., None], surface.normal, (0, 0, 1.0)))
    root = np.sqrt(np.clip(surface.reflectance, 0, 1))
    channels = np.rint(root * 255).astype(np.uint32)
    packed[..., 2] = channels @ np.array([1, 1 << 8, 1 << 16], np.uint32)
    material = np.clip(surface.material_id, 0, 0xFFFF).astype(np.uint32)
    flags = surface.valid * VALID + surface.is_object * OBJECT + (material << MATERIAL_SHIFT)
    # A pixel shows a luminous body, which is an object, or a real shell, which is none and may be
    # a hole.
    bodies = [
        0 if number is None else (number + 1).astype(np.uint32) << BODY_SHIFT
        for number in (surface.body_id, surface.shell_id)
    ]
    packed[..., 3] = np.where(surface.valid, flags + bodies[0], 0) + bodies[1]
    return packed


def _octahedral(normal: NDArray[np.float64]) -> NDArray[np.uint32]:
    signed = np.asarray(np.rint(np.clip(square_of(normal), -1, 1) * 32767), np.int16)
    bits = np.asarray(signed.view(np.uint16), np.uint32)
    return bits[..., 0] | (bits[..., 1] << np.uint32(16))


def unpack_surface(packed: NDArray[np.uint32], view: View, /) -> dict[str, NDArray[Any]]:
    """The fields of `Surface` that a packed G-buffer holds, by name."""
    halves = np.stack([packed[..., 1] & 0xFFFF, packed[..., 1] >> 16], axis=-1)
    signed: NDArray[np.int16] = halves.astype(np.uint16).view(np.int16)
    e: NDArray[np.float64] = np.maximum(np.asarray(signed, np.float64) / 32767.0, -1.0)
    valid = (packed[..., 3] & VALID) > 0
    codes = np.stack([(packed[..., 2] >> shift) & 255 for shift in (0, 8, 16)], axis=-1)
    material = ((packed[..., 3] >> MATERIAL_SHIFT) & 0xFFFF).astype(np.int32)
    body = ((packed[..., 3] >> BODY_SHIFT) & 0xFF).astype(np.int32) - 1
    is_object = (packed[..., 3] & OBJECT) > 0
    return {
        "depth": np.where(valid, packed[..., 0].view(np.float32), np.nan),
        "normal": directions_of(e),
        "reflectance": (codes / 255.0) ** 2,
        "valid": valid,
        "is_object": is_object,
        "material_id": np.where(valid, material, -1),
        "body_id": np.where(is_object, body, np.int32(-1)),
        "shell_id": np.where(is_object, np.int32(-1), body),
    }
