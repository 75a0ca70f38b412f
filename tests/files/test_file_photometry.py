"""IES LM-63 and EULUMDAT: what the numbers mean, symmetries, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from andon.errors import InputError
from andon.files import read_photometry
from photometry_files import ies, ldt


def read(tmp_path, text, name="lamp.ies", encoding="utf-8"):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode(encoding))
    return read_photometry(path)


def test_numbers_of_an_ies_file(tmp_path):
    lamp = read(tmp_path, ies(head="2 1500 3 {v} {h} {type} 1 1 -2 0.5", factors="0.9 1 40"))
    assert lamp.photometry == "C"
    assert lamp.candela[0] == pytest.approx(2.7 * np.array([100, 101, 102, 103]))
    assert lamp.lamp_lumens == 3000
    assert lamp.stated_lumens is None
    assert lamp.watts == 40
    # LM-63: width lies across C = 0, length along it; feet; a diameter is negative.
    assert lamp.opening_m == pytest.approx((0.6096, 0.3048, 0.1524))
    assert lamp.is_round
    assert lamp.manufacturer == "Maker"
    assert lamp.name == "A lamp, continued"
    assert ("TEST", "1") in lamp.keywords


@pytest.mark.parametrize(
    ("first", "factor"),
    [
        (None, 0.5),
        ("IESNA91", 0.5),
        ("IESNA:LM-63-1995", 1),
        ("IESNA:LM-63-2002", 1),
        ("IES:LM-63-2019", 1),
    ],
)
def test_the_second_factor_counts_until_1991(tmp_path, first, factor):
    lamp = read(tmp_path, ies(first=first, factors="1 0.5 9"))
    assert lamp.candela[0, 0] == pytest.approx(100 * factor)


def test_absolute_lumens(tmp_path):
    lamp = read(tmp_path, ies(labels=["[_ABSOLUTELUMENS]9217 LM"]))
    assert (lamp.stated_lumens, lamp.lamp_lumens) == (9217, None)


C_ANGLES = np.array([0.0, 30, 90, 150, 180, 200, 270, 300, 359])


@pytest.mark.parametrize(
    ("planes", "folded"),
    [
        ([0], lambda c: 0 * c),
        ([0, 45, 90], lambda c: np.minimum(c % 180, 180 - c % 180)),
        ([0, 20, 180], lambda c: np.minimum(c, 360 - c)),
        ([90, 120, 270], lambda c: np.where(c < 90, 180 - c, np.where(c > 270, 540 - c, c))),
        ([0, 100, 200, 360], lambda c: c),
        ([0, 90, 180, 270], lambda c: c),
    ],
)
def test_symmetries_of_type_c(tmp_path, planes, folded):
    """Each plane's candela is its own angle: what is read at C must be that of the folded C."""
    values = np.array(planes, float)[:, None] + 1
    if planes[-1] == 270 and planes[0] == 0:
        expected = np.interp(C_ANGLES, [0, 90, 180, 270, 360], [1, 91, 181, 271, 1])
    else:
        expected = folded(C_ANGLES) + 1
    lamp = read(tmp_path, ies(horizontals=planes, candela=values))
    assert lamp.horizontal_degrees[[0, -1]].tolist() == [0, 360]
    assert (np.diff(lamp.horizontal_degrees) > 0).all()
    assert np.interp(C_ANGLES, lamp.horizontal_degrees, lamp.candela[:, 2]) == pytest.approx(
        expected
    )


@pytest.mark.parametrize("kind", [2, 3])
def test_halves_of_types_a_and_b_are_mirrored(tmp_path, kind):
    lamp = read(tmp_path, ies(kind=kind, verticals=(0, 45, 90), horizontals=(0, 90)))
    assert lamp.photometry == {2: "B", 3: "A"}[kind]
    assert lamp.horizontal_degrees.tolist() == [-90, 0, 90]
    assert lamp.vertical_degrees.tolist() == [-90, -45, 0, 45, 90]
    assert lamp.candela[0].tolist() == [112, 111, 110, 111, 112]
    assert lamp.candela[1].tolist() == [102, 101, 100, 101, 102]
    whole = read(tmp_path, ies(kind=kind, verticals=(-90, 0, 90), horizontals=(-90, 0, 90)))
    assert whole.candela[0].tolist() == [100, 101, 102]


def test_free_form(tmp_path):
    """Numbers run over lines, commas separate, DOS ends lines and the file."""
    text = ies(end="\r\n").replace("0 30 60 90", "0,30,\r\n\r\n 60 9.0e1").replace("12.5", "12.5,")
    lamp = read(tmp_path, text + "\x1a")
    assert lamp.vertical_degrees.tolist() == [0, 30, 60, 90]


