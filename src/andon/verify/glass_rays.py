"""View rays through glass by either engine: where they land on the plane behind, and how far away
that appears."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.glass.model import MAX_SOLIDS, Backdrop, Solid
from andon.glass.paths import THROUGH, trace
from andon.glass.pencils import vergence
from andon.pipeline import EngineName

__all__ = ["Seen", "refracted_on_gpu", "seen_through"]

Float = NDArray[np.float64]

WIDTH = 256

# One pixel a ray: what it meets last, and the vergence of the plane behind.
SHADER = """//!import andon/glass/paths.wgsl
@group(0) @binding(0) var rows: texture_2d_array<f32>;
@group(0) @binding(2) var<uniform> solids: array<SolidRecord, {count}>;
@group(0) @binding(5) var nodes: texture_2d<f32>;
@group(0) @binding(6) var triangles: texture_2d<f32>;
fn path_of(at: vec2i) -> Path {{
  let ray = Ray(textureLoad(rows, at, 0, 0).xyz, textureLoad(rows, at, 1, 0).xyz);
  let frame = frame_of(ray.direction);
  let start = start_pencil(frame.e1, frame.e2);
  let first = boundary(ray, 0u);
  var path = trace(ray, start, first, 1);
  if first.solid < 0 {{
    path.exit = ray;
    path.pencil = start;
    path.solid = -1;
    path.status = THROUGH;
  }}
  return path;
}}
@fragment fn points(@builtin(position) place: vec4f) -> @location(0) vec4f {{
  let path = path_of(vec2i(place.xy));
  return vec4f(path.exit.origin, f32(path.solid));
}}
@fragment fn ways(@builtin(position) place: vec4f) -> @location(0) vec4f {{
  let path = path_of(vec2i(place.xy));
  return vec4f(path.exit.direction, select(0.0, 1.0, path.status == THROUGH));
}}
@fragment fn vergences(@builtin(position) place: vec4f) -> @location(0) vec4f {{
  let path = path_of(vec2i(place.xy));
  let reach = vec3f({centre}) - path.exit.origin;
  let distance = dot(reach, vec3f({front})) / dot(path.exit.direction, vec3f({front}));
  return vergence(spread_at(path.pencil, path.exit.direction, distance));
}}
"""

BEND = """//!import andon/glass/refraction.wgsl
@group(0) @binding(0) var rows: texture_2d_array<f32>;
@fragment fn bends(@builtin(position) place: vec4f) -> @location(0) vec4f {{
  let at = vec2i(place.xy);
  let D = textureLoad(rows, at, 0, 0).xyz;
  let bend = refracted(D, textureLoad(rows, at, 1, 0).xyz, {before} / {after});
  return vec4f(bend.direction, select(0.0, 1.0, bend.total));
}}
"""


@dataclass(frozen=True)
class Seen:
    """What n view rays find on the plane behind the glass.

    Attributes
    ----------
    points : (n, 3) metres, world; NaN where the plane is not met.
    glass : (n,) bool, the ray met glass.
    vergence : (n, 2, 2) dioptres, see `andon.glass.pencils.vergence`.
    """

    points: Float
    glass: NDArray[np.bool_]
    vergence: Float


def seen_through(
    engine: EngineName, solids: Sequence[Solid], origins: Float, directions: Float, /
) -> Seen:
    """What rays from `origins` (n, 3) along unit `directions` (n, 3) find on the backdrop.

    The backdrop is the first solid's, of kind texture; its edges count. Raises `MachineError` where
    the GPU is asked for and there is none.
    """
    origins = np.broadcast_to(origins, directions.shape)
    backdrop = solids[0].backdrop
    if engine == "gpu":
        exits, ways, met, through, seen = _on_gpu(solids, origins, directions)
        points, _ = _landed(backdrop, exits, ways)
    else:
        traced = trace(solids, origins, directions)
        exits, ways, met = traced.exit_point, traced.exit_direction, traced.solid >= 0
        through = traced.status == THROUGH
        points, distance = _landed(backdrop, exits, ways)
        seen = vergence(traced.pencil, distance, ways)
    points[~through] = np.nan
    return Seen(points, met, seen)


def _landed(backdrop: Backdrop, exits: Float, ways: Float) -> tuple[Float, Float]:
    """Points (n, 3) on the rectangle, NaN beside it, and the distance (n,) to its plane."""
    front = np.cross(backdrop.right_m, backdrop.up_m)
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = ((backdrop.centre_m - exits) @ front) / (ways @ front)
    distance[~np.isfinite(distance)] = -1.0  # along the plane: as one that goes away from it
    points = exits + distance[:, None] * ways
    missed = ~(distance > 0)
    for half in (backdrop.right_m, backdrop.up_m):
        missed |= ~(np.abs((points - backdrop.centre_m) @ half) <= half @ half)
    points[missed] = np.nan
    return points, distance


def refracted_on_gpu(
    directions: Float, normals: Float, before: float, after: float, /
) -> tuple[Float, NDArray[np.bool_]]:
    """`andon.glass.refraction.refracted` by the shader's function, for one pair of indices."""
    numbers = {"before": f"{before:.9g}", "after": f"{after:.9g}"}
    bend = _drawn(BEND.format(**numbers), ("bends",), {}, {}, directions, normals)[0]
    return bend[:, :3], bend[:, 3] > 0


