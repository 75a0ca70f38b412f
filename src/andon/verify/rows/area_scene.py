"""Area lamps in the furnished room against Radiance: whole light, and soft shadows."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from andon.lamps import AnyAreaLamp
from andon.pipeline import EngineName, Frame, Renderer
from andon.spaces import View
from andon.transport.baked.radiance.emitters import tiles_of
from andon.transport.direct import reference
from andon.verify.area_lamps import room_area_lamps, tiles_at
from andon.verify.registry import NotShown, Row
from andon.verify.rooms import camera_in
from andon.verify.rows.room import near_depth_edges, near_shadow_edges
from andon.verify.setting import prepared_of, room
from andon.verify.truths.embree import Visibility

__all__ = ["ROWS", "area_scene", "soft_rmse", "truth_noise"]

Float = NDArray[np.float64]
Mask = NDArray[np.bool_]

WIDTH, HEIGHT = 320, 180
# Every eighth pixel is asked: 7,200 points, 64 to 340 shadow rays for each lamp.
ROWS_STEP, COLUMNS_STEP = 2, 4
CUTS = 1
# Places on a lamp whose shadows tell where a penumbra is.
PROBES = 24


def _view() -> View:
    return camera_in(room(), WIDTH, HEIGHT)


@cache
def _frame(engine: EngineName, names: tuple[str, ...], samples: int) -> Frame:
    lamps = tuple(lamp for lamp in room_area_lamps(samples) if lamp.name in names)
    return Renderer(prepared_of(room(), _view(), lamps), engine).render()


def _all_lamps() -> tuple[str, ...]:
    return tuple(lamp.name for lamp in room_area_lamps())


def _chosen() -> Mask:
    """(H, W) the pixels that are asked."""
    chosen = np.zeros((HEIGHT, WIDTH), bool)
    chosen[::ROWS_STEP, ::COLUMNS_STEP] = True
    return chosen & _frame("reference", (), 1).surface.valid


@cache
def _truth(cuts: int) -> Float:
    """(lamps, n, 3) lux of each lamp alone in the chosen pixels; lamps do not hide each other."""
    try:
        from andon.verify.truths.radiance import RadianceScene
    except ImportError as error:
        raise NotShown("Radiance is missing: pip install 'andon[radiance]'") from error
    surface = _frame("reference", (), 1).surface
    chosen = _chosen()
    found: list[Float] = []
    for lamp in room_area_lamps():
        with RadianceScene(room(), [lamp], tiles=tiles_at(cuts)) as scene:
            found.append(scene.irradiance(surface.position[chosen], surface.normal[chosen]))
    return np.stack(found)


@cache
def _edges() -> Mask:
    """(H, W) a penumbra or what is within 2 px of it, for any lamp; or 1 px of an object's edge."""
    surface = _frame("reference", (), 1).surface
    mask = surface.valid
    points, normals = surface.position[mask], surface.normal[mask]
    visibility = Visibility(room())
    near = near_depth_edges(surface.depth)
    for lamp in room_area_lamps():
        places = np.concatenate([t.corners.mean(axis=1) for t in tiles_of(lamp, tiles_at(0))])
        places = places[np.linspace(0, len(places) - 1, PROBES).round().astype(int)]
        visible = np.zeros((*mask.shape, len(places)), bool)
        for number, place in enumerate(places):
            visible[mask, number] = visibility.visible(points, normals, place)
        near |= visible.any(axis=2) != visible.all(axis=2)
        near |= near_shadow_edges(visible, 2)
    return near


@cache
def area_scene(engine: EngineName, samples: int = 64) -> tuple[float, float, float]:
    """Median and 95th percentile of the relative error outside penumbrae; the share left out."""
    chosen = _chosen()
    kept = ~_edges()[chosen]
    truth = _truth(CUTS).sum(axis=0)[kept]
    frame = _frame(engine, _all_lamps(), samples)
    error = _relative(np.asarray(frame.illuminance.lux, float)[chosen][kept], truth)
    return float(np.median(error)), float(np.percentile(error, 95)), 1 - float(kept.mean())


@cache
def truth_noise() -> tuple[float, float]:
    """How far Radiance with lamps of a quarter of the triangles is from the truth that is used.

    The 95th percentile outside penumbrae; and the RMSE of `soft_rmse` everywhere.
    """
    kept = ~_edges()[_chosen()]
    fine, coarse = _truth(CUTS), _truth(CUTS - 1)
    error = _relative(coarse.sum(axis=0)[kept], fine.sum(axis=0)[kept])
    return float(np.percentile(error, 95)), _rmse(list(coarse))


def _relative(ours: Float, truth: Float) -> Float:
    least = 1e-3 * float(np.median(truth))
    return np.abs(ours - truth).max(axis=1) / np.maximum(truth.max(axis=1), least)


@cache
def soft_rmse(engine: EngineName, samples: int) -> float:
    """Root mean square of (ours − truth)/(light without shadows), over lamps and lit pixels."""
    chosen = _chosen()
    frames = [_frame(engine, (lamp.name,), samples) for lamp in room_area_lamps(samples)]
    return _rmse([np.asarray(frame.illuminance.lux, float)[chosen] for frame in frames])


def _rmse(light: list[Float]) -> float:
    squares: list[Float] = []
    for ours, truth, lamp in zip(light, _truth(CUTS), room_area_lamps(), strict=True):
        whole = _unshadowed(lamp)
        lit = whole > GRAZING_SHARE * np.median(whole)
        squares.append(((ours - truth)[lit, 1] / whole[lit]) ** 2)
    return float(np.sqrt(np.concatenate(squares).mean()))


# Where a lamp gives less than this share of its median light, its horizon decides, not its shadow.
GRAZING_SHARE = 0.02


def _unshadowed(lamp: AnyAreaLamp) -> Float:
    surface, chosen = _frame("reference", (), 1).surface, _chosen()
    return reference.illuminance(lamp, surface.position[chosen], surface.normal[chosen])[:, 1]


RADIANCE = "Radiance rtrace -I -ab 0, furnished room, five area lamps as 96 to 672 triangles each"
EXCLUDED = "pixels in penumbrae, within 2 px of them or 1 px of an object's edge"


def _scene_rows(engine: EngineName) -> tuple[Row, ...]:
    name = f"relight.area.scene.{engine}"
    return (
        Row(f"{name}.median", "relight", 0.01, "relative", RADIANCE, lambda: area_scene(engine)[0]),
        Row(f"{name}.p95", "relight", 0.03, "relative", RADIANCE, lambda: area_scene(engine)[1]),
        Row(f"{name}.left_out", "relight", None, "share", EXCLUDED, lambda: area_scene(engine)[2]),
    )


def _soft_row(engine: EngineName, samples: int) -> Row:
    return Row(
        f"relight.soft.rmse.{samples}.{engine}",
        "relight",
        None,
        "of the unshadowed light",
        RADIANCE,
        lambda: soft_rmse(engine, samples),
    )


AGAINST_COARSE = "Radiance with lamps of a quarter of the triangles"

ROWS: tuple[Row, ...] = (
    *_scene_rows("reference"),
    *_scene_rows("gpu"),
    Row(
        "relight.area.scene.truth_p95",
        "relight",
        None,
        "relative",
        AGAINST_COARSE,
        lambda: truth_noise()[0],
    ),
    *(_soft_row(engine, n) for engine in ("reference", "gpu") for n in (4, 16, 64)),
    Row(
        "relight.soft.rmse.truth",
        "relight",
        None,
        "of the unshadowed light",
        AGAINST_COARSE,
        lambda: truth_noise()[1],
    ),
)
