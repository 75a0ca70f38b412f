"""``andon demo``: a real photograph with real geometry, relit."""

from __future__ import annotations

from dataclasses import replace
from importlib import resources
from pathlib import Path
from time import perf_counter

import numpy as np

from andon.cli.console import print_report, steps
from andon.errors import InputError, MachineError, nearest_name

__all__ = ["run"]

DEMONSTRATIONS = ("photo", "glass", "glare")
# What the second relit picture keeps of the photograph's own light.
DIMMING = 0.15
# Whose eyes the demonstration of glare has; the last are the scene's.
AGES = (20.0, 45.0, 70.0)


def run(name: str, out: Path, engine: str) -> None:
    """Writes pictures into `out`.

    photo: contact-sheet.png, relit.png, relit-dimmed.png and illuminance.exr; glass: glass.png;
    glare: glare.png, and beside younger eyes and none glare-ages.png.
    """
    if name not in DEMONSTRATIONS:
        near = nearest_name(name, list(DEMONSTRATIONS))
        raise InputError(
            f"there is no demonstration {name!r}, there is {', '.join(DEMONSTRATIONS)}",
            field="demo",
            remedy=f"did you mean {near!r}?" if near else None,
        )
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise MachineError(f"{out}: cannot be made: {error.strerror}") from error
    with resources.as_file(resources.files("andon") / "data" / "motorcycle") as folder:
        {"photo": _photo, "glass": _glass, "glare": _glare}[name](folder, out, engine)


def _glass(folder: Path, out: Path, engine: str) -> None:
    from andon.cli.glass import GlassOptions
    from andon.cli.glass import run as draw

    draw(GlassOptions(folder / "glass.toml", out / "glass.png", engine=engine))


def _glare(folder: Path, out: Path, engine: str) -> None:
    from andon.display.false_colour import GAP_PX, contact_sheet
    from andon.engines.glare import glare_of
    from andon.engines.prepared import prepare
    from andon.files.pictures import write_picture
    from andon.pipeline import Frame, Renderer
    from andon.scene import Scene, load_scene

    start = perf_counter()
    scene = load_scene(folder / "glare.toml")
    prepared = prepare(scene)

    def seen(scene: Scene | None) -> Frame:
        dimming = np.asarray(prepared.ambient.dimming)
        glare = None if scene is None else glare_of(scene, prepared.frames, dimming)
        return Renderer(replace(prepared, glare=glare), engine).render()  # type: ignore[arg-type]

    with steps("drawing", 1 + len(AGES)) as step:
        tiles = [("without glare", seen(None).image.rgb)]
        for age in AGES:
            step()
            observer = scene.observer.model_copy(update={"age": age})
            frame = seen(scene.model_copy(update={"observer": observer}))
            tiles.append((f"{age:.0f} years", frame.image.rgb))
    write_picture(out / "glare.png", tiles[-1][1])
    write_picture(out / "glare-ages.png", contact_sheet(tiles, columns=2, gap_px=GAP_PX))
    print(f"{perf_counter() - start:.1f} s in all; look at {out / 'glare-ages.png'}")


def _photo(folder: Path, out: Path, engine: str) -> None:
    from andon.composite.model import Ambient
    from andon.display.false_colour import (
        contact_sheet,
        depth_picture,
        false_colour,
        normal_picture,
    )
    from andon.files.pictures import read_picture, write_exr, write_picture
    from andon.pipeline import Renderer
    from andon.quantities import photometric
    from andon.scene import load_scene

    start = perf_counter()
    renderer = Renderer(load_scene(folder / "scene.toml"), engine)  # type: ignore[arg-type]
    frame = renderer.render()
    ambient: Ambient = replace(renderer.prepared.ambient, dimming=(DIMMING,) * 3)
    dimmed = Renderer(replace(renderer.prepared, ambient=ambient), engine).render()  # type: ignore[arg-type]
    surface, lux = frame.surface, np.asarray(frame.illuminance.lux, np.float32)
    tiles = [
        ("photograph", read_picture(folder / "photo.png").values),
        ("depth", depth_picture(surface.depth, surface.valid)),
        ("normals", normal_picture(surface.normal, surface.valid)),
        ("added illuminance", false_colour(photometric(lux), "lx, relative", valid=surface.valid)),
        ("relit", frame.image.rgb),
        (f"relit, {DIMMING:.0%} of the photograph's light left", dimmed.image.rgb),
    ]
    write_picture(out / "relit.png", frame.image.rgb)
    write_picture(out / "relit-dimmed.png", dimmed.image.rgb)
    word = frame.illuminance.photometry
    write_exr(out / "illuminance.exr", lux, unit="lx", photometry=word)
    write_picture(out / "contact-sheet.png", contact_sheet(tiles))
    print_report(frame.report, renderer.setup_seconds, surface.valid.size)
    print(f"{perf_counter() - start:.1f} s in all; look at {out / 'contact-sheet.png'}")
