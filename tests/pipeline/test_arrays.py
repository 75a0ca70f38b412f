"""What `andon.relight` says to arguments that are none: one line with field, rule and remedy."""

import numpy as np
import pytest

import andon
from andon.errors import InputError

VIEW = andon.View("pinhole", 8, 6, 5.0, 5.0, 3.5, 2.5)
LAMP = andon.PointLamp("bulb", np.array([0, 0, -1.0]), np.ones(3))
PHOTO, DEPTH = np.full((6, 8, 3), 9, np.uint8), np.full((6, 8), 2.0)
CURVE = andon.SurfaceCurve(np.array([0.0, 100]), np.array([[0.0] * 3, [0.5] * 3]))
CASES = [
    ("photo", PHOTO.tolist(), r"photo: must be an array \(H, W, 3\), got a list; e\.g\. np\.asarr"),
    ("photo", None, r"photo: must be an array \(H, W, 3\), got None"),
    ("photo", "photo.png", r"photo: must be an array \(H, W, 3\), got 'photo\.png'"),
    ("photo", PHOTO.astype(int), r"photo: must be \(H, W, 3\) uint8, uint16 or float, got .*int64"),
    ("view", None, r"view: must be an andon\.View, got None; e\.g\. andon\.View\("),
    ("view", (8, 6), r"view: must be an andon\.View, got a tuple"),
    ("lamps", ["kind=point"], r"lamps\[0\]: must be a lamp, got 'kind=point'; e\.g\. andon\.Point"),
    ("lamps", [LAMP, None], r"lamps\[1\]: must be a lamp, got None"),
    ("depth_m", None, r"depth_m: must be an array \(6, 8\) of metres, got None"),
    ("depth_m", "depth.npy", r"depth_m: must be an array .* got 'depth\.npy'"),
    ("depth_m", [[1.0, 2.0], [3.0]], r"depth_m: must be an array .* got a list"),
    ("depth_m", DEPTH.T, r"depth_m: .* \(6, 8\) .*the view's \(height, width\), got \(8, 6\)"),
    ("depth_m", DEPTH[..., None], r"depth_m: .* got \(6, 8, 1\)"),
    ("depth_m", DEPTH * 1j, r"depth_m: must be an array .* got \(6, 8\) complex128"),
    ("ambient_lux", None, r"ambient_lux: must be a number, three channels or .* got None"),
    ("ambient_lux", "bright", r"ambient_lux: must be a number, .* got 'bright'"),
    ("dimming", "half", r"dimming: must be a number or three channels, got 'half'"),
    ("response", "srgb", r"response: must be an andon\.Response, got 'srgb'; e\.g\."),
    ("reflectance_map", "rho.png", r"reflectance_map: must be an array \(6, 8, 3\) of linear ρ"),
    ("reflectance_map", DEPTH, r"reflectance_map: must be an array .* got \(6, 8\)$"),
    ("curves", "f.csv", r"curves: must be an andon\.SurfaceCurve, or a list of pairs .*'f\.csv'"),
    ("curves", [CURVE], r"curves\[0\]: must be a pair \(curve, mask\), got a SurfaceCurve"),
    ("curves", [(None, DEPTH > 0)], r"curves\[0\]: must be an andon\.SurfaceCurve, got None"),
    ("curves", [(CURVE, DEPTH)], r"curves\[0\]: the mask must be \(6, 8\) bool, got .*float64"),
    ("curves", [(CURVE, DEPTH < 0)], r"curves\[0\]: the mask selects no pixel"),
    ("photometry", "lux", r"photometry: must be absolute or relative, got 'lux'"),
]  # fmt: skip


@pytest.mark.parametrize(("field", "value", "message"), CASES)
def test_what_is_none(field, value, message):
    given = {"photo": PHOTO, "view": VIEW, "lamps": [LAMP]}
    more = {"depth_m": DEPTH, "ambient_lux": 100.0, "engine": "reference"}
    (given if field in given else more)[field] = value
    with pytest.raises(InputError, match=message):
        andon.relight(*given.values(), **more)


def test_lists_of_numbers_will_do_where_numbers_are_meant():
    andon.relight(
        PHOTO, VIEW, [LAMP], depth_m=DEPTH.tolist(), ambient_lux=[90, 100, 110],
        dimming=[1, 0.5, 0], engine="reference",
    )  # fmt: skip
