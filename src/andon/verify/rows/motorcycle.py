"""The demonstration's photograph: both engines, identity, decimation."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from importlib import resources

import numpy as np
from numpy.typing import NDArray

from andon.engines.prepared import prepare
from andon.files.pictures import read_picture
from andon.lamps import Lamp, PointLamp
from andon.pipeline import EngineName, Frame, Renderer
from andon.rays import RayScene
from andon.scene import load_scene
from andon.surface.occluder import Occluder
from andon.verify.edges import near_change, shadow_edges

__all__ = ["decimation", "identity_bytes", "parity"]

Float = NDArray[np.float64]


@dataclass(frozen=True)
class _Shown:
    renderer: Renderer
    frame: Frame


def _demonstration(engine: EngineName) -> _Shown:
    with resources.as_file(resources.files("andon") / "data" / "motorcycle") as folder:
        renderer = Renderer(load_scene(folder / "scene.toml"), engine)
    return _Shown(renderer, renderer.render())


@cache
def parity() -> tuple[float, float, float, float]:
    """On the motorcycle: % within 5/255, mean difference, both away from edges; % left out; all."""
    gpu, slow = _demonstration("gpu"), _demonstration("reference")
    difference = np.abs(gpu.frame.image.rgb.astype(int) - slow.frame.image.rgb.astype(int))
    worst = difference.max(axis=-1)
    surface, prepared = slow.frame.surface, slow.renderer.prepared
    mask = surface.valid
    edges = np.zeros(mask.shape, bool)
    points, normals = surface.position[mask], surface.normal[mask]
    bias = np.where(
        surface.is_object[mask], prepared.surface.bias.object_m, prepared.surface.bias.real_m
    )
    casters = RayScene(prepared.surface.shadow_casters)

    def visible(at: Float, normals: Float, lamp_position: Float) -> NDArray[np.bool_]:
        return casters.is_visible(at + normals * bias[:, None], lamp_position)

    for lamp in prepared.lamps(0.0):
        assert isinstance(lamp, PointLamp)
        assert lamp.shadow is not None
        size = lamp.shadow.map_size
        edges[mask] |= shadow_edges(points, normals, lamp, visible, casters, size, steps=9)
    # An object's outline is drawn by two rasterisers: they may choose either side of it.
    edges |= near_change(surface.is_object, 1)
    kept = ~edges
    within = float((worst[kept] <= 5).mean() * 100)
    mean = float(difference[kept].mean())
    return within, mean, float(edges.mean() * 100), float((worst <= 5).mean() * 100)


def _dark(time_seconds: float) -> tuple[Lamp, ...]:
    return ()


def identity_bytes(engine: EngineName) -> float:
    """Bytes of the demonstration's photograph that change with no lamps and no dimming."""
    with resources.as_file(resources.files("andon") / "data" / "motorcycle") as folder:
        scene = load_scene(folder / "scene.toml").model_copy(update={"lamp": (), "object": ()})
        prepared = replace(prepare(scene), lamps=_dark)
        photo = read_picture(folder / "photo.png").values
    out = Renderer(prepared, engine).render().image.rgb
    return float(np.count_nonzero(out != photo))


def decimation() -> float:
    """% of the motorcycle's lit pixels whose shadow 30,000 triangles decide otherwise than all."""
    with resources.as_file(resources.files("andon") / "data" / "motorcycle") as folder:
        prepared = prepare(load_scene(folder / "scene.toml"))
    full = Occluder(prepared.surface.real, len(prepared.surface.real.triangles), 0.0)
    exact = replace(prepared, surface=replace(prepared.surface, occluder=full))
    shadows = [
        np.asarray(Renderer(p, "reference").render().illuminance.lux).sum(axis=-1)
        for p in (prepared, exact)
    ]
    valid = shadows[1] > 0
    return float((np.abs(shadows[0] - shadows[1])[valid] > 0.01 * shadows[1][valid]).mean() * 100)
