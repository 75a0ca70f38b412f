"""``andon calibrate ambient``: E0 of each pixel from one photograph and its geometry."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from andon.cli.console import check_apart, check_writable, note
from andon.cli.options import DepthKind, RelightOptions, takes
from andon.errors import InputError

if TYPE_CHECKING:
    from andon.calibrate.ambient import AmbientEstimate, Placed
    from andon.calibrate.ambient.of_scene import Photograph

__all__ = ["AmbientOptions", "ambient", "facts_of", "run"]


@dataclass(frozen=True)
class AmbientOptions:
    """The options of the command, as typed; each field is one of them."""

    out: Annotated[
        Path, typer.Option("-o", "--out", help="EXR of E0 in lx (or relative), for ambient.map.")
    ]
    photo: Annotated[
        Path | None,
        typer.Argument(help="PNG, JPEG, EXR or HDR; with --scene as the scene says."),
    ] = None
    depth: Annotated[
        Path | None, typer.Option(help="Depth or disparity: NPY, NPZ, PFM, PNG, PGM, EXR.")
    ] = None
    camera: Annotated[Path | None, typer.Option(help="Camera: TOML of Andon, or OpenCV YAML.")] = (
        None
    )
    mesh: Annotated[Path | None, typer.Option(help="Geometry instead of a depth.")] = None
    scene: Annotated[
        Path | None,
        typer.Option(help="Scene file (TOML): its picture, surface, response, [[ambient.source]]."),
    ] = None
    depth_kind: Annotated[DepthKind | None, typer.Option(help="Default: z.")] = None
    depth_scale_to_m: Annotated[float | None, typer.Option(help="Metres per unit.")] = None
    baseline_m: Annotated[float | None, typer.Option(help="Stereo baseline of disparity.")] = None
    doffs_px: Annotated[float | None, typer.Option(help="Offset added to disparity.")] = None
    lux: Annotated[
        float | None, typer.Option(help="Photometric mean of E0 over the surface, > 0 lx.")
    ] = None
    reflectance: Annotated[
        float | None,
        typer.Option(
            help="Mean reflectance of the surface, 0…1; needs capture.luminance_per_unit."
        ),
    ] = None
    temperature_k: Annotated[
        float | None,
        typer.Option(
            "--temperature", help="Colour of the mean light, kelvin; default: neutral."
        ),
    ] = None  # fmt: skip
    view: Annotated[str | None, typer.Option(help="left or right of a stereo rig.")] = None
    figure: Annotated[
        Path | None, typer.Option(help="PNG: photograph, E0, what is left, the stated error.")
    ] = None
    facts: Annotated[
        Path | None, typer.Option("--json", help="Scale, errors and shares as numbers.")
    ] = None


@takes(AmbientOptions)
def ambient(**typed: Any) -> None:
    """Estimate E0, the light of a photograph, pixel by pixel: three channels, smooth, no shadows.

    The photograph tells how light changes within each material; scale and mean colour it does not:
    state them, or E0 is relative and its mean is 1. Shadows of a real lamp come in where the scene
    names it as [[ambient.source]]. The stated error is what is to be expected, in the median.

    Examples:

        andon calibrate ambient room.jpg --depth room.npy --camera room.toml -o e0.exr --lux 150

        andon calibrate ambient --scene room/scene.toml -o room/e0.exr --figure e0.png
    """
    run(AmbientOptions(**typed))


def run(options: AmbientOptions) -> None:
    """Estimates and writes. Raises `InputError` before anything is written."""
    _check(options)
    from andon.calibrate.ambient import estimate_ambient, placed
    from andon.calibrate.ambient.of_scene import as_captured, photograph_of
    from andon.cli.typed import scene_of
    from andon.files.pictures import write_exr

    scene = scene_of(_as_relit(options))
    photograph = photograph_of(scene, options.view)
    if options.reflectance is not None and not photograph.has_unit:
        raise InputError(
            "needs a photograph in cd/m², and nothing says what its values are",
            field="--reflectance",
            remedy="state capture.luminance_per_unit in a scene file, or give --lux",
        )
    frame, seen = photograph.frame, photograph.seen
    estimate = estimate_ambient(frame, seen, sources_lux=list(photograph.sources.values()))
    found = placed(
        estimate,
        frame,
        seen,
        mean_lux=options.lux,
        mean_reflectance=options.reflectance,
        colour=_colour(options.temperature_k),
    )
    lux = as_captured(found.lux, photograph.captured)
    write_exr(options.out, lux.astype("float32"), unit="lx", photometry=found.photometry)
    _write_more(options, photograph, estimate, found)
    _print(options, photograph, estimate, found)


def _check(options: AmbientOptions) -> None:
    for path, suffix, field in (
        (options.out, ".exr", "--out"),
        (options.figure, ".png", "--figure"),
        (options.facts, ".json", "--json"),
    ):
        if path is not None:
            check_writable(path, (suffix,), field)
    named = (options.photo, options.depth, options.camera, options.mesh, options.scene)
    inputs = [path for path in named if path is not None]
    check_apart(inputs, (options.out, options.figure, options.facts))
    if options.lux is not None and options.reflectance is not None:
        raise InputError("give one of --lux and --reflectance", field="--lux")
    if options.lux is not None and not 0 < options.lux < math.inf:
        raise InputError(f"must be > 0 lx, got {options.lux:g}", field="--lux")
    if options.reflectance is not None and not 0 < options.reflectance <= 1:
        raise InputError(f"must be > 0 and ≤ 1, got {options.reflectance:g}", field="--reflectance")
    _colour(options.temperature_k)


def _colour(temperature_k: float | None) -> Any:
    """(3,) factors of a colour temperature. Raises `InputError` that names the option."""
    if temperature_k is None:
        return None
    from andon.lamps.colour import factors_from_temperature

    try:
        return factors_from_temperature(temperature_k)
    except InputError as error:
        raise InputError(error.rule, field="--temperature", remedy=error.remedy) from error


def _as_relit(options: AmbientOptions) -> RelightOptions:
    """The same scene as `andon relight` makes of these options; its E0 is not used."""
    return RelightOptions(
        out=options.out,
        photo=options.photo,
        depth=options.depth,
        camera=options.camera,
        mesh=options.mesh,
        scene=options.scene,
        depth_kind=options.depth_kind,
        depth_scale_to_m=options.depth_scale_to_m,
        baseline_m=options.baseline_m,
        doffs_px=options.doffs_px,
        view=options.view,
    )


def _write_more(
    options: AmbientOptions, photograph: Photograph, estimate: AmbientEstimate, found: Placed
) -> None:
    from andon.files.atomic import write_json
    from andon.files.pictures import write_png

    if options.figure is not None:
        from andon.calibrate.ambient.figure import ambient_figure

        write_png(
            options.figure, ambient_figure(photograph.frame, photograph.seen, estimate, found)
        )
    if options.facts is not None:
        write_json(options.facts, facts_of(photograph, estimate, found))


def facts_of(photograph: Photograph, estimate: AmbientEstimate, found: Placed) -> dict[str, Any]:
    """What was found, as JSON."""
    import numpy as np

    from andon.quantities import photometric

    own = found.lux[photograph.seen.valid]
    levels = np.quantile(photometric(own), [0.05, 0.5, 0.95])
    unit = "lux" if found.photometry == "absolute" else "relative"
    return {
        "photometry": found.photometry,
        "scale_by": found.by,
        f"mean_rgb_{unit}": [float(f"{value:.5g}") for value in own.mean(axis=0)],
        f"p5_p50_p95_{unit}": [float(f"{value:.5g}") for value in levels],
        "stated_median_error": float(f"{estimate.stated_error:.4g}"),
        "used_share": float(f"{estimate.used_share:.4g}"),
        "source_shares": {
            name: float(f"{share:.4g}")
            for name, share in zip(photograph.sources, estimate.source_shares, strict=True)
        },
    }


def _print(
    options: AmbientOptions, photograph: Photograph, estimate: AmbientEstimate, found: Placed
) -> None:
    facts = facts_of(photograph, estimate, found)
    word = found.photometry
    unit = "lx" if word == "absolute" else "of its mean"
    key = "lux" if word == "absolute" else "relative"
    low, middle, high = facts[f"p5_p50_p95_{key}"]
    if found.by == "nothing":
        note("the scale of E0 is not known: its mean is 1 (relative); --lux states it")
    note(
        f"E0 {low:.3g} … {middle:.3g} … {high:.3g} {unit} (5, 50, 95 %; {word}, scale by "
        f"{found.by}); expected error {estimate.stated_error:.0%} in the median, after the best "
        f"scale; {estimate.used_share:.0%} of the surface was used"
    )
    for name, share in facts["source_shares"].items():
        note(f"{name!r} gives about {share:.0%} of the light on the surface directly ({word})")
    for path in (options.out, options.figure, options.facts):
        if path is not None:
            print(path)
