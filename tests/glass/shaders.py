"""Calls the functions of the glass's shaders on rows of numbers."""

import numpy as np

from andon.glass.plan import variants_of
from andon.glass.records import STRUCTS
from andon.glass.stage import SolidBuffers
from direct.shader_functions import Caller

__all__ = ["PATHS", "call", "of_solids"]

PATHS = "andon/glass/paths.wgsl"


def call(gpu, module, expression, *columns, statements=""):
    """(n, 4) of `expression` over the rows of `columns`; modules that need no solids."""
    caller = Caller(gpu, module, expression, len(columns), len(columns[0]), statements=statements)
    return caller(*columns).astype(float)


def of_solids(gpu, solids, expressions, *columns, statements=""):
    """For each of `expressions` an (n, 4), in a shader of these solids."""
    shared = SolidBuffers(gpu, solids)
    declared = """
@group(0) @binding(2) var<uniform> solids: array<SolidRecord, 8>;
@group(0) @binding(5) var nodes: texture_2d<f32>;
@group(0) @binding(6) var triangles: texture_2d<f32>;
"""
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
            resources=shared.resources,
            structs=STRUCTS,
            variants=variants_of(solids),
        )
        results.append(caller(*columns).astype(np.float64))
    return results
