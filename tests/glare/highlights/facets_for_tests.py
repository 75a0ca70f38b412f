"""Facets at the origin that face +z, and all directions above them."""

from dataclasses import replace

import numpy as np

from andon.glare.highlights.facets import Facets
from andon.glare.highlights.model import Finish
from andon.glare.highlights.reference import mirrored

__all__ = ["HEMISPHERE", "STEP_SR", "brute_force", "facet", "on_directions"]


def facet(view, finish, base=(1.0, 1.0, 1.0)):
    view = np.array([view], float) / np.linalg.norm(view)
    up = np.array([[0.0, 0, 1]])
    return Facets(finish, np.zeros((1, 3)), up, up, view, np.array([base], float), np.zeros(1))


def _hemisphere(rows=300):
    heights = (np.arange(rows) + 0.5) / rows
    turns = (np.arange(2 * rows) + 0.5) * (np.pi / rows)
    z, turn = np.meshgrid(heights, turns, indexing="ij")
    across = np.sqrt(1 - z * z)
    directions = np.stack([across * np.cos(turn), across * np.sin(turn), z], -1)
    return directions.reshape(-1, 3), np.pi / rows**2


# Equal solid angles of STEP_SR each.
HEMISPHERE, STEP_SR = _hemisphere()


def on_directions(one, directions):
    """The facet, once for each direction."""
    fields = {
        name: np.repeat(getattr(one, name), len(directions), axis=0)
        for name in ("position", "ground", "normal", "view", "base", "widening")
    }
    return replace(one, **fields)


def brute_force(one, shines=None):
    """Luminance of 1 cd/m² from all directions, or from those that `shines` picks."""
    directions = HEMISPHERE if shines is None else HEMISPHERE[shines(HEMISPHERE)]
    return mirrored(on_directions(one, directions), directions).sum(axis=0) * STEP_SR


def ggx(across, along=None, **keys):
    return Finish(alpha=(across, across if along is None else along), **keys)
