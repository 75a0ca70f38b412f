"""Glass balls on the GPU: a record and a layer of the table for each lamp and ball."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.gpu.device import Gpu
from andon.gpu.textures import make_texture, uniform_buffer, write_buffer
from andon.lamps import DirectionalLamp, GoniometricLamp, Lamp, PointLamp, SpotLamp
from andon.transport.direct.balls.model import GlassBall, served_balls
from andon.transport.direct.balls.records import BALL_RECORD, MAX_PAIRS
from andon.transport.direct.balls.reference import straight_transmittance, table_of
from andon.transport.direct.balls.table import CELLS, KNEE, ROWS, BallTable

__all__ = ["BALLS", "NO_BALLS", "PAIRS", "BallBuffers", "pairs_code"]

NO_BALLS = "andon/transport/direct/balls/none.wgsl"
BALLS = "andon/transport/direct/balls/balls.wgsl"
PAIRS = "andon/transport/direct/balls/pairs.wgsl"

# The brightest cell holds all of the flux: 2π over the solid angle of a cell of 2.6 mrad, 3e5. In
# these units that is far below the end of half floats, and 1e-3 far above their beginning.
LIGHT_SCALE = 64.0


class BallBuffers:
    """Records and tables of all pairs of lamps and balls; names and numbers stay, places move.

    Attributes
    ----------
    variants : of shaders that import direct.wgsl; empty where no lamp has a ball.
    resources : bindings 10 and 11 of group 1; empty likewise.
    """

    def __init__(
        self,
        gpu: Gpu,
        lamps: Sequence[Lamp],
        balls: Sequence[GlassBall],
        tables: Mapping[str, tuple[int, int, int]],
    ) -> None:
        self.gpu, self._held = gpu, dict[int, BallTable]()
        self._count = len(_pairs(lamps, balls))
        self.variants: dict[str, str] = {}
        self.resources: dict[int, tuple[str, Any]] = {}
        if not self._count:
            return
        if self._count > MAX_PAIRS:
            raise InputError(
                f"{self._count} pairs of a lamp and a glass ball, at most {MAX_PAIRS} are rendered",
                field="glass.casts_light",
                remedy="set it to false for some balls",
            )
        self._records = uniform_buffer(gpu, BALL_RECORD.dtype.itemsize * MAX_PAIRS, "balls")
        self._tables = make_texture(
            gpu, "rgba16float", CELLS, ROWS, layers=self._count, label="balls"
        )
        self.variants = {NO_BALLS: BALLS, PAIRS: pairs_code(lamps, balls, tables)}
        self.resources = {
            10: ("uniform", self._records),
            11: ("float array", self._tables.view),
        }

    def update(self, lamps: Sequence[Lamp], balls: Sequence[GlassBall]) -> None:
        """Takes lamps and balls of a moment; makes the tables of those that came nearer or went."""
        pairs = _pairs(lamps, balls)
        if len(pairs) != self._count:
            raise ValueError(f"{len(pairs)} pairs of lamp and ball, {self._count} at the start")
        if not pairs:
            return
        # Not np.concatenate: it drops the padding between fields.
        records = np.zeros(len(pairs), BALL_RECORD.dtype)
        for row, (lamp, ball) in enumerate(pairs):
            records[row] = _record(lamp, ball)[0]
        write_buffer(self.gpu, self._records, records)
        for layer, (lamp, ball) in enumerate(pairs):
            if ball.holds(lamp):
                continue
            table = table_of(ball, lamp)
            if self._held.get(layer) is not table:
                self._tables.write(_texels(table), layer)
                self._held[layer] = table


def pairs_code(
    lamps: Sequence[Lamp], balls: Sequence[GlassBall], tables: Mapping[str, tuple[int, int, int]]
) -> str:
    """The module that stands in for pairs.wgsl; `tables` as in `sum_of_lamps`."""
    first, ranges, shares = 0, list[str](), list[str]()
    for number, lamp in enumerate(lamps):
        count = len(served_balls(lamp, balls))
        if not count:
            continue
        ranges.append(f"    case {number}: {{ return vec2i({first}, {first + count}); }}")
        first += count
        share = _emitted(number, lamp, tables)
        if share:
            shares.append(f"    case {number}: {{ {share} }}")
    return "\n".join([
        f"const CELLS: i32 = {CELLS};",
        f"const ROWS: i32 = {ROWS};",
        f"const KNEE: f32 = {KNEE};",
        f"const LIGHT_SCALE: f32 = {LIGHT_SCALE};",
        "fn pairs_of(lamp: i32) -> vec2i {",
        "  switch lamp {", *ranges, "    default: { return vec2i(0); }", "  }",
        "}",
        "fn emitted_share(lamp: i32, direction: vec3f) -> f32 {",
        "  switch lamp {", *shares, "    default: { return 1.0; }", "  }",
        "}",
    ])  # fmt: skip


def _emitted(number: int, lamp: Lamp, tables: Mapping[str, tuple[int, int, int]]) -> str:
    record = f"lamps[{number}]"
    if isinstance(lamp, SpotLamp):
        return f"return cone_ramp({number}, dot({record}.axis, direction));"
    if isinstance(lamp, GoniometricLamp):
        axes = ", ".join(f"dot(direction, {record}.{axis})" for axis in ("right", "down", "axis"))
        first, rows, columns = tables[lamp.name]
        return f"return relative_intensity({first}, {rows}, {columns}, vec3f({axes}));"
    return ""


def _pairs(lamps: Sequence[Lamp], balls: Sequence[GlassBall]) -> list[tuple[Lamp, GlassBall]]:
    return [(lamp, ball) for lamp in lamps for ball in served_balls(lamp, balls)]


def _record(lamp: Lamp, ball: GlassBall) -> NDArray[Any]:
    if ball.holds(lamp):
        return BALL_RECORD.pack(radius_m=-1.0)
    distance = 0.0
    if not isinstance(lamp, DirectionalLamp):
        assert isinstance(lamp, PointLamp)
        distance = float(np.linalg.norm(ball.centre_m - lamp.position_m))
    return BALL_RECORD.pack(
        centre=ball.centre_m,
        radius_m=ball.radius_m,
        axis=ball.axis(lamp),
        lamp_vergence=ball.lamp_vergence(lamp),
        straight=straight_transmittance(ball),
        at_centre=1 / distance**2 if distance else 1.0,
        lamp_distance_m=distance,
    )


def _texels(table: BallTable) -> NDArray[np.float16]:
    texels = np.concatenate([table.light, table.lean[..., None]], axis=-1) / LIGHT_SCALE
    return texels.astype(np.float16)
