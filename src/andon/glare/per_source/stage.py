"""The veil of known sources on the GPU."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon import gbuffer
from andon.errors import InputError
from andon.glare.kernel import Kernel
from andon.glare.model import Source
from andon.glare.per_source.atlas import Atlas
from andon.glare.per_source.halos import HALO_STEPS, halo_table
from andon.glare.per_source.model import PerSource
from andon.glare.per_source.records import (
    FAR,
    HALO,
    MIDDLE,
    NEAR,
    STRUCTS,
    VEIL_SOURCE,
    constants,
    pack_source,
)
from andon.glare.per_source.reference import checked_weights, has_core
from andon.glare.per_source.rings import halo_samples, reach_chord, rings_of
from andon.glare.per_source.tables import table_of
from andon.gpu.bindings import BindGroup, bind_group
from andon.gpu.device import Gpu
from andon.gpu.passes import PLUS, color_attachment, pipeline_layout, shader_module
from andon.gpu.textures import Texture, make_texture, uniform_buffer, write_buffer
from andon.observer.spread.model import SpreadFunction
from andon.spaces import View

__all__ = ["PerSourceStage"]

FORMAT = "rgba16float"
FOLDER = "andon/glare/per_source"
CAP = "andon/glare/quads/{}.wgsl"
# A ring that ends beyond this chord is the whole picture, and is drawn with others.
WHOLE = 1.4
RINGS = 4


class PerSourceStage:
    """Adds the veil of sources to a picture, rgba16float of the view's size; its alpha stays.

    Sources whose veil is seen in the whole picture are summed in one pass in float32; each ring
    that is drawn apart is rounded to half floats as it is added, by up to 0.05 % of the sum.
    """

    def __init__(
        self,
        gpu: Gpu,
        view: View,
        capacity: int,
        /,
        *,
        outlines: int = 16,
        luminance_per_unit: float = 1.0,
    ) -> None:
        """At most `capacity` sources, of them `outlines` different ones that are no circles."""
        self.gpu, self.view, self.capacity = gpu, view, capacity
        self._luminance_per_unit = luminance_per_unit
        self._atlas = Atlas(gpu, outlines)
        self._halos = make_texture(gpu, "rgba32float", HALO_STEPS, 1, label="halos")
        self._view = uniform_buffer(gpu, gbuffer.VIEW_RECORD.dtype.itemsize, "view")
        write_buffer(gpu, self._view, gbuffer.pack_view(view))
        self._sources = self._storage(capacity * VEIL_SOURCE.dtype.itemsize)
        self._instances = self._storage(capacity * RINGS * 8)
        self._whole = uniform_buffer(gpu, 16, "sources in the whole picture")
        self._group = self._bindings()
        self._halo: SpreadFunction | None = None
        # Pipeline, first instance, how many.
        self._draws: list[tuple[tuple[str, str], int, int]] = []
        self._pipelines = {
            (shape, entry): self._pipeline(shape, entry)
            for shape in ("circle", "outline")
            for entry in ("whole_light", "far_light", "near_light")
        }

    def _storage(self, size: int) -> Any:
        import wgpu

        usage = wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_DST
        return self.gpu.device.create_buffer(label="glare", size=max(16, size), usage=usage)

    def _bindings(self) -> BindGroup:
        resources: dict[int, tuple[str, Any]] = {
            0: ("uniform", self._view),
            1: ("storage", self._sources),
            2: ("storage", self._instances),
            3: ("float array", self._atlas.tables.view),
            4: ("float", self._atlas.edges.view),
            5: ("float", self._halos.view),
            6: ("uniform", self._whole),
        }
        return bind_group(self.gpu, resources, "glare")

    def _pipeline(self, shape: str, entry: str) -> Any:
        variants = gbuffer.projection_variant(self.view) | {
            CAP.format("pinhole"): CAP.format(self.view.projection),
            f"{FOLDER}/circle.wgsl": f"{FOLDER}/{shape}.wgsl",
            f"{FOLDER}/constants.wgsl": constants(),
        }
        structs = STRUCTS | gbuffer.STRUCTS
        module = shader_module(self.gpu, f"{FOLDER}/veil.wgsl", structs, variants)
        return self.gpu.device.create_render_pipeline(
            label=f"glare: {shape} {entry}",
            layout=pipeline_layout(self.gpu, [self._group]),
            vertex={
                "module": module,
                "entry_point": "fullscreen" if entry == "whole_light" else "source_quad",
            },
            primitive={"topology": "triangle-list"},
            fragment={
                "module": module,
                "entry_point": entry,
                "targets": [{"format": FORMAT, "blend": PLUS}],
            },
        )

    def update(
        self,
        sources: Sequence[Source],
        kernel: Kernel,
        /,
        *,
        halo: SpreadFunction | None = None,
        weights: Sequence[float] | None = None,
        settings: PerSource | None = None,
    ) -> None:
        """The sources that are drawn from now on; `veil_of_sources` has the parameters.

        Raises `InputError` for more than `capacity`, or more different outlines than `outlines`.
        """
        if len(sources) > self.capacity:
            raise InputError(
                f"at most {self.capacity} sources, got {len(sources)}", field="glare.sources"
            )
        settings = PerSource() if settings is None else settings
        shares = checked_weights(sources, weights)
        core = has_core(self.view, kernel) if settings.core is None else settings.core
        self._atlas.begin(kernel, core, settings.bloom)
        rows = self._atlas.rows_of([source.outline for source in sources])
        # Filled, not concatenated: that would pack the struct and lose its stride.
        records = np.zeros(len(sources), VEIL_SOURCE.dtype)
        for i, (source, row, share) in enumerate(zip(sources, rows, shares, strict=True)):
            ring = self._halo_of(source, halo, share)
            records[i] = self._record(source, kernel, row, ring, settings, core)[0]
        self._plan(sources, records, settings.bloom_drawn)

    def _halo_of(
        self, source: Source, halo: SpreadFunction | None, share: float
    ) -> tuple[NDArray[np.float64], float, int]:
        """Share of its ring, where that ends, and samples."""
        if halo is None or share == 0:
            return np.zeros(3), 0.0, 1
        ring = halo_table(halo)
        if halo is not self._halo:
            self._halos.write(np.pad(ring.values, ((0, 0), (0, 1))))
            self._halo = halo
        return share * ring.weakening(source.outline), ring.end, halo_samples(self.view)

    def _record(
        self,
        source: Source,
        kernel: Kernel,
        rows: tuple[float, float],
        halo: tuple[NDArray[np.float64], float, int],
        settings: PerSource,
        core: bool,
    ) -> NDArray[Any]:
        table = table_of(kernel, source.outline, core=core, bloom=settings.bloom)
        reach = reach_chord(table, float(source.illuminance_lux.max()), settings.least_cd_m2)
        rings = rings_of(self.view, kernel, source.outline, reach)
        return pack_source(
            source,
            table,
            rings,
            rows=rows,
            halo=halo,
            luminance_per_unit=self._luminance_per_unit,
        )

    def _plan(self, sources: Sequence[Source], records: NDArray[Any], bloom: bool) -> None:
        """Writes sources and instances: circles first, of them first those that are everywhere."""
        is_outline = np.array([len(s.outline.radii_radians) > 1 for s in sources], bool)
        is_local = records["ends"][:, FAR] < WHOLE
        order = np.lexsort((is_local, is_outline))
        records, is_outline, is_local = records[order], is_outline[order], is_local[order]
        instances: list[tuple[int, int]] = []
        self._draws = []
        whole: list[int] = []
        for shape, of_shape in (("circle", ~is_outline), ("outline", is_outline)):
            everywhere = np.nonzero(of_shape & ~is_local & bloom)[0]
            first = int(everywhere[0]) if len(everywhere) else 0
            whole += [first, first + len(everywhere)]
            if len(everywhere):
                self._draws.append(((shape, "whole_light"), 0, 1))
            ringed = of_shape & np.any(records["halo"] > 0, axis=1)
            far = [(int(i), FAR) for i in np.nonzero(of_shape & is_local & bloom)[0]]
            bloomed = np.nonzero(of_shape & bloom)[0]
            near = [(int(i), ring) for i in bloomed for ring in (NEAR, MIDDLE)]
            near += [(int(i), HALO) for i in np.nonzero(ringed)[0]]
            for entry, drawn in (("far_light", far), ("near_light", near)):
                if drawn:
                    self._draws.append(((shape, entry), len(instances), len(drawn)))
                instances += drawn
        if instances or any(whole):
            write_buffer(self.gpu, self._sources, records)
            write_buffer(self.gpu, self._instances, np.array(instances or [(0, 0)], np.uint32))
            write_buffer(self.gpu, self._whole, np.array(whole, np.uint32))

    def encode(self, encoder: Any, target: Texture) -> None:
        """Records the veil onto `target`, whose light stays."""
        if not self._draws:
            return
        render = encoder.begin_render_pass(
            label="glare: sources", color_attachments=[color_attachment(target.view, load=True)]
        )
        render.set_bind_group(0, self._group.group)
        vertices = 12 if self.view.projection == "latlong" else 6
        for pipeline, first, count in self._draws:
            render.set_pipeline(self._pipelines[pipeline])
            render.draw(3 if pipeline[1] == "whole_light" else vertices, count, 0, first)
        render.end()
