"""Remakes figures 3, 4 and 5 of the paper on the tatami room, and the andon's picture.

python examples/tatami/figures.py -o OUT

Figure 4 takes the maps in figure4-maps, and bakes them if there are none: some minutes, or a good
half with ``--quality draft``. A bake that was stopped goes on.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import andon
from andon.bake.maps import bake_maps
from andon.cli.bar import Bar
from andon.display.false_colour import GAP_PX, contact_sheet, false_colour, top_of
from andon.display.reference import tone_curve
from andon.engines.prepared import Prepared, prepare
from andon.files.illuminance_maps import MANIFEST, IlluminanceMap, read_manifest, read_moment
from andon.files.pictures import write_png
from andon.responses import srgb_encode
from andon.surface import reference as surface

HERE = Path(__file__).resolve().parent
Rgb = NDArray[np.uint8]

# The andon alone, and with a lamp: one bake is for both.
FIGURE_4 = ("figure4.toml", "figure4-lamp.toml")
# Luminance that is white in the simulated pictures: white paper in 150 lx.
SIMULATED_WHITE_CD_M2 = 50.0
# Pixels of figure 4 for each of a map, along a row: its texels are to be seen.
TEXEL_PX = 2


def drawn(name: str, engine: str) -> andon.Frame:
    """The frame of a scene file beside this one."""
    return andon.render(andon.load_scene(HERE / name), engine=engine)  # type: ignore[arg-type]


def figure3(frame: andon.Frame) -> Rgb:
    """Input, illuminance map, relit."""
    lux = andon.photometric(frame.illuminance.lux)
    added = false_colour(lux, "lx", valid=frame.surface.valid)
    tiles = [
        ("(a) input", shown(frame, frame.captured.linear * frame.captured.luminance_per_unit)),
        ("(b) illuminance that the ball adds", added),
        ("(c) relit", frame.image.rgb),
    ]
    return contact_sheet(tiles)


def figure5(frame: andon.Frame) -> Rgb:
    """The body alone, filtered, composed."""
    tiles = [
        ("(a) the luminous body", shown(frame, _light(frame, "bodies"))),
        ("(b) filtered", shown(frame, _light(frame, "glow"))),
        ("(c) relit with its glow", frame.image.rgb),
    ]
    return contact_sheet(tiles)


def figure4(engine: str) -> Rgb:
    """What Radiance computed from two places, its illuminance maps, and the room relit by them."""
    scene = andon.load_scene(HERE / FIGURE_4[0])
    assert scene.baked is not None
    folder = scene.path(scene.baked.folder, "baked.folder")
    maps = read_moment(folder, read_manifest(folder), 0)
    prepared = prepare(scene)
    lux = [_of_all_lamps(seen) for seen in maps]
    top = top_of(np.concatenate([andon.photometric(light).ravel() for light in lux]))
    pictures = [_enlarged(simulated(prepared, seen)) for seen in maps]
    coloured = [
        false_colour(
            _enlarged(andon.photometric(light)),
            "lx",
            valid=_enlarged(np.isfinite(seen.depth_m)),
            top=top,
        )
        for seen, light in zip(maps, lux, strict=True)
    ]
    relit = [drawn(name, engine).image.rgb for name in FIGURE_4]
    white = f"white is {SIMULATED_WHITE_CD_M2:g} cd per square metre"
    captions = (
        f"(a) simulated, first camera; {white}",
        f"(b) simulated, second camera; {white}",
        "(c) illuminance map of the first camera",
        "(d) illuminance map of the second camera",
        "(e) relit by the andon",
        "(f) relit by the andon and a point lamp",
    )
    tiles = list(zip(captions, (*pictures, *coloured, *relit), strict=True))
    return contact_sheet(tiles, columns=2, gap_px=GAP_PX)


def reflections(engine: str) -> Rgb:
    """The andon's direct light alone, and all that the room makes of it."""
    scene = andon.load_scene(HERE / FIGURE_4[0])
    direct = tuple(lamp.model_copy(update={"transport": "direct"}) for lamp in scene.lamp)
    alone = scene.model_copy(update={"lamp": direct, "baked": None})
    tiles = [
        ("direct light alone", _shrunk(andon.render(alone, engine=engine).image.rgb)),  # type: ignore[arg-type]
        ("baked: what the room reflects as well", _shrunk(drawn(FIGURE_4[0], engine).image.rgb)),
    ]
    return contact_sheet(tiles, columns=2, gap_px=GAP_PX)


