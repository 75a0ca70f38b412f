"""Radiance scene files of users: what Radiance reads is read, what starts programs is not."""

import os
import tracemalloc
from dataclasses import replace

import pytest

from andon.bake.tasks import write_bundle
from andon.errors import InputError, MachineError
from andon.files.limits import DEFAULT_LIMITS
from andon.files.radiance_programs import package_folder, run_radiance
from andon.files.radiance_text import read_included, read_radiance
from andon.files.radiance_types import FILES, NUMBERS, TYPES
from andon.transport.baked.radiance.scene import radiance_bundle
from requirements import required

from .specimens import RAD

required("pyradiance")

BALL = b"void plastic m 0 0 5 .5 .5 .5 0 0\nm sphere s 0 0 4 0 0 0 1\n"
# Where a command may hide; `oconv` runs all of these, see the test below.
HIDDEN = {
    "own line": b"\n!touch ran\n",
    "after blanks": b"\n  \t !touch ran\n",
    "same line": b" !touch ran\n",
    "odd white space": b"\v\f!touch ran\n",
    "after an alias": b"\nvoid alias q m !touch ran\n",
    "comment's end escaped": b"\n# a \\\n!touch ran\n",
    "end of a long comment": b"\n#" + b" " * 2047 + b"!touch ran\n",
    "on several lines": b"\n!touch \\\n ran\n",
    "at the end": b"\n!touch ran",
    "after Windows' line": b"\r\n!touch ran\r\n",
}


def put(folder, contents, name="a.rad"):
    (folder / name).write_bytes(contents)
    return folder / name


def refused(folder, contents, **options):
    """The one line with which a text is refused."""
    with pytest.raises(InputError) as caught:
        read_radiance(put(folder, contents), **options)
    assert caught.value.file.endswith("a.rad")
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_sound_file(tmp_path):
    (tmp_path / "d.dat").write_bytes(b"1\n0 1 2\n.5 1\n")
    found = read_radiance(put(tmp_path, RAD))
    ((name, contents),) = found.files.items()
    assert contents == b"1\n0 1 2\n.5 1\n"
    assert name.endswith("-d.dat")
    assert found.text == RAD.replace(b"d.dat", name.encode())  # source.cal is Radiance's own
    assert found.lights == ("glowing",)


@pytest.mark.parametrize("line", HIDDEN.values(), ids=HIDDEN)
def test_lines_that_start_programs(line, tmp_path):
    message = refused(tmp_path, BALL + line)
    if b" " * 2047 in line:
        assert "Radiance reads the rest as scene" in message
    else:
        assert "starts a program: '!touch" in message
        assert "--trust" in message
    assert not (tmp_path / "ran").exists()


@pytest.mark.parametrize("line", HIDDEN.values(), ids=HIDDEN)
def test_radiance_does_run_them(line, tmp_path):
    """The threat is real: without this the test above would be of our own opinion."""
    put(tmp_path, BALL + line)
    run_radiance("oconv", ["-w", "a.rad"], b"", 20, cwd=tmp_path)
    assert [name for name in os.listdir(tmp_path) if "ran" in name]


def test_an_octree_may_start_programs_and_is_refused(tmp_path):
    put(tmp_path, BALL, "s.rad")
    octree = run_radiance("oconv", ["-w", "!touch ran; cat s.rad"], b"", 20, cwd=tmp_path)
    put(tmp_path, octree, "o.oct")
    (tmp_path / "ran").unlink()
    contents = b"void instance i 1 o.oct 0 0\n"
    put(tmp_path, run_radiance("oconv", ["-w", "-"], contents, 20, cwd=tmp_path), "i.oct")
    run_radiance("rtrace", ["-h", "-w", "i.oct"], b"0 0 5 0 0 -1\n", 20, cwd=tmp_path)
    assert (tmp_path / "ran").exists()
    assert "may start programs" in refused(tmp_path, contents)
    assert "may start programs" in refused(tmp_path, b"void mesh i 1 o.rtm 0 0\n")


def test_trusted_programs_run_once_and_leave_plain_text(tmp_path):
    put(tmp_path, BALL, "s.rad")
    text = BALL + b"!echo once >> log; genbox m box 1 2 3 | xform -t 5 0 0\n!xform -n two s.rad\n"
    found = read_radiance(put(tmp_path, text), trust=True)
    assert (tmp_path / "log").read_text() == "once\n"
    assert found.text.count(b"polygon") == 6
    assert b"two.s" in found.text
    again = read_radiance(put(tmp_path, found.text, "b.rad"))  # nothing in it is to be trusted
    assert again.text == found.text
    run_radiance("oconv", ["-w", "-"], found.text, 20, cwd=tmp_path)


def test_the_same_text_wherever_it_lies(tmp_path):
    texts = []
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        path = put(tmp_path / name, BALL + b"!genbox m box 1 2 3\n")
        texts.append(read_radiance(path, trust=True).text)
    assert texts[0] == texts[1]


