"""One probe: its pictures taken, and what is kept of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from andon.bake.journal import Result
from andon.bake.panoramas import panorama_light
from andon.engines.cubes import CubeEngine, CubeSetting
from andon.harmonics import SolidAngle, coefficient_count, cube_directions, project_cube
from andon.scene import Scene
from andon.transport.probes.capture import Capture, Seen, captured, quantised
from andon.transport.probes.placement import Placed
from andon.transport.probes.visibility import distance_map

if TYPE_CHECKING:
    from andon.transport.probes.light import ProbeLight

__all__ = ["PARTS", "Look", "Pictures", "bounced", "encoded", "first_light"]

Float = NDArray[np.float64]

# Parts of a probe's light that are kept apart, each (k, 3) coefficients.
PARTS = ("ambient", "emitted", "reflected")


@dataclass(frozen=True, eq=False)
class Look:
    """An engine with what its pictures mean.

    Attributes
    ----------
    engine, size : that takes pictures of `size` pixels.
    setting : what it sees.
    order, solid_angle : of the projection.
    """

    engine: CubeEngine
    size: int
    setting: CubeSetting
    order: int
    solid_angle: SolidAngle

    def projected(self, light: Float) -> Float:
        """(k, 3) coefficients of a cube map (6, s, s, 3); negative light is taken away."""
        return project_cube(light, self.order, self.solid_angle, signed=True)


@dataclass(frozen=True, eq=False)
class Pictures:
    """What first pictures are taken of.

    Attributes
    ----------
    look : takes them; None: there is nothing to be seen, only panoramas.
    lit : lamps' light is reflected.
    far_m : what no surface counts as in the distances.
    """

    scene: Scene
    placed: Placed
    look: Look | None
    order: int
    lit: bool
    far_m: float


def first_light(pictures: Pictures, index: int, /) -> Result:
    """The light of a probe before bounces, part by part, and how far it sees."""
    panorama = pictures.placed.panoramas[index]
    counts = dict.fromkeys(
        ("not_finite", "clipped_share", "negative", "unphotographed", "surroundings"), 0.0
    )
    distance: Float = np.full((6, 8, 8), np.inf)
    if panorama is not None:
        light = panorama_light(pictures.scene, panorama, pictures.order)
        nothing = np.zeros((coefficient_count(pictures.order), 3))
        parts = [light.coefficients, nothing, nothing]
        counts |= {"clipped_share": light.clipped_share, "negative": float(light.negative)}
        if pictures.look is not None:
            place = pictures.placed.capture_positions[index]
            distance = pictures.look.engine.look(place, lit=False)[0].distance_m
    else:
        assert pictures.look is not None
        capture = _capture(pictures.look, pictures.placed, index, lit=pictures.lit)
        parts = [
            pictures.look.projected(light)
            for light in (capture.ambient_cd_m2, capture.emitted_cd_m2, capture.reflected_cd_m2)
        ]
        distance = capture.distance_m
        counts |= {
            "not_finite": float(capture.not_finite),
            "unphotographed": capture.unphotographed_share,
            "surroundings": capture.surroundings_share,
        }
    mean, square = distance_map(distance, far_m=pictures.far_m)
    found: dict[str, NDArray[Any]] = dict(zip(PARTS, parts, strict=True))
    found |= {"mean_m": mean, "mean_square_m2": square}
    return found | {key: np.array(value) for key, value in counts.items()}


def _capture(look: Look, placed: Placed, index: int, *, lit: bool) -> Capture:
    seen, lux = look.engine.look(placed.capture_positions[index], lit=lit)
    return captured(
        seen,
        cube_directions(look.size),
        look.setting.lighting,
        lux=np.zeros_like(seen.reflectance) if lux is None else lux,
        range_m=float(placed.ranges_m[index]),
    )


def bounced(look: Look, placed: Placed, light: ProbeLight, index: int, /) -> Result:
    """What surfaces around a probe reflect of the light of all probes, (k, 3)."""
    seen, _ = look.engine.look(placed.capture_positions[index], lit=False)
    reach = float(placed.ranges_m[index])
    capture = captured(
        seen,
        cube_directions(look.size),
        replace(look.setting.lighting, sky=()),
        lux=_lux_of_probes(look, light, seen, reach),
        range_m=reach,
    )
    return {"reflected": look.projected(capture.reflected_cd_m2)}


def encoded(
    look: Look,
    placed: Placed,
    light: ProbeLight | None,
    index: int,
    /,
    *,
    lit: bool,
    white_cd_m2: float,
) -> Result:
    """All light of a probe as 8-bit pictures hold it, (k, 3); and the share that they clip."""
    seen, lux = look.engine.look(placed.capture_positions[index], lit=lit)
    reach = float(placed.ranges_m[index])
    lux = np.zeros_like(seen.reflectance) if lux is None else lux
    if light is not None:
        lux = lux + _lux_of_probes(look, light, seen, reach)
    directions = cube_directions(look.size)
    capture = captured(seen, directions, look.setting.lighting, lux=lux, range_m=reach)
    codes, clipped = quantised(capture.luminance_cd_m2, white_cd_m2)
    share = clipped / (6 * look.size**2)
    return {"all": look.projected(codes), "clipped_share": np.array(share)}


def _lux_of_probes(look: Look, light: ProbeLight, seen: Seen, reach_m: float) -> Float:
    """Illuminance (6, s, s, 3) that the probes give to what lies within `reach_m`; else 0.

    It is negative where light is missing that sources of E0 gave.
    """
    from andon.transport.probes.light import probe_illuminance

    own, signed = seen.distance_m <= reach_m, look.setting.takes_away
    lux = np.zeros_like(seen.reflectance)
    lux[own] = probe_illuminance(light, seen.position[own], seen.normal[own], signed=signed)
    return lux