def simulated(prepared: Prepared, seen: IlluminanceMap) -> Rgb:
    """What a map's camera sees in its light alone: ρ·E/π, and paper that is luminous itself."""
    there = surface.with_bodies(surface.see(prepared.surface, seen.view), prepared.bodies(0.0))
    reflected = there.reflectance * _of_all_lamps(seen) / np.pi
    # Maps hold the light of what is behind a luminous body.
    own = np.zeros(there.valid.shape, bool) if there.body_id is None else there.body_id >= 0
    luminance = np.where(own[..., None], there.emitted_cd_m2, reflected)
    return encoded(tone_curve(luminance / SIMULATED_WHITE_CD_M2, "hue"))


def bake(scene: andon.Scene, quality: str | None) -> None:
    """Makes the maps of a scene if there are none, or if a quality is asked for."""
    assert scene.baked is not None
    if quality is not None:
        baked = scene.baked.model_copy(update={"quality": quality})
        scene = scene.model_copy(update={"baked": baked})
    elif (scene.path(scene.baked.folder, "baked.folder") / MANIFEST).exists():
        return
    with Bar("baking figure 4") as bar:
        bake_maps(scene, progress=bar.show)


def _of_all_lamps(seen: IlluminanceMap) -> NDArray[Any]:
    """(h, w, 3) lx."""
    return np.sum(list(seen.lux.values()), axis=0)


def _shrunk(picture: Rgb) -> Rgb:
    """Half as wide and high."""
    pixels = picture.reshape(picture.shape[0] // 2, 2, picture.shape[1] // 2, 2, 3)
    return np.asarray(np.round(np.mean(pixels, axis=(1, 3))), np.uint8)


def _enlarged(values: NDArray[Any]) -> NDArray[Any]:
    """(h, w, …) with each texel `TEXEL_PX` × `TEXEL_PX` times."""
    return values.repeat(TEXEL_PX, axis=0).repeat(TEXEL_PX, axis=1)


def _light(frame: andon.Frame, name: str) -> NDArray[Any]:
    """Luminance (H, W, 3) of one layer of the frame, in cd/m²."""
    layer = getattr(frame, name)
    if layer is None:
        raise SystemExit(f"the frame has no {name}")
    return layer.cd_m2


def shown(frame: andon.Frame, luminance: NDArray[Any]) -> Rgb:
    """Luminance in cd/m² at the exposure of the photograph."""
    return encoded(luminance / frame.captured.luminance_per_unit)


def encoded(linear: NDArray[Any]) -> Rgb:
    """Linear light of which 1 is white, as sRGB."""
    return np.round(srgb_encode(np.clip(linear, 0, 1)) * 255).astype(np.uint8)


def main() -> None:
    """Writes figure3.png, figure4.png, reflections.png, figure5.png and andon.png."""
    parser = argparse.ArgumentParser(description="Remakes the figures.")
    parser.add_argument("-o", "--out", type=Path, required=True, help="folder to write to")
    parser.add_argument("--engine", default="auto", help="auto, gpu or reference")
    parser.add_argument("--quality", help="bake figure 4 with this: draft, normal or fine")
    arguments = parser.parse_args()
    engine: str = arguments.engine
    arguments.out.mkdir(parents=True, exist_ok=True)
    bake(andon.load_scene(HERE / FIGURE_4[0]), arguments.quality)
    makers: dict[str, Callable[[], Rgb]] = {
        "figure3.png": lambda: figure3(drawn("figure3.toml", engine)),
        "figure4.png": lambda: figure4(engine),
        "reflections.png": lambda: reflections(engine),
        "figure5.png": lambda: figure5(drawn("figure5.toml", engine)),
        "andon.png": lambda: drawn("andon.toml", engine).image.rgb,
    }
    for name, make in makers.items():
        print(write_png(arguments.out / name, make()))


if __name__ == "__main__":
    main()