@pytest.mark.parametrize(
    "command", [b"!false", b"!no-such-program", b"!xform no-such.rad", b"!echo void plastic"]
)
def test_trusted_programs_that_fail(command, tmp_path):
    assert "fail" in refused(tmp_path, BALL + command + b"\n", trust=True)


def test_trusted_programs_must_not_hide_a_file(tmp_path):
    line = b"!echo 'void colorpict p 7 red green blue /etc/passwd picture.cal u v 0 0'\n"
    assert "must be relative" in refused(tmp_path, BALL + line, trust=True)


@pytest.mark.parametrize("kind", sorted(FILES))
@pytest.mark.parametrize("name", [b"../x.dat", b"/etc/passwd", b"~/x", b"file:///x", b"http://x/y",
                                  b"a/../../x", b"link.dat"])  # fmt: skip
def test_no_file_of_any_type_leaves_the_folder(kind, name, tmp_path):
    folder = tmp_path / "scene"
    folder.mkdir()
    (tmp_path / "x.dat").write_bytes(b"1")
    (folder / "link.dat").symlink_to(tmp_path / "x.dat")
    for place in FILES[kind]:
        words = [b"."] * (max(FILES[kind]) + 1)
        words[place] = name
        count = str(len(words)).encode()
        text = b"void " + kind + b" a " + count + b" " + b" ".join(words) + b" 0 0\n"
        assert "reference must" in refused(folder, text, trust=True)


def test_files_are_named_by_their_contents(tmp_path):
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        put(tmp_path / name, name.encode(), "wood.dat")
        text = b"void brightdata p 3 noop \"wood.dat\" 'wood.dat' 0 0\n"
        put(tmp_path / name, text)
    found = read_included([tmp_path / "one" / "a.rad", tmp_path / "two" / "a.rad"])
    names = [name for name in found if not name.endswith(".rad")]
    assert {found[name] for name in names} == {b"one", b"two"}
    for number, name in enumerate(names):
        expected = b"void brightdata p 3 noop %s %s 0 0\n" % (name.encode(), name.encode())
        assert found[f"include{number}.rad"] == expected


def test_lights_do_not_belong_beside_a_scene(tmp_path):
    dark = b"void light off 0 0 3 0 0 0\n"
    assert read_included([put(tmp_path, BALL + dark)]) == {"include0.rad": BALL + dark}
    for kind, rest in (("light", ""), ("illum", ""), ("glow", " 0"), ("spotlight", " 30 0 0 -1")):
        text = f"void {kind} lit 0 0 {3 + len(rest.split())} 0 0 1{rest}\n".encode()
        with pytest.raises(InputError, match=r"must not emit light, lit does.*\[\[lamp\]\]"):
            read_included([put(tmp_path, BALL + text)])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (b"void", "a type, the file ends"),
        (b"void plastic", "an identifier, the file ends"),
        (b"void plastic m", "number of strings, the file ends"),
        (b"void plastic m 0 0 5 1 1 1 0", "a number, the file ends"),
        (b"void brand m 0 0 0", "type that Radiance knows, got 'brand'"),
        (b"void plastic m 0 0 4 1 1 1 0", "plastic must have 5 numbers, got 4"),
        (b"void plastic m 0 1 3 5 1 1 1 0 0", "0 integers"),
        (b"void plastic m 0 0 5 1 1 nan 0 0", "got 'nan'"),
        (b"void plastic m 0 0 5 1 1 1e999 0 0", "got '1e999'"),
        (b"void plastic m 0 0 5 1 1 0x1 0 0", "got '0x1'"),
        (b"void plastic m -1 0 5 1 1 1 0 0", "number of strings that follow, got '-1'"),
        (b"void plastic m 0 0 99999999 1", "number of numbers that follow"),
        (b"void plastic m 0 0 99999999999 1", "number of numbers that follow"),
        (b"void polygon p 0 0 8 0 0 0 0 0 0 0 0", "3 or more corners, got 8"),
        (b"void plastic # no 0 0 5 1 1 1 0 0", "number of strings that follow, got 'no'"),
        (b"void glass g 0 0 5 1 1 1 1 1", "glass must have 3 or 4 numbers"),
        (b"void brightfunc b 1 x 0 0", "2 strings or more"),
        (b"void plastic " + b"a" * 128 + b" 0 0 5 1 1 1 0 0", "at most 127 letters"),
        (b'void plastic a"b c" 0 0 5 1 1 1 0 0', "quotes amid a word"),
        (b'void plastic "ab 0 0 5 1 1 1 0 0', "with no end"),
        (b"void plastic m 0 0 5 1 1 1 0 0\0", "has the byte 0"),
        (b"# a\rvoid plastic m 0 0 5 1 1 1 0 0", "has the byte 13"),
        (b"void brightdata b 3 noop no.dat . 0 0", "is not there: 'no.dat'"),
        (b"void brightdata b 3 noop 'a b' . 0 0", "without spaces"),
    ],
)
def test_what_radiance_would_not_read_either(text, words, tmp_path):
    assert words in refused(tmp_path, text)


