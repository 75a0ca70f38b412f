"""The mirroring finishes of a scene's virtual objects, at any time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from andon.glare.highlights.model import LEAST_ALPHA, Finish
from andon.glare.highlights.waves import make_waves
from andon.quantities import Material
from andon.scene import Scene
from andon.scene.keyframes import object_at
from andon.scene.objects import SceneObject
from andon.surface.model import SurfaceModel

__all__ = ["SceneHighlights", "finish_of", "highlights_of"]

Float = NDArray[np.float64]

ANISOTROPY = "KHR_materials_anisotropy"


@dataclass(frozen=True, eq=False)
class SceneHighlights:
    """Finishes of the materials of virtual objects.

    Attributes
    ----------
    finishes : by slot; None is diffuse. Their axes are those of the objects.
    entries : (slots,) whose they are; None: no object of the scene's.
    """

    finishes: tuple[Finish | None, ...]
    entries: tuple[SceneObject | None, ...]

    def at(self, time_seconds: float, /) -> tuple[Finish | None, ...]:
        """The finishes with their axes in the world."""
        if not self._is_brushed:
            return self.finishes
        return tuple(
            finish
            if finish is None or finish.axis is None or entry is None
            else replace(finish, axis=_turned(finish.axis, entry, time_seconds))
            for finish, entry in zip(self.finishes, self.entries, strict=True)
        )

    @cached_property
    def _is_brushed(self) -> bool:
        return any(finish is not None and finish.axis is not None for finish in self.finishes)


def _turned(axis: Float, entry: SceneObject, time_seconds: float) -> Float:
    turned = object_at(entry, time_seconds)[:3, :3] @ axis
    return turned / np.linalg.norm(turned)


def highlights_of(scene: Scene, surface: SurfaceModel, /) -> SceneHighlights | None:
    """The finishes of `scene`; None where nothing mirrors."""
    entries: list[SceneObject | None] = []
    for info in surface.objects_table:
        entries += [scene.object[info.entry] if info.entry >= 0 else None] * info.slots
    finishes: Sequence[Finish | None] = [
        None if entry is None else finish_of(entry, material, scene.scene.seed)
        for entry, material in zip(entries, surface.object_materials, strict=True)
    ]
    if all(finish is None for finish in finishes):
        return None
    return SceneHighlights(tuple(finishes), tuple(entries))


def finish_of(entry: SceneObject, material: Material, seed: int, /) -> Finish | None:
    """How a material of an object mirrors; None: not at all.

    By default as its file says, if it says that it is metal: glTF's default is metal as well, and
    files without any word of it are as often plaster.
    """
    takes = entry.lit_by_lamps
    if entry.water is not None:
        return _water(entry, seed)
    stated = material.metallic if material.metallic_stated else 0.0
    metallic = stated if entry.metallic is None else entry.metallic
    model = entry.highlights
    if model == "auto":
        model = "cook-torrance" if metallic > 0 else "none"
    if model == "none":
        return None
    roughness = material.roughness if entry.roughness is None else entry.roughness
    alpha = max(roughness**2, LEAST_ALPHA)
    if model == "phong":
        return Finish(
            "phong",
            metallic=metallic,
            exponent=entry.phong_exponent,
            reflectance=entry.phong_reflectance,
            takes_lamps=takes,
        )
    if model == "cook-torrance":
        return Finish(alpha=(alpha, alpha), metallic=metallic, takes_lamps=takes)
    strength = float(material.extensions.get(ANISOTROPY, {}).get("anisotropyStrength", 0.0))
    strength = strength or entry.anisotropy
    # The extension's formula. A scratch spreads light across itself.
    rough = alpha + (1 - alpha) * strength**2
    axis = np.array(entry.brush, float)
    return Finish(
        alpha=(rough, alpha),
        metallic=metallic,
        axis=axis / np.linalg.norm(axis),
        around=entry.brush_around,
        takes_lamps=takes,
    )


def _water(entry: SceneObject, seed: int) -> Finish:
    water = entry.water
    assert water is not None
    waves = make_waves(
        slope=water.slope,
        wavelength_m=water.wavelength_m,
        wind_degrees=water.wind_degrees,
        count=water.waves,
        seed=seed if water.seed is None else water.seed,
    )
    return Finish(
        "water",
        alpha=(LEAST_ALPHA, LEAST_ALPHA),
        metallic=0.0,
        index=water.index,
        waves=waves,
        takes_lamps=entry.lit_by_lamps,
    )
