"""The veil of a whole picture on the GPU."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glare.whole_picture import tables
from andon.glare.whole_picture.charts import MARGIN, Chart, block_shape
from andon.glare.whole_picture.ladder import Rung
from andon.glare.whole_picture.neighbours_pass import NeighboursPass
from andon.glare.whole_picture.plan import WholePlan
from andon.glare.whole_picture.splines import filters
from andon.gpu.bindings import bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import FullscreenPass, color_attachment
from andon.gpu.textures import Texture, make_texture

__all__ = ["WholePictureStage"]

# Light and veil between passes: half floats are cut, not rounded, by some drivers. The last step
# alone has half floats, since only these can be interpolated by all adapters.
BETWEEN, SMOOTH = "rgba32float", "rgba16float"
# Solid angles that grow by more than this of themselves to the next pixel are not for a sampler.
EVEN = 0.003
# Texels of a half whose four pixels are not all of the picture.
BORDER = 2
FOLDER = "andon/glare/whole_picture"
NUMBERS = f"{FOLDER}/numbers.wgsl"
Bindings = dict[int, tuple[str, Any]]
# Veil on top of what stays: alpha of the veil says how much does, alpha of the picture stays.
STAYS = {
    "color": {"operation": "add", "src_factor": "one", "dst_factor": "src-alpha"},
    "alpha": {"operation": "add", "src_factor": "zero", "dst_factor": "one"},
}


@dataclass(frozen=True)
class _Step:
    """A pass, what it draws into, and the texels that each of its own reads.

    `inside` draws instead where it is not within `BORDER` texels of the border.
    """

    drawn: FullscreenPass
    target: Texture
    taps: int
    inside: FullscreenPass | None = None

    def encode(self, encoder: Any) -> None:
        if self.inside is None:
            self.drawn.encode(encoder, [self.target.view])
            return
        width, height = self.target.width, self.target.height
        across, down = width - 2 * BORDER, height - 2 * BORDER
        render = encoder.begin_render_pass(
            label=self.inside.label, color_attachments=[color_attachment(self.target.view)]
        )
        for step, areas in (
            (self.inside, [(BORDER, BORDER, across, down)]),
            (
                self.drawn,
                [
                    (0, 0, width, BORDER),
                    (0, height - BORDER, width, BORDER),
                    (0, BORDER, BORDER, down),
                    (width - BORDER, BORDER, BORDER, down),
                ],
            ),
        ):
            render.set_pipeline(step.pipeline)
            render.set_bind_group(0, step.groups[0].group)
            for area in areas:
                render.set_scissor_rect(*area)
                render.draw(3)
        render.end()


class WholePictureStage:
    """Draws `source` with its veil into `target`, both of the plan's view.

    `source` is rgba16float or rgba32float, in it NaN and negative values count as 0 and what is
    above 65504 as that; `target` is rgba16float and gets the source's alpha.

    finite : the source is known to hold no NaN, no infinity and nothing negative, so that it need
        not be looked at pixel by pixel: half the time.
    """

    def __init__(
        self,
        gpu: Gpu,
        source: Texture,
        target: Texture,
        plan: WholePlan,
        /,
        *,
        finite: bool = False,
    ) -> None:
        for name, texture in (("source", source), ("target", target)):
            if (texture.height, texture.width) != plan.view.shape:
                size, view = f"{texture.width}×{texture.height}", plan.view
                raise InputError(
                    f"must be {view.width}×{view.height} px, got {size}", field=f"glare.{name}"
                )
        self.gpu, self.plan, self._source, self._target = gpu, plan, source, target
        # Only half floats can be sampled by all adapters.
        self._trusted = finite and source.format == SMOOTH
        self._sampler = gpu.device.create_sampler(mag_filter="linear", min_filter="linear")
        self._shapes = _halvings(plan)
        self._veils = [make_texture(gpu, SMOOTH, *shape[::-1]) for shape in self._shapes]
        self._lights = [_levels(gpu, chart, plan.levels) for chart in plan.charts]
        self._steps = [*self._light(), *self._far(), *self._spread(), *self._seen()]
        self._copy, self._out, self._alone = self._last()
        self._neighbours: NeighboursPass | None = None
        if plan.neighbours is not None:
            self._neighbours = NeighboursPass(gpu, source, SMOOTH, plan.neighbours)

    def _pass(
        self,
        module: str,
        entry: str,
        target: Texture,
        resources: Bindings,
        numbers: str = "",
        taps: int = 0,
    ) -> _Step:
        variants = {NUMBERS: numbers or _numbers(self.plan)}
        group = bind_group(self.gpu, resources, entry)
        path = f"{FOLDER}/{module}.wgsl"
        drawn = FullscreenPass(self.gpu, path, entry, [target.format], [group], variants=variants)
        return _Step(drawn, target, taps)

    def _filled(self, values: NDArray[Any], format: str = "rgba32float") -> Any:
        """The view of a texture of these values (rows, columns[, channels])."""
        texture = make_texture(self.gpu, format, values.shape[1], values.shape[0])
        texture.write(values)
        return texture.view

    def _light(self) -> list[_Step]:
        """Pixels → blocks → cells of all levels."""
        steps: list[_Step] = []
        picture = self._source
        for shape in self._shapes[:-1]:
            half = make_texture(self.gpu, BETWEEN, *shape[::-1])
            steps.append(self._halved("halve", picture, half, picture.view))
            picture = half
        for chart, levels in zip(self.plan.charts, self._lights, strict=True):
            blocks = make_texture(self.gpu, BETWEEN, *self._shapes[-1][::-1])
            factors = tables.block_factors(self.plan, chart)
            even = float(np.abs(factors[..., 2:]).max()) < EVEN
            views = self._filled(factors)
            steps.append(self._halved("reduce_blocks", picture, blocks, views, even=even))
            roots = [
                self._filled(_first_root(self.plan, chart, level), "r32float")
                for level in range(1, self.plan.levels + 1)
            ]
            self._blocks = blocks.view
            steps.append(self._gathered(chart, blocks, levels[0], roots[0]))
            for finer, coarser, root in zip(levels, levels[1:], roots[1:], strict=False):
                inputs: Bindings = {0: ("float", finer.view), 1: ("float", root)}
                steps.append(self._pass("light", "reduced", coarser, inputs, taps=17))
        return steps

    def _halved(
        self, entry: str, picture: Texture, half: Texture, factors: Any, *, even: bool = True
    ) -> _Step:
        """A halving; that of the picture itself is sampled where it may be."""
        inputs: Bindings = {0: ("float", picture.view), 1: ("float", factors)}
        numbers = _numbers(self.plan, picture=picture is self._source)
        step = self._pass("light", entry, half, inputs, numbers, 17)
        large = min(half.width, half.height) > 2 * BORDER
        even &= self.plan.view.projection != "latlong"
        if not (self._trusted and picture is self._source and even and large):
            return step
        inputs[0] = ("smooth", picture.view)
        inputs[2] = ("linear sampler", self._sampler)
        if entry == "halve":
            del inputs[1]
        smooth = self._pass("light_smooth", entry, half, inputs)
        return replace(step, inside=smooth.drawn)

    def _gathered(self, chart: Chart, blocks: Texture, cells: Texture, roots: Any) -> _Step:
        found = tables.windows(self.plan, chart)
        views = (blocks.view, roots, self._filled(found.first), self._filled(found.steps))
        inputs = {index: ("float", view) for index, view in enumerate(views)}
        entry = "gathered" if found.size else "gathered_exactly"
        # Exactly: a block and its place, as many as the windows have in the mean.
        each = 2 * float(np.mean(found.first[..., 2] * found.first[..., 3]))
        taps = int(np.prod(found.size) if found.size else np.ceil(each)) + 3
        numbers = _numbers(self.plan, window=found.size)
        return self._pass("spline", entry, cells, inputs, numbers, taps)

    def _far(self) -> list[_Step]:
        """Cells of level F in a row, and the matrix times it; `_far_light`, `_far_places`."""
        far, lights = self.plan.far, [levels[self.plan.far.level - 1] for levels in self._lights]
        lit, matrix, places = tables.far_tables(far, [(t.height, t.width) for t in lights])
        self._far_places = [self._filled(index, "r32uint") for index in places]
        strip = make_texture(self.gpu, BETWEEN, lit.shape[1], 1, label="light of coarse cells")
        self._far_light = make_texture(
            self.gpu, BETWEEN, tables.STRIP, -(-len(matrix) // tables.STRIP), label="far light"
        )
        shared = {2: ("uint", self._filled(lit, "rgba32uint")), 3: ("float", self._filled(matrix))}
        cells = {0: ("float", lights[0].view), 1: ("float", lights[-1].view), **shared}
        row = {0: ("float", strip.view), 1: ("float", strip.view), **shared}
        return [
            self._pass("far", "collected", strip, cells, taps=3),
            self._pass("far", "far", self._far_light, row, taps=5 * matrix.shape[1]),
        ]

    def _spread(self) -> list[_Step]:
        """From the coarsest level to the first: a level's veil takes the place of its light."""
        steps: list[_Step] = []
        for chart, levels, places in zip(
            self.plan.charts, self._lights, self._far_places, strict=True
        ):
            far = {3: ("float", self._far_light.view), 4: ("uint", places)}
            for level in range(self.plan.levels, 0, -1):
                above = levels[level].view if level < self.plan.levels else None
                steps += self._level(chart, level, levels[level - 1], above, far)
        return steps

    def _level(
        self, chart: Chart, level: int, cells: Texture, above: Any | None, far: Bindings
    ) -> list[_Step]:
        """Its rungs along x, and along y with all that is on top."""
        rungs = self.plan.rungs_of(level)
        numbers = _numbers(self.plan, level)
        steps: list[_Step] = []
        swept: list[Any] = []
        for rung, entry in zip(rungs, ("filtered_x", "filtered_x_second"), strict=False):
            target = make_texture(self.gpu, BETWEEN, cells.width, cells.height)
            # The first has its √w in alpha of the cells.
            root = self._filled(_root(self.plan, chart, rung), "r32float") if swept else cells.view
            inputs = {0: ("float", cells.view), 1: ("float", root)}
            reads = _reads(level, rung) * (2 if swept else 1)
            steps.append(self._pass("spread", entry, target, inputs, numbers, reads))
            swept.append(target.view)
        # What the constants leave out is not read, but must be there and not be drawn into.
        unread = far[3]
        inputs = {
            index: ("float", view) if view is not None else unread
            for index, view in enumerate((*swept, None, None)[:2])
        }
        inputs[2] = unread if above is None else ("float", above)
        reads = sum(_reads(level, rung) for rung in rungs)
        reads += 4 * (above is not None) + 2 * (level == self.plan.far.level)
        steps.append(self._pass("spread", "accumulated", cells, inputs | far, numbers, reads))
        return steps

    def _seen(self) -> list[_Step]:
        """Cells of level 1 → blocks → … → halves."""
        inputs: Bindings = {}
        for index, (chart, levels) in enumerate(zip(self.plan.charts, self._lights, strict=True)):
            inputs[2 * index] = ("float", levels[0].view)
            places = self._filled(tables.block_places(self.plan, chart))
            inputs[2 * index + 1] = ("float", places)
        # The same for both charts.
        inputs[7] = ("float", self._blocks)
        entry = "blocks_seen_by_two" if self.plan.pair else "blocks_seen"
        taps = 10 * len(self.plan.charts)
        steps = [self._pass("seen", entry, self._veils[-1], inputs, taps=taps)]
        for finer, coarser in zip(self._veils[-2::-1], self._veils[:0:-1], strict=True):
            steps.append(self._pass("seen", "expand_blocks", finer, self._smooth(coarser), taps=4))
        return steps

    def _smooth(self, veil: Texture) -> Bindings:
        return {4: ("smooth", veil.view), 5: ("linear sampler", self._sampler)}

    def _last(self) -> tuple[FullscreenPass, FullscreenPass, FullscreenPass]:
        """The picture itself; the veil on top of it; the veil alone."""
        veil = [bind_group(self.gpu, self._smooth(self._veils[0]), "veil")]
        picture = [bind_group(self.gpu, {6: ("float", self._source.view)}, "picture")]
        path, formats = f"{FOLDER}/seen.wgsl", [self._target.format]
        return (
            FullscreenPass(self.gpu, path, "copied", formats, picture),
            FullscreenPass(self.gpu, path, "expand_blocks", formats, veil, blend=STAYS),
            FullscreenPass(self.gpu, path, "added", formats, veil),
        )

    def encode(self, encoder: Any) -> None:
        """Records (1 − k)·L + veil into the target."""
        self._encode_veil(encoder)
        if self._trusted:
            encoder.copy_texture_to_texture(
                {"texture": self._source.handle},
                {"texture": self._target.handle},
                (self._target.width, self._target.height, 1),
            )
        else:
            self._copy.encode(encoder, [self._target.view])
        render = encoder.begin_render_pass(
            label="veil", color_attachments=[color_attachment(self._target.view, load=True)]
        )
        render.set_pipeline(self._out.pipeline)
        render.set_bind_group(0, self._out.groups[0].group)
        render.draw(3)
        render.end()
        if self._neighbours is not None:
            self._neighbours.encode(encoder, self._target, alone=False)

    def encode_glare(self, encoder: Any, texture: Texture) -> None:
        """Records the veil alone into `texture` (rgba16float, of the view's size), alpha 0."""
        self._encode_veil(encoder)
        self._alone.encode(encoder, [texture.view])
        if self._neighbours is not None:
            self._neighbours.encode(encoder, texture, alone=True)

    def cost(self) -> tuple[int, int]:
        """Texels read and bytes read and written for a picture."""
        width, height = self.plan.view.width, self.plan.view.height
        texels = [(step.target.width * step.target.height, step.taps) for step in self._steps]
        taps = sum(count * each for count, each in texels)
        written = sum(count for count, _ in texels)
        # The picture: read, written, read and written again; a sample of the veil is four texels.
        pixels = width * height
        if self._neighbours is not None:
            taps += self._neighbours.TAPS * pixels
        return taps + 6 * pixels, 16 * (taps + written) + 8 * 8 * pixels

    def _encode_veil(self, encoder: Any) -> None:
        for step in self._steps:
            step.encode(encoder)