def _on_gpu(
    solids: Sequence[Solid], origins: Float, directions: Float
) -> tuple[Float, Float, NDArray[np.bool_], NDArray[np.bool_], Float]:
    from andon.glass.plan import variants_of
    from andon.glass.records import STRUCTS
    from andon.glass.stage import SolidBuffers
    from andon.gpu.device import open_gpu

    buffers = SolidBuffers(open_gpu(), solids)
    options: dict[str, Any] = {"structs": STRUCTS, "variants": variants_of(solids)}
    entries = ("points", "ways", "vergences")
    shader = _shader(solids[0].backdrop)
    point, way, seen = _drawn(shader, entries, buffers.resources, options, origins, directions)
    return point[:, :3], way[:, :3], point[:, 3] >= 0, way[:, 3] > 0, seen.reshape(-1, 2, 2)


def _drawn(
    shader: str,
    entries: Sequence[str],
    resources: dict[int, tuple[str, Any]],
    options: dict[str, Any],
    *columns: Float,
) -> list[Float]:
    """(n, 4) of each of `entries` of the text `shader`, one pixel for each row of `columns`."""
    from andon.gpu.bindings import bind_group
    from andon.gpu.device import open_gpu
    from andon.gpu.passes import FullscreenPass
    from andon.gpu.textures import make_texture

    gpu = open_gpu()
    count = len(columns[0])
    height = -(-count // WIDTH)
    rows = make_texture(gpu, "rgba32float", WIDTH, height, layers=len(columns))
    for layer, column in enumerate(columns):
        filled = np.zeros((height * WIDTH, 4), np.float32)
        filled[:count, :3] = column
        rows.write(filled, layer)
    group = bind_group(gpu, {0: ("float array", rows.view)} | resources)
    variants = options.get("variants", {}) | {"harness": shader}
    results: list[Float] = []
    for entry in entries:
        target = make_texture(gpu, "rgba32float", WIDTH, height)
        step = FullscreenPass(
            gpu, "harness", entry, ["rgba32float"], [group], **(options | {"variants": variants})
        )
        encoder = gpu.device.create_command_encoder()
        step.encode(encoder, [target.view])
        gpu.device.queue.submit([encoder.finish()])
        results.append(target.read().reshape(-1, 4)[:count].astype(np.float64))
    return results


def _shader(backdrop: Backdrop) -> str:
    front = np.cross(backdrop.right_m, backdrop.up_m)
    front /= np.linalg.norm(front)
    numbers = {
        name: ", ".join(f"{value:.9g}" for value in vector)
        for name, vector in (("centre", backdrop.centre_m), ("front", front))
    }
    return SHADER.format(count=MAX_SOLIDS, **numbers)
