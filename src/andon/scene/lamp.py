"""The twelve kinds of [[lamp]], each with just its own keys.

A tagged union rather than one table with a dozen optional fields: a key of another kind is an
error at parse time, and the JSON schema knows which key goes with which kind.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal, cast

from pydantic import Discriminator, Field, Tag, model_validator

from andon.scene.base import NonNegative, Positive, Reference, Vector, refusal
from andon.scene.geometry import Direction
from andon.scene.lamp_base import LampTable, Shadowing, ShadowMapSize, Shelled

__all__ = [
    "LAMP_KINDS",
    "AnyLamp",
    "DirectionalTable",
    "DiskTable",
    "HemisphereTable",
    "IesTable",
    "MeshTable",
    "PointTable",
    "PolygonTable",
    "RectangleTable",
    "SkyTable",
    "SphereTable",
    "SpotTable",
    "TubeTable",
]

_INTENSITY = "Luminous intensity in cd."
_FLUX = "Luminous flux in lm."


class _Bulb(LampTable, Shadowing, Shelled):
    position: Vector = Field(description="Position in metres, world.")
    intensity_cd: NonNegative | None = Field(default=None, description=_INTENSITY)
    flux_lm: NonNegative | None = Field(default=None, description=_FLUX)

    @model_validator(mode="after")
    def _check_real_shell(self) -> _Bulb:
        moves = self.path is not None or any(key.position is not None for key in self.key)
        if self.shell is not None and self.shell.real and moves:
            raise refusal(
                "is part of the photograph, and the lamp moves",
                key="shell.real",
                remedy="leave out path and the keys' positions, or real",
            )
        return self


class PointTable(_Bulb):
    """Shines equally to all sides."""

    kind: Literal["point"] = Field(description="Kind of lamp.")


class SpotTable(_Bulb):
    """A cone with glTF's soft edge; `intensity_cd` is on the axis."""

    kind: Literal["spot"] = Field(description="Kind of lamp.")
    direction: Direction = Field(description="Where the axis points, world; any length.")
    # Defaults of KHR_lights_punctual.
    inner_degrees: Annotated[float, Field(ge=0, le=90)] = Field(
        default=0.0,
        description="Half-angle of the full-intensity cone in degrees, 0 ≤ inner < outer.",
    )
    outer_degrees: Annotated[float, Field(ge=0.1, le=90)] = Field(
        default=45.0,
        description="Half-angle where the light ends in degrees, inner < outer, 0.1…90.",
    )

    @model_validator(mode="after")
    def _check_cone(self) -> SpotTable:
        if not self.inner_degrees < self.outer_degrees:
            raise refusal(
                f"must be < outer_degrees, {self.outer_degrees:g}, got {self.inner_degrees:g}",
                key="inner_degrees",
            )
        return self


class IesTable(_Bulb):
    """A luminaire with a measured distribution (IES LM-63 or EULUMDAT)."""

    kind: Literal["ies"] = Field(description="Kind of lamp.")
    light_required: ClassVar[bool] = False

    file: Reference = Field(description="The .ies or .ldt file.")
    direction: Direction = Field(
        default=(0.0, -1.0, 0.0),
        description="Where the luminaire's nadir (γ = 0) points, world.",
    )
    roll_degrees: float = Field(
        default=0.0,
        description="Turn of the C planes about the nadir, degrees.",
    )
    intensity_cd: NonNegative | None = Field(
        default=None,
        description="Scales the file so that its peak is this, in cd; neither: as the file.",
    )
    flux_lm: NonNegative | None = Field(
        default=None,
        description="Scales the file to this flux in lm.",
    )


class _Area(LampTable, Shadowing):
    kinds_of_light: ClassVar[tuple[str, ...]] = ("intensity_cd", "flux_lm", "luminance_cd_m2")

    intensity_cd: NonNegative | None = Field(
        default=None,
        description="Luminous intensity in cd: along the normal; sphere, tube: broadside; mesh: "
        "mean over all directions.",
    )
    flux_lm: NonNegative | None = Field(
        default=None,
        description="Luminous flux in lm; of both sides, if two_sided.",
    )
    luminance_cd_m2: NonNegative | None = Field(
        default=None,
        description="Luminance of the area in cd/m², equal to all sides.",
    )
    drawn: bool = Field(
        default=True,
        description="The area is seen in the picture, and casts shadows; its back is black unless "
        "two_sided.",
    )
    shadow_map_size: ShadowMapSize = Field(
        default=512,
        description="Texels along a side of each shadow map, 16…8192.",
    )
    shadow_samples: Annotated[int, Field(ge=1, le=64)] = Field(
        default=16,
        description="Points on the area from which its shadow is looked at, 1…64; the penumbra is "
        "their mean. With maps of 512² texels 16 err by about 4 % of the light (RMS), 4 by 5 %; "
        "more than 16 gain little: larger maps do.",
    )


class SphereTable(_Area):
    """A glowing ball."""

    kind: Literal["sphere"] = Field(description="Kind of lamp.")
    position: Vector = Field(description="Centre in metres, world.")
    radius_m: Positive = Field(description="Radius in metres.")


class DiskTable(_Area):
    """A flat round lamp."""

    kind: Literal["disk"] = Field(description="Kind of lamp.")
    position: Vector = Field(description="Centre in metres, world.")
    direction: Direction = Field(description="Normal of the emitting side, world.")
    radius_m: Positive = Field(description="Radius in metres.")
    two_sided: bool = Field(
        default=False,
        description="Emits from both sides.",
    )


