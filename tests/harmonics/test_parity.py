"""WGSL against the reference."""

import numpy as np

from andon.harmonics import basis, convolved, irradiance
from direct.shader_functions import Caller

from .quadrature import units


def test_irradiance_l2(gpu):
    generator = np.random.default_rng(7)
    light = generator.normal(size=(200, 9, 3)) * 100
    normals = units(200, 8)
    columns = [normals, *np.moveaxis(convolved(light), 1, 0)]
    terms = ", ".join(f"x[{k}].xyz" for k in range(1, 10))
    caller = Caller(
        gpu,
        "andon/harmonics/harmonics.wgsl",
        f"vec4f(irradiance_l2(array<vec3f, 9>({terms}), x[0].xyz), 0.0)",
        10,
        200,
    )
    given = caller(*columns)[:, :3]
    # float32: some 2⁻²⁴ of each of nine terms.
    scale = np.abs(convolved(light) * np.abs(basis(normals))[..., None]).sum(axis=1)
    assert (np.abs(given - irradiance(light, normals)) <= 4e-7 * scale + 1e-6).all()


def test_terms_of_band_4(gpu):
    normals = units(200, 9)
    module = "andon/harmonics/harmonics.wgsl"
    parts = [
        Caller(gpu, module, expression, 1, 200)(normals)
        for expression in (
            "high_terms(x[0].xyz).a",
            "high_terms(x[0].xyz).b",
            "vec4f(high_terms(x[0].xyz).c)",
        )
    ]
    given = np.concatenate([parts[0], parts[1], parts[2][:, :1]], axis=1)
    np.testing.assert_allclose(given, basis(normals, 4)[:, 16:], atol=2e-6)