def test_an_error_names_its_line(tmp_path):
    assert "line 4: starts" in refused(tmp_path, BALL + b"\n !x\n")
    assert "line 3: must have a type" in refused(tmp_path, BALL + b"void what 0 0 0\n")


def test_limits(tmp_path):
    few = replace(DEFAULT_LIMITS, max_text_bytes=40)
    assert "at most 40 bytes" in refused(tmp_path, BALL, limits=few)
    lines = b"".join(b"void brightdata b 3 noop %d.dat . 0 0\n" % i for i in range(6))
    for i in range(6):
        put(tmp_path, b"1 2 3", f"{i}.dat")
    few = replace(DEFAULT_LIMITS, max_references=4)
    assert "at most 4 other files" in refused(tmp_path, lines, limits=few)
    few = replace(DEFAULT_LIMITS, max_file_bytes=20)
    assert "bytes in other files" in refused(tmp_path, lines, limits=few)


def test_every_type_of_radiance_is_known():
    """The words that `oconv` itself has for types stand together in the program."""
    program = (package_folder() / "bin" / "oconv").read_bytes()
    start = program.index(b"\0polygon\0")
    end = program.index(b"\0specpict\0", start) + 9
    words = set(program[start:end].split(b"\0")) - {b"", b"alias"}
    assert {word for word in words if word.isalnum() and len(word) > 1} == TYPES


@pytest.mark.parametrize("kind", sorted(NUMBERS))
def test_radiance_wants_as_many_numbers(kind, tmp_path):
    """What this reader takes of surfaces and materials, `oconv` takes."""
    if kind in (b"instance", b"mesh"):
        return
    for count in NUMBERS[kind]:
        words = [b"."] * (max(FILES.get(kind, (-1,))) + 1)
        head = b" ".join([b"void", kind, b"a", str(len(words)).encode(), *words, b"0"])
        text = head + b" %d" % count + b" 1 2 3 5 6 8 9 11"[: 2 * count + max(0, count - 7)] + b"\n"
        assert read_radiance(put(tmp_path, BALL + text)).text == BALL + text
        run_radiance("oconv", ["-w", "-"], BALL + text, 20, cwd=tmp_path)


def test_radiances_own_scenes(data_dir):
    """What their authors gave as tests of Radiance itself, with and without trust."""
    paths = sorted((data_dir / "radiance_tests").rglob("*.rad"))
    plain, trusted, refusals = [], [], {}
    for path in paths:
        for trust, kept in ((False, plain), (True, trusted)):
            try:
                read_radiance(path, trust=trust)
                kept.append(path.name)
                break
            except InputError as error:
                refusals[path.name] = error.rule
    assert len(paths) == 36
    assert len(plain) == 23
    assert sorted(trusted) == [
        "ball_in_cube.rad", "bubble_in_cube.rad", "closed_end.rad", "disks.rad", "mist.rad",
        "rect_opening.rad", "torus.rad",
    ]  # fmt: skip
    left = {name: rule for name, rule in refusals.items() if name not in trusted}
    assert set(left) == {
        "ballcompare.rad",  # a font that is not with them
        "blinds.rad",  # a BSDF that is not with them
        "combined_scene.rad",  # a scene that is not with them
        "cornell_window.rad",  # a BSDF without its strings
        "sunset_sky.rad",  # pictures that are not with them
        "vase.rad",
    }


def test_memory_is_that_of_a_few_copies(tmp_path):
    """A text is looked at word by word; it never becomes a list of objects."""
    polygon = b"m polygon p%d 0 0 12 0 0 0 1.25 0 0 1.25 1.25 0 0 1.25 0\n"
    text = BALL + b"".join(polygon % i for i in range(5000))
    path = put(tmp_path, text)
    tracemalloc.start()
    assert read_radiance(path).text == text
    assert tracemalloc.get_traced_memory()[1] < 4 * len(text)
    tracemalloc.stop()


def test_what_is_included_stands_in_a_bake(tmp_path):
    """The text and the file that it names are where `rtrace` looks for them."""
    put(tmp_path, b"1\n0 9 2\n.5 1\n", "stripes.dat")
    square = b"striped polygon p 0 0 12 0 0 0 1 0 0 1 0 -1 0 0 -1\n"
    text = b"void brightdata lines 4 noop stripes.dat . Px 0 0\n"
    text += b"lines plastic striped 0 0 5 1 1 1 0 0\n" + square
    bundle = radiance_bundle([], [], include=read_included([put(tmp_path, text)]))
    folder = write_bundle(tmp_path / "bundle", bundle)
    arguments, ray = ["-h", "-w", "-oLmv", "scene.oct"], b".5 1 -.5 0 -1 0\n"
    length, material, *_ = run_radiance("rtrace", arguments, ray, 20, cwd=folder).split()
    assert (float(length), material) == (1.0, b"striped")
    (name,) = [name for name in bundle if "stripes" in name]
    (folder / name).unlink()
    with pytest.raises(MachineError, match="stripes"):
        run_radiance("rtrace", arguments, ray, 20, cwd=folder)
