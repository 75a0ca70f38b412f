"""Lamps mirrored to the eye in float64: the truth that the shaders are held against."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence, Set
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.glare.highlights.albedo import albedo
from andon.glare.highlights.facets import Facets, facets_of, without_base
from andon.glare.highlights.lobes import (
    dot,
    edge_share,
    fan_share,
    ggx_slopes,
    masking,
    phong_edge_share,
    phong_lobe,
)
from andon.glare.highlights.model import Finish
from andon.glare.highlights.outlines import Edge, LampBall, ball_of, edges_of, round_edges
from andon.lamps import (
    DirectionalLamp,
    HemisphereLamp,
    Lamp,
    PointLamp,
    SkyLamp,
)
from andon.lamps.model import LIGHT_FIELDS
from andon.quantities import Surface

__all__ = [
    "Mirrored",
    "diffuse_share",
    "even_reflectance",
    "facing_lux",
    "is_mirrored",
    "lamp_highlight",
    "mirrored",
    "mirrored_picture",
    "wide_highlight",
]

Float = NDArray[np.float64]

# Directions below the horizon are lifted to this sine above it.
HORIZON = 1e-3
# Lamps lower over the surface are not mirrored: their lux there is too small to be divided by.
LEAST_FACING = 1e-4
# A lobe's middle farther from a lamp's than this many of the lamp's sizes: see `lobes`.
FAR = 6.0


def mirrored(facets: Facets, towards: Float, /) -> Float:
    """(n, 3) 1/sr: luminance per lux on a plane that faces a small lamp `towards` (n, 3)."""
    cosine = dot(facets.normal, towards)
    if facets.finish.kind == "phong":
        lobe = phong_lobe(dot(facets.mirror, towards), facets.finish.exponent)
        lobe = lobe[:, None] * facets.straight
    else:
        lobe = _ggx(facets, towards)
    return np.where(cosine[:, None] > 0, lobe, 0.0)


def _ggx(facets: Facets, towards: Float) -> Float:
    towards = above_horizon(facets, towards)
    slopes, upright, cosine = half_slopes(facets, towards)
    density = ggx_slopes(slopes) / np.prod(facets.alpha, axis=-1)
    jacobian = 4 * np.maximum(cosine, 1e-6) * upright**3
    return weight(facets, towards) * (density / jacobian)[:, None]


def weight(facets: Facets, towards: Float, /) -> Float:
    """(n, 3) F·G₂·(v·h)/((n·v)(n·h)): what multiplies GGX's share of slopes."""
    _, upright, cosine = half_slopes(facets, towards)
    shown = masking(facets.flatness(facets.view), facets.flatness(towards))
    factor = shown * cosine / (facets.cosine_view * upright)
    return facets.reflectance(cosine) * factor[:, None]


def half_slopes(facets: Facets, towards: Float, /) -> tuple[Float, Float, Float]:
    """Of the half vector h of `towards` (n, 3): slopes (n, 2) in units of α, n·h, and v·h."""
    towards = towards / np.linalg.norm(towards, axis=-1, keepdims=True)
    half = facets.local(towards) + facets.local(facets.view)
    length = np.maximum(np.linalg.norm(half, axis=-1), 1e-9)
    upright = np.maximum(half[:, 2] / length, 1e-6)
    cosine = dot(half, facets.local(facets.view)) / length
    slopes = half[:, :2] / np.maximum(half[:, 2:], 1e-9) / facets.alpha
    return slopes, upright, np.clip(cosine, 0, 1)


def above_horizon(facets: Facets, towards: Float, /) -> Float:
    """(n, 3) of any length: what is below the horizon is moved straight up to it."""
    length = np.linalg.norm(towards, axis=-1)
    lack = np.maximum(HORIZON * length - dot(towards, facets.normal), 0)
    return towards + lack[:, None] * facets.normal


def lamp_highlight(facets: Facets, lamp: Lamp, arrives: Float, /) -> Float:
    """Luminance (n, 3) in cd/m² of one lamp mirrored by `facets`.

    `arrives` (n, 3) is the share of an area lamp that is seen; of other lamps the lux on a plane
    that faces the lamp, shadow included. 0 for sky and hemisphere: `wide_highlight`.
    """
    match lamp:
        case DirectionalLamp():
            towards = np.broadcast_to(-lamp.direction, facets.position.shape)
            return arrives * mirrored(facets, towards)
        case PointLamp():
            return _of_a_place(facets, lamp, arrives)
        case SkyLamp() | HemisphereLamp():
            return np.zeros_like(facets.position)
        case _:
            return arrives * _of_an_area(facets, ball_of(lamp), edges_of(lamp, facets.position))


