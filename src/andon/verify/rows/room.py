"""The furnished room against Radiance, and its shadows against rays."""

from __future__ import annotations

from functools import cache
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from andon.lamps import Shadow
from andon.pipeline import EngineName, Frame, Renderer
from andon.rays import RayScene
from andon.verify.edges import near_change, shadow_edges
from andon.verify.registry import NotShown
from andon.verify.rooms import camera_in
from andon.verify.rows.closed_forms import GRAZING
from andon.verify.setting import prepared_of, room, room_lamps, room_setting
from andon.verify.truths.embree import Visibility

__all__ = ["against_radiance", "near_depth_edges", "near_shadow_edges", "paraboloids"]

Float = NDArray[np.float64]


@cache
def _room_frame(engine: EngineName) -> Frame:
    return Renderer(room_setting(4, 640, 360), engine).render()


def near_shadow_edges(visible: NDArray[np.bool_], reach: int) -> NDArray[np.bool_]:
    """(H, W): some lamp's shadow (H, W, lamps) changes within `reach` pixels."""
    near = np.zeros(visible.shape[:2], bool)
    for lamp in range(visible.shape[2]):
        near |= near_change(visible[..., lamp], reach)
    return near


@cache
def against_radiance(engine: EngineName) -> tuple[float, float, float]:
    """Median and 95th percentile of the relative error in the room, and the share left out."""
    try:
        from andon.verify.truths.radiance import RadianceScene
    except ImportError as error:
        raise NotShown("Radiance is missing: pip install 'andon[radiance]'") from error
    frame, lamps = _room_frame(engine), room_lamps(4)
    surface = frame.surface
    mask = surface.valid
    points, normals = surface.position[mask], surface.normal[mask]
    visibility = Visibility(room())
    visible = np.zeros((*mask.shape, len(lamps)), bool)
    for index, lamp in enumerate(lamps):
        visible[mask, index] = visibility.visible(points, normals, lamp.position_m)
    kept = mask & ~near_shadow_edges(visible, 2) & ~near_depth_edges(surface.depth)
    chosen = np.zeros_like(kept)
    chosen[1::3, 1::3] = True  # a ninth of the pixels: 25,000 points
    kept &= chosen
    with RadianceScene(room(), lamps) as scene:
        truth = scene.irradiance(surface.position[kept], surface.normal[kept])
    ours = np.asarray(frame.illuminance.lux, float)[kept]
    floor = 1e-3 * float(np.median(truth))
    error = np.abs(ours - truth).max(axis=1) / np.maximum(truth.max(axis=1), floor)
    left_out = 1 - np.count_nonzero(kept) / np.count_nonzero(chosen & mask)
    return float(np.median(error)), float(np.percentile(error, 95)), left_out


def near_depth_edges(depth: Float) -> NDArray[np.bool_]:
    """(H, W): the surface changes within a pixel; both engines may see either side there."""
    filled = np.nan_to_num(depth).astype(np.float32)
    kernel = np.ones((3, 3), np.uint8)
    low = np.asarray(cv2.erode(filled, kernel))
    return np.asarray(cv2.dilate(filled, kernel)) > 1.05 * low


@cache
def paraboloids(
    shadow_filter: Literal["none", "exact"], map_size: int
) -> tuple[float, float, float]:
    """Share of pixels whose shadow differs from rays; those far from an edge; on the seam."""
    visibility, casters = Visibility(room()), RayScene(room())
    view = camera_in(room(), 1280, 720)
    differing = facing = far = seam = 0
    for lamp in room_lamps(4, Shadow(map_size, shadow_filter)):
        frame = Renderer(prepared_of(room(), view, (lamp,)), "gpu").render()
        surface = frame.surface
        mask = surface.valid
        points, normals = surface.position[mask], surface.normal[mask]
        reach = lamp.position_m - points
        cosine = np.einsum("ij,ij->i", reach, normals) / np.linalg.norm(reach, axis=1)
        ours = np.asarray(frame.illuminance.lux)[mask].max(axis=1) > 0
        truth = visibility.visible(points, normals, lamp.position_m)
        counted = cosine > GRAZING
        wrong = counted & (ours != truth)
        differing += int(wrong.sum())
        facing += int(counted.sum())
        away = ~shadow_edges(
            points[wrong],
            normals[wrong],
            lamp,
            visibility.visible,
            casters,
            map_size,
            steps=9,
        )
        far += int(away.sum())
        seam += int((away & _on_seam(points[wrong] - lamp.position_m, map_size)).sum())
    return differing / facing * 100, float(far), float(seam)


def _on_seam(reach: Float, map_size: int) -> NDArray[np.bool_]:
    """(n,) within two texels of the circle where one paraboloid ends and the other begins."""
    distance = np.linalg.norm(reach, axis=1)
    radius = np.linalg.norm(reach[:, :2], axis=1) / (distance + np.abs(reach[:, 2]))
    return np.abs(radius - 1) < 2 * 2 / map_size