def _halvings(plan: WholePlan) -> list[tuple[int, int]]:
    """Shapes of the halves of the picture, the last that of the blocks."""
    shapes = [plan.view.shape]
    while not shapes[1:] or shapes[-1] != block_shape(plan.view):
        height, width = shapes[-1]
        shapes.append((-(-height // 2) + 2, -(-width // 2) + 2))
    return shapes[1:]


def _levels(gpu: Gpu, chart: Chart, count: int) -> list[Texture]:
    shapes = [chart.array_shape(level) for level in range(1, count + 1)]
    return [make_texture(gpu, BETWEEN, columns, rows) for rows, columns in shapes]


def _root(plan: WholePlan, chart: Chart, rung: Rung) -> NDArray[np.float64]:
    """√w of the cells of a rung's level."""
    return plan.root(rung, chart.scale(chart.cell_directions(rung.level)))


def _reads(level: int, rung: Rung) -> int:
    return 2 * len(filters(level)[rung.which]) - 1


def _first_root(plan: WholePlan, chart: Chart, level: int) -> NDArray[np.float64]:
    """√w of a level's first rung, 0 where it has none."""
    rungs = plan.rungs_of(level)
    return _root(plan, chart, rungs[0]) if rungs else np.zeros(chart.array_shape(level))


def _numbers(
    plan: WholePlan,
    level: int = 1,
    window: tuple[int, int] | None = None,
    *,
    picture: bool = False,
) -> str:
    """The constants that stand in for numbers.wgsl."""
    row = "1.0"
    if picture and plan.view.projection == "latlong":
        row = f"sin((f32(row) + 0.5) * {np.pi / plan.view.height:.9g}f)"
    columns, rows = window or (1, 1)
    rungs = plan.rungs_of(level)
    taps = [filters(level)[rung.which] for rung in rungs] + [(1.0, 0.0)] * (2 - len(rungs))
    lines = [
        f"const MARGIN: i32 = {MARGIN};",
        f"const WINDOW = vec2i({columns}, {rows});",
        f"const RUNGS: i32 = {len(rungs)};",
        f"const HAS_BLOCKS: bool = {str(bool(plan.of_blocks().max() > 0)).lower()};",
        f"const WRAPS: bool = {str(plan.wraps).lower()};",
        f"const HAS_ABOVE: bool = {str(level < plan.levels).lower()};",
        f"const HAS_FAR: bool = {str(level == plan.far.level).lower()};",
        f"fn weight_of_row(row: i32) -> f32 {{ return {row}; }}",
    ]
    for name, side in zip(("", "WIDE_"), taps, strict=True):
        values = ", ".join(f"{tap:.9g}f" for tap in side)
        lines.append(f"const {name}RADIUS: i32 = {len(side) - 1};")
        lines.append(f"const {name}TAPS = array<f32, {len(side)}>({values});")
    return "\n".join(lines)
