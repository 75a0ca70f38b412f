"""Host struct of glass balls in the light of lamps."""

from __future__ import annotations

from andon.gpu.layout import HostStruct

__all__ = ["BALL_RECORD", "MAX_PAIRS"]

# Lamps times balls: 64 layers of the table are 32 MiB.
MAX_PAIRS = 64

BALL_RECORD = HostStruct(
    "BallRecord",
    (
        ("centre", "vec3f"),
        ("radius_m", "f32"),  # negative: the ball holds the lamp, and does nothing to its light
        ("axis", "vec3f"),  # unit, from the lamp
        ("lamp_vergence", "f32"),  # radius over distance of the lamp
        ("straight", "vec3f"),  # transmittance along the axis
        ("at_centre", "f32"),  # 1/distance², or 1 for parallel light
        ("lamp_distance_m", "f32"),  # 0 for parallel light
    ),
)
