"""WGSL for just the lamps of a frame: constants as constants, no branches.

Points, spots and distant lamps are named one by one: a software rasteriser runs through a loop
once even if it is empty. Area lamps go through loops, one for each form and one for the shadows:
a driver copies every call into the shader, and eight copies of a soft shadow took 14 s to compile.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set

from andon.lamps import AnyAreaLamp, Lamp
from andon.transport.direct.records import form_of
from andon.transport.direct.soft import probes

__all__ = ["lamp_terms", "softenings", "sum_of_lamps"]


def sum_of_lamps(
    lamps: Sequence[Lamp],
    bodies: Sequence[str] = (),
    *,
    layers: Mapping[str, int],
    samples: Mapping[str, int],
    edges: Mapping[str, tuple[int, int]],
    tables: Mapping[str, tuple[int, int, int]],
    map_size: int,
    soft_map_size: int,
    triangles: int,
    captured: Set[str] = frozenset(),
    silent: Set[str] = frozenset(),
    shells: Set[str] = frozenset(),
) -> str:
    """The module that stands in for sum.wgsl.

    Parameters
    ----------
    bodies : names of the luminous bodies; number 0 in the shader is nobody.
    layers, samples : lamp name → first layer of its shadow map, or first of its sample points.
    edges : lamp name → first and count of the edges of a polygon or mesh lamp.
    tables : lamp name → first value, rows and columns of a luminaire's distribution.
    triangles : how many cast shadows.
    captured : names of sky and hemisphere lamps whose light probes hold.
    silent : names of lamps that are not in the sum: their light is baked.
    shells : names of the bodies that are real shells, on which no part of their lamp falls.
    """
    lines = [
        f"const MAP_SIZE: f32 = {float(map_size)};",
        f"const SOFT_MAP_SIZE: f32 = {float(soft_map_size)};",
        f"const TRIANGLES: i32 = {triangles};",
        "fn illuminance(position: vec3f, normal: vec3f, bias: f32, body: u32) -> vec3f {",
        "  var total = vec3f(0.0);",
    ]
    summed = [(n, lamp) for n, lamp in enumerate(lamps) if lamp.name not in silent]
    for number, lamp in summed:
        if isinstance(lamp, AnyAreaLamp):
            continue
        term = _term(number, lamp, layers, tables)
        if lamp.owner in shells:
            own = list(bodies).index(lamp.owner) + 1
            term = f"select({term}, vec3f(0.0), body == {own}u)"
        lines.append(f"  total += {term};")
    areas = [(n, lamp) for n, lamp in summed if isinstance(lamp, AnyAreaLamp)]
    if areas:
        lines += _areas(areas, bodies, shells, samples, edges)
    lines += ["  return total;", "}", "fn captured_lux(normal: vec3f) -> vec3f {"]
    terms = [
        _term(number, lamp, layers, tables) for number, lamp in summed if lamp.name in captured
    ]
    return "\n".join([*lines, f"  return {' + '.join(['vec3f(0.0)', *terms])};", "}"])


def lamp_terms(
    lamps: Sequence[Lamp],
    /,
    layers: Mapping[str, int],
    tables: Mapping[str, tuple[int, int, int]],
) -> dict[str, str]:
    """Lamp name → WGSL of its shadowed lux at `position` and `normal`; area lamps have none."""
    return {
        lamp.name: _term(number, lamp, layers, tables)
        for number, lamp in enumerate(lamps)
        if not isinstance(lamp, AnyAreaLamp)
    }


def softenings(
    lamps: Sequence[Lamp], firsts: Mapping[str, int], /
) -> dict[str, tuple[int, int, int]]:
    """Name of a shadowed area lamp → first sample, samples, and how many of these are probes."""
    shadows = {lamp.name: lamp.shadow for lamp in lamps if isinstance(lamp, AnyAreaLamp)}
    return {
        name: (firsts[name], shadow.samples, probes(shadow.samples))
        for name, shadow in shadows.items()
        if shadow is not None
    }


def _term(
    number: int,
    lamp: Lamp,
    layers: Mapping[str, int],
    tables: Mapping[str, tuple[int, int, int]],
) -> str:
    form = form_of(lamp)
    if form == "hemisphere":
        return f"hemisphere_illuminance({number}, normal)"
    layer = f"{layers.get(lamp.name, -1)}"
    if form == "goniometric":
        layer += ", {}, {}, {}".format(*tables[lamp.name])
    return f"{form}_illuminance({number}, {layer}, position, normal, bias)"


def _areas(
    areas: Sequence[tuple[int, AnyAreaLamp]],
    bodies: Sequence[str],
    shells: Set[str],
    samples: Mapping[str, int],
    edges: Mapping[str, tuple[int, int]],
) -> list[str]:
    """Unshadowed light of each area lamp, form by form, then its shadow."""
    lines = [f"  var light: array<vec3f, {len(areas)}>;"]
    calls: dict[str, list[tuple[int, ...]]] = {}
    shadows: list[tuple[int, ...]] = []
    for slot, (number, lamp) in enumerate(areas):
        own_edges = edges.get(lamp.name, (0, 0))
        calls.setdefault(form_of(lamp), []).append((slot, number, *own_edges))
        count = 0 if lamp.shadow is None else lamp.shadow.samples
        body = lamp.owner if lamp.owner in shells else lamp.body
        own = list(bodies).index(body) + 1 if body in bodies else 0
        shadows.append((samples.get(lamp.name, 0), count, probes(count), own))
    for form, rows in calls.items():
        has_edges = form.startswith(("polygon", "edges"))
        place = "call.y, call.z, call.w" if has_edges else "call.y"
        lines += _loop(f"{form}_calls", rows, [
            f"light[call.x] = {form}_illuminance({place}, position, normal);",
        ])  # fmt: skip
    lines += _loop("shadows", shadows, [
        "let falls = select(1.0, 0.0, call.w > 0 && u32(call.w) == body);",
        "total += softened(light[k] * falls, call.xyz, position, normal, bias);",
    ])  # fmt: skip
    return lines


def _loop(name: str, rows: Sequence[tuple[int, ...]], body: Sequence[str]) -> list[str]:
    table = ", ".join(f"vec4i({', '.join(map(str, row))})" for row in rows)
    return [
        f"  var {name} = array<vec4i, {len(rows)}>({table});",
        f"  for (var k = 0; k < {len(rows)}; k++) {{",
        f"    let call = {name}[k];",
        *(f"    {line}" for line in body),
        "  }",
    ]
