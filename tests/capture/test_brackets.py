"""Brackets: known light through known cameras comes back; motion is found; refusals."""

from dataclasses import replace

import numpy as np
import pytest

from andon.capture.align import STILL, align
from andon.capture.brackets import (
    border_of,
    bracket_of,
    check_exposures,
    common_rectangle,
)
from andon.capture.merge import merge
from andon.capture.recovery import recover_curves
from andon.errors import InputError
from andon.files.exposures import read_exposures
from andon.files.pictures import read_picture
from andon.responses import SRGB, Response, srgb_decode

TIMES = [1 / 320, 1 / 80, 1 / 20]
KNOTS = np.linspace(0, 1, 33)[:, None]
# A camera that pleases: an S over a gamma, and each channel its own.
PLEASING = Response(
    "curve", linear=KNOTS ** [2.2, 2.0, 2.4],
    encoded=np.repeat(KNOTS - 0.06 * np.sin(2 * np.pi * KNOTS), 3, axis=1),
)  # fmt: skip


def smooth(shape, width, seed):
    import cv2

    noise = np.random.default_rng(seed).standard_normal(shape).astype(np.float32)
    blurred = cv2.GaussianBlur(noise, (0, 0), width)
    return np.asarray(blurred / blurred.std(), float)


def light(shape=(120, 160), decades=2.5, seed=3):
    """(H, W, 3) with a median of 1: hills over some decades."""
    hills = 10 ** (np.clip(smooth(shape, 6, seed), -2, 2) / 4 * decades)
    fine = 1 + 0.1 * np.clip(smooth(shape, 1, seed + 1), -2, 2)
    return (hills * fine)[..., None] * [1.0, 0.8, 0.6]


