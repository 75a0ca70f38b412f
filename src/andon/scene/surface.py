"""[surface]: the real geometry that receives light."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from andon.scene.base import (
    Count,
    FractionTriple,
    Name,
    NonNegative,
    Positive,
    Reference,
    Table,
    exactly_one,
    refusal,
)
from andon.scene.geometry import Transform

__all__ = ["Depth", "Surface", "SurfaceResponse"]


def _drop_nan(values: tuple[float, ...]) -> tuple[float, ...]:
    # NaN is a hole in any case; keeping it would make a scene unequal to itself.
    return tuple(value for value in values if value == value)


class Depth(Table):
    """A depth image. Holes stay holes, and are counted, unless `fill_px` says otherwise."""

    file: Reference = Field(description="The depth image.")
    kind: Literal["z", "distance", "disparity"] = Field(
        default="z",
        description="z: along the optical axis; distance: along the ray; disparity: pixels.",
    )
    scale_to_m: Positive = Field(
        default=1.0,
        description="Metres (disparity: pixels) per unit of the file; 0.001 for millimetres.",
    )
    shift_m: float = Field(
        default=0.0,
        description="Metres added after scaling, of kinds z and distance; `andon depth fit` "
        "finds it for relative depth.",
    )
    baseline_m: Positive | None = Field(
        default=None,
        description="Of disparity: distance of the cameras.",
    )
    focal_px: Positive | None = Field(
        default=None,
        description="Of disparity: focal length in pixels; default: the camera's fx.",
    )
    doffs_px: float = Field(
        default=0.0,
        description="Of disparity: x difference of the principal points.",
    )
    invalid: Annotated[
        tuple[Annotated[float, Field(allow_inf_nan=True)], ...], AfterValidator(_drop_nan)
    ] = Field(
        default=(),
        description="Values of the file that mean a hole. NaN, ±inf and what is ≤ 0 once scaled "
        "and shifted always do.",
    )
    max_jump: Annotated[float, Field(gt=0, le=1)] = Field(
        default=0.05,
        description="Relative step between neighbours that cuts the surface, (0, 1].",
    )
    thickness_m: Positive | None = Field(
        default=None,
        description="Closes objects at their back for shadows, metres; default: open.",
    )
    fill_px: Annotated[int, Field(ge=0, le=256)] = Field(
        default=0,
        description="Gaps of up to so many pixels across are closed: holes get the depth of "
        "their farther rim, are lit, and are counted; for shadows, a surface goes on behind narrow "
        "things before it. 0: holes stay holes, and light passes where nothing was measured.",
    )

    @model_validator(mode="after")
    def _check_disparity(self) -> Depth:
        if self.kind == "disparity" and self.baseline_m is None:
            raise refusal(
                "kind 'disparity' needs it", key="baseline_m", remedy="state it in metres"
            )
        if self.kind == "disparity" and "shift_m" in self.model_fields_set:
            raise refusal(
                "belongs to kinds z and distance", key="shift_m", remedy="state doffs_px instead"
            )
        if self.kind != "disparity":
            for key in ("baseline_m", "focal_px", "doffs_px"):
                if key in self.model_fields_set:
                    raise refusal("belongs to kind 'disparity'", key=key, remedy="remove it")
        return self


class SurfaceResponse(Table):
    """Measured relation of illuminance and camera RGB of one material."""

    material: Name = Field(
        default="*",
        description="Name of the material in the mesh; * is all other pixels. Where `mask` is "
        "stated: a name for messages.",
    )
    mask: Reference | None = Field(
        default=None,
        description="Picture of the view, white where the surface is; for surfaces without "
        "materials (depth, normals). Goes before materials; where masks overlap the later "
        "counts.",
    )
    file: Reference | None = Field(
        default=None,
        description="CSV of `andon calibrate surface`, instead of the two lists.",
    )
    illuminance_lux: tuple[NonNegative, ...] = Field(
        default=(),
        description="Rising illuminances in lx.",
    )
    rgb: tuple[tuple[NonNegative, NonNegative, NonNegative], ...] = Field(
        default=(),
        description="Linear camera RGB at each of them, 1 is the sensor's white, rising in every "
        "channel. Straight between them and on beyond both ends.",
    )

    @model_validator(mode="after")
    def _check_curve(self) -> SurfaceResponse:
        lists = bool(self.illuminance_lux or self.rgb)
        if lists == (self.file is not None):
            raise refusal("exactly one of file, (illuminance_lux and rgb) is allowed")
        if lists and not len(self.illuminance_lux) == len(self.rgb) >= 2:
            raise refusal(
                f"illuminance_lux and rgb must be equally long, 2 at least, got "
                f"{len(self.illuminance_lux)} and {len(self.rgb)}"
            )
        if any(b <= a for a, b in pairwise(self.illuminance_lux)):
            raise refusal("must rise", key="illuminance_lux")
        if any(y <= x for a, b in pairwise(self.rgb) for x, y in zip(a, b, strict=True)):
            raise refusal("must rise in every channel", key="rgb")
        return self


def _depth_from_text(value: Any) -> Any:
    return {"file": value} if isinstance(value, str) else value


AnyDepth = Annotated[
    Depth, BeforeValidator(_depth_from_text, json_schema_input_type=Reference | Depth)
]


class Surface(Table):
    """The real geometry that receives virtual light: a mesh, a depth image, or normals alone."""

    mesh: Reference | None = Field(
        default=None,
        description="Mesh file (OBJ, glTF) in world space.",
    )
    depth: AnyDepth | None = Field(
        default=None,
        description="Depth image: a path or [surface.depth].",
    )
    normals: Reference | None = Field(
        default=None,
        description="Picture of normals. Alone: a surface without positions, for distant lamps "
        "only; with depth: instead of the depth's own normals.",
    )
    normals_axes: Literal["opencv", "opengl", "world"] = Field(
        default="opencv",
        description="Axes of `normals`: camera with y down, z forward (opencv); y up, z backward "
        "(opengl); world.",
    )
    lamps: bool = Field(
        default=False,
        description="The lights of the glTF file (KHR_lights_punctual) are lamps of the scene, "
        "named by their nodes; their `range` is not used.",
    )
    world_from_mesh: Transform | None = Field(
        default=None,
        description="4×4 affine placement of the mesh, row by row.",
    )
    reflectance: FractionTriple | None = Field(
        default=None,
        description="Diffuse reflectance ρ in [0, 1], number or three; default: the mesh's.",
    )
    reflectance_map: Reference | None = Field(
        default=None,
        description="Picture of ρ in the view, EXR (linear) or PNG (sRGB codes), instead of "
        "`reflectance`: where E0 is too weak for the photograph to tell what the surface reflects, "
        "added light falls on this ρ, in the scale that the photograph shows elsewhere.",
    )
    occluder_triangles: Count = Field(
        default=30000,
        description="Depth meshes are thinned to this many triangles for shadows; 0: all.",
    )
    response: tuple[SurfaceResponse, ...] = Field(
        default=(),
        description="[[surface.response]] per material.",
    )

    @model_validator(mode="after")
    def _check_geometry(self) -> Surface:
        if self.normals is None or self.mesh is not None:  # normals may go with depth, or alone
            exactly_one(self, "mesh", "depth", "normals")
        if self.lamps and self.mesh is None:
            raise refusal("needs a mesh, whose lights they are", key="lamps")
        if self.reflectance is not None and self.reflectance_map is not None:
            raise refusal(
                "reflectance and reflectance_map exclude each other", key="reflectance_map"
            )
        seen: set[str] = set()
        for index, entry in enumerate(self.response):
            if entry.mask is None and entry.material in seen:
                raise refusal(
                    f"{entry.material!r} has a response already", key=f"response[{index}].material"
                )
            if entry.mask is None:
                seen.add(entry.material)
        return self