def facing_lux(lamp: Lamp, facets: Facets, lux: Float, /) -> Float:
    """(n, 3) lux on planes that face a lamp without an area, of `lux` (n, 3) on the surface."""
    if isinstance(lamp, DirectionalLamp):
        cosine = -facets.ground @ lamp.direction
    elif isinstance(lamp, PointLamp):
        reach = lamp.position_m - facets.position
        cosine = dot(facets.ground, reach) / np.maximum(np.linalg.norm(reach, axis=-1), 1e-3)
    else:
        return lux
    return np.where(cosine > LEAST_FACING, 1, 0)[:, None] * (
        lux / np.maximum(cosine, LEAST_FACING)[:, None]
    )


def _of_a_place(facets: Facets, lamp: PointLamp, lux: Float) -> Float:
    reach = lamp.position_m - facets.position
    square = np.maximum(dot(reach, reach), 1e-6)
    if lamp.visible_radius_m <= 0:
        return lux * mirrored(facets, reach / np.sqrt(square)[:, None])
    # The lamp is drawn as a ball; its mirror image is one as well.
    luminance = lux * (square / (np.pi * lamp.visible_radius_m**2))[:, None]
    ball = LampBall(lamp.position_m, lamp.visible_radius_m)
    edges = round_edges(None, ball.middle, ball.radius_m, facets.position, luminance)
    return _of_an_area(facets, ball, edges)


def _of_an_area(facets: Facets, ball: LampBall, edges: Iterable[Edge]) -> Float:
    """Luminance (n, 3) of a lamp within `ball`, seen in full."""
    near = nearest_to_mirror(facets, ball)
    total = np.zeros_like(facets.position)
    # Lifted to the horizon, an outline straight below would go all the way round it.
    risen = dot(facets.normal, ball.middle - facets.position) > -ball.radius_m
    if facets.finish.kind == "phong":
        a, b = facets.mirror_frame
        for edge in edges:
            ends = [above_horizon(facets, end) for end in (edge.start, edge.end)]
            p, q = (np.stack([dot(e, a), dot(e, b), dot(e, facets.mirror)], -1) for e in ends)
            total += edge.luminance_cd_m2 * phong_edge_share(p, q, facets.finish.exponent)[:, None]
        return risen[:, None] * np.abs(total) * facets.straight
    middle, far = _middle(facets, ball)
    mean = Mean(facets)
    for edge in edges:
        start, end = (above_horizon(facets, point) for point in (edge.start, edge.end))
        p, q = (half_slopes(facets, point)[0] for point in (start, end))
        share = np.where(far, fan_share(p, q, middle), edge_share(p, q))
        total += edge.luminance_cd_m2 * share[:, None]
        mean.add(start, p)
    return risen[:, None] * np.abs(total) * mean.with_inner(near)


class Mean:
    """F·G₂·(v·h)/((n·v)(n·h)) over an outline: half its corners, half a point within.

    For a round outline that is exact to the third degree; each is weighted by the lobe there.
    """

    def __init__(self, facets: Facets) -> None:
        self.facets = facets
        self.value, self.lobe, self.count = np.zeros_like(facets.position), 0.0, 0

    def add(self, corner: Float, slopes: Float) -> None:
        """Takes a corner (n, 3) and its slopes (n, 2)."""
        lobe = ggx_slopes(slopes)[:, None]
        self.value += weight(self.facets, corner) * lobe
        self.lobe, self.count = self.lobe + lobe, self.count + 1

    def with_inner(self, point: Float) -> Float:
        """(n, 3) the mean, with `point` (n, 3) within."""
        lobe = ggx_slopes(half_slopes(self.facets, point)[0])[:, None]
        own = weight(self.facets, point) * lobe
        return (own + self.value / self.count) / (lobe + self.lobe / self.count)


def _middle(facets: Facets, ball: LampBall) -> tuple[Float, NDArray[np.bool_]]:
    """Slopes (n, 2) of the lamp's middle, and whether the lobe's middle is far from them."""
    reach = ball.middle - facets.position
    middle, upright, cosine = half_slopes(facets, above_horizon(facets, reach))
    sine = ball.radius_m / np.maximum(np.linalg.norm(reach, axis=-1), ball.radius_m)
    size = sine / (2 * np.maximum(cosine, 0.05) * upright**2 * facets.alpha.min(axis=-1))
    return middle, np.linalg.norm(middle, axis=-1) > FAR * size


def nearest_to_mirror(facets: Facets, ball: LampBall, /) -> Float:
    """(n, 3) unit: where in a lamp F and G₂ are taken.

    Where a smooth surface mirrors it, or the point of the lamp next to that; of rough ones nearer
    to its middle.
    """
    reach = ball.middle - facets.position
    distance = np.maximum(np.linalg.norm(reach, axis=-1, keepdims=True), 1e-9)
    axis = reach / distance
    sine = np.minimum(ball.radius_m / distance, 0.999)
    along = dot(facets.mirror, axis)[:, None]
    across = facets.mirror - along * axis
    length = np.maximum(np.linalg.norm(across, axis=-1, keepdims=True), 1e-9)
    bounded = np.sqrt(1 - sine**2) * axis + sine / length * across
    closest = np.where(along > np.sqrt(1 - sine**2), facets.mirror, bounded)
    rough = np.sqrt(np.prod(facets.alpha, axis=-1))[:, None]
    towards = above_horizon(facets, closest + (axis - closest) * rough)
    return towards / np.linalg.norm(towards, axis=-1, keepdims=True)


