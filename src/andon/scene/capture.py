"""[capture]: the pictures and what their numbers mean."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from andon.scene.base import Fraction, NonNegative, Positive, Reference, Table, refusal
from andon.scene.geometry import Pose

__all__ = ["Capture", "PoseSource", "ResponseTable", "StereoSource"]


class ResponseTable(Table):
    """How the camera encodes light."""

    kind: Literal["linear", "srgb", "gamma", "curve"] = Field(description="Family of curves.")
    gamma: Positive | None = Field(
        default=None,
        description="γ of kind gamma: encoded = linear^(1/γ).",
    )
    file: Reference | None = Field(
        default=None,
        description="Response file of kind curve.",
    )

    @model_validator(mode="after")
    def _check_response(self) -> ResponseTable:
        for key, kind in (("gamma", "gamma"), ("file", "curve")):
            if (getattr(self, key) is not None) != (self.kind == kind):
                raise refusal(f"kind {kind!r} needs {key}, other kinds do not take it", key=key)
        return self


class StereoSource(Table):
    """Two sources of pictures."""

    left: Reference = Field(description="Source of the left eye's pictures.")
    right: Reference = Field(description="Source of the right eye's pictures.")


class PoseSource(Table):
    """Where the rig's pose comes from while capturing."""

    kind: Literal["fixed", "trajectory", "marker", "board", "openxr"] = Field(
        default="fixed",
        description="fixed: [rig]; marker: one ArUco marker; board: ChArUco or AprilTag.",
    )
    dictionary: str = Field(
        default="DICT_ARUCO_ORIGINAL",
        description="OpenCV's name of the marker family.",
    )
    marker_length_m: Positive | None = Field(
        default=None,
        description="Side of a marker in metres.",
    )
    square_length_m: Positive | None = Field(
        default=None,
        description="Side of a board's square in metres.",
    )
    board_columns: Annotated[int, Field(ge=1, le=1000)] | None = Field(
        default=None,
        description="Squares of the board along a row.",
    )
    board_rows: Annotated[int, Field(ge=1, le=1000)] | None = Field(
        default=None,
        description="Squares of the board along a column.",
    )
    world_from_marker: Pose | None = Field(
        default=None,
        description="4×4 rigid pose of the marker or board; default: the world's origin.",
    )
    hold_seconds: NonNegative = Field(
        default=0.5,
        description="Last pose is held this long after loss.",
    )
    fade_seconds: NonNegative = Field(
        default=0.5,
        description="Then the added light fades, seconds.",
    )


def _response_from_text(value: Any) -> Any:
    if not isinstance(value, str):
        return value
    kind, _, gamma = value.partition(":")
    if not gamma:
        return {"kind": kind}
    try:
        return {"kind": kind, "gamma": float(gamma)}
    except ValueError:
        raise refusal(f"must be like 'gamma:2.2', got {value[:40]!r}") from None


AnyResponse = Annotated[
    ResponseTable,
    BeforeValidator(_response_from_text, json_schema_input_type=str | ResponseTable),
]


def _source_tag(value: Any) -> str:
    return "<pair>" if isinstance(value, Mapping | StereoSource) else "<path>"


AnySource = Annotated[
    Annotated[Reference, Tag("<path>")] | Annotated[StereoSource, Tag("<pair>")],
    Discriminator(_source_tag),
]


class Capture(Table):
    """The pictures and what their numbers mean."""

    source: AnySource | None = Field(
        default=None,
        description="Picture, folder, video or session; `device:0`, `openxr:` or `simulated:`; "
        "or { left = …, right = … }. Without: there is no photograph, and the surface is "
        "drawn from the materials of its mesh.",
    )
    response: AnyResponse | None = Field(
        default=None,
        description='"linear", "srgb", "gamma:2.2", or { kind, gamma, file }. Default: linear for '
        "EXR and HDR files, srgb for others.",
    )
    luminance_per_unit: Positive | None = Field(
        default=None,
        description="cd/m² of linear value 1. Default: E0/π, so that a white diffuser in the "
        "light of the photograph is linear 1; without a photograph: E/π of what directional, "
        "sky and hemisphere lamps and E0 give at the start together.",
    )
    clipped_luminance_cd_m2: Positive | None = Field(
        default=None,
        description="cd/m² assumed where the sensor clipped; default: as captured.",
    )
    undistort: bool = Field(
        default=True,
        description="Remove lens distortion; else draw with it.",
    )
    depth: Reference | None = Field(
        default=None,
        description="Depth that comes with each frame.",
    )
    pose: PoseSource = Field(
        default=PoseSource(),
        description="Where the pose comes from.",
    )
    gaze: Reference | None = Field(
        default=None,
        description="Gaze recorded with the frames; see [gaze].",
    )
    noise: Fraction = Field(
        default=0.0,
        description="Of a simulated camera: noise σ relative to white.",
    )
