"""``andon bake show``: baked illuminance maps as one picture."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from andon.cli.bake import maps_folder
from andon.cli.console import check_writable, note, printable
from andon.errors import InputError, nearest_name

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from andon.files.illuminance_maps import Manifest

    Float = NDArray[np.float32]
    Bool = NDArray[np.bool_]
    Rgb = NDArray[np.uint8]

__all__ = ["show"]

# Smaller maps are enlarged to this width, pixel by pixel, so that captions and scales fit.
LEAST_WIDTH_PX = 320


@dataclass(frozen=True, eq=False)
class _Tile:
    """One camera's map: caption, illuminance (h, w) in lx, and where there is a surface."""

    caption: str
    lux: Float
    valid: Bool
    normal: Float
    depth_m: Float


def show(
    source: Annotated[
        Path,
        typer.Argument(metavar="SCENE|FOLDER", help="Scene file (TOML), or a folder of maps."),
    ],
    out: Annotated[Path, typer.Option("-o", "--out", help="Picture, PNG.")] = Path("maps.png"),
    lamp: Annotated[
        str | None, typer.Option(metavar="NAME", help="Light of this lamp; default: of all.")
    ] = None,
    time: Annotated[
        float | None, typer.Option(metavar="S", help="Seconds; default: the first moment.")
    ] = None,
    geometry: Annotated[
        bool, typer.Option("--geometry", help="Depth and normals of each camera beside it.")
    ] = False,
) -> None:
    """Show baked illuminance maps: what each camera sees, in lx, all on one scale.

    Grey is where a camera sees no surface. Where no map sees what a frame shows, `andon relight
    --uncovered` tells.

    Examples:

        andon bake show room.toml -o maps.png

        andon bake show room.maps --lamp lantern --time 0.5 --geometry
    """
    check_writable(out, (".png",), "--out")
    from andon.files.illuminance_maps import read_manifest
    from andon.files.pictures import write_png

    folder = maps_folder(source)
    manifest = read_manifest(folder)
    names = _lamps(manifest, lamp, folder)
    moment = _moment(manifest, time)
    tiles = [_tile(folder, manifest, names, at, moment) for at in range(len(manifest.cameras))]
    write_png(out, _sheet(tiles, manifest.photometry, geometry))
    _say(manifest, names, moment)
    print(out)


def _lamps(manifest: Manifest, lamp: str | None, folder: Path) -> tuple[str, ...]:
    names = [each.name for each in manifest.lamps]
    if lamp is None:
        return tuple(names)
    if lamp not in names:
        near = nearest_name(lamp, names)
        remedy = f"did you mean {near!r}?" if near else f"there are {', '.join(names)}"
        raise InputError(
            f"the maps have no lamp {lamp[:80]!r}", file=folder, field="--lamp", remedy=remedy
        )
    return (lamp,)


def _moment(manifest: Manifest, time: float | None) -> int:
    """The number of the moment that is nearest to a time; without one, the first."""
    if time is None:
        return 0
    if not abs(time) < float("inf"):
        raise InputError(f"must be a finite number of seconds, got {time:g}", field="--time")
    return min(range(len(manifest.moments)), key=lambda at: abs(manifest.moments[at] - time))


def _tile(
    folder: Path, manifest: Manifest, lamps: tuple[str, ...], camera: int, moment: int
) -> _Tile:
    import numpy as np

    from andon.files.illuminance_maps import read_geometry, read_lux
    from andon.quantities import photometric

    depth_m, normal = read_geometry(folder, manifest, camera, moment)
    lux = np.zeros(depth_m.shape, np.float32)
    for name in lamps:
        lux += photometric(read_lux(folder, manifest, name, camera, moment))
    valid = np.isfinite(depth_m)
    mean = float(lux[valid].mean()) if valid.any() else 0.0
    name = printable(manifest.cameras[camera].name)
    caption = f"{camera}: {name}, mean {float(f'{mean:.3g}'):g} lx"
    return _Tile(caption, lux, valid, normal, depth_m)


def _sheet(tiles: list[_Tile], photometry: str, geometry: bool) -> Rgb:
    import numpy as np

    from andon.display.false_colour import (
        GAP_PX,
        contact_sheet,
        depth_picture,
        false_colour,
        normal_picture,
        top_of,
    )

    top = top_of(np.concatenate([tile.lux[tile.valid] for tile in tiles]))
    unit = "lx" if photometry == "absolute" else "lx, relative"
    shown: list[tuple[str, Rgb]] = []
    for tile in tiles:
        valid = _enlarged(tile.valid)
        shown.append((tile.caption, false_colour(_enlarged(tile.lux), unit, valid=valid, top=top)))
        if geometry:
            near, far = _range(tile)
            shown.append(
                (f"depth, {near:.3g}…{far:.3g} m", depth_picture(_enlarged(tile.depth_m), valid))
            )
            shown.append(("normals", normal_picture(_enlarged(tile.normal), valid)))
    columns = 3 if geometry else min(3, len(shown))
    return contact_sheet(shown, columns=columns, gap_px=GAP_PX)


def _range(tile: _Tile) -> tuple[float, float]:
    depth = tile.depth_m[tile.valid]
    return (float(depth.min()), float(depth.max())) if depth.size else (0.0, 0.0)


def _enlarged(values: NDArray[Any]) -> NDArray[Any]:
    """(H, W, …) with each pixel k × k times."""
    times = -(-LEAST_WIDTH_PX // values.shape[1])
    return values.repeat(times, axis=0).repeat(times, axis=1)


def _say(manifest: Manifest, lamps: tuple[str, ...], moment: int) -> None:
    parts = {lamp.name: lamp.part for lamp in manifest.lamps}
    words = {"all": "all light", "bounce": "reflected light"}
    listed = ", ".join(f"{printable(name)} ({words[parts[name]]})" for name in lamps)
    seconds = manifest.moments[moment]
    note(f"{listed}; {manifest.quality}, {manifest.bounces} bounces; at {seconds:g} s")
