"""WGSL for what is mirrored of just the lamps of a frame (see transport/direct/sum.py)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set

from andon.glare.highlights.outlines import FACET_PARTS, POLYGON_PARTS, ball_of
from andon.glare.highlights.reference import is_mirrored
from andon.lamps import (
    AnyAreaLamp,
    DirectionalLamp,
    DiskLamp,
    HemisphereLamp,
    Lamp,
    PointLamp,
    PolygonLamp,
    SkyLamp,
    SphereLamp,
    TubeLamp,
)

__all__ = ["highlights_of_lamps"]


def highlights_of_lamps(
    lamps: Sequence[Lamp],
    /,
    *,
    terms: Mapping[str, str],
    softening: Mapping[str, tuple[int, int, int]],
    edges: Mapping[str, tuple[int, int]],
    captured: Set[str] = frozenset(),
) -> str:
    """The module that stands in for sum.wgsl.

    Parameters
    ----------
    terms : lamp name → WGSL of its shadowed lux at `position` and `normal`; none of area lamps.
    softening : name of an area lamp → its first shadow sample, their number, and how many of these
        are probes.
    edges : name of a polygon or mesh lamp → first and number of its edges.
    captured : sky and hemisphere lamps that are mirrored with the light of probes.
    """
    own = [(number, lamp) for number, lamp in enumerate(lamps) if is_mirrored(lamp)]
    lines = [
        "fn lamps_mirrored(facet: Facet, bias: f32, lit: bool) -> vec3f {",
        "  let position = facet.position;",
        "  let normal = facet.ground;",
        "  let once = select(0, 1, lit);",
        "  var total = vec3f(0.0);",
        *_places(own, terms),
        *_areas(own, softening, edges),
        "  return total;",
        "}",
        "fn skies_mirrored(facet: Facet) -> vec3f {",
    ]
    skies = [
        f"sky_light(facet, {number})"
        for number, lamp in own
        if isinstance(lamp, SkyLamp | HemisphereLamp) and lamp.name not in captured
    ]
    return "\n".join([*lines, f"  return {' + '.join(['vec3f(0.0)', *skies])};", "}"])


_Numbered = Sequence[tuple[int, Lamp]]


def _places(own: _Numbered, terms: Mapping[str, str]) -> list[str]:
    """Lamps without an area. A loop, which ends where no pixel is lit: an `if` costs its inside."""
    lines = ["  for (var k = 0; k < once; k++) {"]
    for number, lamp in own:
        if isinstance(lamp, PointLamp):
            radius = float(max(lamp.visible_radius_m, 0.0))
            call = f"place_highlight(facet, {number}, {terms[lamp.name]}, {radius})"
            lines.append(f"    total += {call};")
        elif isinstance(lamp, DirectionalLamp):
            lines.append(f"    total += distant_highlight(facet, {number}, {terms[lamp.name]});")
    return [*lines, "  }"]


def _areas(
    own: _Numbered,
    softening: Mapping[str, tuple[int, int, int]],
    edges: Mapping[str, tuple[int, int]],
) -> list[str]:
    """Area lamps: a loop for each form, since a driver copies every call into the shader."""
    calls: dict[str, list[tuple[float, ...]]] = {}
    for number, lamp in own:
        if isinstance(lamp, AnyAreaLamp):
            form, numbers = _area(lamp, edges)
            row = number, *softening.get(lamp.name, (0, 0, 0)), *numbers
            calls.setdefault(form, []).append(row)
    lines: list[str] = []
    for form, rows in calls.items():
        size = len(rows[0])
        table = ", ".join(f"array<f32, {size}>({', '.join(map(str, row))})" for row in rows)
        rest = "".join(f", call[{place}]" for place in range(4, size))
        lines += [
            f"  var {form}_calls = array<array<f32, {size}>, {len(rows)}>({table});",
            f"  for (var k = 0; k < {len(rows)} * once; k++) {{",
            f"    let call = {form}_calls[k];",
            f"    let light = {form}_highlight(facet, i32(call[0]){rest});",
            "    let wanted = vec3i(i32(call[1]), i32(call[2]), i32(call[3]));",
            "    total += softened(light, wanted, position, normal, bias);",
            "  }",
        ]
    return lines


def _area(lamp: AnyAreaLamp, edges: Mapping[str, tuple[int, int]]) -> tuple[str, tuple[float, ...]]:
    """Which function, and its arguments after the lamp's number."""
    match lamp:
        case SphereLamp():
            return "sphere", ()
        case DiskLamp():
            return "disk", (float(lamp.two_sided),)
        case TubeLamp():
            return "tube", ()
        case _:
            is_plain = isinstance(lamp, PolygonLamp) and lamp.texture is None
            parts = POLYGON_PARTS if is_plain else FACET_PARTS
            return "edges", (*edges[lamp.name], parts, ball_of(lamp).radius_m)
