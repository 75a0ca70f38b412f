"""Blurring and composing the layers on the GPU."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from andon.errors import InputError
from andon.glass.defocus.kernels import LEAST_BLUR_PX, MAX_BLUR_PX
from andon.glass.defocus.plan import LEVELS, DiscPlan, Rect, grown, size_table
from andon.glass.model import Blur
from andon.gpu.bindings import bind_group
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

# Largest blur of what is refracted, sticks to the surface, is mirrored, in px.
Largest = tuple[float, float, float]
IMAGES = ("refracted", "reflected")


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
    `refracted`    rgb times coverage; a: diameter of the blur in px
    `surface`      rgb times α and coverage; a: α·coverage
    `reflected`    rgb times coverage; a: diameter in px
    `sizes`        r: coverage, 0 or 1 (a share is taken as a weight); g: diameter in px
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
        self._reduce = {n: self._reducing(n) for n in range(1, DEEPEST + 1)}
        self._fill = {n: self._filling(n) for n in range(1, DEEPEST + 1)}
        self._disc = {(n, s): self._gathering(n, s) for n in LEVELS for s in (False, True)}
        self._settle = {(n, s): self._settling(n, s) for n in LEVELS for s in (False, True)}
        self._compose: dict[tuple[bool, bool, bool], FullscreenPass] = {}

    def encode(
        self, encoder: Any, within: Rect | None = None, largest: Largest = (MAX_BLUR_PX,) * 3
    ) -> None:
        """Records the blur and the composition.

        Parameters
        ----------
        within : (x, y, width, height) in pixels that holds all glass; None is the whole picture.
        largest : diameter in px that no pixel of refracted, surface, reflected exceeds; a layer
            with less than a pixel is sharp and costs nothing but its composition.
        """
        reach = self._largest(largest)
        rect = within or (0, 0, *self._size)
        drawn = grown(rect, reach[1] / 2 + 1 if reach[1] else 0, 1, self._size)
        if not (rect[2] > 0 and rect[3] > 0 and drawn[2] and drawn[3]):
            return
        if any(reach):
            self._encode_pyramid(encoder, rect, reach)
        render = self._begin(encoder, "compose", [self._target], drawn, load=True)
        self._draw(render, self._composing(reach), self._compose_group(reach))

    def _largest(self, largest: Largest) -> Largest:
        """Diameters of discs; 0 for what stays sharp."""
        refracted, surface, reflected = (
            0.0 if self.kind == "off" or px < LEAST_BLUR_PX else self._plan.diameter(px)
            for px in largest
        )
        return (0.0 if self.kind == "paper" else refracted), surface, reflected

    def _encode_pyramid(self, encoder: Any, rect: Rect, reach: Largest) -> None:
        around = (max(reach) + reach[1]) * (0.5 if self._plan.shape == "optical" else 0.75)
        rects = {
            n: grown(rect, around + MARGIN_PX, 2**n, self._level_size(n), MARGIN_TEXELS)
            for n in self._levels
        }
        for n in range(1, DEEPEST + 1):
            targets = list(self._levels[n].means.values())
            render = self._begin(encoder, f"reduce {n}", targets, rects[n], load=False)
            self._draw(render, self._reduce[n])
        for n in range(DEEPEST, 0, -1):
            targets = list(self._levels[n].filled.values())
            render = self._begin(encoder, f"fill {n}", targets, rects[n], load=True)
            self._draw(render, self._fill[n])
        for name, px in zip(("refracted", "surface", "reflected"), reach, strict=True):
            used = self._plan.levels_of(px)
            for n in reversed(used):
                self._encode_level(encoder, n, name, rects[n], is_last=n == used[-1])

    def _encode_level(self, encoder: Any, n: int, name: str, rect: Rect, *, is_last: bool) -> None:
        level, is_sheet = self._levels[n], name == "surface"
        own = (level.means if is_sheet else level.filled)[name], level.filled["sizes"]
        targets = [level.discs["light"], *([level.discs["rim"]] if is_sheet else [])]
        render = self._begin(encoder, f"discs {name} {n}", targets, rect, load=True)
        self._draw(render, self._disc[n, is_sheet], self._disc_group(*own, *own))
        coarser = self._levels[n if is_last else n + 1]
        beyond = own if is_last else (coarser.answers[name], coarser.answers["rim"])
        discs = level.discs["light"], level.discs["rim"]
        answers = [level.answers[name], *([level.answers["rim"]] if is_sheet else [])]
        render = self._begin(encoder, f"settle {name} {n}", answers, rect, load=True)
        self._draw(render, self._settle[n, is_sheet], self._disc_group(*discs, *beyond))

    # ── passes ──────────────────────────────────────────────────────────────────────────────────

    def _begin(
        self, encoder: Any, label: str, targets: Sequence[Texture], rect: Rect, *, load: bool
    ) -> Any:
        render = encoder.begin_render_pass(
            label=f"defocus: {label}",
            color_attachments=[color_attachment(t.view, load=load) for t in targets],
        )
        render.set_scissor_rect(*rect)
        return render

    def _draw(self, render: Any, step: FullscreenPass, group: Any = None) -> None:
        render.set_pipeline(step.pipeline)
        render.set_bind_group(0, (group or step.groups[0]).group)
        render.draw(3)
        render.end()

    def _reducing(self, n: int) -> FullscreenPass:
        finer = self._levels[n - 1].means
        group = self._pyramid_group(finer, finer)
        return FullscreenPass(self.gpu, f"{FOLDER}/pyramid.wgsl", "reduce", [FORMAT] * 4, [group])

    def _filling(self, n: int) -> FullscreenPass:
        # The coarsest has no coarser one: what it does not know is farther away than any disc.
        beyond = self._levels[n + 1].filled if n < DEEPEST else self._levels[n].means
        group = self._pyramid_group(self._levels[n].means, beyond)
        return FullscreenPass(self.gpu, f"{FOLDER}/pyramid.wgsl", "fill", [FORMAT] * 3, [group])

    def _gathering(self, n: int, is_sheet: bool) -> FullscreenPass:
        level = self._levels[n]
        source = level.means["surface"], level.filled["sizes"]
        return self._disc_pass(n, "gather", is_sheet, self._disc_group(*source, *source))

    def _settling(self, n: int, is_sheet: bool) -> FullscreenPass:
        source = self._levels[n].discs["light"], self._levels[n].discs["rim"]
        return self._disc_pass(n, "settle", is_sheet, self._disc_group(*source, *source))

    def _disc_pass(self, n: int, verb: str, is_sheet: bool, group: Any) -> FullscreenPass:
        return FullscreenPass(
            self.gpu,
            f"{FOLDER}/gather.wgsl",
            f"{verb}_{'sheet' if is_sheet else 'image'}",
            [FORMAT] * (2 if is_sheet else 1),
            [group],
            variants={KERNEL: self._plan.wgsl(n)},
        )

    def _composing(self, reach: Largest) -> FullscreenPass:
        blurs = bool(reach[0]), bool(reach[1]), bool(reach[2])
        if blurs not in self._compose:
            self._compose[blurs] = FullscreenPass(
                self.gpu,
                f"{FOLDER}/compose.wgsl",
                "compose",
                [FORMAT],
                [self._compose_group(reach)],
                variants={KERNEL: self._plan.wgsl(0, blurs)},
                blend=OVER,
            )
        return self._compose[blurs]

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

    def _group(self, *textures: Texture, table: bool) -> Any:
        """The sampler, the table, and textures that are read between pixels, in order."""
        resources: dict[int, tuple[str, Any]] = {0: ("linear sampler", self._sampler)}
        if table:
            resources[1] = ("float", self._table.view)
        for texture in textures:
            resources[len(resources)] = ("smooth", texture.view)
        return bind_group(self.gpu, resources, "defocus")

    def _pyramid_group(self, own: dict[str, Texture], beyond: dict[str, Texture]) -> Any:
        own_textures = (own[name] for name in ("refracted", "surface", "reflected", "sizes"))
        coarser = (beyond[name] for name in (*IMAGES, "sizes"))
        return self._group(*own_textures, *coarser, table=False)

    def _disc_group(self, *textures: Texture) -> Any:
        return self._group(*textures, table=True)

    def _compose_group(self, reach: Largest) -> Any:
        """What was blurred is read from the pyramid's answers, the rest from what it goes on with."""
        level = self._levels[1]
        far = [bool(self._plan.levels_of(px)) for px in reach]
        coarser = (
            level.answers["refracted"] if far[0] else level.filled["refracted"],
            level.answers["surface"] if far[1] else level.means["surface"],
            level.answers["reflected"] if far[2] else level.filled["reflected"],
            level.answers["rim"] if far[1] else level.filled["sizes"],
        )
        sources = (self._sources[name] for name in ("refracted", "surface", "reflected", "sizes"))
        return self._group(*sources, *coarser, table=True)
