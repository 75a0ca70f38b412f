"""Other programs' formulas, written down here from their sources, fed with what we export.

Each must return our irradiance E(n), or E(n)/π where that is what it returns, to the digits that
its own constants have.
"""

import numpy as np
import pytest

from andon.errors import InputError
from andon.harmonics import basis, irradiance
from andon.harmonics.conventions import (
    cmgen_text,
    from_cmgen_text,
    from_filament,
    from_gltf,
    from_three,
    from_unity,
    to_filament,
    to_gltf,
    to_three,
    to_unity,
)

from .quadrature import units

NORMALS = units(50, 1)
LIGHT = np.random.default_rng(2).normal(size=(9, 3))
LIGHT[0] += 5
E = irradiance(LIGHT, NORMALS)

PAIRS = {
    "three": (to_three, from_three),
    "gltf": (to_gltf, from_gltf),
    "unity": (to_unity, from_unity),
    "filament": (to_filament, from_filament),
}


@pytest.mark.parametrize("name", PAIRS)
def test_there_and_back(name):
    there, back = PAIRS[name]
    many = np.random.default_rng(3).normal(size=(4, 9, 3))
    np.testing.assert_allclose(back(there(many)), many, rtol=1e-14)
    np.testing.assert_allclose(there(many)[2], there(many[2]), rtol=0)
    higher = np.concatenate([many, np.ones((4, 16, 3))], axis=1)
    np.testing.assert_array_equal(there(higher), there(many))
    with pytest.raises(InputError, match="must be finite"):
        back(there(many) * np.nan)
    with pytest.raises(InputError, match=r"must be \(\.\.\., "):
        back(np.ones((2, 2)))
    with pytest.raises(InputError, match="must be numbers"):
        back([["a"]])


# ── three.js ────────────────────────────────────────────────────────────────────────────────────


def sh_get_irradiance_at(normal, coefficients):
    """three.js r187, lights_pars_begin.glsl.js."""
    x, y, z = normal
    c = coefficients
    result = c[0] * 0.886227
    result = result + c[1] * 2.0 * 0.511664 * y
    result = result + c[2] * 2.0 * 0.511664 * z
    result = result + c[3] * 2.0 * 0.511664 * x
    result = result + c[4] * 2.0 * 0.429043 * x * y
    result = result + c[5] * 2.0 * 0.429043 * y * z
    result = result + c[6] * (0.743125 * z * z - 0.247708)
    result = result + c[7] * 2.0 * 0.429043 * x * z
    return result + c[8] * 0.429043 * (x * x - y * y)


def test_three():
    numbers = to_three(LIGHT)
    assert numbers.shape == (27,)
    vectors = [numbers[3 * i : 3 * i + 3] for i in range(9)]  # fromArray
    drawn = [sh_get_irradiance_at(n, vectors) for n in NORMALS]
    np.testing.assert_allclose(drawn, E, atol=2e-5)


# ── glTF ────────────────────────────────────────────────────────────────────────────────────────


def test_gltf_by_its_source():
    """Ramamoorthi & Hanrahan 2001, equation 6: E = Σ E_lm·Y_lm."""
    drawn = basis(NORMALS) @ to_gltf(LIGHT)
    np.testing.assert_allclose(drawn, E, atol=1e-12)


# Babylon.js, sphericalPolynomial.ts: SH3ylmBasisConstants and the terms behind them.
BABYLON_CONSTANTS = [
    np.sqrt(1 / (4 * np.pi)),
    -np.sqrt(3 / (4 * np.pi)),
    np.sqrt(3 / (4 * np.pi)),
    -np.sqrt(3 / (4 * np.pi)),
    np.sqrt(15 / (4 * np.pi)),
    -np.sqrt(15 / (4 * np.pi)),
    np.sqrt(5 / (16 * np.pi)),
    -np.sqrt(15 / (4 * np.pi)),
    np.sqrt(15 / (16 * np.pi)),
]


def polynomial(normal, c):
    """The nine terms as Filament's and Babylon's shaders have them."""
    x, y, z = normal
    return (
        c[0]
        + c[1] * y
        + c[2] * z
        + c[3] * x
        + c[4] * (y * x)
        + c[5] * (y * z)
        + c[6] * (3.0 * z * z - 1.0)
        + c[7] * (z * x)
        + c[8] * (x * x - y * y)
    )


def test_gltf_in_babylon():
    """convertIrradianceToLambertianRadiance, preScaleForRendering, computeEnvironmentIrradiance."""
    coefficients = to_gltf(LIGHT, condon_shortley=True) / np.pi
    scaled = [c * k for c, k in zip(coefficients, BABYLON_CONSTANTS, strict=True)]
    drawn = [polynomial(n, scaled) for n in NORMALS]
    np.testing.assert_allclose(drawn, E / np.pi, atol=1e-12)
    back = from_gltf(to_gltf(LIGHT, condon_shortley=True), condon_shortley=True)
    np.testing.assert_allclose(back, LIGHT, rtol=1e-14)


