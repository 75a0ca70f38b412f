"""The options of ``andon depth``: the tables from which its command lines are made."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

__all__ = ["FitOptions", "ImportOptions", "RelativeKind"]


class RelativeKind(StrEnum):
    """What an estimator's numbers are."""

    inverse = "inverse"
    depth = "depth"


@dataclass(frozen=True)
class FitOptions:
    """The options of ``andon depth fit``, as typed; each field is one of them."""

    relative: Annotated[Path, typer.Argument(help="Relative depth: NPY, NPZ, PFM, PNG, PGM, EXR.")]
    camera: Annotated[Path, typer.Option(help="Camera of the photograph: TOML, or OpenCV YAML.")]
    out: Annotated[
        Path,
        typer.Option(
            "-o", "--out", help="EXR: depth in metres; TOML: [surface.depth] of the input."
        ),
    ]
    kind: Annotated[
        RelativeKind, typer.Option(help="inverse: 1/z = a·r + b; depth: z = a·r + b.")
    ] = RelativeKind.inverse
    lengths: Annotated[
        list[str] | None,
        typer.Option(
            "--length", metavar="X1,Y1,X2,Y2=METRES", help="Between two points in space. Repeat."
        ),
    ] = None
    points: Annotated[
        list[str] | None,
        typer.Option("--at", metavar="X,Y=METRES", help="Depth z of a pixel. Repeat."),
    ] = None
    planes: Annotated[
        list[str] | None,
        typer.Option(
            "--plane", metavar="MASK.png|X,Y,W,H", help="Pixels that lie on one plane. Repeat."
        ),
    ] = None
    perpendicular: Annotated[
        list[str] | None,
        typer.Option(
            metavar="I,J|I,floor", help="Planes at right angles: by number, 1 first. Repeat."
        ),
    ] = None
    floor: Annotated[
        str | None,
        typer.Option(
            metavar="MASK.png|X,Y,W,H", help="Pixels of a floor, level by the camera's pose."
        ),
    ] = None
    height: Annotated[float | None, typer.Option(help="Of the camera over the floor, metres.")] = (
        None
    )
    known: Annotated[
        Path | None, typer.Option(help="Metric depth z of some pixels; may be noisy.")
    ] = None
    known_scale_to_m: Annotated[
        float, typer.Option(help="Metres per unit of --known: 0.001 for millimetres.")
    ] = 1.0
    invalid: Annotated[
        list[float] | None, typer.Option(help="Value of the input that is a hole. Repeat.")
    ] = None
    figure: Annotated[
        Path | None, typer.Option(help="PNG: depth, what is known, seen from above and aside.")
    ] = None
    json: Annotated[Path | None, typer.Option(help="The report as JSON.")] = None


@dataclass(frozen=True)
class ImportOptions:
    """The options of ``andon depth import``, as typed; each field is one of them."""

    capture: Annotated[Path, typer.Argument(help="Folder of the capture, or a .r3d file.")]
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder for the frame's files.")]
    frame: Annotated[
        str | None, typer.Option(help="Its name, or its number from 0; default: the first.")
    ] = None
    camera: Annotated[
        Path | None, typer.Option(help="Intrinsics instead of the capture's; its pose stays.")
    ] = None
    scale_to_m: Annotated[float | None, typer.Option(help="Metres per unit, of COLMAP.")] = None
