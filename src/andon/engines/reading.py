"""From the tables of a scene to pictures, views and settings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from andon.composite.model import Ambient
from andon.display.model import Exposure, SeeThrough
from andon.errors import InputError
from andon.files.cameras import read_camera
from andon.files.pictures import Picture, read_picture
from andon.glow.automatic import glow_from_table
from andon.glow.model import Glow
from andon.quantities import photometric
from andon.responses import LINEAR, SRGB, Response
from andon.scene import Scene
from andon.spaces import View

__all__ = [
    "exposure_of",
    "glow_of",
    "luminance_per_unit_of",
    "read_pictures",
    "response_of",
    "source_of",
    "view_names_of",
    "view_of",
]


def source_of(scene: Scene, name: str) -> tuple[str, str]:
    """The path of a view's picture, and the field that names it."""
    source = scene.capture.source if scene.capture else None
    if source is None:
        raise InputError(
            "is missing: there is no picture to relight",
            file=scene.file,
            field="capture.source",
            remedy='add [capture] with source = "photo.png"',
        )
    if isinstance(source, str):
        return str(scene.path(source, "capture.source")), "capture.source"
    field = f"capture.source.{name}"
    return str(scene.path(getattr(source, name), field)), field


def read_pictures(scene: Scene) -> dict[str, Picture]:
    """The picture of each view of the rig."""
    names = view_names_of(scene)
    shared = scene.capture is not None and isinstance(scene.capture.source, str)
    if len(names) > 1 and shared:
        raise InputError(
            "is one picture for two eyes",
            file=scene.file,
            field="capture.source",
            remedy="give { left = …, right = … }",
        )
    return {name: read_picture(source_of(scene, name)[0]) for name in names}


def view_names_of(scene: Scene) -> list[str]:
    """The views of the rig. Raises `InputError` where there are none, or they move."""
    if scene.rig is None or not scene.rig.cameras:
        raise InputError(
            "is missing: nothing says where the pixels look",
            file=scene.file,
            field="rig.camera",
            remedy="add [rig.camera] with file, fx or hfov_degrees",
        )
    if scene.rig.trajectory is not None:
        raise InputError(
            "is in the schema but not rendered yet",
            file=scene.file,
            field="rig.trajectory",
            remedy="state rig.camera.world_from_camera",
        )
    return [name for name, _ in scene.rig.cameras]


def view_of(scene: Scene, name: str, shape: tuple[int, int] | None) -> View:
    """Where the pixels of a view's picture look.

    `shape` is (height, width) of the picture; None: the camera says.
    """
    assert scene.rig is not None
    camera = dict(scene.rig.cameras)[name]
    height, width = shape or (None, None)
    if camera.file is None:
        try:
            view = camera.view(name, width=width, height=height)
        except InputError as error:
            raise InputError(
                error.rule, file=scene.file, field=error.field, remedy=error.remedy
            ) from error
    else:
        field = f"rig.{'camera' if scene.rig.camera is not None else name}.file"
        size = None if shape is None else (shape[1], shape[0])
        view = read_camera(scene.path(camera.file, field), size=size)
        view = replace(view, name=name)
        if camera.has_pose:
            view = replace(view, world_from_camera=camera.pose())
    if scene.rig.camera is not None and scene.rig.kind == "stereo":
        view = replace(view, world_from_camera=_eye_pose(view, scene.observer.interpupillary_mm))
    undistort = scene.capture is None or scene.capture.undistort
    if view.distortion and not undistort:
        raise InputError(
            "false is in the schema but not rendered yet",
            file=scene.file,
            field="capture.undistort",
            remedy="leave it out: pictures are undistorted",
        )
    return view


def _eye_pose(view: View, interpupillary_mm: float) -> NDArray[np.float64]:
    """The pose of an eye beside the point between both eyes, which is the pose of `view`."""
    side = {"left": -0.5, "right": 0.5}[view.name]
    pose = view.world_from_camera.copy()
    pose[:3, 3] += side * interpupillary_mm / 1000 * pose[:3, 0]
    return pose


def response_of(scene: Scene, picture: Picture | None) -> Response:
    """g of a picture: what its codes mean; without a picture, what codes for the screen mean."""
    table = scene.capture.response if scene.capture else None
    if picture is not None and picture.encoding == "linear":
        if table is not None and table.kind != "linear":
            raise InputError(
                f"must be linear for an HDR picture, got {table.kind!r}",
                file=scene.file,
                field="capture.response",
                remedy="leave it out",
            )
        # HDR light is shown as sRGB: g is what a display needs, g⁻¹ was never applied.
        return SRGB
    if table is None:
        return SRGB
    if table.kind == "gamma":
        return Response("gamma", gamma=table.gamma or 2.2)
    if table.kind == "curve":
        from andon.files.responses import read_response

        return read_response(scene.path(table.file or "", "capture.response.file"))
    return LINEAR if table.kind == "linear" else SRGB


def luminance_per_unit_of(scene: Scene, ambient: Ambient) -> float:
    """cd/m² of the linear value 1."""
    if scene.capture and scene.capture.luminance_per_unit:
        return scene.capture.luminance_per_unit
    # A white diffuser (ρ = 1) in the light of the photograph is the picture's white.
    return float(photometric(ambient.mean_lux)) / np.pi


def exposure_of(scene: Scene) -> Exposure:
    """Settings of the display."""
    display = scene.display
    through = None
    if display.mode == "ost":
        assert display.peak_luminance_cd_m2 is not None  # the schema asks for it
        through = SeeThrough(
            display.peak_luminance_cd_m2,
            display.transmittance,
            display.compensation,
            scene.has_photograph,
        )
    return Exposure(display.exposure, display.tone, through)


def glow_of(scene: Scene) -> Glow | None:
    """The glow of luminous bodies, or None."""
    try:
        return glow_from_table(scene.glare, scene.observer)
    except InputError as error:
        raise InputError(
            error.rule, file=scene.file, field=error.field, remedy=error.remedy
        ) from error
