"""glTF: `EXT_lights_image_based`, one light and one scene for each probe.

The extension asks for irradiance as nine harmonics, and for a cube map of the light for shiny
surfaces, blurred level by level up to roughness 1. A probe has no such map: it is drawn here *from
the harmonics themselves*, so mirrors show no more than the few bands that there are. Its blur is
that of GGX with the view along the normal (Karis 2013): the kernel D(θ/2)·cos θ around the
reflected direction is zonal, so it is a factor for each band. With roughness 1 it is the cosine,
and the level is E/π.

The light's `intensity` takes the largest value out, so that 8 bits of sRGB without an alpha channel
hold the rest (the extension reads four channels as RGBD). What rings below zero is black. The text
of the extension wants each image flipped about its vertical axis: it is then what one sees who
looks along the axis of the face.

The extension names no sign of its basis (see `andon.harmonics.conventions.gltf`). Here there is
none, as in the papers that it refers to.

Source: Khronos Group, "EXT_lights_image_based", multi-vendor extension of glTF 2.0.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.files.volumes.glb import GlbArrays
from andon.harmonics import basis, cube_directions, order_of
from andon.harmonics.conventions import to_gltf
from andon.responses import srgb_encode
from andon.transport.probes.export.model import ExportUnit, PlacedLight

__all__ = ["MOST_LIGHTS", "band_factors", "image_based_glb"]

Float = NDArray[np.float64]

NAME = "EXT_lights_image_based"
# Levels from roughness 0 to 1. The extension suggests 16² for the last; of light with so few bands
# 64² shows no more than 32².
SIZES = (64, 32, 16)
# 18 pictures each: some 30 kB.
MOST_LIGHTS = 1000
# Of the quadrature in the cosine, exact to 1e-12 for the smooth kernels here (roughness ≥ 0.5).
NODES = 256


def image_based_glb(lights: Sequence[PlacedLight], unit: ExportUnit) -> bytes:
    """A GLB file without geometry: scene i has the light of probe i, and a node where it stands."""
    if len(lights) > MOST_LIGHTS:
        raise InputError(
            f"at most {MOST_LIGHTS} lights go into one glTF file, these are {len(lights)}",
            field="format",
            remedy="choose a probe",
        )
    arrays = GlbArrays()
    images: list[dict[str, Any]] = []
    entries = [_light(light, unit, arrays, images) for light in lights]
    scenes = [
        {"name": light.name, "nodes": [number], "extensions": {NAME: {"light": number}}}
        for number, light in enumerate(lights)
    ]
    nodes = [{"name": p.name, "translation": p.position_m.tolist()} for p in lights]
    return arrays.document(
        {
            "asset": {"version": "2.0", "generator": "Andon", "extras": {"unit": unit.words}},
            "extensionsUsed": [NAME],
            "scene": 0,
            "scenes": scenes,
            "nodes": nodes,
            "images": images,
            "extensions": {NAME: {"lights": entries}},
        }
    )


def _light(
    light: PlacedLight, unit: ExportUnit, arrays: GlbArrays, images: list[dict[str, Any]]
) -> dict[str, Any]:
    coefficients = unit.scale * light.coefficients
    levels = [
        _cube(coefficients, size, roughness)
        for size, roughness in zip(SIZES, np.linspace(0, 1, len(SIZES)), strict=True)
    ]
    intensity = max(float(level.max()) for level in levels)
    if not intensity > 0:
        intensity = 1.0
    numbers: list[list[int]] = []
    for level in levels:
        numbers.append([])
        for face in level:
            numbers[-1].append(len(images))
            view = arrays.blob(_png(face / intensity))
            images.append({"bufferView": view, "mimeType": "image/png"})
    return {
        "name": light.name,
        "intensity": intensity,
        "irradianceCoefficients": to_gltf(coefficients / intensity).tolist(),
        "specularImageSize": SIZES[0],
        "specularImages": numbers,
    }


def _cube(coefficients: Float, size: int, roughness: float) -> Float:
    """(6, s, s, 3) luminance ≥ 0, faces in the extension's order and its mirrored images."""
    order = order_of(len(coefficients))
    bands = np.repeat(band_factors(roughness, order), 2 * np.arange(order + 1) + 1)
    values = _basis_of(size, order) @ (coefficients * bands[:, None])
    return np.maximum(values[:, :, ::-1], 0.0)


@lru_cache(maxsize=16)
def _basis_of(size: int, order: int) -> Float:
    return basis(cube_directions(size), order)


@lru_cache(maxsize=64)
def band_factors(roughness: float, order: int, /) -> Float:
    """(order + 1,) what GGX of a `roughness` in 0…1 (α = roughness²) does to each band.

    With N = V = R the half vector is half-way: light from θ beside R has the density
    D(θ/2)·cos θ, normalised. 1 for roughness 0.
    """
    if roughness == 0:
        return np.ones(order + 1)
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    cosine = (nodes + 1) / 2  # cos θ in 0…1, beyond it faces away
    half = (cosine + 1) / 2  # cos²(θ/2)
    alpha = roughness**2
    kernel = weights * cosine / (half * (alpha**2 - 1) + 1) ** 2
    legendre = np.polynomial.legendre.legvander(cosine, order)
    found: Float = kernel @ legendre / kernel.sum()
    return found


def _png(face: Float) -> bytes:
    from PIL import Image

    stream = io.BytesIO()
    values = np.round(255 * srgb_encode(np.clip(face, 0, 1))).astype(np.uint8)
    Image.fromarray(values).save(stream, "PNG")
    return stream.getvalue()
