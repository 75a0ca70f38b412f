"""[[object]] and [[glass]]: what is put into the scene."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from andon.quaternions import rotation_matrices
from andon.scene.base import (
    Count,
    Fraction,
    FractionTriple,
    Name,
    NonNegative,
    NonNegativeTriple,
    Positive,
    Reference,
    Size,
    Table,
    Vector,
    refusal,
)
from andon.scene.geometry import Direction, Transform, UnitQuaternion

__all__ = ["Background", "Glass", "ObjectKey", "SceneObject", "Water"]


class Placed(Table):
    """Where a thing stands: position, rotation and scale, or one matrix."""

    position: Vector = Field(
        default=(0.0, 0.0, 0.0),
        description="Position in metres, world.",
    )
    rotation_xyzw: UnitQuaternion = Field(
        default=(0.0, 0.0, 0.0, 1.0),
        description="Rotation as a unit quaternion (x, y, z, w).",
    )
    scale: Positive = Field(
        default=1.0,
        description="Uniform scale.",
    )
    transform: Transform | None = Field(
        default=None,
        description="4×4 affine matrix, row by row, instead of the three above.",
    )

    @model_validator(mode="after")
    def _check_placed(self) -> Placed:
        if self.transform is not None:
            for key in ("position", "rotation_xyzw", "scale"):
                if key in self.model_fields_set:
                    raise refusal("transform excludes it", key=key, remedy="keep one of them")
        return self

    def world_from_object(self) -> NDArray[np.float64]:
        """(4, 4) affine placement in metres."""
        if self.transform is not None:
            return np.array(self.transform, dtype=np.float64)
        matrix = np.eye(4)
        matrix[:3, :3] = self.scale * rotation_matrices(np.array(self.rotation_xyzw))
        matrix[:3, 3] = self.position
        return matrix


class ObjectKey(Table):
    """One keyframe of an object. Between keys it moves straight and turns the shorter way at a
    constant rate; outside it stays.
    """

    time_seconds: float = Field(description="Session time of the key in seconds.")
    position: Vector | None = Field(
        default=None,
        description="Position in metres, world.",
    )
    rotation_xyzw: UnitQuaternion | None = Field(
        default=None,
        description="Unit quaternion (x, y, z, w).",
    )

    @model_validator(mode="after")
    def _check_sets(self) -> ObjectKey:
        if self.position is None and self.rotation_xyzw is None:
            raise refusal("needs position or rotation_xyzw")
        return self


class Water(Table):
    """A level surface of water, rippled. Its mesh is flat; +Y is up."""

    index: Annotated[float, Field(gt=1, le=3)] = Field(
        default=1.333,
        description="Refractive index, 1…3.",
    )
    slope: Annotated[float, Field(ge=0, le=0.5)] = Field(
        default=0.06,
        description="Of the ripples, root mean square; 0: a mirror. Wind of 1, 5 and 10 m/s gives "
        "0.09, 0.17 and 0.23 on the sea (Cox and Munk).",
    )
    wavelength_m: tuple[Positive, Positive] = Field(
        default=(0.08, 1.5),
        description="Shortest and longest ripple, metres.",
    )
    wind_degrees: float = Field(
        default=0.0,
        description="Where the wind blows to: 0 is +X, 90 is +Z.",
    )
    waves: Annotated[int, Field(ge=1, le=64)] = Field(
        default=32,
        description="How many ripples are added up, 1…64.",
    )
    seed: Count | None = Field(
        default=None,
        description="Of their phases and directions; default: from scene.seed.",
    )

    @model_validator(mode="after")
    def _check_wavelengths(self) -> Water:
        if not self.wavelength_m[0] <= self.wavelength_m[1]:
            raise refusal("must rise", key="wavelength_m")
        return self


class SceneObject(Placed):
    """A virtual object."""

    name: Name = Field(
        default="object",
        description="For messages.",
    )
    mesh: Reference = Field(description="glTF file.")
    animation: Name | None = Field(
        default=None,
        description="Animation of the glTF file that plays: its name, or its number from 0; "
        "without one the object has the pose of the file.",
    )
    animation_start_seconds: float = Field(
        default=0.0,
        description="Session time at which it starts; before, the pose it starts with is held.",
    )
    animation_speed: float = Field(
        default=1.0,
        description="1: as in the file; 0: stands still; below 0: from its end backwards.",
    )
    loop: bool = Field(
        default=True,
        description="The animation begins again at its end; else its last pose is held.",
    )
    lamps: bool = Field(
        default=False,
        description="The lights of the glTF file (KHR_lights_punctual) are lamps of the scene, "
        "named by their nodes; their `range` is not used.",
    )
    casts_shadow: bool = Field(
        default=True,
        description="Darkens the real surface.",
    )
    lit_by_probes: bool = Field(
        default=True,
        description="Takes indirect light from [probes], instead of E0.",
    )
    lit_by_lamps: bool = Field(
        default=True,
        description="Takes direct light from [[lamp]].",
    )
    highlights: Literal["auto", "cook-torrance", "anisotropic", "phong", "none"] = Field(
        default="auto",
        description="How lamps are mirrored. auto: Cook–Torrance on materials whose file states a "
        "metallicFactor above 0, else none; cook-torrance and anisotropic: GGX on all of it; "
        "phong: the paper's I·I_s·cosⁿα, normalised; none: diffuse.",
    )
    metallic: Fraction | None = Field(
        default=None,
        description="Instead of the file's metallicFactor (where the file states none: 0).",
    )
    roughness: Fraction | None = Field(
        default=None,
        description="Instead of the file's roughnessFactor.",
    )
    anisotropy: Fraction = Field(
        default=0.8,
        description="Of anisotropic: 0 as cook-torrance, 1 brushed smooth along one direction; "
        "KHR_materials_anisotropy's strength goes before it.",
    )
    brush: Direction = Field(
        default=(0.0, 1.0, 0.0),
        description="Of anisotropic: an axis of the object that scratches follow or go round.",
    )
    brush_around: bool = Field(
        default=False,
        description="Of anisotropic: scratches go round the axis, as turned metal has them.",
    )
    phong_exponent: Annotated[float, Field(ge=1, le=100000)] = Field(
        default=200.0,
        description="Of phong: n, 1…100000.",
    )
    phong_reflectance: FractionTriple | None = Field(
        default=None,
        description="Of phong: I_s, share of light in the lobe; default: as cook-torrance straight "
        "ahead.",
    )
    water: Water | None = Field(
        default=None,
        description="[object.water]: the object is a level surface of water.",
    )
    key: tuple[ObjectKey, ...] = Field(
        default=(),
        description="[[object.key]]: keyframes, rising times. What no key states is the object's "
        "own.",
    )

    @model_validator(mode="after")
    def _check_keys(self) -> SceneObject:
        for index, (before, after) in enumerate(pairwise(self.key), start=1):
            if not after.time_seconds > before.time_seconds:
                raise refusal("must be later than the key before", key=f"key[{index}].time_seconds")
        if self.water is not None and self.highlights != "auto":
            raise refusal("belongs to things that are not water", key="highlights")
        if self.key and self.transform is not None:
            remedy = "state position, rotation_xyzw and scale"
            raise refusal("excludes keyframes", key="transform", remedy=remedy)
        return self


class Background(Table):
    """What is seen through glass."""

    kind: Literal["frame", "surface", "texture"] = Field(
        default="surface",
        description="surface: the scene's geometry with the frame on it; frame: the picture at "
        "distance_m; texture: a picture on a plane.",
    )
    file: Reference | None = Field(
        default=None,
        description="Picture of kind texture.",
    )
    distance_m: Positive | None = Field(
        default=None,
        description="Of kind frame: from the eye, metres.",
    )
    position: Vector = Field(
        default=(0.0, 0.0, 0.0),
        description="Of kind texture: the plane's centre, metres.",
    )
    normal: Direction = Field(
        default=(0.0, 0.0, 1.0),
        description="Of kind texture: the plane's normal.",
    )
    up: Direction = Field(
        default=(0.0, 1.0, 0.0),
        description="Of kind texture: the picture's up.",
    )
    width_m: Positive = Field(
        default=1.0,
        description="Of kind texture: metres.",
    )
    height_m: Positive = Field(
        default=1.0,
        description="Of kind texture: metres.",
    )

    @model_validator(mode="after")
    def _check_kind(self) -> Background:
        for key, kind in (("file", "texture"), ("distance_m", "frame")):
            if (getattr(self, key) is not None) != (self.kind == kind):
                raise refusal(f"kind {kind!r} needs {key}, other kinds do not take it", key=key)
        return self


class Glass(Placed):
    """A transparent body."""

    name: Name = Field(
        default="glass",
        description="For messages.",
    )
    shape: Literal["sphere", "slab", "lens", "mesh"] = Field(
        default="sphere",
        description="Its form.",
    )
    radius_m: Positive | None = Field(
        default=None,
        description="Of a sphere, metres; of a lens: its rim.",
    )
    size_m: Size | None = Field(
        default=None,
        description="Of a slab: width, height, thickness in metres.",
    )
    curvature_m: tuple[float, float] | None = Field(
        default=None,
        description="Of a lens: radii of front and back, metres, convex positive.",
    )
    thickness_m: Positive | None = Field(
        default=None,
        description="Of a lens: at its centre, metres.",
    )
    mesh: Reference | None = Field(
        default=None,
        description="Of shape mesh: a closed glTF or OBJ mesh.",
    )
    index: Annotated[float, Field(ge=1, le=5)] = Field(
        default=1.51,
        description="Refractive index, 1…5.",
    )
    cauchy_b_um2: NonNegative = Field(
        default=0.0,
        description="Dispersion: n(λ) = index + B·(1/λ² − 1/0.5876²), λ and B in µm, µm².",
    )
    absorption_per_m: NonNegativeTriple = Field(
        default=(0.0, 0.0, 0.0),
        description="Beer–Lambert absorption in 1/m, number or three.",
    )
    texture: Reference | None = Field(
        default=None,
        description="Picture of what sticks to the outside, diffuse. On a sphere latlong with its "
        "middle at +z; on a slab and a lens seen from +z; on a mesh by its own coordinates. Where "
        "its alpha is 0 nothing sticks.",
    )
    texture_transmittance: Fraction = Field(
        default=0.8,
        description="Share of light that the texture lets through; α = 1 − this.",
    )
    interfaces: Annotated[int, Field(ge=1, le=2)] = Field(
        default=2,
        description="Refractions: 1 (entry only) or 2 (exact).",
    )
    background: Background = Field(
        default=Background(),
        description="What is seen through it.",
    )
    highlight_exponent: Annotated[float, Field(ge=1, le=100000)] = Field(
        default=2000.0,
        description="Of Phong's lobe in which lamps are mirrored, 1…100000; its light is kept.",
    )
    casts_light: bool = Field(
        default=True,
        description="Of a sphere: shadow and caustic of point and spot lamps on other surfaces.",
    )

    @model_validator(mode="after")
    def _check_shape(self) -> Glass:
        needed = {
            "sphere": ("radius_m",),
            "slab": ("size_m",),
            "lens": ("radius_m", "curvature_m", "thickness_m"),
            "mesh": ("mesh",),
        }
        for key in ("radius_m", "size_m", "curvature_m", "thickness_m", "mesh"):
            given = getattr(self, key) is not None
            if given != (key in needed[self.shape]):
                rule = "takes no" if given else "needs"
                raise refusal(f"shape {self.shape!r} {rule} {key}", key=key)
        if self.curvature_m is not None and 0 in self.curvature_m:
            raise refusal("a radius of 0 is no surface", key="curvature_m")
        return self
