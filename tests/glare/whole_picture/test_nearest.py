"""What pixels send to those near by: by the kernel, by blocks, by filters, by a plan's shares."""

import numpy as np
import pytest

from andon.glare.kernel import Kernel
from andon.glare.whole_picture.nearest import (
    NEIGHBOURS,
    OFFSETS,
    sent,
    sent_by_blocks,
    sent_by_filter,
)
from andon.glare.whole_picture.plan import plan_whole
from andon.glare.whole_picture.reference import expand_blocks, reduce_blocks, veil
from andon.glare.whole_picture.splines import filters
from andon.observer.spread.family import spread_function
from andon.spaces import View, pinhole_view
from comparison import assert_agree

KERNEL = Kernel(spread_function("cie135", halo=False))


def test_far_pixels_are_sent_the_kernel_at_their_middle():
    pixel = np.radians(0.5)
    table = sent(KERNEL, np.array([[pixel, pixel]]))[0]
    distance = np.hypot(*OFFSETS.T)
    far = (distance > 8) & (distance < 16)
    # Half the second moment of a tent, times the Laplacian of a power of -2.5: 0.8 % at 8 pixels.
    assert_agree(table[far], KERNEL.per_sr(distance[far] * pixel) * pixel**2, rtol=0.015)


def test_neighbours_are_sent_the_mean_over_both_pixels():
    pixel = np.radians(0.4)
    table = sent(KERNEL, np.array([[pixel, pixel]]))[0]
    tent = np.convolve(np.ones(200), np.ones(200)) / 200**2
    offset = np.arange(-199, 200) / 200
    theta = pixel * np.hypot(1 + offset[:, None], offset)
    mean = np.einsum("i,j,ij->", tent, tent, KERNEL.per_sr(theta)) * pixel**2
    assert table[(OFFSETS == (1, 0)).all(1)] == pytest.approx(mean, rel=0.01)


def test_blocks_send_what_the_reference_does_in_the_mean():
    shape, total = (40, 40), np.zeros((9, 9))
    for phase in np.ndindex(2, 2):
        light = np.zeros((*shape, 3))
        row, column = 20 + phase[0], 20 + phase[1]
        light[row, column] = 1
        seen = expand_blocks(reduce_blocks(light), shape)[..., 0] / 4
        total += seen[row - 4 : row + 5, column - 4 : column + 5] / 4
    expected = (total + total[::-1] + total[:, ::-1] + total[::-1, ::-1]) / 4
    for (x, y), value in zip(OFFSETS.astype(int), sent_by_blocks(), strict=True):
        assert value == pytest.approx(expected[4 + y, 4 + x] if max(x, y) < 5 else 0, abs=1e-12)


def test_filters_keep_light():
    table = sent_by_filter(filters(1)[1], np.array([[2.1, 1.8]]))[0]
    times = np.where(OFFSETS > 0, 2, 1).prod(1)
    own = sent_by_filter(filters(1)[1], np.array([[2.1, 1.8]]) * 1e3)[0]
    assert (times * table).sum() < 1
    assert (times * table).sum() > 0.9, "but for the pixel itself"
    assert own.max() < table.max()


@pytest.mark.parametrize("degrees", [20.0, 60.0])
def test_one_pixel_sends_what_the_kernel_does(degrees):
    """Mean over the places of a pixel in its block and of blocks in cells."""
    view = pinhole_view(160, 120, 80 / np.tan(np.radians(degrees / 2)))
    plan = plan_whole(view, KERNEL)
    pixel = 1 / view.fx
    wanted = sent(KERNEL, np.array([[pixel, pixel]]))[0]
    found = []
    for row in range(58, 62):
        for column in range(78, 82):
            light = np.zeros((*view.shape, 3))
            light[row, column] = 1
            seen = veil(light, plan)[..., 0]
            each = [
                [seen[row + j * y, column + i * x] for i in (-1, 1) for j in (-1, 1)]
                for x, y in OFFSETS.astype(int)
            ]
            found.append(np.mean(each, 1))
    ratio = np.mean(found, 0) / wanted
    assert np.abs(ratio[NEIGHBOURS] - 1).max() < 0.02
    assert np.sqrt(np.mean((ratio - 1) ** 2)) < 0.03


def test_what_neighbours_exchange_is_the_same_both_ways():
    view = View("latlong", 64, 32)
    neighbours = plan_whole(view, KERNEL).neighbours
    assert neighbours is not None
    light = np.random.default_rng(3).random((2, *view.shape, 1))
    solid = neighbours.solid_angles[..., None]
    one, other = (neighbours.veil(each) * solid for each in light)
    assert (one * light[1]).sum() == pytest.approx((other * light[0]).sum(), rel=1e-12)
    leaves = (neighbours.share()[..., None] * light[0] * solid).sum()
    assert one.sum() == pytest.approx(leaves, rel=1e-12)


def test_fine_pixels_exchange_nothing_by_themselves():
    assert plan_whole(pinhole_view(1280, 720, 1108.5), KERNEL).neighbours is None
