"""WGSL for just the lamps of a frame: no loops over them, no branches, constants as constants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from andon.lamps import AnyAreaLamp, Lamp
from andon.transport.direct.records import form_of
from andon.transport.direct.soft import probes

__all__ = ["sum_of_lamps"]


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
) -> str:
    """The module that stands in for sum.wgsl.

    Parameters
    ----------
    bodies : names of the luminous bodies; number 0 in the shader is nobody.
    layers, samples : lamp name → first layer of its shadow map, or first of its sample points.
    edges : lamp name → first and count of the edges of a polygon or mesh lamp.
    tables : lamp name → first value, rows and columns of a luminaire's distribution.
    triangles : how many cast shadows.
    """
    lines = [
        f"const MAP_SIZE: f32 = {float(map_size)};",
        f"const SOFT_MAP_SIZE: f32 = {float(soft_map_size)};",
        f"const TRIANGLES: i32 = {triangles};",
        "fn illuminance(position: vec3f, normal: vec3f, bias: f32, body: u32) -> vec3f {",
        "  var total = vec3f(0.0);",
    ]
    for number, lamp in enumerate(lamps):
        if isinstance(lamp, AnyAreaLamp):
            term = _area_term(number, lamp, bodies, samples, edges)
        else:
            term = _term(number, lamp, layers, tables)
        lines.append(f"  total += {term};")
    return "\n".join([*lines, "  return total;", "}"])


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


def _area_term(
    number: int,
    lamp: AnyAreaLamp,
    bodies: Sequence[str],
    samples: Mapping[str, int],
    edges: Mapping[str, tuple[int, int]],
) -> str:
    form = form_of(lamp)
    place = "position, normal, bias"
    term = f"{form}_illuminance({number}, position, normal)"
    if lamp.name in edges:
        first, count = edges[lamp.name]
        term = f"{form}_illuminance({number}, {first}, {count}, position, normal)"
    if lamp.shadow is not None:
        first, count = samples[lamp.name], lamp.shadow.samples
        term = f"softened({term}, {first}, {count}, {probes(count)}, {2 * first}, {place})"
    if lamp.body in bodies:
        term += f" * select(1.0, 0.0, body == {list(bodies).index(lamp.body) + 1}u)"
    return term