def wide_highlight(facets: Facets, lamps: Sequence[Lamp], standing_lux: Float, /) -> Float:
    """Luminance (n, 3) of sky, hemispheres and the light that all stands in, mirrored."""
    wide = standing_lux / np.pi
    width = np.maximum(facets.alpha.max(axis=-1), 1e-3)
    for lamp in lamps:
        if isinstance(lamp, SkyLamp | HemisphereLamp):
            up = np.clip(0.5 + 0.5 * facets.mirror @ lamp.up / width, 0, 1)[:, None]
            sky, ground = (
                (lamp.illuminance_lux, np.zeros(3))
                if isinstance(lamp, SkyLamp)
                else (lamp.sky_illuminance_lux, lamp.ground_illuminance_lux)
            )
            wide = wide + (up * sky + (1 - up) * ground) / np.pi
    return wide * even_reflectance(facets)


def even_reflectance(facets: Facets, /) -> Float:
    """(n, 3) share of even light from all sides that is mirrored to the eye."""
    if facets.finish.kind == "phong":
        return facets.straight
    if facets.finish.kind == "water":
        return facets.reflectance(facets.cosine_view)
    # Of two roughnesses the root of the mean square: within 0.04 for 0.6 and 0.1.
    alpha = np.sqrt((facets.alpha**2).mean(axis=-1))
    return albedo(facets.cosine_view, alpha, facets.straight)


def diffuse_share(facets: Facets, /) -> Float:
    """(n,) share of the diffuse light that remains beneath what is mirrored."""
    finish = facets.finish
    if finish.kind == "phong":
        return (1 - finish.metallic) * (1 - facets.straight.max(axis=-1))
    if finish.kind == "water":
        return 1 - facets.reflectance(facets.cosine_view)[:, 0]
    return (1 - finish.metallic) * (1 - even_reflectance(without_base(facets))[:, 0])


@dataclass(frozen=True, eq=False)
class Mirrored:
    """What the mirroring surfaces of a picture send to the eye.

    Attributes
    ----------
    lamps_cd_m2 : (H, W, 3) of lamps alone: the highlights.
    wide_cd_m2 : (H, W, 3) of all other light.
    diffuse_share : (H, W) what remains of the diffuse light; 1 where nothing mirrors.
    """

    lamps_cd_m2: Float
    wide_cd_m2: Float
    diffuse_share: Float

    def over(self, emitted_cd_m2: Float, luminance_cd_m2: Float, /) -> Float:
        """(H, W, 3) the picture of diffuse light with what is mirrored; emission stays."""
        diffuse = self.diffuse_share[..., None] * (luminance_cd_m2 - emitted_cd_m2)
        mirrored_light = self.lamps_cd_m2 + self.wide_cd_m2
        shown = diffuse + emitted_cd_m2 + mirrored_light
        return np.where((self.diffuse_share < 1)[..., None], shown, luminance_cd_m2)


def mirrored_picture(
    seen: Surface,
    finishes: Sequence[Finish | None],
    lamps: Sequence[Lamp],
    arrives: Callable[[Lamp, Facets], Float],
    standing_lux: Float,
    time_seconds: float,
    /,
    captured: Set[str] = frozenset(),
) -> Mirrored:
    """All that the mirroring surfaces of a view send to the eye.

    Parameters
    ----------
    finishes : of the materials of virtual objects, by slot; None is diffuse.
    arrives : (n, 3) of a lamp at n facets, as `lamp_highlight` has it.
    standing_lux : (H, W, 3) E0 or light of probes, dimmed.
    captured : sky and hemisphere lamps that `standing_lux` holds.
    """
    shape = seen.view.shape
    found = Mirrored(np.zeros((*shape, 3)), np.zeros((*shape, 3)), np.ones(shape))
    shining = [lamp for lamp in lamps if is_mirrored(lamp)]
    skies = [lamp for lamp in shining if lamp.name not in captured]
    for mask, facets in facets_of(seen, finishes, time_seconds):
        takes = facets.finish.takes_lamps
        for lamp in shining if takes else []:
            if not isinstance(lamp, SkyLamp | HemisphereLamp):
                found.lamps_cd_m2[mask] += lamp_highlight(facets, lamp, arrives(lamp, facets))
        wide = skies if takes else []
        found.wide_cd_m2[mask] = wide_highlight(facets, wide, standing_lux[mask])
        found.diffuse_share[mask] = diffuse_share(facets)
    return found


def is_mirrored(lamp: Lamp, /) -> bool:
    """Light that is taken away is not."""
    values = [getattr(lamp, name, None) for name in LIGHT_FIELDS]
    return not any(np.min(value) < 0 for value in values if value is not None)
