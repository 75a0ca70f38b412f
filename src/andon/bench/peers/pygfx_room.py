"""The engine peer: pygfx draws a room with shadowed point lamps, in our units.

Units (pygfx 0.17, read from its shaders and held by a test against the closed form): a
`PointLight` has `intensity` in candela, with ``decay=2`` the irradiance is I·cos φ/d², and the
Phong material's diffuse term is ρ/π, so the colour that it computes *is* luminance in cd/m². It
is written to an 8-bit sRGB texture: intensities are divided by the luminance that shall be white,
and the texture is decoded again. There is no tone curve before pygfx's output pass, and that pass
is left out.

What leaves exact agreement:

- 8-bit sRGB: half a step is 2 % of the value at 0.04 of white (`agreement` allows for it).
- Phong with a black specular colour still has Fresnel's grazing term F/4π beside ρ/π. It passes
  1 % of ρ = 0.5 where lamp and eye are more than 110° apart over the surface, 8 % at 145°.
- Shadow maps have 1024² texels per cube face and hardware 2×2 comparison; only back faces are
  drawn into them (pygfx's default), which needs closed objects. A few lit dots line the seams.

Measured on the furnished room (1280×720, four lamps, against Embree shadows and the closed form):
99.98 % of pixels agree within 5 % without shadows, 98.4 % with them. On two cores of Mesa 22.3's
lavapipe a frame took 65 ms without shadows, 280 ms with kept and 345 ms with drawn ones; reading
it back added 2 ms or less.

pygfx draws its shadow maps anew in every frame; ``shadows="kept"`` draws them once, by taking the
objects' ``cast_shadow`` away after the first frame, which leaves the maps as they are.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from andon.errors import InputError, MachineError
from andon.quantities import Geometry
from andon.responses import srgb_decode, srgb_encode
from andon.spaces import View

__all__ = ["PygfxRoom", "agreement"]

Float = NDArray[np.float64]

# The maps' depth range, metres: lamps stand ≥ 0.15 m from anything, rooms are smaller than 50 m.
SHADOW_NEAR_M, SHADOW_FAR_M = 0.05, 50.0
CAMERA_NEAR_M = 0.05
# pygfx 0.17 looks the wrong way with the upper face of a shadow cube (+y comes out as −z: turning
# to a direction parallel to "up" forgets the present rotation). An "up" that leans by 1e-4 rad
# avoids that branch and rolls two faces by no more than 0.05 texels.
SHADOW_UP = (1e-4, 1.0, 0.0)
# Phong's exponent: the lowest spreads the grazing term thinnest. Exactly 0 would be 0⁰ where the
# lamp is behind the surface, which is NaN on some drivers.
SHININESS = 1e-3


class PygfxRoom:
    """One scene, one view, drawn by pygfx without a window.

    Parameters
    ----------
    geometry : closed objects; `Material.reflectance` is used, textures are not.
    view : pinhole with the principal point at the picture's centre.
    lamp_positions : (n, 3) metres.
    lamp_intensities_cd : (n, 3) candela per channel, > 0.
    white_cd_m2 : luminance that becomes 1.0 in the 8-bit target; more is clipped.
    shadows : ``"drawn"`` in every frame, ``"kept"`` from the first, or ``"none"``.

    Raises
    ------
    MachineError : pygfx is not installed, or finds no adapter.
    InputError : a view or material that this peer cannot draw alike.
    """

    def __init__(
        self,
        geometry: Geometry,
        view: View,
        lamp_positions: ArrayLike,
        lamp_intensities_cd: ArrayLike,
        *,
        white_cd_m2: float,
        shadows: Literal["drawn", "kept", "none"] = "drawn",
    ) -> None:
        if not (np.isfinite(white_cd_m2) and white_cd_m2 > 0):
            raise InputError(f"must be > 0 cd/m², got {white_cd_m2}", field="white_cd_m2")
        gfx = _pygfx()
        self.white_cd_m2, self._shape = white_cd_m2, view.shape
        self._meshes: list[Any] = _meshes(gfx, geometry, shadows != "none")
        lamps = _lamps(gfx, lamp_positions, lamp_intensities_cd, white_cd_m2, shadows != "none")
        self._camera: Any = _camera(gfx, view)
        self._scene: Any = gfx.Scene()
        self._scene.add(*self._meshes, *lamps)
        target = gfx.Texture(dim=2, size=(view.width, view.height, 1), format="rgba8unorm-srgb")
        try:
            self._renderer: Any = gfx.WgpuRenderer(
                target, pixel_scale=1, ppaa="none", sort_objects=True
            )
        except RuntimeError as error:
            raise MachineError(
                f"pygfx found no adapter ({error})", remedy="install a Vulkan driver"
            ) from error
        self._fence: Any = self._renderer.device.create_buffer(size=4, usage="COPY_SRC|COPY_DST")
        self.draw()
        if shadows == "kept":
            for mesh in self._meshes:
                mesh.cast_shadow = False

    @property
    def adapter_name(self) -> str:
        """The adapter's own description, to be compared with ours."""
        return str(self._renderer.device.adapter.summary)

    def draw(self) -> None:
        """One frame into the target, done when the adapter is; nothing is read back."""
        # Without flush the output pass (a copy with a gamma) is spared.
        self._renderer.render(self._scene, self._camera, clear=True, flush=False)
        # Queues work in order: four bytes read back mean that the frame before them is done.
        # (The queue's own on_submitted_work_done raises in wgpu 0.32.)
        self._renderer.device.queue.read_buffer(self._fence)

    def render(self) -> NDArray[np.uint8]:
        """(H, W, 4) uint8 sRGB: one frame, read back."""
        self.draw()
        return np.array(self._renderer.snapshot())

    def luminance(self) -> Float:
        """(H, W, 3) cd/m²: one frame, read back and decoded."""
        decoded = srgb_decode(self.render()[..., :3] / np.float64(255))
        return np.asarray(decoded, np.float64) * self.white_cd_m2

    def close(self) -> None:
        """Lets go of what the adapter holds; nothing can be drawn afterwards."""
        self._scene.clear()
        self._meshes.clear()
        del self._renderer, self._fence