def photographed(scene, seconds, response=SRGB, noise=0.7, seed=7):
    """Codes at exposures around a middle one at which light 1 is 0.4 of white."""
    generator = np.random.default_rng(seed)
    middle = np.sort(seconds)[len(seconds) // 2]
    return [
        np.clip(
            response.encode(np.clip(scene * 0.4 * t / middle, 0, 1)) * 255
            + generator.normal(0, noise, scene.shape) + 0.5, 0, 255,
        ).astype(np.uint8)
        for t in seconds
    ]  # fmt: skip


def bracket(scene, seconds, **options):
    names = [f"{t:.4g}.png" for t in seconds]
    return bracket_of(names, photographed(scene, seconds, **options), seconds)


def errors_of(merged, scene, codes):
    """Relative errors of light ratios, channel by channel, where a photograph is not clipped."""
    known = np.any([(c > 2) & (c < 253) for c in codes], axis=0)
    logs = np.log(np.maximum(merged.linear.astype(float), 1e-30) / scene)
    return np.concatenate(
        [np.abs(logs[..., c][known[..., c]] - np.median(logs[..., c][known[..., c]]))
         for c in range(3)]
    )  # fmt: skip


@pytest.mark.parametrize("response", [SRGB, PLEASING, Response("gamma", gamma=1.8)])
@pytest.mark.parametrize("seconds", [TIMES, [2.0**-k for k in range(8)], [1.0, 2.0]])
def test_ratios_of_light_come_back(seconds, response):
    scene = light()
    taken = bracket(scene, seconds, response=response)
    error = errors_of(merge(taken), scene, taken.codes)
    assert np.median(error) < 0.02
    assert np.percentile(error, 95) < 0.07


def test_the_unit_is_that_of_the_middle_photograph():
    """What it shows unclipped at mid-grey is what capture makes of it."""
    scene = light()
    taken = bracket(scene, TIMES, noise=0)
    linear = merge(taken).linear
    middle = taken.codes[taken.middle]
    assert taken.names[taken.middle] == "0.0125.png"
    grey = (middle > 100) & (middle < 160)
    np.testing.assert_allclose(linear[grey], srgb_decode(middle[grey] / 255.0), rtol=0.05)


def test_the_response_comes_back():
    taken = bracket(light(), [2.0**-k for k in range(8)], response=PLEASING)
    curve = recover_curves(taken).curves
    assert (np.diff(curve, axis=0) >= 0).all()
    assert (curve[128] == 0).all()
    codes = np.arange(20, 240)
    expected = np.log(PLEASING.decode(np.repeat(codes[:, None] / 255, 3, axis=1)))
    expected = expected - np.log(PLEASING.decode(np.full((1, 3), 128 / 255)))
    assert np.abs(curve[codes] - expected).max() < 0.08
    response = merge(taken).response
    np.testing.assert_allclose(response.encode(response.decode(KNOTS * np.ones(3))),
                               KNOTS * np.ones(3), atol=1e-6)  # fmt: skip


def test_what_is_clipped_in_all_is_a_bound_and_counted():
    scene = light()
    scene[:10, :16] = 1e4
    scene[-10:, -16:] = 1e-7
    taken = bracket(scene, TIMES, noise=0)
    merged = merge(taken)
    white, black = (
        np.all([codes == end for codes in taken.codes], axis=0).any(axis=-1).mean()
        for end in (255, 0)
    )
    assert merged.clipped_share == pytest.approx(white)
    assert merged.black_share == pytest.approx(black)
    assert min(white, black) >= 160 / (120 * 160)
    assert np.isfinite(merged.linear).all()
    assert merged.linear[:10, :16].min() >= np.percentile(merged.linear[10:], 90)
    assert merged.linear[-10:, -16:].max() <= np.percentile(merged.linear[:-10], 1)


def test_things_that_move_do_not_bend_the_response():
    scene = light()
    still = merge(bracket(scene, TIMES))
    codes = photographed(scene, TIMES)
    codes[0][30:60, 40:80] = 200  # somebody walks through the darkest
    moved = merge(bracket_of(["a", "b", "c"], codes, TIMES))
    elsewhere = np.ones(scene.shape[:2], bool)
    elsewhere[30:60, 40:80] = False
    ratio = moved.linear[elsewhere] / still.linear[elsewhere]
    assert np.percentile(np.abs(np.log(ratio)), 95) < 0.05


def test_borders_of_a_pure_colour_are_left_out():
    scene = light()
    plain = merge(bracket(scene, TIMES))
    codes = photographed(scene, TIMES)
    codes[0][:6] = codes[1][:, -5:] = codes[2][:4] = [0, 0, 255]
    codes[1][50:60, 50:60] = [255, 0, 0]  # a lamp is none
    taken = bracket_of(["a", "b", "c"], codes, TIMES)
    assert [int((~seen).sum()) for seen in taken.seen] == [6 * 160, 5 * 120, 4 * 160]
    corner = photographed(scene, TIMES)[1]
    corner[:2, :40] = [0, 0, 255]  # along a quarter of one side: it is what it looks like
    assert not border_of(corner).any()
    merged = merge(taken)
    inside = merged.linear[4:, :-5] / plain.linear[4:, :-5]
    inside = np.delete(inside, np.s_[46:56], axis=0)
    assert np.percentile(np.abs(np.log(inside)), 99) < 0.1
    rows, columns = common_rectangle(taken.seen)
    assert (rows, columns) == (slice(6, 120), slice(0, 155))
    unseen = merge(replace(taken, codes=tuple(codes), seen=(taken.seen[0],) * 3))
    assert unseen.unseen_share == pytest.approx(6 / 120)
    assert (unseen.linear[:6] == 0).all()


def test_a_rectangle_around_a_hole_inside():
    seen = np.ones((40, 60), bool)
    seen[20, 50] = False
    rows, columns = common_rectangle([seen, np.ones_like(seen)])
    assert seen[rows, columns].all()
    assert seen[rows, columns].size >= 40 * 50
    with pytest.raises(InputError, match="no common part"):
        common_rectangle([np.zeros((4, 4), bool)])


def hand_held(moves, shape=(200, 260)):
    """Photographs of one scene through cameras that were moved by (x, y, degrees)."""
    import cv2

    wide = light((shape[0] + 80, shape[1] + 80), seed=11)
    scenes = []
    for x, y, degrees in moves:
        middle = ((wide.shape[1] - 1) / 2, (wide.shape[0] - 1) / 2)
        turn = cv2.getRotationMatrix2D(middle, degrees, 1.0)
        turn[:, 2] += x, y
        moved = cv2.warpAffine(wide, turn, wide.shape[1::-1], flags=cv2.INTER_CUBIC)
        scenes.append(np.maximum(moved[40:-40, 40:-40], 1e-3))
    codes = [photographed(scene, TIMES)[i] for i, scene in enumerate(scenes)]
    return bracket_of(["a", "b", "c"], codes, TIMES), scenes


def test_whole_shifts_are_found_and_taken_out():
    taken, scenes = hand_held([(7, -4, 0), (0, 0, 0), (-12, 9, 0)])
    aligned, moves = align(taken, "shift")
    assert [move.shift_px for move in moves] == [(7, -4), (0, 0), (-12, 9)]
    rows, columns = common_rectangle(aligned.seen)
    assert (rows.stop - rows.start, columns.stop - columns.start) == (200 - 13, 260 - 19)
    error = errors_of(merge(aligned.cropped(rows, columns)), scenes[1][rows, columns],
                      aligned.cropped(rows, columns).codes)  # fmt: skip
    assert np.median(error) < 0.02
    blurred = errors_of(merge(align(taken, "none")[0]), scenes[1], taken.codes)
    assert np.median(blurred) > 3 * np.median(error)


@pytest.mark.parametrize("method", ["ecc", "auto"])
def test_turns_and_fractions_are_found(method):
    taken, _ = hand_held([(3.4, -2.3, 0.8), (0, 0, 0), (-5.6, 6.2, -1.1)])
    _, moves = align(taken, method)
    found = np.array([[*move.shift_px, move.turn_degrees] for move in moves])
    # OpenCV turns counter-clockwise; a turn here is positive clockwise.
    expected = [[3.4, -2.3, -0.8], [0, 0, 0], [-5.6, 6.2, 1.1]]
    assert np.abs(found - expected)[:, :2].max() < 0.3
    assert np.abs(found - expected)[:, 2].max() < 0.1


def test_photographs_from_a_tripod_stay_as_they_are():
    taken, _ = hand_held([(0, 0, 0)] * 3)
    aligned, moves = align(taken, "auto")
    assert all(move.is_still for move in moves)
    assert all((a == b).all() for a, b in zip(aligned.codes, taken.codes, strict=True))
    assert all(seen.all() for seen in aligned.seen)


def test_nearly_black_photographs_are_not_moved_by_their_noise():
    generator = np.random.default_rng(5)
    codes = [generator.integers(10, 16, (120, 160, 3)).astype(np.uint8),
             *photographed(light(), TIMES[1:])]  # fmt: skip
    _, moves = align(bracket_of(["a", "b", "c"], codes, TIMES), "auto")
    assert (moves[0].matrix == STILL).all()


def test_the_reference_is_the_middle_exposure_in_any_order():
    codes = photographed(light(), TIMES)
    shuffled = bracket_of(["c", "a", "b"], [codes[2], codes[0], codes[1]])
    assert shuffled.order == [1, 2, 0]
    assert shuffled.middle == 2
    timed = bracket_of(["c", "a", "b"], [codes[2], codes[0], codes[1]], [TIMES[2], *TIMES[:2]])
    assert timed.middle == 2


REFUSED = [
    (None, "exposure times are not known"),
    ([0.1, -1, 0.2], "must be finite and > 0"),
    ([0.1, np.nan, 0.2], "must be finite and > 0"),
    ([0.1, 0.1, 0.1], "all photographs are exposed for 0.1 s"),
    (TIMES[::-1], r"is darker \(mean code [\d.]+\) than .* though it is exposed longer"),
]


@pytest.mark.parametrize(("seconds", "words"), REFUSED)
def test_exposures_that_tell_nothing_are_refused(seconds, words):
    taken = bracket_of(["a", "b", "c"], photographed(light(), TIMES), seconds)
    with pytest.raises(InputError, match=words):
        check_exposures(taken)


def test_pictures_that_make_no_bracket_are_refused():
    grey = np.full((8, 10, 3), 90, np.uint8)
    with pytest.raises(InputError, match="is one photograph, and no series of exposures"):
        bracket_of(["a.png"], [grey])
    with pytest.raises(InputError, match=r"b\.png: is 8×10 px but a\.png is 10×8"):
        bracket_of(["a.png", "b.png"], [grey, grey.swapaxes(0, 1)])
    with pytest.raises(InputError, match="nothing but one pure colour"):
        bracket_of(["a", "b"], [grey, np.full((8, 10, 3), [0, 0, 255], np.uint8)])
    black, white = np.zeros_like(grey), np.full_like(grey, 255)
    with pytest.raises(InputError, match="every pixel of every photograph is clipped"):
        check_exposures(bracket_of(["a", "b"], [black, white], [1, 2]))


def test_a_list_of_exposures(tmp_path):
    path = tmp_path / "list.txt"
    path.write_text(
        "# Filename exposure 1/shutter_speed f/stop gain(db) ND_filters\n"
        "a.png 2 0.5 8 0 0\n\nb.png 2 0.5 4 0 0\nc.png 2 0.5 8 6 0\n"
    )
    entries = read_exposures(path)
    assert [entry.path for entry in entries] == [tmp_path / f"{n}.png" for n in "abc"]
    # Half the f-number is four times the light; 6 dB as well.
    assert [entry.seconds for entry in entries] == pytest.approx([2, 8, 8])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("# nothing\n", "must name photographs"),
        ("a.png\n", "2 to 6 columns"),
        ("a.png 0\n", "finite numbers > 0, got '0'"),
        ("a.png 1/80\n", "finite numbers > 0"),
        ("a.png 1 1 8 0 2\n", "neutral density filters"),
        ("a.png 1\na.png 2\n", "names 'a.png' twice"),
        ("../a.png 1\n", "must stay inside the folder"),
    ],
)
def test_lists_that_are_refused(tmp_path, text, words):
    path = tmp_path / "list.txt"
    path.write_text(text)
    with pytest.raises(InputError, match=words):
        read_exposures(path)


