"""The demonstration of glare, drawn by either engine with and without it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from importlib import resources

from andon.engines.prepared import Prepared, prepare
from andon.pipeline import EngineName, Frame, Renderer
from andon.scene import load_scene

__all__ = ["demonstration", "frame_of", "renderer_of"]


@cache
def demonstration() -> Prepared:
    """The photographed garage by night."""
    with resources.as_file(resources.files("andon") / "data" / "motorcycle") as folder:
        return prepare(load_scene(folder / "glare.toml"))


def renderer_of(engine: EngineName, *, glare: bool = True) -> Renderer:
    """Draws it; without `glare` as sharp as it is."""
    prepared = demonstration()
    return Renderer(prepared if glare else replace(prepared, glare=None), engine)


@cache
def frame_of(engine: EngineName) -> Frame:
    """What an eye of 70 years sees of it."""
    return renderer_of(engine).render()
