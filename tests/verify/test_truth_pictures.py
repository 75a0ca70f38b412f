"""Whole pictures of glass by Mitsuba: what they are of, the right way up, in cd/m²."""

import numpy as np
import pytest

from andon.errors import InputError
from andon.glass.model import Backdrop, Ball, Slab, Solid, Sticker
from andon.lamps import PointLamp
from andon.spaces import look_at, pinhole_view
from andon.verify.truths.mitsuba_pictures import Surroundings, path_traced
from requirements import required

required("mitsuba")

EYE = np.array([0.0, 0.0, 0.4])
VIEW = pinhole_view(64, 36, 88.0, look_at(EYE, np.zeros(3)))
OPTIONS = {"pupil_m": 1e-5, "focus_dioptres": 2.5, "samples": 32}


def backdrop(picture):
    return Backdrop(
        "texture",
        picture=np.asarray(picture, np.float32),
        centre_m=np.array([0, 0, -0.2]),
        right_m=np.array([0.4, 0, 0]),
        up_m=np.array([0, 0.3, 0]),
    )


def quarters():
    """Red above left, green above right, blue below left, dark below right."""
    picture = np.zeros((40, 40, 3))
    picture[:20, :20, 0] = picture[:20, 20:, 1] = picture[20:, :20, 2] = 1
    return backdrop(picture)


def test_a_ball_turns_what_is_behind_it_upside_down():
    glass = Solid("ball", Ball(0.075), backdrop=quarters())
    picture = path_traced([glass], VIEW, Surroundings(white_cd_m2=200.0), **OPTIONS)
    beside = picture[2, 2], picture[2, -3], picture[-3, 2], picture[-3, -3]
    np.testing.assert_allclose(beside, 200 * np.array([*np.eye(3), np.zeros(3)]), rtol=1e-3)
    through = picture[22, 37]  # below right of the middle: the upper left is seen, less 8 %
    assert through[0] == pytest.approx(200 * 0.92, rel=0.08)
    assert through[1:].max() < 20


def test_a_label_is_where_it_is_stuck_and_lit():
    cover = np.zeros((32, 64, 4), np.float32)
    cover[:, 32:, :] = 1.0  # what is seen from +x
    dark = backdrop(np.zeros((2, 2, 3)))
    glass = Solid("ball", Ball(0.075), sticker=Sticker(cover, 0.8), backdrop=dark)
    lamp = PointLamp("lamp", np.array([0.0, 0.0, 2.0]), np.full(3, 400.0))
    picture = path_traced([glass], VIEW, Surroundings((lamp,)), **(OPTIONS | {"samples": 512}))
    right, left = picture[14:22, 36:40].mean(), picture[14:22, 24:28].mean()
    # α·E/π, the label faces the lamp, but for some degrees.
    assert right == pytest.approx(0.2 * 400 / 1.925**2 / np.pi, rel=0.15)
    assert left < 0.3 * right


def test_what_it_is_not_told_is_refused():
    labelled = Sticker(np.ones((2, 4, 4), np.float32), 0.8)
    for solid in (
        Solid("slab", Slab(np.full(3, 0.05)), sticker=labelled, backdrop=quarters()),
        Solid("ball", Ball(0.05), interfaces=1, backdrop=quarters()),
        Solid("ball", Ball(0.05), absorption_per_m=(1.0, 0, 0), backdrop=quarters()),
        Solid("ball", Ball(0.05), backdrop=Backdrop("surface")),
    ):
        with pytest.raises(InputError):
            path_traced([solid], VIEW, Surroundings(), **OPTIONS)
