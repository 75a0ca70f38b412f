"""The --lamp option."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from andon.errors import InputError
from andon.lamps import parse_lamp_option
from andon.scene import scene_from_dict

BULB = {
    "kind": "point",
    "position": [0.5, 0.2, -1.5],
    "flux_lm": 800,
    "temperature_k": 2700,
}


@pytest.mark.parametrize(
    "text",
    [
        "kind=point,position=0.5,0.2,-1.5,flux_lm=800,temperature_k=2700",
        "kind=point,position=0.5;0.2;-1.5,flux_lm=800,temperature_k=2700",
        "kind=point,position=[0.5,0.2,-1.5],flux_lm=800,temperature_k=2700",
        "kind=point,position=[0.5 0.2 -1.5],flux_lm=800,temperature_k=2700",
        " kind = point , position = 0.5, 0.2, -1.5 , flux_lm = 800 , temperature_k = 2.7e3 ",
        "flux_lm=800,position=5e-1 .2 -1.5,temperature_k=2700,kind=point",
    ],
)
def test_spellings(text):
    assert parse_lamp_option(text) == BULB
    (lamp,) = scene_from_dict({"lamp": [parse_lamp_option(text)]}).lamp
    assert lamp.position == (0.5, 0.2, -1.5)


def test_texts_flags_and_inner_tables():
    table = parse_lamp_option(
        "kind=point,name=my lamp,position=0,0,0,intensity_cd=1,shadow=false,"
        "shell.radius_m=0.1,shell.transmittance=0.2,0.3,0.4"
    )
    assert table["name"] == "my lamp"
    assert table["shadow"] is False
    assert table["shell"] == {"radius_m": 0.1, "transmittance": [0.2, 0.3, 0.4]}
    scene_from_dict({"lamp": [table]})


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "must be key=value"),
        ("point", "must be key=value"),
        ("position=0,0,0", "kind is required"),
        ("kind=pont,position=0,0,0", "did you mean 'point'?"),
        ("kind=3", "must be one of point"),
        ("kind=point,positon=0,0,0", "did you mean 'position'?"),
        ("kind=point,qqqq=0", "known keys: "),
        ("kind=point,position=", "has no value"),
        ("kind=point,position=1,1,1,position=2,2,2", "is given twice"),
        ("kind=point,position=1,position.x=2", "has a value already"),
        ("kind=bulb,position=0,0,0", "--lamp: kind: bulb is a preset; write preset=bulb"),
        (
            "kind=point,shell={radius_m=0.1, transmittance=0.6},flux_lm=9",
            "--lamp: shell: takes no table in braces; write shell.radius_m=0.1,shell.tran",
        ),
        (
            "kind=point,shell={radius_m=0.1,transmittance=[0.6,0.5,0.4]},flux_lm=9",
            "write shell.radius_m=0.1,shell.transmittance=[0.6,0.5,0.4]",
        ),
        ("kind=point,shell = { radius_m=0.1", "write shell.radius_m=0.1"),
        (
            "kind=sphere,position=0,0,0,radius_m=1,shell.radius_m=2",
            "kind 'sphere' has no key 'shell'; only point, spot and ies have a shell",
        ),
        ("kind=point,a b=1", "must be key=value,key=value…, got 'a b=1'"),
        ("kind=point," + "x" * 10_000, "at most"),
    ],
)
def test_mistakes_are_named(text, expected):
    with pytest.raises(InputError) as caught:
        parse_lamp_option(text)
    assert expected in str(caught.value)
    assert str(caught.value).startswith("--lamp")
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 500


@given(st.text(alphabet="kindpointposition=,;.[] 0123456789-einfa\n", max_size=60))
def test_any_text_gives_a_table_or_a_clear_error(text):
    try:
        table = parse_lamp_option(text)
    except InputError as error:
        assert "\n" not in str(error)  # noqa: PT017
    else:
        assert "kind" in table


def test_braces_in_a_name_are_a_name():
    assert parse_lamp_option("kind=point,name={a},flux_lm=1")["name"] == "{a}"


@given(st.tuples(*[st.floats(allow_nan=False, allow_infinity=False)] * 3))
def test_numbers_come_back_exactly(position):
    text = "kind=point,position=" + ",".join(map(repr, position))
    assert tuple(parse_lamp_option(text)["position"]) == position


def test_points_are_written_one_after_the_other():
    table = parse_lamp_option("kind=tube,ends=[0,1,-2,1,1,-2],radius_m=0.01,flux_lm=9")
    assert table["ends"] == [[0, 1, -2], [1, 1, -2]]
    table = parse_lamp_option("kind=polygon,vertices=0 0 0 1 0 0 0 1 0,flux_lm=9")
    assert table["vertices"] == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    for text in (
        "[[0,0,0],[1,0,0],[0,1,0]]",
        "[[0, 0, 0], [1, 0, 0] [0, 1, 0]]",
        "[0,0,0],[1 0 0],[0;1;0]",
    ):
        assert parse_lamp_option(f"kind=polygon,vertices={text},flux_lm=9") == table
    short = parse_lamp_option("kind=polygon,vertices=[[0,0,0],[1,0],[0,1,0,0]],flux_lm=9")
    assert short["vertices"] == [[0, 0, 0], [1, 0], [0, 1, 0, 0]]
    odd = parse_lamp_option("kind=polygon,vertices=0 0 0 1,flux_lm=9")
    assert odd["vertices"] == [0, 0, 0, 1]