def test_the_memorial_church(data_dir):
    """Against two reconstructions by others: the same order of light, within a fraction of a stop.

    Nobody knows the truth; they differ from each other by as much.
    """
    folder = data_dir / "brackets_memorial"
    entries = read_exposures(folder / "image_list.txt")
    assert [entry.seconds for entry in entries[:2]] == [32, 16]
    taken = bracket_of(
        [entry.path.name for entry in entries],
        [read_picture(entry.path).values for entry in entries],
        [entry.seconds for entry in entries],
    )
    check_exposures(taken)
    # Every border pixel is found, and nothing else: pure blue occurs at the rim only.
    for codes, seen in zip(taken.codes, taken.seen, strict=True):
        assert ((codes == [0, 0, 255]).all(axis=-1) == ~seen).all()
    merged = merge(taken)
    assert merged.range_ratio > 5000
    common = np.logical_and.reduce(taken.seen)
    ours = (merged.linear @ [0.2126, 0.7152, 0.0722])[common]
    for name in ("debevec", "robertson"):
        theirs = read_picture(folder / f"third_party_recon_{name}.hdr").values[common]
        theirs = theirs @ [0.2126, 0.7152, 0.0722]
        ranks = [np.argsort(np.argsort(values)) for values in (ours, theirs)]
        assert np.corrcoef(ranks)[0, 1] > 0.99
        stops = np.log2(ours / theirs)
        assert np.median(np.abs(stops - np.median(stops))) < 0.3
