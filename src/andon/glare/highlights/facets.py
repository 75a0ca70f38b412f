"""Pixels of one finish as their lobes see them: normals, frames, roughness (float64)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from andon.glare.highlights import fresnel
from andon.glare.highlights.lobes import dot
from andon.glare.highlights.model import Finish
from andon.glare.highlights.outlines import frames
from andon.glare.highlights.waves import slopes_at
from andon.quantities import Surface
from andon.spaces import rotate

__all__ = ["Facets", "facets_of", "without_base"]

Float = NDArray[np.float64]

# A normal that is turned from the eye is bent back to this cosine.
LEAST_VIEW = 0.02
# Neighbours of one surface: depths that differ by less, as a share.
SAME_SURFACE = 0.05


@dataclass(frozen=True, eq=False)
class Facets:
    """n points of one finish.

    Attributes
    ----------
    finish : how they mirror.
    position : (n, 3) metres, world.
    ground : (n, 3) unit normal of the surface, towards the eye.
    normal : (n, 3) the same with ripples.
    view : (n, 3) unit, to the eye.
    base : (n, 3) base colour.
    widening : (n,) what a pixel's own curvature or unresolved ripples add to α².
    """

    finish: Finish
    position: Float
    ground: Float
    normal: Float
    view: Float
    base: Float
    widening: Float

    @cached_property
    def alpha(self) -> Float:
        """(n, 2) of GGX along the two tangents."""
        return np.sqrt(np.array(self.finish.alpha) ** 2 + self.widening[:, None])

    @cached_property
    def tangents(self) -> tuple[Float, Float]:
        """(n, 3) each, right-handed with the normal; the second is the brush's direction."""
        axis = self.finish.axis
        if axis is None:
            return frames(self.normal)
        along = np.cross(axis, self.normal) if self.finish.around else axis
        along = (
            along
            - dot(self.normal, np.broadcast_to(along, self.normal.shape))[:, None] * self.normal
        )
        length = np.linalg.norm(along, axis=-1, keepdims=True)
        # Where the axis is the normal, any direction is as good.
        along = np.where(length > 1e-6, along / np.maximum(length, 1e-6), frames(self.normal)[1])
        return np.cross(along, self.normal), along

    def local(self, direction: Float, /) -> Float:
        """(n, 3) components along the tangents and the normal."""
        a, b = self.tangents
        return np.stack([dot(direction, a), dot(direction, b), dot(direction, self.normal)], -1)

    def flatness(self, direction: Float, /) -> Float:
        """(n,) the square that `masking` asks for."""
        x, y, z = np.moveaxis(self.local(direction), -1, 0)
        leaning = (self.alpha[:, 0] * x) ** 2 + (self.alpha[:, 1] * y) ** 2
        return leaning / np.maximum(z, 1e-3) ** 2

    @cached_property
    def cosine_view(self) -> Float:
        """(n,) n·v, at least 1e-3."""
        return np.maximum(dot(self.normal, self.view), 1e-3)

    @cached_property
    def mirror(self) -> Float:
        """(n, 3) unit, where a mirror would look."""
        along = dot(self.normal, self.view)[:, None]
        return 2 * along * self.normal - self.view

    @cached_property
    def mirror_frame(self) -> tuple[Float, Float]:
        """(n, 3) each, right-handed with `mirror`."""
        return frames(self.mirror)

    @cached_property
    def straight(self) -> Float:
        """(n, 3) reflectance straight ahead; of Phong's its I_s."""
        finish = self.finish
        if finish.kind == "water":
            return np.full_like(self.base, ((finish.index - 1) / (finish.index + 1)) ** 2)
        if finish.kind == "phong" and finish.reflectance is not None:
            return np.broadcast_to(finish.reflectance, self.base.shape).astype(np.float64)
        return fresnel.DIELECTRIC * (1 - finish.metallic) + self.base * finish.metallic

    def reflectance(self, cosine: Float, /) -> Float:
        """(n, 3) Fresnel's at `cosine` of the angle of incidence (n,)."""
        if self.finish.kind != "water":
            return fresnel.schlick(cosine[:, None], self.straight)
        # An eye below the surface is in the water.
        n = self.finish.index
        ratio = np.where(self.view[:, 1] < 0, 1 / n, n)
        return np.repeat(fresnel.dielectric(cosine, ratio)[:, None], 3, axis=1)