def agreement(
    ours_cd_m2: NDArray[Any],
    peer_cd_m2: NDArray[Any],
    /,
    *,
    white_cd_m2: float,
    within: float = 0.05,
) -> float:
    """Share of pixels, in [0, 1], whose three channels agree within `within` of the larger value.

    Both are (H, W, 3) cd/m²; ours is clipped to white as the peer's is, and half a step of the
    peer's 8-bit sRGB is granted on top. NaN agrees with nothing.
    """
    if ours_cd_m2.shape != peer_cd_m2.shape:
        raise InputError(
            f"must have one shape, got {ours_cd_m2.shape} and {peer_cd_m2.shape}", field="agreement"
        )
    ours, peer = (np.minimum(x / white_cd_m2, 1.0) for x in (ours_cd_m2, peer_cd_m2))
    code = srgb_encode(np.maximum(peer, 0))
    half_step = srgb_decode(code + 0.5 / 255) - srgb_decode(code)
    close = np.abs(ours - peer) <= within * np.maximum(ours, peer) + half_step
    return float(close.all(axis=-1).mean())


def _pygfx() -> Any:
    try:
        return import_module("pygfx")
    except ImportError as error:
        raise MachineError(
            f"pygfx is missing ({error})", remedy="install it with: pip install 'andon[bench]'"
        ) from error


def _physical_color(gfx: Any, triple: Float) -> Any:
    return gfx.Color.from_physical(*(float(value) for value in triple))


def _meshes(gfx: Any, geometry: Geometry, shadowed: bool) -> list[Any]:
    """One mesh per material that is in use; flat shading where there are no normals."""
    positions = np.ascontiguousarray(geometry.positions, np.float32)
    ids = geometry.material_ids
    meshes: list[Any] = []
    for number, material in enumerate(geometry.materials):
        if material.texture is not None:
            raise InputError("the peer draws no textures", field=f"materials[{number}].texture")
        chosen = geometry.triangles if ids is None else geometry.triangles[ids == number]
        if len(chosen) == 0:
            continue
        used, indices = np.unique(chosen, return_inverse=True)
        buffers = {
            "positions": positions[used],
            "indices": np.ascontiguousarray(indices.reshape(-1, 3), np.int32),
        }
        if geometry.normals is not None:
            buffers["normals"] = np.ascontiguousarray(geometry.normals[used], np.float32)
        paint = gfx.MeshPhongMaterial(
            color=_physical_color(gfx, np.array(material.reflectance)),
            specular="#000",
            shininess=SHININESS,
            flat_shading=geometry.normals is None,
            pick_write=False,
        )
        mesh = gfx.Mesh(gfx.Geometry(**buffers), paint)
        mesh.cast_shadow = mesh.receive_shadow = shadowed
        meshes.append(mesh)
    return meshes


def _lamps(
    gfx: Any, positions: ArrayLike, intensities_cd: ArrayLike, white_cd_m2: float, shadowed: bool
) -> list[Any]:
    places, powers = np.asarray(positions, np.float64), np.asarray(intensities_cd, np.float64)
    if places.ndim != 2 or places.shape[1:] != (3,) or places.shape != powers.shape:
        raise InputError(
            f"must both be (n, 3), got {places.shape} and {powers.shape}", field="lamps"
        )
    if not (np.isfinite(places).all() and np.isfinite(powers).all() and (powers > 0).all()):
        raise InputError("must be finite, with intensities > 0 cd", field="lamps")
    lamps: list[Any] = []
    for place, power in zip(places, powers, strict=True):
        strongest = float(power.max())
        lamp = gfx.PointLight(
            _physical_color(gfx, power / strongest),
            intensity=strongest / white_cd_m2,
            decay=2,
            cast_shadow=shadowed,
        )
        lamp.local.position = tuple(place.tolist())
        lamp.shadow.camera.world.reference_up = SHADOW_UP
        lamp.shadow.camera.depth_range = (SHADOW_NEAR_M, SHADOW_FAR_M)
        lamps.append(lamp)
    return lamps


def _camera(gfx: Any, view: View) -> Any:
    centre = ((view.width - 1) / 2, (view.height - 1) / 2)
    if view.projection != "pinhole" or view.distortion:
        raise InputError("must be an undistorted pinhole", field="view")
    if not np.allclose((view.cx, view.cy), centre, atol=1e-6) or view.fx != view.fy:
        raise InputError("must have a central principal point and square pixels", field="view")
    # pygfx's field of view belongs to the mean of width and height.
    extent = (view.width + view.height) / 2
    camera = gfx.PerspectiveCamera(
        np.degrees(2 * np.arctan(extent / 2 / view.fx)),
        view.width / view.height,
        depth_range=(CAMERA_NEAR_M, SHADOW_FAR_M),
    )
    # Its camera looks along −z with y up (OpenGL), ours along +z with y down (OpenCV).
    camera.local.matrix = view.world_from_camera @ np.diag([1.0, -1.0, -1.0, 1.0])
    return camera
