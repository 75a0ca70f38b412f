"""The three images that one eye sees in glass, in float64."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from andon.glass.backdrops.model import Footprint, SceneOfView
from andon.glass.backdrops.reference import environment_light, look, sticker_at
from andon.glass.defocus.kernels import MAX_BLUR_PX
from andon.glass.highlights import highlight_luminance
from andon.glass.layers import Counts, Layered, Layers
from andon.glass.model import Focus, GlassModel, Highlight
from andon.glass.paths import LOST, Traced, trace
from andon.glass.pencils import blur_radians, vergence
from andon.glass.refraction import against
from andon.glass.silhouette import silhouette

__all__ = ["frame_blur_px", "layers_of"]

Float = NDArray[np.float64]
# (points (n, 3), normals (n, 3)) → (n, 3) lux that arrives there, all light together.
Lit = Callable[[Float, Float], Float]

# The channel whose rays say how far away things appear: green.
MIDDLE = 1


def layers_of(
    model: GlassModel,
    behind: SceneOfView,
    focus: Focus | None,
    highlights: Sequence[Highlight],
    lit: Lit,
    /,
) -> Layered:
    """Surface, refracted and mirrored image of all glass in a view; sharp, with their blurs.

    Parameters
    ----------
    behind : the frame before glass.
    focus : of the eye; None: nothing is blurred.
    highlights : lamps that the solids mirror.
    lit : what lights stickers.
    """
    eye, directions = behind.view.rays_world()
    rays = directions.reshape(-1, 3)
    pixel_radians = np.sqrt(behind.view.solid_angles().reshape(-1))
    pixels = np.flatnonzero(_may_hit(model, eye, rays, pixel_radians))
    rays, coverage = silhouette(model.solids, eye, rays[pixels], pixel_radians[pixels])
    traced = trace(model.solids, eye[None], rays)
    ahead = behind.surface.distance_m.reshape(-1)[pixels]
    kept = (coverage > 0) & (traced.solid >= 0) & (traced.distance_m < ahead)
    assembly = _Assembly(model, behind, focus, pixels[kept], rays[kept], coverage[kept])
    return assembly.layers(highlights, lit)


def frame_blur_px(model: GlassModel, behind: SceneOfView, focus: Focus, /) -> Float:
    """(H, W) diameters in pixels of the blur of what is seen beside the glass, by its distance.

    Holes are as far away as can be.
    """
    vergences = 1 / behind.surface.distance_m
    wide = model.pupil_m * np.abs(vergences - focus.dioptres)
    return np.minimum(wide / np.sqrt(behind.view.solid_angles()), MAX_BLUR_PX)


def _may_hit(model: GlassModel, eye: Float, rays: Float, pixel_radians: Float) -> NDArray[np.bool_]:
    """(n,) rays that meet the ball around a body, or pass by it within a pixel."""
    found = np.zeros(len(rays), np.bool_)
    for solid in model.solids:
        middle, radius = solid.ball_around
        reach = middle - eye
        along = rays @ reach
        across = np.linalg.norm(reach - along[:, None] * rays, axis=-1)
        wide = radius + np.abs(along) * pixel_radians
        found |= (across <= wide) & ((along > 0) | (np.linalg.norm(reach) <= radius))
    return found


@dataclass(frozen=True)
class _Found:
    """Light (n, 3) behind a boundary, how it was come by, and its blur (n,)."""

    light: Float
    missed: NDArray[np.bool_]
    beside: NDArray[np.bool_]
    blur_px: Float


class _Assembly:
    """Light and blurs of the pixels of glass, as layers.wgsl puts them together."""

    def __init__(
        self,
        model: GlassModel,
        behind: SceneOfView,
        focus: Focus | None,
        pixels: NDArray[np.int64],
        rays: Float,
        coverage: Float,
    ) -> None:
        self.model, self.behind, self.focus = model, behind, focus
        self.pixels, self.rays, self.coverage = pixels, rays, coverage
        self.eye = behind.view.position
        self.pixel_radians = np.sqrt(behind.view.solid_angles().reshape(-1)[pixels])
        self.traced = self._trace(MIDDLE)
        self.own = [np.flatnonzero(self.traced.solid == k) for k in range(len(model.solids))]

    def _trace(self, channel: int) -> Traced:
        return trace(self.model.solids, self.eye[None], self.rays, channel=channel)

    def layers(self, highlights: Sequence[Highlight], lit: Lit) -> Layered:
        """All pixels; those without glass are 0."""
        refracted, through = self._refracted()
        reflected, away = self._reflected(highlights)
        surface, alpha = self._surface(lit)
        near = self._blur_px(np.eye(2) / self.traced.distance_m[:, None, None])
        share = self.coverage[:, None]
        layers = Layers(
            self._picture(self.coverage),
            self._picture(share * refracted),
            self._picture(share * surface),
            self._picture(self.coverage * alpha),
            self._picture(share * reflected),
            self._picture(through.blur_px),
            self._picture(near),
            self._picture(away.blur_px),
        )
        cut = np.maximum(through.blur_px, away.blur_px) >= MAX_BLUR_PX
        lost = self.traced.status == LOST
        found = (lost, through.missed & ~lost, through.beside, cut)
        counts = Counts(len(self.pixels), *(int(np.count_nonzero(one)) for one in found))
        return Layered(layers, counts)

    def _picture(self, values: Float) -> Float:
        height, width = self.behind.view.shape
        whole = np.zeros((height * width, *values.shape[1:]))
        whole[self.pixels] = values
        return whole.reshape(height, width, *values.shape[1:])

    def _refracted(self) -> tuple[Float, _Found]:
        """(n, 3) cd/m² that comes through, and what the middle channel found."""
        middle = self._through(self.traced)
        light = middle.light.copy()
        if any(solid.is_dispersive for solid in self.model.solids):
            for channel in (0, 2):
                light[:, channel] = self._through(self._trace(channel)).light[:, channel]
        return light, middle

    def _through(self, traced: Traced) -> _Found:
        found = self._found(traced.exit_point, traced.exit_direction, traced.pencil)
        absorbed = np.array([solid.absorption_per_m for solid in self.model.solids])
        share = traced.transmitted[:, None] * np.exp(-(traced.path_m @ absorbed))
        return replace(found, light=found.light * share)

    def _reflected(self, highlights: Sequence[Highlight]) -> tuple[Float, _Found]:
        """(n, 3) cd/m² that is mirrored, lamps included."""
        traced = self.traced
        found = self._found(traced.point, traced.mirrored, traced.mirrored_pencil)
        light = found.light.copy()
        for number, rows in enumerate(self.own):
            light[rows] += highlight_luminance(
                [one for one in highlights if one.solid == number],
                traced.point[rows],
                traced.mirrored[rows],
                self.model.solids[number].highlight_exponent,
            )
        return traced.reflectance[:, None] * light, found

    def _found(self, origins: Float, directions: Float, pencil: Float) -> _Found:
        """What rays find behind their last boundary; misses see the environment."""
        count = len(origins)
        light, distance = np.zeros((count, 3)), np.zeros(count)
        missed, beside = np.zeros((2, count), np.bool_)
        moves = pencil[:, 2:] * self.pixel_radians[:, None, None, None]
        for number, rows in enumerate(self.own):
            footprint = Footprint(moves[rows, :, 0], moves[rows, :, 1])
            backdrop = self.model.solids[number].backdrop
            seen = look(backdrop, origins[rows], directions[rows], footprint, self.behind)
            around = environment_light(self.model.environment[number], directions[rows])
            light[rows] = np.where(seen.missed[:, None], around, seen.light)
            distance[rows] = seen.distance_m
            missed[rows], beside[rows] = seen.missed, seen.beside
        if self.model.blur == "paper":
            reach = np.linalg.norm(origins + distance[:, None] * directions - self.eye, axis=-1)
            appears = np.eye(2) / reach[:, None, None]
        else:
            appears = vergence(pencil, distance, directions)
        return _Found(light, missed, beside, self._blur_px(appears))

    def _blur_px(self, seen: Float) -> Float:
        """(n,) diameters in pixels of what has the vergence `seen` (n, 2, 2)."""
        if self.focus is None or self.model.blur == "off":
            return np.zeros(len(seen))
        wide = blur_radians(seen, self.focus.dioptres, self.model.pupil_m)
        return np.minimum(wide / self.pixel_radians, MAX_BLUR_PX)

    def _surface(self, lit: Lit) -> tuple[Float, Float]:
        """(n, 3) cd/m² of what sticks to the glass, times α; and α (n,)."""
        traced, count = self.traced, len(self.pixels)
        stuck, pixel = np.zeros((count, 4)), self.pixel_radians[:, None, None]
        for number, rows in enumerate(self.own):
            solid = self.model.solids[number]
            rows = rows[np.isfinite(traced.uv[rows]).all(axis=-1)]
            if solid.sticker is None or not len(rows):
                continue
            picture = sticker_at(solid, traced.uv[rows], traced.uv_steps[rows] * pixel[rows])
            stuck[rows] = (1 - solid.sticker.transmittance) * picture
        light = np.zeros((count, 3))
        covered = np.flatnonzero(stuck[:, 3] > 0)
        if len(covered):
            normals = against(self.rays[covered], traced.normal[covered])
            light[covered] = lit(traced.point[covered], normals) / np.pi
        return stuck[:, :3] * light, stuck[:, 3]
