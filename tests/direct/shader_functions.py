"""Calls WGSL functions on rows of numbers: a full-screen pass with one pixel per row."""

import numpy as np

from andon.gpu.bindings import bind_group
from andon.gpu.passes import FullscreenPass
from andon.gpu.textures import make_texture

__all__ = ["Caller"]

WIDTH = 64


class Caller:
    """`expression` over `x[0]`, `x[1]`, … (vec4f each), in WGSL, gives a vec4f per row.

    `rows` is how many at most, or (width, height) of the picture. `declarations` and `resources`:
    more bindings of group 0; `options` go to the pass.
    """

    def __init__(
        self, gpu, module, expression, columns, rows, *, statements="", declarations="",
        resources=None, **options,
    ):  # fmt: skip
        self.gpu = gpu
        self.width, self.height = rows if isinstance(rows, tuple) else (WIDTH, -(-rows // WIDTH))
        self.inputs = make_texture(gpu, "rgba32float", self.width, self.height, layers=columns)
        self.target = make_texture(gpu, "rgba32float", self.width, self.height)
        reads = ", ".join(f"textureLoad(rows, at, {k}, 0)" for k in range(columns))
        text = f"""//!import {module}
{declarations}
@group(0) @binding(0) var rows: texture_2d_array<f32>;
@fragment fn call(@builtin(position) pixel: vec4f) -> @location(0) vec4f {{
  let at = vec2i(pixel.xy);
  var x = array<vec4f, {columns}>({reads});
  {statements}
  return {expression};
}}
"""
        group = bind_group(gpu, {0: ("float array", self.inputs.view)} | (resources or {}))
        variants = {"harness": text} | options.pop("variants", {})
        self.render = FullscreenPass(
            gpu, "harness", "call", ["rgba32float"], [group], variants=variants, **options
        )

    def fill(self, *columns):
        for layer, column in enumerate(columns):
            column = np.asarray(column, np.float32).reshape(len(column), -1)
            data = np.zeros((self.height * self.width, 4), np.float32)
            data[: len(column), : column.shape[1]] = column
            self.inputs.write(data, layer)

    def run(self):
        encoder = self.gpu.device.create_command_encoder()
        self.render.encode(encoder, [self.target.view])
        self.gpu.device.queue.submit([encoder.finish()])

    def __call__(self, *columns):
        """(n, 4) float32 of the rows of `columns`, each (n, ≤ 4)."""
        self.fill(*columns)
        self.run()
        return self.target.read().reshape(-1, 4)[: len(columns[0])]
