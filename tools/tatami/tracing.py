"""What the pixels see: several rays in each, with the texture's reflectance where they end."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.quantities import Geometry
from andon.rays import RayScene, face_normals
from andon.responses import srgb_decode
from andon.spaces import View

Float = NDArray[np.float64]
# A pixel is cut into GRID × GRID; rows of pixels are traced in bands that fit the memory.
GRID, BAND_ROWS = 4, 60


@dataclass(frozen=True)
class Samples:
    """Rays of one band of pixels, those nearest to pixel centres first.

    Attributes
    ----------
    pixel : (n,) index into the picture, row by row.
    position, normal : (n, 3) metres, world; normals face the camera.
    reflectance : (n, 3) linear.
    group : (n,) int64, alike where one value of E serves: same material, same plane.
    material : (n,) index into the geometry's materials.
    """

    pixel: NDArray[np.int64]
    position: Float
    normal: Float
    reflectance: Float
    group: NDArray[np.int64]
    material: NDArray[np.int32]


class Tracer:
    """Rays into a textured mesh whose every ray ends on something."""

    def __init__(self, geometry: Geometry) -> None:
        self._geometry, self._rays = geometry, RayScene(geometry)
        self._facets = face_normals(geometry)
        assert geometry.normals is not None
        corners = geometry.normals[geometry.triangles]
        flat = np.abs(np.einsum("nkj,nj->nk", corners, self._facets) - 1).max(axis=1) < 1e-4
        self._plane = self._planes(flat)
        self._density = _texels_per_metre(geometry)
        self._pyramids = [_pyramid(material.texture) for material in geometry.materials]

    def _planes(self, flat: NDArray[np.bool_]) -> NDArray[np.int64]:
        """(m,) one number per plane and material; curved surfaces have −1."""
        first = self._geometry.positions[self._geometry.triangles[:, 0]]
        offset = np.einsum("nj,nj->n", first, self._facets)
        assert self._geometry.material_ids is not None
        keys = np.concatenate(
            [np.round(self._facets * 50), np.round(offset[:, None] * 500)], axis=1
        )
        keys = np.concatenate([keys, self._geometry.material_ids[:, None]], axis=1)
        _, plane = np.unique(keys, axis=0, return_inverse=True)
        return np.where(flat, plane.reshape(-1), -1)

    def bands(self, view: View) -> Iterator[Samples]:
        """All samples of the view, band by band."""
        for top in range(0, view.height, BAND_ROWS):
            yield self._band(view, top, min(top + BAND_ROWS, view.height))

    def _band(self, view: View, top: int, bottom: int) -> Samples:
        steps = (np.arange(GRID) + 0.5) / GRID - 0.5
        shifts = np.array([(x, y) for y in steps for x in steps])
        shifts = shifts[np.argsort((shifts**2).sum(1), kind="stable")]
        rows, columns = np.mgrid[top:bottom, : view.width]
        pixel = (rows * view.width + columns).reshape(-1)
        x = (columns.reshape(-1) + shifts[:, :1] - view.cx) / view.fx
        y = (rows.reshape(-1) + shifts[:, 1:] - view.cy) / view.fy
        camera = np.stack([x, y, np.ones_like(x)], axis=-1).reshape(-1, 3)
        camera /= np.linalg.norm(camera, axis=1, keepdims=True)
        rays = camera @ view.world_from_camera[:3, :3].T
        return self._shade(np.tile(pixel, len(shifts)), rays, view)

    def _shade(self, pixel: NDArray[np.int64], rays: Float, view: View) -> Samples:
        geometry = self._geometry
        assert geometry.normals is not None
        assert geometry.material_ids is not None
        origin = np.broadcast_to(view.position, rays.shape)
        hits = self._rays.first_hits(origin, rays)
        if (hits.triangle < 0).any():
            raise RuntimeError(f"{np.count_nonzero(hits.triangle < 0)} rays leave the room")
        corners = geometry.triangles[hits.triangle]
        weights = hits.barycentric[:, :, None]
        normal = (geometry.normals[corners] * weights).sum(1)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        facet = self._facets[hits.triangle]
        away = np.einsum("nj,nj->n", facet, rays) > 0
        normal[away] *= -1
        cosine = np.maximum(np.abs(np.einsum("nj,nj->n", facet, rays)), 0.05)
        spacing = hits.distance / (view.fx * GRID) / np.sqrt(cosine)
        material = geometry.material_ids[hits.triangle]
        uv = self._uv(corners, weights)
        reflectance = self._reflectance(material, uv, spacing * self._density[hits.triangle])
        plane = self._plane[hits.triangle]
        octant = np.round(normal * 1.2).astype(np.int64) @ [1, 3, 9] + 13
        group = np.where(plane >= 0, plane, -1 - (material.astype(np.int64) * 27 + octant))
        position = view.position + hits.distance[:, None] * rays
        return Samples(pixel, position, normal, reflectance, group, material)

    def _uv(self, corners: NDArray[np.int32], weights: Float) -> Float:
        assert self._geometry.uvs is not None
        return np.asarray((self._geometry.uvs[corners] * weights).sum(1))

    def _reflectance(self, material: NDArray[np.int32], uv: Float, texels: Float) -> Float:
        """(n, 3): `texels` (n,) of the full texture lie between neighbouring rays."""
        out = np.empty((len(material), 3))
        for number, look in enumerate(self._geometry.materials):
            chosen = np.flatnonzero(material == number)
            out[chosen] = look.reflectance
            if self._pyramids[number] and len(chosen):
                level = np.log2(np.maximum(texels[chosen], 1))
                out[chosen] *= _sampled(self._pyramids[number], uv[chosen], level)
        return out


def _texels_per_metre(geometry: Geometry) -> Float:
    """(m,) density of the texture on each triangle, the larger of its two directions."""
    assert geometry.uvs is not None
    assert geometry.material_ids is not None
    p, t = geometry.positions[geometry.triangles], geometry.uvs[geometry.triangles]
    sizes = np.array(
        [(1, 1) if m.texture is None else m.texture.shape[1::-1] for m in geometry.materials]
    )
    t = t * sizes[geometry.material_ids][:, None, :]
    lengths = np.linalg.norm(np.roll(p, -1, 1) - p, axis=-1)
    spans = np.linalg.norm(np.roll(t, -1, 1) - t, axis=-1)
    return (spans / np.maximum(lengths, 1e-9)).max(axis=1)


def _pyramid(texture: NDArray[np.uint8] | None) -> list[Float]:
    """Linear texture, halved again and again; empty where there is none."""
    import cv2

    if texture is None:
        return []
    levels = [srgb_decode(np.asarray(texture) / 255.0)]
    while min(levels[-1].shape[:2]) > 2:
        height, width = levels[-1].shape[:2]
        size = (max(1, width // 2), max(1, height // 2))
        levels.append(np.asarray(cv2.resize(levels[-1], size, interpolation=cv2.INTER_AREA)))
    return levels


def _sampled(pyramid: list[Float], uv: Float, level: Float) -> Float:
    """Trilinear values (n, 3)."""
    from andon.surface.textures import sample_bilinear

    level = np.clip(level, 0, len(pyramid) - 1)
    low = np.floor(level).astype(int)
    out = np.zeros((len(uv), 3))
    for number in range(len(pyramid)):
        for offset in (0, 1):
            chosen = np.flatnonzero(np.minimum(low + offset, len(pyramid) - 1) == number)
            share = level[chosen] - low[chosen]
            weight = share if offset else 1 - share
            if len(chosen):
                out[chosen] += weight[:, None] * sample_bilinear(pyramid[number], uv[chosen])
    return out
