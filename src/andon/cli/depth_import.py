"""``andon depth import``: a frame of somebody's capture as photo, depth, camera and scene."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from andon.cli.console import check_folder, note, printable
from andon.cli.depth_options import ImportOptions
from andon.cli.typed import ASSUMED_AMBIENT_LUX
from andon.errors import InputError

if TYPE_CHECKING:
    from andon.files.captures import Capture, CaptureFrame

__all__ = ["run"]

SHOWN_NAMES = 3
SCENE = """\
# A frame of a capture. E0 is assumed: results are relative. Lamps are added by [[lamp]] or --lamp.
[scene]
name = "{name}"
photometry = "relative"

[rig.camera]
file = "camera.toml"

[capture]
source = "{photo}"

[surface]
depth = "depth.exr"

[ambient]
illuminance_lux = {lux:g}
"""


def run(options: ImportOptions) -> None:
    """Reads one frame and writes its files. Raises `InputError` before anything is written."""
    from andon.files.captures import open_capture

    check_folder(options.out)
    if options.out.resolve() == options.capture.resolve():
        raise InputError("is the capture itself", file=options.out, field="--out")
    capture = open_capture(options.capture, scale_to_m=options.scale_to_m)
    number = _number(capture, options.frame)
    frame = capture.read(number)
    if options.camera is not None:
        frame = _with_camera(frame, options)
    for line in _lines(capture, frame, number, has_camera=options.camera is not None):
        note(line)
    _write(capture, frame, options)
    print(options.out / "scene.toml")


def _number(capture: Capture, typed: str | None) -> int:
    """The frame of a name, or else of a number."""
    names = capture.names
    if typed is None:
        return 0
    if typed in names:
        return names.index(typed)
    if typed.isdecimal() and int(typed) < len(names):
        return int(typed)
    shown = ", ".join(names[:SHOWN_NAMES]) + (" …" if len(names) > SHOWN_NAMES else "")
    raise InputError(
        f"must be one of {printable(shown)}, or a number below {len(names)}, got {typed[:40]!r}",
        file=capture.path,
        field="--frame",
    )


def _with_camera(frame: CaptureFrame, options: ImportOptions) -> CaptureFrame:
    from andon.files.cameras import read_camera

    assert options.camera is not None
    size = (frame.view.width, frame.view.height)
    view = read_camera(options.camera, size=size)
    if not frame.has_pose:
        return replace(frame, view=view)
    return replace(frame, view=replace(view, world_from_camera=frame.view.world_from_camera))


def _lines(capture: Capture, frame: CaptureFrame, number: int, *, has_camera: bool) -> list[str]:
    height, width = frame.depth_m.shape
    seen = frame.depth_m[np.isfinite(frame.depth_m)]
    if not seen.size:
        raise InputError("has no depth in this frame", file=capture.path, field=frame.name)
    near, far = np.percentile(seen, [1, 99])
    lines = [
        f"{capture.format}: frame {printable(frame.name)}, {number + 1} of {len(capture.names)}",
        f"picture {frame.view.width}×{frame.view.height} px; depth {width}×{height} px, "
        f"{near:.2f}…{far:.2f} m, {1 - seen.size / frame.depth_m.size:.1%} holes",
    ]
    if not frame.has_pose:
        lines.append("the capture states no pose: the camera looks along −Z, level")
    notes = [line for line in capture.notes if not (has_camera and "intrinsics" in line)]
    return [*lines, *notes]


def _write(capture: Capture, frame: CaptureFrame, options: ImportOptions) -> None:
    from andon.files.atomic import write_bytes
    from andon.files.cameras import write_camera
    from andon.files.pictures import write_exr

    options.out.mkdir(exist_ok=True)
    photo = f"photo{frame.photo.suffix}"
    write_bytes(options.out / photo, frame.photo.data)
    write_camera(options.out / "camera.toml", frame.view)
    write_exr(options.out / "depth.exr", frame.depth_m, unit="m")
    name = printable(f"{capture.path.resolve().name} {frame.name}")
    name = name.replace("\\", "/").replace('"', "'")
    text = SCENE.format(name=name, photo=photo, lux=ASSUMED_AMBIENT_LUX)
    write_bytes(options.out / "scene.toml", text.encode())
