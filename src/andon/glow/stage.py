"""The glow on the GPU."""

from __future__ import annotations

from typing import Any

from andon.errors import InputError
from andon.glow.model import Glow
from andon.glow.plan import Span, plan_axis
from andon.gpu.bindings import BindGroup, bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import PLUS, FullscreenPass, color_attachment
from andon.gpu.textures import Texture, make_texture
from andon.spaces import View

__all__ = ["BODY_LIMIT", "GlowStage"]

# Luminance of a body, in units of the picture, above which it is cut: what a half float holds. A
# unit is the picture's white, so in a room of 1 lx that is 20,000 cd/m², a frosted bulb. Where the
# sum is more than that the picture is cut, or infinite: white on any display.
BODY_LIMIT = 65504.0

FORMAT = "rgba16float"
# Between passes: half floats are cut, not rounded, by some drivers, which costs 0.04 % of the light
# a pass; float32 takes no longer.
BETWEEN = "rgba32float"
MODULE = "andon/glow/glow.wgsl"
AXIS = "andon/glow/axis.wgsl"


class GlowStage:
    """Adds ``fraction·(G∗B − B)`` of `bodies` to `target`; both rgba16float, of the view's size.

    In `bodies` NaN and negative values count as 0, and what is above `BODY_LIMIT` as that; its
    alpha is not read. Alpha of `target` stays.
    """

    def __init__(self, gpu: Gpu, bodies: Texture, target: Texture, glow: Glow, view: View) -> None:
        for name, texture in (("bodies", bodies), ("target", target)):
            if (texture.height, texture.width) != view.shape:
                size = f"{texture.width}×{texture.height}"
                raise InputError(
                    f"must be {view.width}×{view.height} px, got {size}", field=f"glow.{name}"
                )
        self.gpu, self.glow, self._target = gpu, glow, target
        self._size = (view.width, view.height)
        across, down = glow.sigma_pixels(view)
        self._x, self._y = plan_axis(view.width, across), plan_axis(view.height, down)
        self._columns, self._cells, self._swept, self._rows = self._textures()
        self._passes = {
            "reduce x": self._pass("reduce", "x", bodies),
            "reduce y": self._pass("reduce", "y", self._columns),
            "filter x": self._pass("filter_cells", "x", self._cells),
            "filter y": self._pass("filter_cells", "y", self._swept),
            "expand x": self._pass("expand", "x", self._cells),
            "expand y": self._pass("expand", "y", self._rows, target=FORMAT),
            "scatter": self._pass("scatter", "y", self._rows, bodies, target=FORMAT),
        }

    def _textures(self) -> tuple[Texture, Texture, Texture, Texture]:
        """Reduced in x; in both; filtered in x; filtered in both and expanded in x."""
        (width, height), x, y = self._size, self._x.texels, self._y.texels
        sizes = ((x, height), (x, y), (x, y), (width, y))
        a, b, c, d = (make_texture(self.gpu, BETWEEN, *size, label="glow") for size in sizes)
        return a, b, c, d

    def _pass(
        self,
        entry: str,
        axis: str,
        source: Texture,
        bodies: Texture | None = None,
        target: str = BETWEEN,
    ) -> FullscreenPass:
        plan = self._x if axis == "x" else self._y
        return FullscreenPass(
            self.gpu,
            MODULE,
            entry,
            [target],
            [self._group(source, bodies)],
            variants={AXIS: plan.wgsl(axis == "x", self.glow.fraction, BODY_LIMIT)},
            blend=PLUS if bodies else None,
        )

    def _group(self, source: Texture, bodies: Texture | None) -> BindGroup:
        resources: dict[int, tuple[str, Any]] = {0: ("float", source.view)}
        if bodies is not None:
            resources[1] = ("float", bodies.view)
        return bind_group(self.gpu, resources, "glow")

    def encode(self, encoder: Any, within: tuple[int, int, int, int] | None = None) -> None:
        """Records the glow.

        `within`: (x, y, width, height) in pixels that holds all bodies; what is outside it
        is 0. None is the whole picture.
        """
        if self.glow.fraction == 0:
            return
        reached = self._filter(encoder, within)
        if reached is not None:
            self._draw(encoder, "scatter", self._target, *reached)

    def encode_filtered(self, encoder: Any, target: Texture) -> None:
        """Records G∗B alone into `target` (rgba16float, of the view's size), for figures."""
        reached = self._filter(encoder, None)
        if reached is not None:
            self._draw(encoder, "expand y", target, *reached)

    def _filter(
        self, encoder: Any, within: tuple[int, int, int, int] | None
    ) -> tuple[Span, Span] | None:
        """Records all but the last pass; columns and rows that light reaches, or None."""
        x, y, width, height = within or (0, 0, *self._size)
        columns = max(x, 0), min(x + width, self._x.length)
        rows = max(y, 0), min(y + height, self._y.length)
        if columns[0] >= columns[1] or rows[0] >= rows[1]:
            return None
        in_x, in_y = self._x.spans(columns), self._y.spans(rows)
        self._draw(encoder, "reduce x", self._columns, in_x.reduced, in_y.source)
        self._draw(encoder, "reduce y", self._cells, in_x.reduced, in_y.reduced)
        self._draw(encoder, "filter x", self._swept, in_x.filtered, in_y.reduced)
        self._draw(encoder, "filter y", self._cells, in_x.filtered, in_y.filtered)
        self._draw(encoder, "expand x", self._rows, in_x.reached, in_y.filtered)
        return in_x.reached, in_y.reached

    def _draw(self, encoder: Any, name: str, target: Texture, x: Span, y: Span) -> None:
        """One pass over columns and rows of `target`; the rest stays, and is not read."""
        step = self._passes[name]
        render = encoder.begin_render_pass(
            label=f"glow: {name}", color_attachments=[color_attachment(target.view, load=True)]
        )
        render.set_pipeline(step.pipeline)
        render.set_bind_group(0, step.groups[0].group)
        render.set_scissor_rect(x[0], y[0], x[1] - x[0], y[1] - y[0])
        render.draw(3)
        render.end()
