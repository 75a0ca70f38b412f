"""Shaders for a scene's own solids: the text that stands in for solids.wgsl.

A scene of one ball pays for no mesh, no mask and no search after its second boundary.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from andon.glass.model import Ball, Closed, LensShape, Slab, Solid

__all__ = ["MAX_EVENTS", "SOLIDS", "variants_of"]

# Boundaries on one path; what is still inside after them is lost.
MAX_EVENTS = 16

# Boundaries of two bodies that are this share of the larger one's size apart are one: some steps of
# a float32 coordinate.
NEAR = 4e-6

SOLIDS = "andon/glass/solids.wgsl"
_CURVATURE = "andon/glass/curvature{}.wgsl"
_OUTLINE = "andon/glass/silhouette{}.wgsl"
_IMPORTS: dict[type, str] = {
    Ball: "andon/glass/ball.wgsl",
    Slab: "andon/glass/slab.wgsl",
    LensShape: "andon/glass/lens.wgsl",
    Closed: "andon/glass/mesh.wgsl",
}
_HITS: dict[type, str] = {
    Ball: "ball_hit(local.origin, local.direction, solids[{0}].size.x, {1})",
    Slab: "slab_hit(local.origin, local.direction, solids[{0}].size.xyz, {1})",
    LensShape: "lens_hit(local.origin, local.direction, solids[{0}].size, {1})",
    Closed: "mesh_hit(local.origin, local.direction, solids[{0}], {1})",
}
_STICKINGS: dict[type, str] = {
    Ball: "ball_sticking(local, solids[{0}].size.x, steps)",
    Slab: "slab_sticking(local, met.normal * turn, solids[{0}].size.xyz, steps)",
    LensShape: "lens_sticking(local, met.normal * turn, solids[{0}].size, steps)",
    Closed: "mesh_sticking(local, solids[{0}].first_triangle + met.triangle, steps)",
}


def variants_of(solids: Sequence[Solid], /) -> dict[str, str]:
    """`variants` of a shader that imports solids.wgsl, for these solids (1…MAX_SOLIDS of them)."""
    variants = {SOLIDS: _text(solids)}
    if all(isinstance(solid.shape, (Ball, Slab)) for solid in solids):
        variants[_CURVATURE.format("")] = _CURVATURE.format("_round")
    if len(solids) == 1 and isinstance(solids[0].shape, Ball):
        variants[_OUTLINE.format("")] = _OUTLINE.format("_ball")
    return variants


def _text(solids: Sequence[Solid]) -> str:
    used = {type(solid.shape) for solid in solids}
    imports = "".join(f"//!import {_IMPORTS[kind]}\n" for kind in _IMPORTS if kind in used)
    return f"//!import andon/glass/rays.wgsl\n{imports}{_constants(solids)}" + "".join(
        [_boundary(solids), _sticking(solids)]
    )


def _constants(solids: Sequence[Solid]) -> str:
    ball_alone = len(solids) == 1 and isinstance(solids[0].shape, Ball)
    convex_alone = len(solids) == 1 and isinstance(solids[0].shape, (Ball, Slab))
    entry_only = all(solid.interfaces == 1 for solid in solids)
    events = 1 if entry_only else 2 if ball_alone else MAX_EVENTS
    # A ray that enters a ball alone leaves it at the same angle: reflection is never total.
    flags = {"CONVEX_ALONE": convex_alone, "ENTRY_ONLY": entry_only, "MIRRORS": not ball_alone}
    flags["DISPERSES"] = any(solid.is_dispersive for solid in solids)
    flags["STICKERS"] = any(solid.sticker is not None for solid in solids)
    flags["FACETS"] = any(isinstance(solid.shape, Closed) for solid in solids)
    lines = [f"const SOLIDS: i32 = {len(solids)};", f"const EVENTS: i32 = {events};"]
    near = NEAR * max(_scale(solid.shape) for solid in solids)
    lines.append(f"const NEAR: f32 = {near:.9g}f;")
    lines += [f"const {name}: bool = {str(value).lower()};" for name, value in flags.items()]
    return "\n".join(lines) + "\n"


def _scale(shape: Ball | Slab | LensShape | Closed) -> float:
    match shape:
        case Ball(radius):
            return radius
        case Slab(half):
            return float(np.max(half))
        case LensShape(radius, _, thickness):
            return max(radius, thickness / 2)
        case Closed(geometry):
            return float(np.ptp(geometry.positions, axis=0).max()) / 2


def _boundary(solids: Sequence[Solid]) -> str:
    lines = ["fn boundary(ray: Ray, inside: u32) -> Boundary {", "  var nearest = no_boundary();"]
    for row, solid in enumerate(solids):
        hit = _HITS[type(solid.shape)].format(row, f"(inside & {1 << row}u) != 0u")
        lines.append(f"  {{ let local = local_ray(ray, {row});")
        lines.append(f"    nearest = nearer(nearest, {hit}, {row}, NEAR); }}")
    return "\n".join([*lines, "  return nearest;", "}", ""])


def _has_place(solid: Solid) -> bool:
    return not isinstance(solid.shape, Closed) or solid.shape.geometry.uvs is not None


def _sticking(solids: Sequence[Solid]) -> str:
    lines = ["fn sticking(met: Boundary, point: vec3f, moves: mat2x3f) -> Sticking {"]
    for row, solid in enumerate(solids):
        if solid.sticker is not None and _has_place(solid):
            lines += [
                f"  if met.solid == {row} {{",
                f"    let turn = world_from_glass({row});",
                f"    let local = local_point(point, {row});",
                "    let steps = mat2x3f(moves[0] * turn, moves[1] * turn);",
                f"    return {_STICKINGS[type(solid.shape)].format(row)};",
                "  }",
            ]
    return "\n".join([*lines, "  return nothing_sticks();", "}", ""])
