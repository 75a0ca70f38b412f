"""glTF's metallic-roughness materials as `Material` (glTF 2.0, section 3.9).

Every extension is handed on as read. Emission with a texture is reduced to its mean over the
texture, because a `Material` emits one luminance: right in total where the texture covers the
surface evenly, wrong in place.

Where a file states no metallicFactor glTF's default is 1, all metal; exporters that mean plaster
leave it out as well. So a material says whether its file stated one (`metallic_stated`), and
textures of metallic and roughness are not read.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.files.meshes.gltf.buffers import BufferStore, decode_data_uri
from andon.files.meshes.gltf.container import Document
from andon.files.meshes.textures import TextureStore
from andon.files.tree import Tree
from andon.quantities import Material
from andon.responses import srgb_decode

__all__ = ["MaterialReader", "TextureUse"]

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class TextureUse:
    """Which set of texture coordinates the base colour uses, and KHR_texture_transform's 2×3."""

    coordinates: int = 0
    transform: tuple[Triple, Triple] | None = None


class MaterialReader:
    """Reads the materials of one document; textures are read once."""

    def __init__(self, document: Document, buffers: BufferStore) -> None:
        self._document, self._buffers = document, buffers
        self._textures = TextureStore(document.path, document.limits)
        self._means: dict[int, NDArray[np.float64]] = {}

    def read(self, entry: Tree) -> tuple[Material, TextureUse]:
        """One entry of ``materials``."""
        base = entry.get("pbrMetallicRoughness") or Tree({}, entry.place, entry.file)
        factor = _numbers(base, "baseColorFactor", (1.0, 1.0, 1.0, 1.0))
        colour = base.get("baseColorTexture")
        name = entry.get("name")
        sided = entry.get("doubleSided")
        material = Material(
            name.text() if name else entry.place,
            (factor[0], factor[1], factor[2]),
            self._texture(colour) if colour else None,
            self._emission(entry),
            _number(base, "metallicFactor", 1.0, 1.0),
            _number(base, "roughnessFactor", 1.0, 1.0),
            sided.boolean() if sided else False,
            _extensions(entry, factor[3]),
            "metallicFactor" in base and base.get("metallicRoughnessTexture") is None,
        )
        return material, _use(colour) if colour else TextureUse()

    def _emission(self, entry: Tree) -> Triple:
        """Luminance in cd/m²: emissiveFactor × strength (KHR_materials_emissive_strength)."""
        factor = np.array(_numbers(entry, "emissiveFactor", (0.0, 0.0, 0.0)))
        extension = _extension(entry, "KHR_materials_emissive_strength")
        if extension is not None:
            factor *= _number(extension, "emissiveStrength", 1.0, 1e12)
        texture = entry.get("emissiveTexture")
        if texture is not None and factor.any():
            values = self._texture(texture)
            if id(values) not in self._means:  # the store keeps textures alive: ids stay theirs
                self._means[id(values)] = _mean_linear(values)
            factor *= self._means[id(values)]
        red, green, blue = factor.tolist()
        return red, green, blue

    def _texture(self, info: Tree) -> NDArray[Any]:
        texture = self._document.entry("textures", info.at("index"))
        source = texture.get("source")
        if source is None:
            extensions = texture.get("extensions")
            names = ", ".join(extensions.table()) if extensions else ""
            raise texture.error(
                f"must have a PNG or JPEG source{', has only ' + names[:80] if names else ''}",
                "export the textures as PNG or JPEG",
            )
        image = self._document.entry("images", source)
        view = image.get("bufferView")
        if view is not None:
            return self._textures.from_bytes(lambda: bytes(self._buffers.view(view)), image.place)
        uri = image.at("uri")
        if uri.text()[:5].lower() == "data:":
            return self._textures.from_bytes(lambda: decode_data_uri(uri), image.place)
        return self._textures.from_reference(uri.text(), percent_encoded=True)


def _mean_linear(texture: NDArray[Any]) -> NDArray[np.float64]:
    """(3,) mean of a texture as linear light; 8-bit ones by their histogram."""
    if texture.dtype != np.uint8:
        return texture.reshape(-1, 3).mean(axis=0, dtype=np.float64)
    linear = srgb_decode(np.arange(256) / 255)
    counts = [np.bincount(texture[..., c].ravel(), minlength=256) for c in range(3)]
    return np.array([float(linear @ count / count.sum()) for count in counts])


def _use(info: Tree) -> TextureUse:
    coordinates = info.get("texCoord")
    number = coordinates.integer(0, 15) if coordinates else 0
    extension = _extension(info, "KHR_texture_transform")
    if extension is None:
        return TextureUse(number)
    override = extension.get("texCoord")
    offset = _numbers(extension, "offset", (0.0, 0.0), signed=True)
    scale = _numbers(extension, "scale", (1.0, 1.0), signed=True)
    rotation = extension.get("rotation")
    angle = rotation.number() if rotation else 0.0
    cos, sin = float(np.cos(angle)), float(np.sin(angle))
    # translation · rotation · scale; the rotation is counter-clockwise as seen, with v down, as
    # the viewers have it (the extension's GLSL, read by columns, would turn the other way).
    rows = (
        (cos * scale[0], sin * scale[1], offset[0]),
        (-sin * scale[0], cos * scale[1], offset[1]),
    )
    return TextureUse(override.integer(0, 15) if override else number, rows)


def _extensions(entry: Tree, alpha: float) -> dict[str, Any]:
    """The extensions as read; how alpha is meant, where it is, stands beside them."""
    found = entry.get("extensions")
    kept = dict(found.table()) if found else {}
    mode = entry.get("alphaMode")
    if mode is not None and mode.text() != "OPAQUE":
        kept["alpha"] = {"mode": mode.text(), "factor": alpha}
    return kept


def _extension(owner: Tree, name: str) -> Tree | None:
    extensions = owner.get("extensions")
    return extensions.get(name) if extensions else None


def _number(owner: Tree, key: str, default: float, most: float) -> float:
    found = owner.get(key)
    return default if found is None else found.number(0.0, most)


def _numbers(
    owner: Tree, key: str, default: tuple[float, ...], *, signed: bool = False
) -> tuple[float, ...]:
    """A list of numbers; in [0, 1] unless `signed`."""
    found = owner.get(key)
    if found is None:
        return default
    values = found.numbers(len(default))
    if not signed and not all(0 <= value <= 1 for value in values):
        raise found.error(f"must be numbers in 0…1, got {values}")
    return values
