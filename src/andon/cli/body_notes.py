"""What is worth saying of luminous bodies as the camera sees them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.engines.real_shells import RealShells
from andon.lamps import Body, Lamp
from andon.lamps.shells.beams import solid_angles
from andon.quantities import Surface
from andon.rays import RayScene, face_normals

__all__ = ["notes_on_bodies", "notes_on_shells"]

# A sheet takes at most half of all directions; what takes more is around the camera, a lantern
# that is open above and below included.
SURROUNDING_SR = 2.2 * np.pi
# Share of the picture from which an unlit back is worth a word.
LARGE_BACK = 0.01


def notes_on_bodies(surface: Surface, bodies: Sequence[Body], lamps: Sequence[Lamp]) -> list[str]:
    """One line for each body around the camera, and for each large back without light."""
    around = [body for body in bodies if _surrounds(body, surface.view.position)]
    own = {lamp.name for lamp in lamps if getattr(lamp, "drawn", False)}  # lamps in shells are not
    notes = [
        f"the camera is inside the {'body' if body.name in own else 'shell'} of {body.name!r}: "
        "move it"
        for body in around
    ]
    two_sided = {lamp.name for lamp in lamps if hasattr(lamp, "two_sided")}
    for number, body in enumerate(bodies):
        if surface.body_id is None or body in around or body.inside_cd_m2.any():
            continue
        share = _share_of_backs(surface, surface.body_id == number, body)
        if share >= LARGE_BACK:
            remedy = ", two_sided = true lights it" if body.name in two_sided else ""
            notes.append(
                f"the unlit back of {body.name!r} covers {share:.0%} of the picture: "
                f"drawn = false hides it{remedy}"
            )
    return notes


# A shell of which less is found than this is not where the geometry has it.
NOTABLE_FOUND = 0.5


def notes_on_shells(shells: RealShells | None, view_name: str, bodies: Sequence[Body]) -> list[str]:
    """One line for each real shell that is seen, but not found in the geometry."""
    if shells is None:
        return []
    return [
        f"of the shell of {bodies[number].name!r} {share:.0%} are where the geometry has a surface "
        f"within {shells.margins_m[bodies[number].name]:.2g} m, or a hole: check the lamp's "
        "position and the shell's form, or state shell.margin_m"
        for number, share in shells.views[view_name].seen_share.items()
        if share is not None and share < NOTABLE_FOUND
    ]


def _surrounds(body: Body, eye: NDArray[np.float64]) -> bool:
    corners = body.geometry.positions[body.geometry.triangles] - eye
    return abs(float(solid_angles(corners).sum())) > SURROUNDING_SR


def _share_of_backs(surface: Surface, mask: NDArray[np.bool_], body: Body) -> float:
    """Of the picture's pixels: those that show the side on which triangles run clockwise."""
    if mask.mean() < LARGE_BACK:
        return 0.0
    origin, directions = surface.view.rays_world()
    rays: Any = directions[mask]
    hits = RayScene(body.geometry).first_hits(np.broadcast_to(origin, rays.shape), rays)
    met = hits.triangle >= 0
    normals = face_normals(body.geometry)[hits.triangle[met]]
    backs = np.einsum("ij,ij->i", normals, rays[met]) > 0
    return float(np.count_nonzero(backs) / mask.size)
