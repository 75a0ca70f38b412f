"""WGSL against the reference."""

import numpy as np
import pytest

from andon.harmonics import basis
from direct.shader_functions import Caller

from .quadrature import units


@pytest.mark.parametrize(("terms", "bands"), [("low", slice(0, 9)), ("high", slice(16, 25))])
def test_terms(gpu, terms, bands):
    normals = units(200, 9)
    parts = [
        Caller(gpu, "andon/harmonics/harmonics.wgsl", expression, 1, 200)(normals)
        for expression in (
            f"{terms}_terms(x[0].xyz).a",
            f"{terms}_terms(x[0].xyz).b",
            f"vec4f({terms}_terms(x[0].xyz).c)",
        )
    ]
    given = np.concatenate([parts[0], parts[1], parts[2][:, :1]], axis=1)
    np.testing.assert_allclose(given, basis(normals, 4)[:, bands], atol=2e-6)
