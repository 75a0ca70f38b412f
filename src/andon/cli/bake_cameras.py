"""``andon bake cameras``: where the illuminance maps of a scene are seen from."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from andon.cli.console import check_writable, note

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from andon.scene import Scene
    from andon.spaces import View
    from andon.transport.baked.placement import Suggested

__all__ = ["camera_tables", "cameras"]


def cameras(
    scene: Annotated[Path, typer.Argument(help="Scene file (TOML) with a [baked] table.")],
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Plan of the cameras, PNG.")
    ] = None,
    toml: Annotated[
        bool, typer.Option("--toml", help="Print [[baked.camera]] tables to paste.")
    ] = False,
) -> None:
    """Say from where the illuminance maps of a scene are seen, and what that covers.

    Examples:

        andon bake cameras scene.toml

        andon bake cameras scene.toml -o plan.png

        andon bake cameras scene.toml --toml >> scene.toml
    """
    from andon.bake.maps import searched_cameras
    from andon.scene import load_scene

    if out is not None:
        check_writable(out, (".png",), "--out")
    loaded = load_scene(scene)
    geometry, suggested = searched_cameras(loaded)
    if loaded.baked is not None and loaded.baked.camera:
        note("the scene states [[baked.camera]]: these are those that would be found without")
    if toml:
        print(_tables(suggested))
    else:
        _print(suggested)
    _note_shortfall(suggested, loaded)
    if out is not None:
        from andon.files.pictures import write_png
        from andon.transport.baked.placement import plan_picture

        write_png(out, plan_picture(geometry, suggested))
        note(f"{out} is written")


def _print(suggested: Suggested) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table(box=None, pad_edge=False)
    for heading in ("camera", "position in m", "looks", "map", "adds in m²", "coverage so far"):
        table.add_column(heading)
    rows = zip(suggested.views, suggested.adds_m2, suggested.coverage_so_far, strict=True)
    for number, (view, area, so_far) in enumerate(rows):
        frame = " (frame)" if number < suggested.frame_count else ""
        table.add_row(
            f"{number + 1}{frame}",
            _numbers(view.position),
            "all around" if view.projection == "latlong" else "at " + _numbers(_looks_at(view)),
            f"{view.width}×{view.height}",
            f"{area:.3g}",
            f"{so_far:.1%}",
        )
    Console(highlight=False, markup=False).print(table)


def _note_shortfall(suggested: Suggested, scene: Scene) -> None:
    """Why there are no more cameras, where the stated coverage is not reached."""
    assert scene.baked is not None
    if suggested.ended == "reached":
        return
    if suggested.ended == "most cameras":
        reason = f"baked.most_cameras is {scene.baked.most_cameras}; allow more"
    else:
        reason = "no further camera adds a thousandth; what is left lies in gaps"
    stated = f"{scene.baked.coverage:.1%} of baked.coverage"
    note(f"{suggested.coverage:.1%} are seen, not the {stated}: {reason}")


def _looks_at(view: View) -> NDArray[np.float64]:
    """(3,) a metre ahead."""
    return view.position + view.world_from_camera[:3, 2]


def _numbers(values: Any) -> str:
    return " ".join(f"{value:.2f}" for value in values + 0.0)


def _tables(suggested: Suggested) -> str:
    from andon.scene.dump import toml_text

    head = (
        f"# {len(suggested.views)} cameras that see {suggested.coverage:.1%} of "
        f"{suggested.reachable_area_m2:.4g} m².\n"
    )
    return head + toml_text({"baked": {"camera": camera_tables(suggested.views)}})


def camera_tables(views: tuple[View, ...], /) -> list[dict[str, Any]]:
    """[[baked.camera]] of each view, in the terms of the scene file; the same views read back."""
    return [_table(view) for view in views]


def _table(view: View) -> dict[str, Any]:
    from andon.spaces import look_at

    size: dict[str, Any] = {
        "projection": view.projection,
        "width": view.width,
        "height": view.height,
    }
    if view.projection == "latlong":
        ahead = _looks_at(view).round(9)
        if (look_at(view.position, ahead) == view.world_from_camera).all():
            return {**size, "position": view.position.tolist(), "look_at": ahead.tolist()}
    else:
        size |= {key: float(getattr(view, key)) for key in ("fx", "fy", "cx", "cy")}
    return {**size, "world_from_camera": (view.world_from_camera + 0.0).tolist()}
