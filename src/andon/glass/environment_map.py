"""Glass without the method, to compare with: an environment map and Fresnel's share.

What ordinary real-time renderers do: the view ray is bent once, where it enters, and its
*direction* alone says what is seen, in a picture of the surroundings as from the body's centre. So
what is behind the glass is seen as if it lay infinitely far away: neither its size nor its
disparity between the eyes is that of the real thing, and a picture on a display has no depth to
blur.
"""

from __future__ import annotations

from dataclasses import replace

from andon.glass.model import Backdrop, GlassModel, Solid

__all__ = ["environment_mapped"]

# A backdrop that is this much larger around the body's centre looks the same from there, and all
# places within the body are as good as its centre. In float32 nothing overflows.
FAR = 1e6


def environment_mapped(model: GlassModel, /) -> GlassModel:
    """`model` as an environment map shows it: one interface, everything sharp and far away.

    A picture on a plane is seen as from each body's centre; the frame and the scene's geometry
    become the frame on a sphere around the eye without end. The label stays where it is.
    """
    solids = tuple(
        replace(solid, interfaces=1, backdrop=_from_afar(solid)) for solid in model.solids
    )
    return replace(model, solids=solids, blur="off", defocus_frame=False)


def _from_afar(solid: Solid) -> Backdrop:
    backdrop, centre = solid.backdrop, solid.world_from_glass[:3, 3]
    if backdrop.kind != "texture":
        return Backdrop("frame", distance_m=FAR)
    return replace(
        backdrop,
        centre_m=centre + FAR * (backdrop.centre_m - centre),
        right_m=FAR * backdrop.right_m,
        up_m=FAR * backdrop.up_m,
    )
