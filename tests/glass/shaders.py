"""Calls the functions of the glass's shaders on rows of numbers."""

import numpy as np

from andon.glass.plan import variants_of
from andon.glass.records import STRUCTS, pack_solids
from andon.gpu.textures import uniform_buffer, write_buffer
from direct.shader_functions import Caller

__all__ = ["PATHS", "call", "of_solids"]

PATHS = "andon/glass/paths.wgsl"


def call(gpu, module, expression, *columns, statements=""):
    """(n, 4) of `expression` over the rows of `columns`; modules that need no solids."""
    caller = Caller(gpu, module, expression, len(columns), len(columns[0]), statements=statements)
    return caller(*columns).astype(float)


def of_solids(gpu, solids, expressions, *columns, statements=""):
    """For each of `expressions` an (n, 4), in a shader of these solids."""
    buffer = uniform_buffer(gpu, STRUCTS["SolidRecord"].dtype.itemsize * 8, "solids")
    declared = "@group(0) @binding(1) var<uniform> solids: array<SolidRecord, 8>;"
    none = [(0, 0)] * len(solids)
    write_buffer(gpu, buffer, pack_solids(solids, offsets=none))
    results = []
    for expression in expressions:
        caller = Caller(
            gpu,
            PATHS,
            expression,
            len(columns),
            len(columns[0]),
            statements=statements,
            declarations=declared,
            resources={1: ("uniform", buffer)},
            structs=STRUCTS,
            variants=variants_of(solids),
        )
        results.append(caller(*columns).astype(np.float64))
    return results