class RectangleTable(_Area):
    """A flat rectangular lamp."""

    kind: Literal["rectangle"] = Field(description="Kind of lamp.")
    position: Vector = Field(description="Centre in metres, world.")
    direction: Direction = Field(description="Normal of the emitting side, world.")
    up: Direction = Field(
        default=(0.0, 1.0, 0.0),
        description="Which way its height runs, world.",
    )
    width_m: Positive = Field(description="Width in metres.")
    height_m: Positive = Field(description="Height in metres.")
    two_sided: bool = Field(
        default=False,
        description="Emits from both sides.",
    )
    texture: Reference | None = Field(
        default=None,
        description="Picture on the area; its mean has the stated luminance.",
    )


class TubeTable(_Area):
    """A fluorescent tube: a cylinder with round ends."""

    kind: Literal["tube"] = Field(description="Kind of lamp.")
    position: Vector = Field(
        default=(0.0, 0.0, 0.0),
        description="Offset of `ends` in metres, world.",
    )
    ends: tuple[Vector, Vector] = Field(description="Both ends of the axis in metres.")
    radius_m: Positive = Field(description="Radius in metres.")

    @model_validator(mode="after")
    def _check_ends(self) -> TubeTable:
        if self.ends[0] == self.ends[1]:
            raise refusal("the two ends must differ", key="ends", remedy="use kind 'sphere'")
        return self


class PolygonTable(_Area):
    """A flat polygon; emits to the side from which its vertices run counter-clockwise."""

    kind: Literal["polygon"] = Field(description="Kind of lamp.")
    position: Vector = Field(
        default=(0.0, 0.0, 0.0),
        description="Offset of `vertices` in metres, world.",
    )
    vertices: Annotated[tuple[Vector, ...], Field(min_length=3, max_length=1024)] = Field(
        description="Corners in metres, 3…1024 of them."
    )
    two_sided: bool = Field(
        default=False,
        description="Emits from both sides.",
    )


class MeshTable(_Area):
    """A lamp of any form. Its facets do not hide one another, which is exact for convex forms.

    For its light the mesh is reduced to about 64 triangles; it is drawn as it is.
    """

    kind: Literal["mesh"] = Field(description="Kind of lamp.")
    position: Vector = Field(
        default=(0.0, 0.0, 0.0),
        description="Offset of the mesh in metres, world.",
    )
    mesh: Reference = Field(
        description="Mesh file; every triangle emits to the side on which it runs "
        "counter-clockwise."
    )


class DirectionalTable(LampTable, Shadowing):
    """Parallel light: the sun."""

    kind: Literal["directional"] = Field(description="Kind of lamp.")
    kinds_of_light: ClassVar[tuple[str, ...]] = ("illuminance_lux",)

    direction: Direction = Field(description="Where the light travels, world; any length.")
    illuminance_lux: NonNegative | None = Field(
        default=None,
        description="On a surface that faces the light, in lx.",
    )
    angular_diameter_degrees: Annotated[float, Field(ge=0, le=90)] = Field(
        default=0.0,
        description="Apparent diameter in degrees (the sun: 0.53); 0: a point.",
    )


class _Dome(LampTable):
    kinds_of_light: ClassVar[tuple[str, ...]] = ("illuminance_lux",)

    up: Direction = Field(
        default=(0.0, 1.0, 0.0),
        description="The zenith, world.",
    )
    illuminance_lux: NonNegative | None = Field(
        default=None,
        description="From the sky on a surface that faces the zenith, in lx.",
    )


class SkyTable(_Dome):
    """A sky of equal luminance above the horizon; casts no shadow."""

    kind: Literal["sky"] = Field(description="Kind of lamp.")


class HemisphereTable(_Dome):
    """A sky and a ground, each of equal luminance; casts no shadow."""

    kind: Literal["hemisphere"] = Field(description="Kind of lamp.")
    ground_illuminance_lux: NonNegative = Field(
        description="From the ground on a surface that faces straight down, in lx."
    )
    ground_rgb: tuple[NonNegative, NonNegative, NonNegative] | None = Field(
        default=None,
        description="Linear Rec.709 factors of the ground's light; default: as the sky's.",
    )

    @model_validator(mode="after")
    def _check_ground(self) -> HemisphereTable:
        if self.ground_rgb is not None and not max(self.ground_rgb) > 0:
            raise refusal("at least one channel must be > 0", key="ground_rgb")
        return self


LAMP_KINDS: dict[str, type[LampTable]] = {
    "point": PointTable,
    "spot": SpotTable,
    "ies": IesTable,
    "sphere": SphereTable,
    "disk": DiskTable,
    "rectangle": RectangleTable,
    "tube": TubeTable,
    "polygon": PolygonTable,
    "mesh": MeshTable,
    "directional": DirectionalTable,
    "sky": SkyTable,
    "hemisphere": HemisphereTable,
}


def _tag(value: Any) -> str:
    # Angle brackets mark tags, so that error paths can be told from keys (see refusals.py).
    if isinstance(value, Mapping):
        return f"<{cast(Mapping[str, Any], value).get('kind', '')}>"
    return f"<{getattr(value, 'kind', '')}>"


AnyLamp = Annotated[
    Annotated[PointTable, Tag("<point>")]
    | Annotated[SpotTable, Tag("<spot>")]
    | Annotated[IesTable, Tag("<ies>")]
    | Annotated[SphereTable, Tag("<sphere>")]
    | Annotated[DiskTable, Tag("<disk>")]
    | Annotated[RectangleTable, Tag("<rectangle>")]
    | Annotated[TubeTable, Tag("<tube>")]
    | Annotated[PolygonTable, Tag("<polygon>")]
    | Annotated[MeshTable, Tag("<mesh>")]
    | Annotated[DirectionalTable, Tag("<directional>")]
    | Annotated[SkyTable, Tag("<sky>")]
    | Annotated[HemisphereTable, Tag("<hemisphere>")],
    Discriminator(_tag),
]
