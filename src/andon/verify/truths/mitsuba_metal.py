"""A ball of rough metal under a luminous ball, path-traced by Mitsuba.

Its `roughconductor` has GGX and no absorption here; its masking is the product of both directions'
(ours is height-correlated), which is up to some per cent darker where both are grazing.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.lamps import SphereLamp
from andon.spaces import View
from andon.verify.truths.mitsuba_glass import mitsuba, sensor_of

__all__ = ["metal_ball"]

Float = NDArray[np.float64]


def metal_ball(
    view: View, centre: Float, radius_m: float, alpha: float, lamp: SphereLamp, /, samples: int
) -> Float:
    """Luminance (H, W) in cd/m² of the ball alone, whose facets mirror all light.

    Raises `NotShown` where Mitsuba is not installed.
    """
    mi = mitsuba()
    metal = {"type": "roughconductor", "material": "none", "distribution": "ggx", "alpha": alpha}
    document: dict[str, Any] = {
        "type": "scene",
        "integrator": {"type": "direct", "hide_emitters": True},
        "ball": {"type": "sphere", "center": centre.tolist(), "radius": radius_m, "bsdf": metal},
        "lamp": {
            "type": "sphere",
            "center": lamp.position_m.tolist(),
            "radius": lamp.radius_m,
            "emitter": {"type": "area", "radiance": float(lamp.luminance_cd_m2[1])},
        },
        "sensor": sensor_of(view),
    }
    scene: Any = mi.load_dict(document)
    picture = np.asarray(mi.render(scene, spp=samples, seed=1), np.float64)
    return picture[..., 1]