# ── Unity ───────────────────────────────────────────────────────────────────────────────────────


def shade_sh9(normal, sh):
    """UnityCG.cginc: SHEvalLinearL0L1 + SHEvalLinearL2, with the shader's seven vectors."""
    x, y, z = normal
    a = [[s[3], s[1], s[2], s[0] - s[6]] for s in sh]
    b = [[s[4], s[5], 3 * s[6], s[7]] for s in sh]
    c = [s[8] for s in sh]
    linear = [np.dot(row, [x, y, z, 1.0]) for row in a]
    square = [np.dot(row, [x * y, y * z, z * z, z * x]) for row in b]
    return np.array(linear) + square + np.array(c) * (x * x - y * y)


@pytest.mark.parametrize(("mirror", "flip"), [("z", [1, 1, -1]), ("x", [-1, 1, 1])])
def test_unity(mirror, flip):
    """In Unity's left-handed world the same normal has its z (or x) turned round."""
    sh = to_unity(LIGHT, mirror=mirror)
    assert sh.shape == (3, 9)
    drawn = [shade_sh9(n * flip, sh) for n in NORMALS]
    np.testing.assert_allclose(drawn, E / np.pi, atol=1e-12)
    np.testing.assert_allclose(from_unity(sh, mirror=mirror), LIGHT, rtol=1e-14)


def test_unitys_ambient_light():
    """AddAmbientLight(white) is 1 in the first number: a sky of luminance 1."""
    sky = np.zeros((9, 3))
    sky[0] = np.sqrt(4 * np.pi)
    np.testing.assert_allclose(to_unity(sky), np.eye(9)[[0] * 3], atol=1e-15)


def test_unitys_axes():
    with pytest.raises(InputError, match="mirror: must be x or z, got 'y'"):
        to_unity(LIGHT, mirror="y")


# ── Filament ────────────────────────────────────────────────────────────────────────────────────


def test_filament():
    drawn = [polynomial(n, to_filament(LIGHT)) for n in NORMALS]
    np.testing.assert_allclose(drawn, E / np.pi, atol=1e-12)


def cmgen_sums(directions, weights, radiance, *, irradiance):
    """CubemapSH::computeSH with TSH's basis: the signs are Condon's and Shortley's."""
    x, y, z = directions.T
    root = 1 / (2 * np.sqrt(np.pi))
    terms = [
        root + 0 * x,
        -np.sqrt(3) * y * root,
        np.sqrt(3) * z * root,
        -np.sqrt(3) * x * root,
        np.sqrt(15) * y * x * root,
        -np.sqrt(15) * y * z * root,
        np.sqrt(5) * (3 * z * z - 1) * root / 2,
        -np.sqrt(15) * z * x * root,
        np.sqrt(15) * (x * x - y * y) * root / 2,
    ]
    sums = (np.stack(terms) * weights) @ radiance
    if irradiance:
        sums *= np.array([np.pi, *[2 * np.pi / 3] * 3, *[np.pi / 4] * 5])[:, None]
    return sums


NAMES = ["L00", "L1-1", "L10", "L11", "L2-2", "L2-1", "L20", "L21", "L22"]


@pytest.mark.parametrize(("irradiance", "kind"), [(False, ""), (True, ", irradiance")])
def test_cmgens_plain_text(irradiance, kind):
    from .quadrature import gauss_fourier

    directions, weights = gauss_fourier(8)
    sums = cmgen_sums(directions, weights, basis(directions) @ LIGHT, irradiance=irradiance)
    text = "\n".join(
        f"({r:18.15f}, {g:18.15f}, {b:18.15f}); // {name}{kind}"
        for name, (r, g, b) in zip(NAMES, sums, strict=True)
    )
    np.testing.assert_allclose(from_cmgen_text(text), LIGHT, atol=1e-13)


def test_cmgens_text_for_shaders():
    text = cmgen_text(LIGHT)
    first = text.splitlines()[0]
    assert first.endswith("); // L00, irradiance, pre-scaled base")
    np.testing.assert_allclose(from_cmgen_text(text), LIGHT, atol=1e-13)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t.replace("(", "[", 1), "line 1 of cmgen's text: must be"),
        (lambda t: "\n".join(t.splitlines()[:8]), "nine lines L00 … L22 in order"),
        (lambda t: t.replace("L10", "L11", 1), "nine lines L00 … L22 in order"),
        (lambda t: t.replace(", pre-scaled base", "", 1), "lines are of several kinds"),
        (lambda t: t.replace("pre-scaled", "scaled"), "an unknown kind"),
        (lambda t: t.replace(t[1:19], "      1.2.3       ", 1), "must be a number, got '1.2.3'"),
    ],
)
def test_what_cmgen_never_wrote(change, message):
    with pytest.raises(InputError, match=message):
        from_cmgen_text(change(cmgen_text(LIGHT)))
