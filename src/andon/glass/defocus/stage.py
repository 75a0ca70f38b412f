"""Blurring and composing the layers on the GPU."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from andon.errors import InputError
from andon.glass.defocus.kernels import LEAST_BLUR_PX, MAX_BLUR_PX, REACH_SIGMAS
from andon.glass.defocus.plan import LEVELS, DiscPlan, Rect, Three, grown, size_table
from andon.glass.model import Blur
from andon.gpu.bindings import BindGroup, bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import FullscreenPass, color_attachment
from andon.gpu.textures import Texture, make_texture

__all__ = ["DefocusStage"]

FORMAT = "rgba16float"
FOLDER = "andon/glass/defocus"
KERNEL = f"{FOLDER}/kernel.wgsl"
# Levels of the pyramid that only go on with images beyond the rim: 2⁶ px, the largest disc.
DEEPEST = 6
# Pixels that are drawn around what the discs reach, and texels of each level.
MARGIN_PX, MARGIN_TEXELS = 8, 3
# rgb over what is there, by 1 − alpha; the alpha of the frame stays.
OVER = {
    "color": {"operation": "add", "src_factor": "one", "dst_factor": "one-minus-src-alpha"},
    "alpha": {"operation": "add", "src_factor": "zero", "dst_factor": "one"},
}

# Of what is refracted, sticks to the surface, is mirrored, px.
Diameters = tuple[float, float, float]
IMAGES = ("refracted", "reflected")
LAYERS = ("refracted", "surface", "reflected")


@dataclass(frozen=True)
class _Level:
    """Textures of one level: premultiplied means, images without holes, answers of each layer."""

    means: dict[str, Texture]
    filled: dict[str, Texture]
    discs: dict[str, Texture]
    answers: dict[str, Texture]


class DefocusStage:
    """Blurs the layers of the glass and lays them over `target`; all rgba16float of one size.

    =============  =====================================================================
    `refracted`    rgb, and a: diameter of the blur in px; all times coverage
    `surface`      rgb times α and coverage; a: α·coverage
    `reflected`    rgb, and a: diameter in px; all times coverage
    `sizes`        r: coverage; g: diameter in px, times coverage
    `target`       the frame; its rgb is composed in place, its alpha stays
    =============  =====================================================================

    Where there is no glass all four layers are 0. In mode ``paper`` the refracted image is taken
    as it is.

    Raises `InputError` where a texture has another size or format.
    """

    def __init__(
        self,
        gpu: Gpu,
        refracted: Texture,
        surface: Texture,
        reflected: Texture,
        sizes: Texture,
        target: Texture,
        kind: Blur,
        size: tuple[int, int],
    ) -> None:
        given = {"refracted": refracted, "reflected": reflected, "sizes": sizes, "surface": surface}
        for name, texture in (*given.items(), ("target", target)):
            if (texture.width, texture.height) != size or texture.format != FORMAT:
                got = f"{texture.width}×{texture.height} {texture.format}"
                wanted = f"{size[0]}×{size[1]} {FORMAT}"
                raise InputError(f"must be {wanted}, got {got}", field=f"defocus.{name}")
        self.gpu, self.kind, self._size, self._target = gpu, kind, size, target
        self._sources, self._plan = given, DiscPlan(kind)
        self._sampler = gpu.device.create_sampler(mag_filter="linear", min_filter="linear")
        table = size_table(self._plan)
        self._table = make_texture(gpu, "r32float", table.shape[1], 1, label="sizes of discs")
        self._table.write(table)
        self._levels = {0: _Level(given, given, {}, {})}
        for level in range(1, DEEPEST + 1):
            self._levels[level] = self._make_level(level)
        self._passes: dict[tuple[str, str, Any], FullscreenPass] = {}
        self._groups: dict[tuple[int, ...], BindGroup] = {}

    def encode(
        self,
        encoder: Any,
        within: Rect | None = None,
        largest: Diameters = (MAX_BLUR_PX, MAX_BLUR_PX, MAX_BLUR_PX),
        smallest: Diameters = (0.0, 0.0, 0.0),
    ) -> None:
        """Records the blur and the composition.

        Parameters
        ----------
        within : (x, y, width, height) in pixels that holds all glass; None is the whole picture.
        largest : diameter in px that no pixel of refracted, surface, reflected exceeds; a layer
            with less than a pixel is sharp and costs nothing but its composition.
        smallest : diameter that no pixel falls below, where it is known: saves the passes for
            smaller discs.
        """
        most, least = self._discs(largest), self._discs(smallest)
        rect = within or (0, 0, *self._size)
        drawn = grown(rect, self._reach(most[1]), 1, self._size)
        if not (rect[2] > 0 and rect[3] > 0 and drawn[2] and drawn[3]):
            return
        if any(most):
            self._encode_pyramid(encoder, rect, most, least)
        render = self._begin(encoder, "compose", [self._target], drawn, load=True)
        step = self._pass(
            "compose", "compose", self._plan.wgsl(0, *self._uses(most, least)), blend=OVER
        )
        self._draw(render, step, self._compose_group(most))

    def _discs(self, blurs: Diameters) -> Diameters:
        """Diameters of discs; 0 for what stays sharp."""
        refracted, surface, reflected = (
            0.0 if self.kind == "off" or px < LEAST_BLUR_PX else self._plan.diameter(px)
            for px in blurs
        )
        return (0.0 if self.kind == "paper" else refracted), surface, reflected

    def _uses(self, most: Diameters, least: Diameters) -> tuple[Three, Three]:
        """Which layers are blurred, and which of them have discs that are gathered at full size."""
        blurs = bool(most[0]), bool(most[1]), bool(most[2])
        near = [self._plan.has_discs(0, px) for px in least]
        return blurs, (near[0], near[1], near[2])

    def _reach(self, disc_px: float) -> float:
        """Pixels from the middle of a disc to its last weight."""
        return disc_px * (0.5 if self._plan.shape == "optical" else REACH_SIGMAS / 4) + 1

    def _encode_pyramid(self, encoder: Any, rect: Rect, most: Diameters, least: Diameters) -> None:
        rects = {n: self._around(rect, n, most[1], max(most)) for n in self._levels}
        # What is composed reads less than what the discs read.
        inner = {n: self._around(rect, n, most[1]) for n in LEVELS}
        constants = self._plan.wgsl(0, *self._uses(most, least))
        for n in range(1, DEEPEST + 1):
            level, finer = self._levels[n], self._levels[n - 1].means
            render = self._begin(encoder, f"reduce {n}", level.means.values(), rects[n])
            step = self._pass("pyramid", "reduce", constants, targets=4)
            self._draw(render, step, self._pyramid_group(finer, finer))
        for n in range(DEEPEST, 0, -1):
            level = self._levels[n]
            # The coarsest has no coarser one: what it does not know no disc reaches.
            beyond = self._levels[n + 1].filled if n < DEEPEST else level.means
            render = self._begin(encoder, f"fill {n}", level.filled.values(), rects[n], load=True)
            step = self._pass("pyramid", "fill", constants, targets=3)
            self._draw(render, step, self._pyramid_group(level.means, beyond))
        for name, largest, smallest in zip(LAYERS, most, least, strict=True):
            used = self._plan.levels_of(largest)
            for n in reversed(used):
                self._encode_level(encoder, n, name, inner[n], n == used[-1], smallest)

    def _around(self, rect: Rect, n: int, *discs_px: float) -> Rect:
        """What discs around `rect` reach, in texels of level `n`."""
        reach = sum(self._reach(px) for px in discs_px) + MARGIN_PX
        return grown(rect, reach, 2**n, self._level_size(n), MARGIN_TEXELS)

    def _encode_level(
        self, encoder: Any, n: int, name: str, rect: Rect, is_last: bool, smallest: float
    ) -> None:
        level, is_sheet = self._levels[n], name == "surface"
        what, targets = ("sheet", 2) if is_sheet else ("image", 1)
        own = (level.means if is_sheet else level.filled)[name], level.filled["sizes"]
        discs, constants = (level.discs["light"], level.discs["rim"]), self._plan.wgsl(n)
        answers = (level.answers[name], level.answers["rim"])
        coarser = self._levels[n if is_last else n + 1].answers
        beyond = own if is_last else (coarser[name], coarser["rim"])
        if self._plan.has_discs(n, smallest):
            render = self._begin(encoder, f"discs {name} {n}", discs[:targets], rect, load=True)
            step = self._pass("gather", f"gather_{what}", constants, targets)
            self._draw(render, step, self._disc_group(*own, *own))
            verb = "settle"
        else:
            discs, verb = own, "enlarge"
        render = self._begin(encoder, f"{verb} {name} {n}", answers[:targets], rect, load=True)
        step = self._pass("gather", f"{verb}_{what}", constants, targets)
        self._draw(render, step, self._disc_group(*discs, *beyond))

    # ── passes ──────────────────────────────────────────────────────────────────────────────────

    def _begin(
        self,
        encoder: Any,
        label: str,
        targets: Iterable[Texture],
        rect: Rect,
        *,
        load: bool = False,
    ) -> Any:
        render = encoder.begin_render_pass(
            label=f"defocus: {label}",
            color_attachments=[color_attachment(t.view, load=load) for t in targets],
        )
        render.set_scissor_rect(*rect)
        return render

    def _draw(self, render: Any, step: FullscreenPass, group: BindGroup) -> None:
        render.set_pipeline(step.pipeline)
        render.set_bind_group(0, group.group)
        render.draw(3)
        render.end()

    def _pass(
        self, file: str, entry: str, constants: str, targets: int = 1, blend: Any = None
    ) -> FullscreenPass:
        """The pipeline for these constants, made at its first use."""
        key = file, entry, constants
        if key not in self._passes:
            group = {
                "pyramid": self._pyramid_group(self._levels[0].means, self._levels[1].means),
                "gather": self._disc_group(*(self._sources[name] for name in (*LAYERS, "sizes"))),
                "compose": self._compose_group((0.0, 0.0, 0.0)),
            }[file]
            self._passes[key] = FullscreenPass(
                self.gpu,
                f"{FOLDER}/{file}.wgsl",
                entry,
                [FORMAT] * targets,
                [group],
                variants={KERNEL: constants},
                blend=blend,
            )
        return self._passes[key]

    # ── textures ────────────────────────────────────────────────────────────────────────────────

    def _level_size(self, n: int) -> tuple[int, int]:
        return -(-self._size[0] // 2**n), -(-self._size[1] // 2**n)

    def _make_level(self, n: int) -> _Level:
        def made(names: Sequence[str]) -> dict[str, Texture]:
            size = self._level_size(n)
            return {m: make_texture(self.gpu, FORMAT, *size, label=f"{m} {n}") for m in names}

        return _Level(
            means=made((*IMAGES, "sizes", "surface")),
            filled=made((*IMAGES, "sizes")),
            discs=made(("light", "rim") if n in LEVELS else ()),
            answers=made((*IMAGES, "surface", "rim") if n in LEVELS else ()),
        )

    def _group(self, *textures: Texture, table: bool) -> BindGroup:
        """The sampler, the table, and textures that are read between pixels, in order."""
        key = (int(table), *(id(texture) for texture in textures))
        if key not in self._groups:
            resources: dict[int, tuple[str, Any]] = {0: ("linear sampler", self._sampler)}
            if table:
                resources[1] = ("float", self._table.view)
            for texture in textures:
                resources[len(resources)] = ("smooth", texture.view)
            self._groups[key] = bind_group(self.gpu, resources, "defocus")
        return self._groups[key]

    def _pyramid_group(self, own: dict[str, Texture], beyond: dict[str, Texture]) -> BindGroup:
        own_textures = (own[name] for name in (*LAYERS, "sizes"))
        coarser = (beyond[name] for name in (*IMAGES, "sizes"))
        return self._group(*own_textures, *coarser, table=False)

    def _disc_group(self, *textures: Texture) -> BindGroup:
        return self._group(*textures, table=True)

    def _compose_group(self, most: Diameters) -> BindGroup:
        """Blurred layers are read from the pyramid's answers, others from what it goes on with."""
        level = self._levels[1]
        far = [bool(self._plan.levels_of(px)) for px in most]
        coarser = (
            level.answers["refracted"] if far[0] else level.filled["refracted"],
            level.answers["surface"] if far[1] else level.means["surface"],
            level.answers["reflected"] if far[2] else level.filled["reflected"],
            level.answers["rim"] if far[1] else level.filled["sizes"],
        )
        sources = (self._sources[name] for name in (*LAYERS, "sizes"))
        whole = self._levels[self._plan.whole_level].means["sizes"]
        return self._group(*sources, *coarser, whole, table=True)
