"""The commands and their options; bodies import what they need when they run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from andon.cli.bake_app import bake_app
from andon.cli.bracket import AlignOption, ListOption, PhotosArgument, SecondsOption
from andon.cli.calibrate_app import calibrate_app
from andon.cli.depth_app import depth_app
from andon.cli.glare_app import glare_app
from andon.cli.options import EngineOption, RelightOptions, takes
from andon.cli.probes import probes_app

__all__ = ["app"]

app = typer.Typer(
    name="andon",
    help="Light for mixed reality: relights a camera image with virtual lamps, in lux.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
)


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
@takes(RelightOptions)
def relight(**typed: Any) -> None:
    """Relight a photograph with virtual lamps, or draw a scene that has none.

    Without a pose in the camera file, the camera stands at the origin and looks along −Z, +Y is
    up: `position=0,0.5,-2` is two metres ahead and half a metre up.

    Paths in options, those in `--lamp` too, are relative to the current folder; those in a scene
    file to the scene's.

    Examples:

        andon relight room.png --depth depth.npy --camera cam.toml
            --lamp kind=point,position=0.5,0.3,-1.5,flux_lm=800,temperature_k=2700 -o lit.png

        andon relight room.png --scene night.toml -o lit.png --illuminance-map lux.exr

        andon relight --scene examples/basic/walk.toml --time 3 -o walk.png

        andon relight off.png --scene room.toml --fit-to on.png --fit-mask wall.png
            --fit-figure fit.png --fit-report fit.json -o lit.png
    """
    from andon.cli.relight import run

    run(RelightOptions(**typed))


@app.command()
def clip(
    scene: Annotated[Path, typer.Argument(help="Scene file (TOML).")],
    out: Annotated[
        Path,
        typer.Option("-o", "--out", help="WebP, PNG (APNG) or GIF; or a folder of PNGs."),
    ],
    start_seconds: Annotated[
        float | None, typer.Option("--from", help="Session time of the first frame; default: 0.")
    ] = None,
    end_seconds: Annotated[
        float | None,
        typer.Option("--to", help="Session time of the end; default: scene.duration_seconds."),
    ] = None,
    frames_per_second: Annotated[
        float | None, typer.Option("--fps", help="Default: scene.frames_per_second.")
    ] = None,
    view: Annotated[str | None, typer.Option(help="left or right of a stereo rig.")] = None,
    engine: EngineOption = "auto",
    scale: Annotated[
        float, typer.Option(help="Of the cameras' pixels, for previews; without a photograph.")
    ] = 1.0,
) -> None:
    """Draw a scene over time: lamps, objects and their animations move.

    The frame of the end is left out, so that a clip of a whole round loops without a stop. A scene
    without a duration is one frame.

    Examples:

        andon clip walk.toml -o walk.webp

        andon clip walk.toml --scale 0.25 --fps 10 -o preview.webp

        andon clip walk.toml --from 1 --to 3 --fps 25 -o frames/
    """
    from andon.cli.clip import ClipOptions, run

    times = start_seconds, end_seconds, frames_per_second
    run(ClipOptions(scene, out, *times, view, engine, scale))


@app.command()
def fuse(
    out: Annotated[
        Path,
        typer.Option("-o", "--out", help="PNG, JPEG: exposure fusion; EXR, HDR: relative light."),
    ],
    photos: PhotosArgument = None,
    seconds: SecondsOption = None,
    exposures: ListOption = None,
    align: AlignOption = "auto",
    sheet: Annotated[
        Path | None, typer.Option(help="Contact sheet of the photographs and the result.")
    ] = None,
    response: Annotated[
        Path | None,
        typer.Option(help="Recovered camera response (CSV), for capture.response.file."),
    ] = None,
) -> None:
    """Fuse photographs of several exposures: to a picture, or to light.

    Pictures need no exposure times. Light is relative: 1 is white in the photograph of the middle
    exposure. Borders of one pure colour, which registration leaves, are left out.

    Examples:

        andon fuse dark.jpg middle.jpg bright.jpg -o fused.png --sheet sheet.png

        andon fuse a.jpg b.jpg c.jpg --seconds 1/320,1/80,1/20 -o room.exr

        andon fuse --list image_list.txt -o church.hdr
    """
    from andon.cli.fuse import FuseOptions, run

    run(FuseOptions(tuple(photos or ()), out, seconds, exposures, align, sheet, response))


@app.command()
def glass(
    scene: Annotated[
        Path, typer.Argument(help="Scene file (TOML) with [[glass]]; or figure7, the paper's.")
    ],
    out: Annotated[
        Path,
        typer.Option(
            "-o", "--out", help="PNG, JPEG, EXR (cd/m²); WebP, GIF: over time. figure7: a folder."
        ),
    ],
    gaze: Annotated[
        str | None,
        typer.Option(
            metavar="surface|background|DEPTH_M|FILE.csv",
            help="What the eyes look at; default: as the scene says.",
        ),
    ] = None,
    eye: Annotated[
        str | None,
        typer.Option(metavar="left|right|both", help="Of a stereo rig; default: both."),
    ] = None,
    blur: Annotated[
        str | None,
        typer.Option(
            metavar="optical|gaussian|paper|off",
            help="Of what is not looked at: a disc, a Gaussian like it, the paper's, none.",
        ),
    ] = None,
    interfaces: Annotated[
        int | None,
        typer.Option(metavar="1|2", help="Refraction at entry only (the paper's), or all."),
    ] = None,
    layers: Annotated[
        Path | None,
        typer.Option(help="Folder: surface, refracted and mirrored image apart, and their blurs."),
    ] = None,
    time_seconds: Annotated[float, typer.Option("--time", help="Moment of the session, s.")] = 0.0,
    samples: Annotated[
        int | None, typer.Option(help="Of figure7: paths a pixel of real glass; default: 64.")
    ] = None,
    with_scene: Annotated[
        Path | None, typer.Option("--scene", help="Of figure7: another scene than the paper's.")
    ] = None,
    engine: EngineOption = "auto",
) -> None:
    """Draw glass as each eye sees it that looks at its surface, or through it.

    What sticks to the glass, what comes through it and what it mirrors appear at different
    distances; each is blurred by how far it is from where the eyes are focused. The notes say
    where.

    Examples:

        andon glass examples/glass/scene.toml -o surface.png --gaze surface

        andon glass examples/glass/scene.toml -o through.png --gaze background --eye left

        andon glass examples/glass/scene.toml -o paper.png --blur paper --interfaces 1

        andon glass examples/glass/looking.toml -o looking.webp --eye left

        andon glass figure7 -o figure7
    """
    if str(scene) == "figure7":
        from andon.cli.glass_figure import FigureOptions
        from andon.cli.glass_figure import run as run_figure

        run_figure(FigureOptions(out, with_scene, 64 if samples is None else samples, engine))
        return
    from andon.cli.glass import GlassOptions, refuse_of_figure, run

    refuse_of_figure(samples, with_scene)

    run(GlassOptions(scene, out, gaze, eye, blur, interfaces, time_seconds, layers, engine))


@app.command()
def demo(
    name: Annotated[
        str,
        typer.Argument(
            help="photo: a real photograph, relit; glass: a ball in it; glare: at night, "
            "as eyes of 20, 45 and 70 years see it."
        ),
    ] = "photo",
    out: Annotated[Path, typer.Option(help="Folder for the pictures.")] = Path("andon-demo"),
    engine: EngineOption = "auto",
) -> None:
    """Run a demonstration: a real photograph with real geometry, and lamps or glass put into it.

    Example: `andon demo photo --out pictures`
    """
    from andon.cli.demo import run

    run(name, out, engine)


@app.command()
def gaze(
    recording: Annotated[Path, typer.Argument(help="CSV: Pupil Labs Core's, or docs/gaze.md's.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder for pictures and tables.")],
    filter: Annotated[
        str | None, typer.Option(metavar="none|paper|one-euro", help="Default: the scene's.")
    ] = None,
    scene: Annotated[Path | None, typer.Option(help="Scene file whose [gaze] is used.")] = None,
    rate_hz: Annotated[
        float | None, typer.Option("--rate", help="Thin the recording to this rate first, Hz.")
    ] = None,
) -> None:
    """Say where a recording of two eyes looks, how still and how late each filter makes it.

    Writes depth and vergence over time (gaze.png), histogram.png, fixations.csv and report.json.

    Example: `andon gaze gaze_positions.csv -o gaze`
    """
    from andon.cli.gaze import GazeOptions, run

    run(GazeOptions(recording, out, filter, scene, rate_hz))


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

    Examples: `andon verify`, `andon verify glare`, `andon verify relight.point --json rows.json`
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


app.add_typer(bake_app, name="bake")
app.add_typer(calibrate_app, name="calibrate")
app.add_typer(depth_app, name="depth")
app.add_typer(probes_app, name="probes")
app.add_typer(glare_app, name="glare")
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
def lamp_presets(
    long: Annotated[bool, typer.Option("--long", help="Where the numbers come from, too.")] = False,
    json: Annotated[bool, typer.Option("--json", help="All of it, as JSON.")] = False,
) -> None:
    """List the lamps that have a name, for `preset = "…"` in a scene and in `--lamp`.

    Examples:

        andon lamp presets

        andon relight room.png … --lamp preset=candle,position=0,0.2,-1 -o lit.png
    """
    from andon.cli.lamp import presets

    presets(long=long, json=json)
