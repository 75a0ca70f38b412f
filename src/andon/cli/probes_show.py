"""``andon probes show``: a picture of a probe volume."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from andon.cli.console import check_writable, note, printable
from andon.cli.points import point_of
from andon.errors import InputError, nearest_name

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from andon.display.probe_pictures import Look, Part
    from andon.files.volumes import ProbeVolume
    from andon.quantities import Geometry
    from andon.scene import Scene
    from andon.spaces import View

    Float = NDArray[np.float64]

__all__ = ["show"]

MOST_PX = 8192
_SIZE = re.compile(r"(\d{1,5})[x×](\d{1,5})")


@dataclass(frozen=True, eq=False)
class _Subject:
    """What is shown: the volume, and of a scene also what stands around and the state it sees."""

    volume: ProbeVolume
    geometry: Geometry | None = None
    state: str | None = None


def show(
    file: Annotated[Path, typer.Argument(help="Probe volume (.glb), or a scene (.toml).")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Picture, PNG.")] = Path("probes.png"),
    size: Annotated[str, typer.Option(help="Of the picture, pixels.")] = "1280x720",
    eye: Annotated[
        str | None, typer.Option("--from", metavar="X,Y,Z", help="Where from, metres.")
    ] = None,
    target: Annotated[
        str | None, typer.Option("--at", metavar="X,Y,Z", help="Where to, metres.")
    ] = None,
    what: Annotated[
        str, typer.Option(help="Of balls, cells, hull, graph and zones, with commas.")
    ] = "balls,cells,hull,zones",
    irradiance: Annotated[
        bool, typer.Option("--irradiance", help="Balls show irradiance/π, not luminance.")
    ] = False,
    state: Annotated[str | None, typer.Option(help="Of the volume; default: its first.")] = None,
    exposure: Annotated[
        float | None, typer.Option(help="Screen value per cd/m²; default: chosen and printed.")
    ] = None,
) -> None:
    """Draw a probe volume: balls with the probes' light, cells, hull, zones.

    Of a scene, the volume that it names is drawn amid its surfaces, without the walls that hide
    it; while there is none, the places where its probes will go.

    Examples:

        andon probes show basic.probes.glb --what balls,cells

        andon probes show basic.toml -o probes.png

        andon probes show basic.toml -o near.png --from 0,2,4 --at 0,1,0 --irradiance
    """
    check_writable(out, (".png",), "--out")
    shape = _size(size)
    parts = _parts(what)
    ends = point_of(eye, "--from"), point_of(target, "--at")
    if exposure is not None and not 0 < exposure < float("inf"):
        raise InputError(f"must be > 0, got {exposure:g}", field="--exposure")
    subject = _subject(file)
    _check_state(subject.volume, state, file)
    view = _view(subject, shape, *ends)
    from andon.display.probe_pictures import Look

    white = _draw(subject, view, out, Look(parts, irradiance, None, exposure), state, file.name)
    if white == white:
        note(f"white is {white:.4g} cd/m², that is --exposure {1 / white:.3g}")
    print(out)


def _size(text: str) -> tuple[int, int]:
    found = _SIZE.fullmatch(text)
    if found is None or not all(64 <= int(side) <= MOST_PX for side in found.groups()):
        raise InputError(
            f"must be width x height, 64…{MOST_PX} px each, got {text[:40]!r}",
            field="--size",
            remedy="for example --size 1280x720",
        )
    return int(found[1]), int(found[2])


def _parts(text: str) -> tuple[Part, ...]:
    from andon.display.probe_pictures import PARTS

    words = [word.strip() for word in text.split(",") if word.strip()]
    for word in words or [text]:
        if word not in PARTS:
            near = nearest_name(word, list(PARTS))
            raise InputError(
                f"must be of {', '.join(PARTS)}, got {word[:40]!r}",
                field="--what",
                remedy=f"did you mean {near!r}?" if near else None,
            )
    return tuple(part for part in PARTS if part in words)


def _subject(file: Path) -> _Subject:
    from andon.files.volumes import read_volume

    if file.suffix.lower() == ".glb":
        return _Subject(read_volume(file))
    if file.suffix.lower() != ".toml":
        raise InputError("must be a probe volume (.glb) or a scene (.toml)", file=file)
    from andon.bake.to_file import scene_geometry
    from andon.scene import load_scene

    scene = load_scene(file)
    if scene.probes is None:
        raise InputError("needs a [probes] table", file=file, remedy="add probes.volume")
    geometry = scene_geometry(scene)
    path = scene.path(scene.probes.volume, "probes.volume")
    if path.exists():
        return _Subject(read_volume(path), geometry, scene.probes.state)
    note(f"{path.name} is not baked yet: these are the places of its probes")
    return _Subject(_unlit(scene, geometry), geometry)


def _unlit(scene: Scene, geometry: Geometry) -> ProbeVolume:
    """The volume that a bake of the scene would fill."""
    from dataclasses import replace

    from andon.transport.probes.cells import build_cells
    from andon.transport.probes.placement import place_probes, unlit_volume

    placed = place_probes(scene, geometry)
    for warning in placed.warnings:
        note(printable(warning))
    volume = unlit_volume(scene, placed)
    return replace(volume, cells=build_cells(volume.positions, volume.zones))


def _check_state(volume: ProbeVolume, state: str | None, file: Path) -> None:
    if state is not None and state not in volume.states:
        known = ", ".join(volume.states)
        raise InputError(
            f"there is no state {state!r}",
            file=file,
            field="--state",
            remedy=f"it has {known}" if known else "it is not baked yet",
        )


def _view(
    subject: _Subject, size: tuple[int, int], eye: Float | None, target: Float | None
) -> View:
    from andon.display.probe_pictures import around_view, framed_points

    points = framed_points(subject.volume, subject.geometry)
    try:
        return around_view(points, size, eye=eye, target=target)
    except InputError as error:
        if error.field != "look_at":
            raise
        raise InputError("must lie apart", field="--from and --at") from error


def _draw(
    subject: _Subject, view: View, out: Path, look: Look, state: str | None, caption: str
) -> float:
    """Writes the picture; the luminance of its white, NaN without light."""
    from andon.display.probe_pictures import probe_picture
    from andon.files.pictures import write_png

    picture = probe_picture(
        subject.volume,
        view,
        look,
        geometry=subject.geometry,
        state=state or subject.state,
        caption=printable(caption),
    )
    write_png(out, picture.rgb)
    return picture.white_cd_m2