def facets_of(
    seen: Surface, finishes: Sequence[Finish | None], time_seconds: float, /
) -> Iterator[tuple[NDArray[np.bool_], Facets]]:
    """The mirroring pixels of a view: a mask (H, W) and their facets, finish by finish."""
    own = seen.is_object & seen.valid
    if seen.body_id is not None:
        own &= seen.body_id < 0
    slots: list[int] = np.unique(seen.material_id[own]).tolist()
    for slot in slots:
        finish = finishes[slot]
        if finish is not None:
            mask = own & (seen.material_id == slot)
            yield mask, _facets(seen, mask, finish, time_seconds)


def _facets(seen: Surface, mask: NDArray[np.bool_], finish: Finish, time_seconds: float) -> Facets:
    position, ground = seen.position[mask], seen.normal[mask]
    view = seen.view.position - position
    view /= np.linalg.norm(view, axis=-1, keepdims=True)
    if finish.waves is None:
        normal, widening = ground, _curvature(seen)[mask]
    else:
        across, down = _footprint(seen)
        steps = across[mask], down[mask]
        slopes, widening = slopes_at(finish.waves, position, *steps, time_seconds)
        # Of a surface seen from below the normal points down; so do its ripples.
        side = np.where(ground[:, 1] < 0, -1.0, 1.0)[:, None]
        normal = ground - side * np.stack([slopes[:, 0], 0 * slopes[:, 0], slopes[:, 1]], -1)
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    facing = dot(normal, view)
    normal = normal + (np.maximum(LEAST_VIEW - facing, 0))[:, None] * view
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return Facets(finish, position, ground, normal, view, seen.reflectance[mask], widening)


def _curvature(seen: Surface) -> Float:
    """(H, W) what the turn of the normal within a pixel adds to α²: twice its variance.

    A pixel is a box, so that a turn of s from one to the next is a variance of s²/12. The turn is
    the smaller of those to both neighbours, which edges of things do not have.
    """
    total = np.zeros(seen.view.shape)
    for axis in (0, 1):
        turns = [_turn(seen, axis, way) for way in (1, -1)]
        least = np.minimum(*turns)
        total += np.where(np.isfinite(least), least, 0.0)
    return total * (2 / 12)


def _turn(seen: Surface, axis: int, way: int) -> Float:
    """(H, W) squared turn of the normal to a neighbour of the same surface; else inf."""
    size = seen.view.shape[axis]
    there = np.clip(np.arange(size) + way, 0, size - 1)
    fields = seen.normal, seen.depth, seen.material_id, seen.is_object
    normal, depth, material, is_object = (np.take(values, there, axis) for values in fields)
    with np.errstate(invalid="ignore"):
        same = np.abs(depth - seen.depth) <= SAME_SURFACE * seen.depth
        squared = ((normal - seen.normal) ** 2).sum(-1)
    same &= (material == seen.material_id) & (is_object == seen.is_object)
    shape = [1, 1]
    shape[axis] = size
    same &= (there != np.arange(size)).reshape(shape)
    return np.where(same, squared, np.inf)


def _footprint(seen: Surface) -> tuple[Float, Float]:
    """(H, W, 3) each: what a step of one column, and one row, moves a point on its plane."""
    rays = rotate(seen.view.world_from_camera, seen.view.rays_planar())
    reach = seen.position - seen.view.position
    with np.errstate(invalid="ignore"):
        away = dot(reach, seen.normal)
        fall = dot(rays, seen.normal)
        scale = away / np.where(np.abs(fall) > 1e-9, fall, 1e-9)
        steps: list[Float] = []
        for axis in (1, 0):
            turn = np.gradient(rays, axis=axis) if rays.shape[axis] > 1 else np.zeros_like(rays)
            lean = dot(turn, seen.normal) / np.where(np.abs(fall) > 1e-9, fall, 1e-9)
            steps.append(scale[..., None] * (turn - lean[..., None] * rays))
    return steps[0], steps[1]


def without_base(facets: Facets, /) -> Facets:
    """The same points of a black base: what is mirrored by the dielectric alone."""
    return replace(facets, base=np.zeros_like(facets.base))
