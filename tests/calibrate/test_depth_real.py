"""Relative depth of real rooms: measured disparity, of which scale and shift are taken away."""

import numpy as np
import pytest

from andon.calibrate.depth import Knowledge, Length, Plane, fit_depth, relative_depth
from andon.files import read_depth_array
from andon.spaces import View

# z = baseline·f/(disparity + doffs) of the data's own page.
BASELINE_M, FOCAL_PX, DOFFS_PX = 0.193001, 994.978, 31.086
VIEW = View("pinhole", 741, 500, FOCAL_PX, FOCAL_PX, 311.193, 254.877)
# Wheel to wheel, along the wall, and twice from the front to the wall.
ENDS = [
    ((150, 380), (600, 400)),
    ((60, 60), (690, 80)),
    ((600, 400), (60, 60)),
    ((100, 470), (640, 60)),
]
FLOOR = (slice(440, 490), slice(10, 710))
AFFINE = {"inverse": (0.037, 0.11), "depth": (0.9, -1.3)}


@pytest.fixture(scope="module")
def truth(data_dir):
    disparity = read_depth_array(data_dir / "motorcycle_skimage" / "motorcycle_disp.npz")
    with np.errstate(invalid="ignore"):
        known = np.isfinite(disparity) & (disparity > 0)
    return np.where(
        known, BASELINE_M * FOCAL_PX / (np.where(known, disparity, 1) + DOFFS_PX), np.nan
    )


def nearest_known(z, pixel):
    """The pixel with a depth nearest to `pixel`: tapes are laid on what is there."""
    rows, columns = np.nonzero(np.isfinite(z))
    best = np.argmin((columns - pixel[0]) ** 2 + (rows - pixel[1]) ** 2)
    return int(columns[best]), int(rows[best])


def knowledge(z, kind):
    rays = VIEW.rays_planar()
    lengths = []
    for ends in ENDS if kind == "inverse" else ENDS[:2]:
        (x1, y1), (x2, y2) = (nearest_known(z, end) for end in ends)
        metres = np.linalg.norm(rays[y1, x1] * z[y1, x1] - rays[y2, x2] * z[y2, x2])
        lengths.append(Length((x1, y1), (x2, y2), round(float(metres), 2)))  # a tape, to the cm
    if kind == "inverse":
        return Knowledge(tuple(lengths))
    floor = np.zeros(VIEW.shape, bool)
    floor[FLOOR] = True
    return Knowledge(tuple(lengths), planes=(Plane(floor, "--plane 1"),))


def estimated(z, kind, noise, seed):
    """An estimator's r: white errors of `noise` of the relief, and smooth ones of twice that."""
    import cv2

    a, b = AFFINE[kind]
    r = ((1 / z if kind == "inverse" else z) - b) / a
    draw, relief = np.random.default_rng(seed), np.nanstd(r)
    smooth = cv2.GaussianBlur(draw.standard_normal(z.shape), (0, 0), 60)
    r = r + noise * relief * (draw.standard_normal(z.shape) + 2 * smooth / smooth.std())
    return relative_depth(r, VIEW, kind)


@pytest.mark.parametrize("kind", ["inverse", "depth"])
def test_a_tape_brings_a_real_room_back(truth, kind):
    """Lengths to the centimetre: depth errs by what half a centimetre is of the shortest, twice."""
    relative, known = estimated(truth, kind, 0.0, 0), knowledge(truth, kind)
    found = fit_depth(relative, known)
    share = np.nanmedian(np.abs(relative.metric(found.scale, found.shift) / truth - 1))
    assert share < 2 * 0.005 / min(length.metres for length in known.lengths)
    assert not found.shift_is_assumed


@pytest.mark.parametrize("kind", ["inverse", "depth"])
def test_with_an_estimator_s_errors_it_is_right_to_some_percent(truth, kind):
    shares = []
    for seed in range(5):
        relative = estimated(truth, kind, 0.01, seed)
        found = fit_depth(relative, knowledge(truth, kind))
        shares.append(np.nanmedian(np.abs(relative.metric(found.scale, found.shift) / truth - 1)))
    print(kind, np.round(shares, 4))
    assert np.median(shares) < 0.04
