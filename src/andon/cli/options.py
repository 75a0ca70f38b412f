"""The options of ``andon relight``: the table from which its command line is made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from inspect import signature
from pathlib import Path
from typing import Annotated, Any, get_type_hints

import typer

from andon.errors import InputError

__all__ = ["ENGINES", "DepthKind", "EngineOption", "RelightOptions", "takes"]

ENGINES = ("auto", "gpu", "reference")


class DepthKind(StrEnum):
    """What the numbers of a depth file are."""

    z = "z"
    distance = "distance"
    disparity = "disparity"


def _engine(name: str) -> str:
    if name not in ENGINES:
        raise InputError(
            f"must be one of {', '.join(ENGINES)}, got {name!r}",
            field="--engine",
            remedy="gpu draws on every adapter with Vulkan, Metal or D3D12, whoever made it",
        )
    return name


EngineOption = Annotated[
    str,
    typer.Option(
        callback=_engine,
        metavar="|".join(ENGINES),
        help="auto: the GPU where an adapter is found, else the reference.",
    ),
]


@dataclass(frozen=True)
class RelightOptions:
    """The options of the command, as typed; each field is one of them."""

    out: Annotated[Path, typer.Option("-o", "--out", help="PNG or JPEG; EXR: cd/m².")]
    photo: Annotated[
        Path | None,
        typer.Argument(
            help="PNG, JPEG, EXR or Radiance HDR. With --scene it may be left out: the scene names "
            "its picture, or has none."
        ),
    ] = None
    depth: Annotated[
        Path | None, typer.Option(help="Depth or disparity: NPY, NPZ, PFM, PNG, PGM, EXR.")
    ] = None
    camera: Annotated[Path | None, typer.Option(help="Camera: TOML of Andon, or OpenCV YAML.")] = (
        None
    )
    mesh: Annotated[
        Path | None, typer.Option(help="Geometry as OBJ, PLY, glTF instead of a depth.")
    ] = None
    scene: Annotated[Path | None, typer.Option(help="Scene file (TOML); options win.")] = None
    lamps: Annotated[
        list[str] | None,
        typer.Option(
            "--lamp", help="preset=bulb,position=0.5,0.3,-1.5 or kind=point,…,flux_lm=800"
        ),
    ] = None
    ambient_lux: Annotated[
        float | None, typer.Option(help="E0: illuminance that the photograph was taken in.")
    ] = None
    dimming: Annotated[float | None, typer.Option(help="Share of E0 that is left, ≥ 0.")] = None
    depth_kind: Annotated[DepthKind | None, typer.Option(help="Default: z.")] = None
    depth_scale_to_m: Annotated[
        float | None, typer.Option(help="Metres per unit: 0.001 for millimetres.")
    ] = None
    baseline_m: Annotated[float | None, typer.Option(help="Stereo baseline of disparity.")] = None
    doffs_px: Annotated[float | None, typer.Option(help="Offset added to disparity.")] = None
    objects: Annotated[
        list[Path] | None, typer.Option("--object", help="Virtual object (glTF, OBJ, PLY).")
    ] = None
    illuminance_maps: Annotated[
        list[Path] | None,
        typer.Option("--illuminance-map", help="EXR: lux; PNG: false colours. May be repeated."),
    ] = None
    uncovered: Annotated[
        Path | None,
        typer.Option(help="PNG: where no illuminance map of [baked] sees the surface, in magenta."),
    ] = None
    confidence: Annotated[
        Path | None,
        typer.Option(
            help="How far each pixel may be trusted, and why not. PNG: expected error in false "
            "colours, with its causes; EXR: numbers."
        ),
    ] = None
    seen: Annotated[
        Path | None,
        typer.Option(
            help="What the eye gets through an optical see-through display: PNG, JPEG; EXR: cd/m²."
        ),
    ] = None
    tone: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="From light to the screen: none (clips), reinhard (compresses) or another of the "
            "scene file's display.tone.",
        ),
    ] = None
    exposure: Annotated[
        float | None,
        typer.Option(help="Screen value (0…1, linear) per cd/m²; default: the photograph's own."),
    ] = None
    fit_to: Annotated[
        Path | None,
        typer.Option(
            help="Reference photograph of the same view in the lamps' light: their flux and colour "
            "are fitted to it, and the picture is drawn with them.",
        ),
    ] = None
    fit_mask: Annotated[
        Path | None,
        typer.Option(help="White where the fit may look; errors are given inside and outside."),
    ] = None
    fit_lamps: Annotated[
        list[str] | None,
        typer.Option(help="Names of the lamps to fit, a,b; may be repeated. Default: all."),
    ] = None
    fit_dimming: Annotated[
        str,
        typer.Option(
            metavar="auto|off|one|channels",
            help="What is left of E0 is fitted too: one factor (also another exposure of the "
            "reference), or three (white balance). auto: one, where the reference is darker.",
        ),
    ] = "auto"
    fit_colour: Annotated[
        bool, typer.Option(help="Each lamp's three channels are free; else its flux alone.")
    ] = True
    fit_bounce: Annotated[
        bool,
        typer.Option(
            help="A hemisphere of light is fitted too, for what surfaces reflect of the lamps."
        ),
    ] = True
    fit_response: Annotated[
        bool,
        typer.Option(
            "--fit-response",
            help="The camera's response is chosen (srgb, linear, gamma) by the error it leaves.",
        ),
    ] = False
    fit_align: Annotated[
        str,
        typer.Option(
            metavar="auto|none", help="Of a camera that moved a little before the reference."
        ),
    ] = "auto"
    fit_report: Annotated[
        Path | None, typer.Option(help="JSON: fitted values, their errors, error of the picture.")
    ] = None
    fit_figure: Annotated[
        Path | None,
        typer.Option(help="PNG: photograph, reference, prediction and its error, side by side."),
    ] = None
    fit_scene: Annotated[
        Path | None,
        typer.Option(help="TOML: the scene with the fitted lamps, in the folder of its files."),
    ] = None
    view: Annotated[str | None, typer.Option(help="left or right of a stereo rig.")] = None
    time_seconds: Annotated[
        float, typer.Option("--time", help="Moment of the session, seconds.")
    ] = 0.0
    engine: EngineOption = "auto"


def takes(options: type[Any], /) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Gives a command that takes ``**typed`` the parameters of the dataclass `options`."""

    def with_parameters(command: Callable[..., None]) -> Callable[..., None]:
        types = get_type_hints(options, include_extras=True)
        given = signature(options)
        typed = [p.replace(annotation=types[name]) for name, p in given.parameters.items()]
        # Typer's versions differ in which of the two they read.
        command.__signature__ = given.replace(parameters=typed)  # type: ignore[attr-defined]
        command.__annotations__ = types
        return command

    return with_parameters
