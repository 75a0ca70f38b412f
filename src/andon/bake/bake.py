"""The order of a bake: first light, bounces, the volume."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from andon.bake.journal import Journal, Result
from andon.bake.places import far_m
from andon.bake.radiance_bounces import bounce_notes, traced_light
from andon.bake.report import BakeReport
from andon.bake.runner import Progress, Runner
from andon.bake.setting import passes_of, seen_setting, unscaled_of
from andon.bake.task import PARTS, Look, Pictures, bounced, encoded, first_light
from andon.bake.tasks import Workers
from andon.engines.baked import dimming_of, facts_of
from andon.engines.cubes import cube_engine
from andon.engines.cubes_radiance import check_radiance
from andon.engines.digest import digest
from andon.engines.photographless import white_cd_m2
from andon.errors import InputError
from andon.files.volumes import Cells, Distances, ProbeVolume, Zone
from andon.harmonics import coefficient_count, deringed
from andon.scene import Scene
from andon.scene.probes import Probes
from andon.surface.objects import joined
from andon.transport.probes.placement import Placed, Walls, unlit_volume

if TYPE_CHECKING:
    from andon.transport.probes.light import ProbeLight

__all__ = ["DEFAULT_STATE", "Baked", "bake_probes"]

Float = NDArray[np.float64]

DEFAULT_STATE = "default"
# Of what journals hold: results of another version of this package are computed again.
VERSION = 2
# Pixels along a face of the pictures of a bounce, at most.
BOUNCE_SIZE = 32


@dataclass(frozen=True, eq=False)
class Baked:
    """What a bake gives.

    Attributes
    ----------
    volume : of one state.
    report : what is to be said of it.
    """

    volume: ProbeVolume
    report: BakeReport


def bake_probes(
    scene: Scene,
    placed: Placed,
    /,
    *,
    engine: str = "auto",
    progress: Progress | None = None,
    folder: Path | None = None,
    workers: Workers | None = None,
) -> Baked:
    """Captures the light at every placed probe.

    Parameters
    ----------
    scene : has a [probes] table, whose settings are used.
    placed : from `place_probes`; at least one probe.
    engine : ``auto`` takes the GPU where there is an adapter, else the reference.
    progress : called after each probe.
    folder : where finished results are kept, and looked for; whoever asked removes it. None:
        nowhere.
    workers : trace the bounces by Radiance; None: this process does.

    Raises
    ------
    InputError
        for panoramas that are none, files at fault, zones without a probe.
    MachineError
        for probes that fail three times (the others are kept), for ``gpu`` without an adapter, and
        where SciPy is missing.
    """
    return _Bake(scene, placed, engine, progress, Journal(folder), workers).run()


class _Bake:
    def __init__(
        self,
        scene: Scene,
        placed: Placed,
        engine: str,
        progress: Progress | None,
        journal: Journal,
        workers: Workers | None,
    ) -> None:
        self.scene, self.placed, self.workers = scene, placed, workers
        self.journal = journal
        self.runner = Runner(journal, placed.names, progress)
        self.probes = _table(scene)
        self.unlit = unlit_volume(scene, placed)
        self.cells = _cells(placed, self.unlit.zones)
        self.setting = seen_setting(scene, placed)
        self.look = self._looking(self.probes.cube_size_px, engine)
        near = min(BOUNCE_SIZE, self.probes.cube_size_px)
        self.small = self.look if self.look is None else self._looking(near, self.look.engine.name)
        self.far_m = far_m(placed, self.cells, self.setting.geometry if self.setting else ())
        self.base = self._base()
        self.own = [index for index, p in enumerate(placed.panoramas) if p is None]
        self.passes = passes_of(self.setting, self.probes.bounces)
        self.by_radiance = self.probes.bounces_by == "radiance" and bool(self.own)
        if self.by_radiance and self.setting is not None:
            check_radiance(scene, self.setting)
        elif workers is not None and self.probes.bounces_by == "probes":
            raise InputError(
                "is 'probes', and these bounces are not traced by workers",
                file=scene.file,
                field="probes.bounces_by",
                remedy='set it to "radiance", or bake without workers',
            )
        self.recoded = self.probes.encoding == "srgb8" and bool(self.own)
        later = len(self.passes)
        if self.by_radiance:
            later = min(later, 1) * (1 if workers is None else 2)
        later += self.recoded
        self.runner.total = placed.count + later * len(self.own)

    def run(self) -> Baked:
        """First light, bounces, 8 bits if they are asked for, the volume."""
        first = self._first()
        ambient, emitted, reflected = (
            np.stack([result[part] for result in first]) for part in PARTS
        )
        distances = self._distances(first)
        # What lights the first pass is what emits; where nothing does, what lamps light.
        light = emitted if 1 in self.passes else emitted + reflected
        lit_by: ProbeLight | None = None
        for bounce in () if self.by_radiance else self.passes:
            lit_by = self._probe_light(light, distances)
            light = emitted + reflected + self._bounce(bounce, lit_by)
        if self.by_radiance or not self.passes:
            light = emitted + reflected + self._radiance()
        coefficients = ambient + light
        recoded: list[Result] = []
        if self.recoded:
            recoded = self._recode(lit_by)
            coefficients[self.own] = [result["all"] for result in recoded]
        black = coefficients[:, 0] < 0
        coefficients = np.where(black[:, None], 0.0, coefficients)
        report = replace(self._report(first, recoded), black=int(np.count_nonzero(black)))
        return Baked(self._volume(coefficients, distances), report)

    def _first(self) -> list[Result]:
        probes = self.probes
        pictures = Pictures(
            self.scene, self.placed, self.look, probes.order, probes.bounces > 0, self.far_m
        )
        return self.runner.each(
            "first light",
            range(self.placed.count),
            self._first_key,
            lambda index: first_light(pictures, index),
        )

    def _looking(self, size: int, engine: str) -> Look | None:
        if self.setting is None:
            return None
        probes = self.probes
        taker = cube_engine(self.setting, size, engine)
        return Look(taker, size, self.setting, probes.order, probes.solid_angle)

    def _base(self) -> str:
        """The name of all that every probe's light depends on."""
        probes, setting = self.probes, self.setting
        settings = (probes.cube_size_px, probes.solid_angle, probes.order, probes.bounces > 0)
        if setting is None or self.look is None:
            return digest(VERSION, settings)
        lighting, casters = setting.lighting, setting.prepared.casters(setting.moment)
        photograph = () if lighting.photograph is None else lighting.photograph.pictures
        return digest(
            (VERSION, settings, self.look.engine.name, self.look.engine.adapter, self.far_m),
            (setting.geometry, casters.groups, setting.prepared.surface.bias),
            (setting.lamps, setting.moment.bodies, lighting.ambient_lux, lighting.sky),
            (photograph, lighting.surroundings_cd_m2),
        )

    def _first_key(self, index: int) -> str:
        placed = self.placed
        panorama = placed.panoramas[index]
        contents = None
        if panorama is not None:
            path = self.scene.path(panorama.reference, panorama.field)
            contents = digest(
                panorama, dimming_of(self.scene), np.frombuffer(_bytes_of(path), np.uint8)
            )
        return digest(self.base, placed.capture_positions[index], placed.ranges_m[index], contents)

    def _bounce(self, bounce: int, light: ProbeLight) -> Float:
        """(n, k, 3) what is reflected of `light` around every probe; nothing around panoramas."""
        assert self.small is not None
        small = self.small
        name = digest("bounce", self.base, light.coefficients, self._places())
        results = self.runner.each(
            f"bounce {bounce}",
            self.own,
            lambda index: digest(name, self._first_key(index)),
            lambda index: bounced(small, self.placed, light, index),
        )
        total = np.zeros_like(light.coefficients)
        total[self.own] = [result["reflected"] for result in results]
        return total

    def _radiance(self) -> Float:
        """(n, k, 3) what Radiance finds around every probe; nothing around panoramas."""
        total = np.zeros((self.placed.count, coefficient_count(self.probes.order), 3))
        if self.by_radiance and self.passes:
            assert self.small is not None
            total[self.own] = traced_light(
                self.runner,
                self.small,
                self.placed,
                self.probes,
                self.own,
                self._first_key,
                self.workers,
            )
        return total

    def _recode(self, light: ProbeLight | None) -> list[Result]:
        assert self.look is not None
        look, white, lit = self.look, self._white(), self.probes.bounces > 0
        coefficients = None if light is None else light.coefficients
        name = digest("srgb8", self.base, coefficients, self._places(), white)
        return self.runner.each(
            "8 bits",
            self.own,
            lambda index: digest(name, self._first_key(index)),
            lambda index: encoded(look, self.placed, light, index, lit=lit, white_cd_m2=white),
        )

    def _places(self) -> str:
        """The name of what lookups between the probes depend on."""
        return digest(
            self.placed.positions, self.placed.capture_positions, self.cells, self.unlit.zones,
            self.probes.visibility,
        )  # fmt: skip

    def _white(self) -> float:
        assert self.setting is not None
        frames, prepared = self.setting.prepared.frames, self.setting.prepared
        if frames:
            return next(iter(frames.values())).luminance_per_unit
        return white_cd_m2(self.scene, prepared.ambient, prepared.at(0.0).lamps)

    def _distances(self, first: Sequence[Result]) -> Distances | None:
        if not self.probes.visibility or self.setting is None:
            return None
        mean, square = (
            np.stack([result[key] for result in first]).astype(np.float32)
            for key in ("mean_m", "mean_square_m2")
        )
        return Distances(mean, square, self.far_m)

    def _probe_light(self, light: Float, distances: Distances | None) -> ProbeLight:
        from andon.transport.probes.light import light_between

        volume = self._volume(light, distances)
        return light_between(volume, self._smooth(light))

    def _smooth(self, light: Float) -> Float:
        """Without ringing, if that is asked for and light has one sign.

        Where some is added and some taken away, illuminance may be negative on one side of a
        probe without any ringing.
        """
        if not self.probes.dering:
            return light
        if self.setting is None or not self.setting.takes_away:
            return deringed(light)
        return -deringed(-light) if bool((light[:, 0] <= 0).all()) else light

    def _volume(self, coefficients: Float, distances: Distances | None) -> ProbeVolume:
        from andon import __version__

        probes = self.probes
        state = probes.state or DEFAULT_STATE
        notes = {
            "generator": f"Andon {__version__}",
            "scene": Path(self.scene.file).name,
            "cube_size_px": str(probes.cube_size_px),
            "encoding": probes.encoding,
            "solid_angle": probes.solid_angle,
            "bounces": str(probes.bounces),
            **bounce_notes(probes),
            **self._facts(state),
        }
        return replace(
            self.unlit,
            states={state: coefficients},
            cells=self.cells,
            distances=distances,
            notes=notes,
        )

    def _facts(self, state: str) -> dict[str, str]:
        """What the light depends on, for frames that come later; of panoramas alone nothing."""
        if self.setting is None:
            return {}
        prepared = self.setting.prepared
        lamps = self.setting.moment.lamps
        return facts_of(self.scene, prepared.surface, prepared.ambient, lamps).notes(state)

    def _report(self, first: Sequence[Result], recoded: Sequence[Result]) -> BakeReport:
        names = self.placed.names
        shares = np.array([float(result["clipped_share"]) for result in first])
        if recoded:
            shares[self.own] = [float(result["clipped_share"]) for result in recoded]
        taker = None if self.look is None else self.look.engine
        return BakeReport(
            engine="none" if taker is None else taker.name,
            adapter="panoramas alone" if taker is None else taker.adapter,
            probes=self.placed.count,
            bounces=self.probes.bounces,
            cells=len(self.cells.corners),
            captured=self.runner.computed,
            kept=self.journal.found,
            damaged=self.journal.damaged,
            seconds=self.runner.seconds,
            in_walls=self._in_walls(),
            not_finite=int(sum(float(result["not_finite"]) for result in first)),
            clipped=tuple(names[index] for index in np.flatnonzero(shares > 0).tolist()),
            clipped_share=float(shares.max(initial=0.0)),
            negative=int(sum(float(result["negative"]) for result in first)),
            unphotographed_share=self._mean(first, "unphotographed"),
            surroundings_share=self._mean(first, "surroundings"),
            unscaled=unscaled_of(self.probes),
            needs_white=self._needs_white(),
            bounces_by=self.probes.bounces_by,
        )

    def _mean(self, first: Sequence[Result], key: str) -> float:
        """Over the probes that are no panoramas."""
        shares = [float(first[index][key]) for index in self.own]
        return float(np.mean(shares)) if shares else 0.0

    def _needs_white(self) -> bool:
        """Frames of this scene cannot be drawn until it states its white."""
        if self.setting is None or self.scene.has_photograph:
            return False
        try:
            self._white()
        except InputError:
            return True
        return False

    def _in_walls(self) -> tuple[str, ...]:
        """Probes that mostly see backs of surfaces; panoramas see none."""
        if self.setting is None or not self.setting.geometry or not self.own:
            return ()
        walls = Walls(joined(list(self.setting.geometry)))
        buried = walls.sight(self.placed.capture_positions[self.own]).buried
        names = self.placed.names
        return tuple(names[n] for n, inside in zip(self.own, buried, strict=True) if inside)


def _table(scene: Scene) -> Probes:
    if scene.probes is None:
        raise InputError("needs a [probes] table", file=scene.file, remedy="add probes.volume")
    return scene.probes


def _cells(placed: Placed, zones: tuple[Zone, ...]) -> Cells:
    from andon.transport.probes.cells import build_cells

    return build_cells(placed.positions, zones)


def _bytes_of(path: Path) -> bytes:
    from andon.files.paths import open_bounded

    return open_bounded(path)
