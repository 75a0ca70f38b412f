"""The commands and their options; bodies import what they need when they run."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

__all__ = ["app"]

app = typer.Typer(
    name="andon",
    help="Light for mixed reality: relights a camera image with virtual lamps, in lux.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
)


class DepthKind(StrEnum):
    """What the numbers of a depth file are."""

    z = "z"
    distance = "distance"
    disparity = "disparity"


ENGINES = ("auto", "gpu", "reference")


def _engine(name: str) -> str:
    from andon.errors import InputError

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


@app.callback(invoke_without_command=True)
def _root(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
) -> None:
    """Andon: light for mixed reality. `--debug` anywhere shows tracebacks."""
    if version:
        from andon import __version__

        print(f"andon {__version__}")
        raise typer.Exit
    if context.invoked_subcommand is None:
        print(context.get_help())


@app.command()
def relight(
    photo: Annotated[Path, typer.Argument(help="PNG, JPEG, EXR or Radiance HDR.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="PNG or JPEG; EXR: cd/m².")],
    depth: Annotated[
        Path | None, typer.Option(help="Depth or disparity: NPY, NPZ, PFM, PNG, PGM, EXR.")
    ] = None,
    camera: Annotated[
        Path | None, typer.Option(help="Camera: TOML of Andon, or OpenCV YAML.")
    ] = None,
    mesh: Annotated[
        Path | None, typer.Option(help="Geometry as OBJ, PLY, glTF instead of a depth.")
    ] = None,
    scene: Annotated[Path | None, typer.Option(help="Scene file (TOML); options win.")] = None,
    lamp: Annotated[
        list[str] | None,
        typer.Option(help="preset=bulb,position=0.5,0.3,-1.5 or kind=point,…,flux_lm=800"),
    ] = None,
    ambient_lux: Annotated[
        float | None, typer.Option(help="E0: illuminance that the photograph was taken in.")
    ] = None,
    dimming: Annotated[float | None, typer.Option(help="Share of E0 that is left, ≥ 0.")] = None,
    depth_kind: Annotated[DepthKind | None, typer.Option(help="Default: z.")] = None,
    depth_scale_to_m: Annotated[
        float | None, typer.Option(help="Metres per unit: 0.001 for millimetres.")
    ] = None,
    baseline_m: Annotated[float | None, typer.Option(help="Stereo baseline of disparity.")] = None,
    doffs_px: Annotated[float | None, typer.Option(help="Offset added to disparity.")] = None,
    obj: Annotated[
        list[Path] | None, typer.Option("--object", help="Virtual object (glTF, OBJ, PLY).")
    ] = None,
    illuminance_map: Annotated[
        list[Path] | None, typer.Option(help="EXR: lux; PNG: false colours. May be repeated.")
    ] = None,
    view: Annotated[str | None, typer.Option(help="left or right of a stereo rig.")] = None,
    time: Annotated[float, typer.Option(help="Moment of the session, seconds.")] = 0.0,
    engine: EngineOption = "auto",
) -> None:
    """Relight a photograph with virtual lamps.

    Without a pose in the camera file, the camera stands at the origin and looks along −Z, +Y is
    up: `position=0,0.5,-2` is two metres ahead and half a metre up.

    Paths in options, those in `--lamp` too, are relative to the current folder; those in a scene
    file to the scene's.

    Examples:

        andon relight room.png --depth depth.npy --camera cam.toml
            --lamp kind=point,position=0.5,0.3,-1.5,flux_lm=800,temperature_k=2700 -o lit.png

        andon relight room.png --scene night.toml -o lit.png --illuminance-map lux.exr
    """
    from andon.cli.relight import run
    from andon.cli.typed import RelightOptions

    run(
        RelightOptions(
            photo=photo,
            out=out,
            depth=depth,
            camera=camera,
            mesh=mesh,
            scene=scene,
            lamps=tuple(lamp or ()),
            ambient_lux=ambient_lux,
            dimming=dimming,
            depth_kind=depth_kind.value if depth_kind else None,
            depth_scale_to_m=depth_scale_to_m,
            baseline_m=baseline_m,
            doffs_px=doffs_px,
            objects=tuple(obj or ()),
            illuminance_maps=tuple(illuminance_map or ()),
            view=view,
            time_seconds=time,
            engine=engine,
        )
    )


@app.command()
def demo(
    name: Annotated[str, typer.Argument(help="photo: a real photograph, relit.")] = "photo",
    out: Annotated[Path, typer.Option(help="Folder for the pictures.")] = Path("andon-demo"),
    engine: EngineOption = "auto",
) -> None:
    """Run the demonstration: a real photograph with real geometry, two lamps put into it.

    Example: `andon demo photo --out pictures`
    """
    from andon.cli.demo import run

    run(name, out, engine)


@app.command()
def doctor() -> None:
    """Say what this machine has, what is missing, and what would install it."""
    from andon.cli.doctor import run

    run()


@app.command()
def verify(
    names: Annotated[list[str] | None, typer.Argument(help="Rows, or beginnings of them.")] = None,
    json: Annotated[Path | None, typer.Option(help="Write the rows as JSON.")] = None,
) -> None:
    """Measure the accuracy of this installation against closed forms and other programs.

    Examples: `andon verify`, `andon verify relight.point --json rows.json`
    """
    from andon.verify.run import run

    raise typer.Exit(run(tuple(names or ()), json))


@app.command()
def bench(
    names: Annotated[list[str] | None, typer.Argument(help="Rows, or beginnings of them.")] = None,
    quick: Annotated[bool, typer.Option(help="Fewer repetitions.")] = False,
    json: Annotated[Path | None, typer.Option(help="Write the rows as JSON.")] = None,
    plot: Annotated[
        Path | None,
        typer.Option(help="Instead: error against cost of area lamps' shadows, as PNG."),
    ] = None,
) -> None:
    """Measure speed beside peers in one run, after asserting that both give the same answer.

    Examples: `andon bench`, `andon bench relight.frame --quick`, `andon bench --plot soft.png`
    """
    from andon.bench.run import run

    raise typer.Exit(run(tuple(names or ()), quick, json, plot))


lamp_app = typer.Typer()
app.add_typer(lamp_app, name="lamp")


@lamp_app.callback(invoke_without_command=True)
def _lamp(context: typer.Context) -> None:
    """Lamps: what files of luminaires say, and lamps that have a name."""
    if context.invoked_subcommand is None:
        print(context.get_help())


@lamp_app.command("show")
def lamp_show(
    file: Annotated[Path, typer.Argument(help="IES LM-63 (.ies) or EULUMDAT (.ldt).")],
    out: Annotated[Path | None, typer.Option("-o", "--out", help="Polar diagram, PNG.")] = None,
) -> None:
    """Say what a luminaire's photometric file holds, and draw its polar diagram.

    Examples:

        andon lamp show street.ies

        andon lamp show office.ldt -o office.png
    """
    from andon.cli.lamp import show

    show(file, out)


@lamp_app.command("presets")
def lamp_presets() -> None:
    """List the lamps that have a name, for `preset = "…"` in a scene and in `--lamp`.

    Examples:

        andon lamp presets

        andon relight room.png … --lamp preset=candle,position=0,0.2,-1 -o lit.png
    """
    from andon.cli.lamp import presets

    presets()