TILT_TABLE = "1\n3\n0 45 90\n1 0.9 0.8"


def test_tilt(tmp_path):
    lamp = read(tmp_path, ies(tilt=f"TILT=INCLUDE\n{TILT_TABLE}"))
    assert lamp.tilt.lamp_geometry == 1
    assert lamp.tilt.factors.tolist() == [1, 0.9, 0.8]
    (tmp_path / "table.tlt").write_text(TILT_TABLE)
    same = read(tmp_path, ies(tilt="TILT=table.tlt"))
    assert same.tilt.angles_degrees.tolist() == [0, 45, 90]


@pytest.mark.parametrize("name", ["../table.tlt", "/etc/passwd", "missing.tlt", ""])
def test_tilt_files_stay_in_the_folder(tmp_path, name):
    inner = tmp_path / "inner"
    inner.mkdir()
    (tmp_path / "table.tlt").write_text(TILT_TABLE)
    with pytest.raises(InputError):
        read(inner, ies(tilt=f"TILT={name}"))


def test_numbers_of_a_eulumdat_file(tmp_path):
    lamp = read(tmp_path, ldt(conversion="1,5"), "lamp.ldt")
    assert lamp.photometry == "C"
    assert lamp.candela[0] == pytest.approx(1.5 * 2 * np.array([100, 101, 102, 103]))
    assert lamp.stated_lumens == pytest.approx(1600)
    assert lamp.lamp_lumens == 2000
    assert lamp.watts == pytest.approx(15.5)
    # The length of a luminaire lies along C90.
    assert lamp.opening_m == pytest.approx((0.1, 1.0, 0.01))
    assert (lamp.manufacturer, lamp.name) == ("Maker", "A luminaire")
    alternatives = read(tmp_path, ldt(sets=3), "lamp.ldt")
    assert alternatives.candela[0, 0] == pytest.approx(200)
    assert read(tmp_path, ldt(lamps="-1"), "lamp.ldt").lamp_lumens is None


EIGHT = (0, 45, 90, 135, 180, 225, 270, 315)


@pytest.mark.parametrize(
    ("symmetry", "stored", "folded"),
    [
        (0, EIGHT, lambda c: c),
        (1, (0,), lambda c: 0 * c),
        (2, (0, 45, 90, 135, 180), lambda c: np.minimum(c, 360 - c)),
        (3, (270, 315, 0, 45, 90), lambda c: np.where((c > 90) & (c < 270), (180 - c) % 360, c)),
        (4, (0, 45, 90), lambda c: np.minimum(c % 180, 180 - c % 180)),
    ],
)
def test_symmetries_of_eulumdat(tmp_path, symmetry, stored, folded):
    values = np.array(stored, float)[:, None] + 1
    text = ldt(symmetry=symmetry, planes=EIGHT, candela=values, lumens="1000")
    lamp = read(tmp_path, text, "lamp.ldt")
    assert lamp.horizontal_degrees[[0, -1]].tolist() == [0, 360]
    at = np.array(EIGHT, float)
    got = np.interp(at, lamp.horizontal_degrees, lamp.candela[:, 1])
    assert got == pytest.approx(folded(at) + 1)
    assert lamp.candela[0] == pytest.approx(lamp.candela[-1])


