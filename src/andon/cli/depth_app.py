"""``andon depth`` and its sub-commands, listed once."""

from __future__ import annotations

from typing import Any

import typer

from andon.cli.depth_options import FitOptions, ImportOptions
from andon.cli.options import takes

__all__ = ["depth_app"]

depth_app = typer.Typer(no_args_is_help=True)


@depth_app.callback()
def _depth() -> None:
    """Depth of others: estimators' without a unit, and captures of phones and depth cameras."""


@depth_app.command("fit")
@takes(FitOptions)
def fit(**typed: Any) -> None:
    """Find scale and shift of a relative depth from lengths, depths and planes that you know.

    Pixels are columns and rows of the photograph, from 0 at its top left. One length gives the
    scale; the shift takes a second one, a level floor, a right angle, or metric depth.

    Examples:

        andon depth fit midas.png --camera cam.toml --length 210,80,210,395=2.03
            --length 300,402,505,441=1.60 -o depth.exr --figure fit.png

        andon depth fit anything.npy --camera cam.toml --floor 100,400,300,70
            --height 1.55 -o surface.toml

        andon depth fit marigold.npy --kind depth --camera cam.toml
            --known lidar.png --known-scale-to-m 0.001 -o depth.exr --json fit.json
    """
    from andon.cli.depth_fit import run

    run(FitOptions(**typed))


@depth_app.command("import")
@takes(ImportOptions)
def import_(**typed: Any) -> None:
    """Take a frame of a capture by a phone, a depth camera or COLMAP, as `andon relight` takes it.

    Known are folders of TUM RGB-D, RealSense (Open3D's recorder, snapshots of the viewer), Record3D
    (.r3d, too), Stray Scanner, ARKitScenes, COLMAP's dense workspace, and the slambook's.
    Writes photo, depth.exr (metres, holes NaN), camera.toml and scene.toml.

    Examples:

        andon depth import rgbd_dataset_freiburg1_desk -o desk --frame 120

        andon depth import living_room.r3d -o room

        andon relight --scene room/scene.toml -o lit.png
            --lamp preset=bulb,position=0,0.3,-1.5
    """
    from andon.cli.depth_import import run

    run(ImportOptions(**typed))