@pytest.mark.parametrize("page", ["utf-8", "cp1252", "cp850", "utf-8-sig"])
def test_code_pages(tmp_path, page):
    lamp = read(tmp_path, ldt(name="Büroleuchte für Säle"), "lamp.ldt", page)
    assert lamp.name == "Büroleuchte für Säle"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (ies(candela=-1), "line 11, candela value 1 of 4: must be ≥ 0, got -1"),
        (ies(candela=np.nan), "must be a finite number, got 'nan'"),
        (ies(candela=0), "dark"),
        (ies(head="1 -1 1e308 {v} {h} 1 2 0 0 0"), "too large"),
        (ies(head="1 -1 1e999 {v} {h} 1 2 0 0 0"), "line 7, multiplier: must be a finite"),
        (ies(head="1 -1 0 {v} {h} 1 2 0 0 0"), "multiplier: must be > 0"),
        (ies(head="1 -5 1 {v} {h} 1 2 0 0 0"), "−1 for absolute"),
        (ies(head="0 1 1 {v} {h} 1 2 0 0 0"), "number of lamps"),
        (ies(head="1 -1 1 {v} {h} 4 2 0 0 0"), "photometric type: must be a whole number of 1…3"),
        (ies(head="1 -1 1 {v} {h} 1 3 0 0 0"), "unit of lengths"),
        (ies(head="1 -1 1 {v}.5 {h} 1 2 0 0 0"), "count of vertical angles"),
        (ies(head="1 -1 1 99999999 {h} 1 2 0 0 0"), "count of vertical angles: must be a whole"),
        (ies(head="1 -1 1 3000 3000 1 2 0 0 0"), "at most 1048576 candela values"),
        (ies(head="1 -1 1 5 {h} 1 2 0 0 0"), "ends before candela value 4 of 5"),
        (ies(head="1 -1 1 3 {h} 1 2 0 0 0"), "must end here"),
        (ies(verticals=(0, 60, 30, 90)), "vertical angles: must rise, got 60 before 30"),
        (ies(verticals=(0, 0, 30, 90)), "must rise"),
        (ies(verticals=(0, 30, 60, 190)), "must be 0…180°, got 190"),
        (ies(verticals=(10, 30, 60, 90)), "must begin with 0 or 90"),
        (ies(horizontals=(0, 90, 190)), "0…90, 0…180, 90…270 or 0…360°"),
        (ies(horizontals=(45, 90)), "horizontal angles"),
        (ies(kind=2, horizontals=(-100, 100)), "must be -90…90°, got -100"),
        (ies(kind=3, horizontals=(0,)), "need two or more"),
        (ies(factors="0 1 1"), "ballast factor"),
        (ies(factors="1 1 -1"), "watts"),
        (ies(tilt="TILT=INCLUDE\n4"), "lamp-to-luminaire geometry"),
        (ies(tilt="TILT=INCLUDE\n1 999999"), "count of tilt angles"),
        ("IESNA:LM-63-2002\n[TEST]\n", "must have a line TILT="),
        (b"IESNA91\nTILT=NONE\n\0\0\0", "zero bytes"),
        (ies().replace("103", "1_03"), "must be a finite number, got '1_03'"),
    ],
)
def test_bad_ies_files_are_named(tmp_path, text, expected):
    with pytest.raises(InputError) as caught:
        read(tmp_path, text)
    message = str(caught.value)
    assert expected in message
    assert "lamp.ies" in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (ldt(candela=-1), "candela value 1 of 4: must be ≥ 0"),
        (ldt(candela=np.inf), "must be a finite number, got 'inf'"),
        (ldt(lumens="0"), "lumens of the lamps"),
        (ldt(lumens=""), "lumens of the lamps"),
        (ldt(conversion="0"), "conversion factor"),
        (ldt(symmetry=1, candela=0), "dark"),
        (ldt().replace("\r\n4\r\n90", "\r\n99999999\r\n90"), "number of C planes Mc"),
        (ldt(symmetry=4, planes=(0, 10, 20, 30)), "symmetry 4 needs planes 0…90°"),
        (ldt().replace("\r\n1\r\n4\r\n", "\r\n4\r\n5\r\n"), "that 4 divides"),
        (ldt().replace("\r\n1\r\n4\r\n", "\r\n7\r\n4\r\n"), "line 3, symmetry Isym"),
        (ldt(angles=(0, 50, 40, 90)), "must rise"),
        (ldt(angles=(0, 50, 60, 200)), "0…180°"),
        (ldt() + "5\r\n", "must end here"),
        (ldt(symmetry=0, planes=(10, 100, 190, 280)), "must begin with 0"),
    ],
)
def test_bad_eulumdat_files_are_named(tmp_path, text, expected):
    with pytest.raises(InputError) as caught:
        read(tmp_path, text, "lamp.ldt")
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("text", "name"), [(ies(horizontals=(0, 90)), "a.ies"), (ldt(), "a.ldt")])
def test_cut_after_every_line(tmp_path, text, name):
    lines = text.splitlines(keepends=True)
    for count in range(len(lines)):
        with pytest.raises(InputError) as caught:
            read(tmp_path, "".join(lines[:count]), name)
        assert name in str(caught.value)
    read(tmp_path, text, name)


def test_a_small_file_that_claims_much_costs_little(tmp_path):
    import tracemalloc

    tracemalloc.start()
    for text, name in (
        (ies(head="1 -1 1 1024 1024 1 2 0 0 0"), "a.ies"),
        (ldt().replace("\r\n4\r\n90\r\n4", "\r\n3600\r\n90\r\n3600"), "a.ldt"),
    ):
        with pytest.raises(InputError):
            read(tmp_path, text, name)
    assert tracemalloc.get_traced_memory()[1] < 1e6
    tracemalloc.stop()
