"""The veil by its definition: every pixel to every pixel, in the angle between them.

::

    veil(z) = 1/Ω_z ∫_z dω ∫ K(θ) L dω'          the mean over the pixel of what arrives

Slow and plain: the oracle that the fast renderer is held against. Pairs of pixels within
`NEAR_PIXELS` are integrated over both areas by sending *rings* of light from the source, whose
shares of k are those of the kernel: a kernel that falls as θ⁻³ is nowhere sampled at a point there,
so energy is kept whatever the size of a pixel. Farther pairs are evaluated at the centres with the
second moments of both pixels, which leaves 0.2 % at 5 pixels and less beyond.

A latlong picture looks the same from each of its columns: one column of sources is integrated, and
its columns are convolved by a transform, which is exact.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.errors import InputError
from andon.glare.kernel import Kernel
from andon.spaces import View

__all__ = ["convolved"]

Float = NDArray[np.float64]

# Offsets in pixels, and for latlong rows, within which areas are integrated.
NEAR_PIXELS = 4
# Rings are wider by this each; what is within INNER_PIXELS of a point stays in its pixel.
RING_STEP, INNER_PIXELS = 0.06, 0.01
AZIMUTHS = 24
# A pixel at a pole is a wedge: latlong sources are integrated over so many parts each way.
LATLONG_PARTS = 8
# Values that are held at once, of one kind.
BLOCK = 1 << 22
# Two points of equal weight with the variance of a tent of base ±1, the difference of two pixels.
TENT: Float = np.array([-1.0, 1.0]) / np.sqrt(6)
# The same for one box of width 1 (Gauss–Legendre).
BOX: Float = np.array([-1.0, 1.0]) / np.sqrt(12)


def convolved(
    luminance: NDArray[Any], view: View, kernel: Kernel, /, *, core: bool = False
) -> Float:
    """∫ K(θ) L dω', (H, W, 3) in the unit of `luminance` (H, W, 3), averaged over each pixel.

    What lies beside the picture is dark. `core` as in `Kernel.per_sr`. Raises `InputError` unless
    `luminance` has the view's shape and is finite and ≥ 0.
    """
    light = np.asarray(luminance, np.float64)
    if light.shape != (*view.shape, 3):
        raise InputError(f"must be {(*view.shape, 3)}, got {light.shape}", field="glare.luminance")
    if not (np.isfinite(light).all() and (light >= 0).all()):
        raise InputError("must be finite and ≥ 0", field="glare.luminance")
    table = _Table(kernel, core)
    if view.projection == "latlong":
        return _latlong(light, view, table)
    return _far(light, view, table) + _near(light, view, table)


class _Table:
    """K, its Laplacian and its integral over log θ."""

    STEPS = 8000
    SMALLEST = 1e-6  # radians

    def __init__(self, kernel: Kernel, core: bool) -> None:
        step = np.log(np.pi / self.SMALLEST) / (self.STEPS - 1)
        self.log: Float = np.log(self.SMALLEST) + step * np.arange(self.STEPS, dtype=np.float64)
        theta: Float = np.minimum(np.exp(self.log), np.pi)
        whole = kernel.per_sr(theta, core=True)
        ring = whole * 2 * np.pi * np.sin(theta) * theta
        within = np.concatenate([[0], np.cumsum((ring[1:] + ring[:-1]) / 2 * step)])
        within += np.pi * self.SMALLEST**2 * whole[0]
        # The step at θ_min is left out of the table: it lies between two of its entries.
        less = 0.0 if core else self._at(kernel.minimum_degrees, within)
        self._within: Float = np.maximum(within - less, 0)
        self._value = kernel.per_sr(theta, core=core)
        # ∇²K = (K_xx + (θ·cot θ − 1)·K_x)/θ² with x = log θ.
        slope: Float = np.gradient(whole, step)
        bend: Float = np.gradient(slope, step)
        tangent = np.divide(theta, np.tan(theta), out=np.ones_like(theta), where=theta < 3)
        self._laplacian = (bend + (tangent - 1) * slope) / theta**2

    def _at(self, degrees: float, table: Float) -> float:
        return np.interp(np.log(np.radians([degrees])), self.log, table).item()

    def within(self, theta: Float) -> Float:
        """Share of a point's light that arrives within θ (…)."""
        return np.asarray(np.interp(np.log(theta), self.log, self._within), np.float64)

    def values(self, chord2: Float) -> tuple[Float, Float]:
        """K and ∇²K in sr⁻¹ of squared chords (…), linear in log θ."""
        theta = 2 * np.arcsin(np.minimum(np.sqrt(chord2) / 2, 1))
        place = np.log(np.maximum(theta, self.SMALLEST)) - self.log[0]
        place *= (self.STEPS - 1) / (self.log[-1] - self.log[0])
        first = np.minimum(np.asarray(place, np.int32), self.STEPS - 2)
        part = place - first
        k, bend = self._value, self._laplacian
        return (
            k[first] + part * (k[first + 1] - k[first]),
            bend[first] + part * (bend[first + 1] - bend[first]),
        )

    def rings(self, inner: float, outer: float) -> tuple[Float, Float, float]:
        """Angles (n,), shares (n,) and the share within them, of rings from `inner` to `outer`."""
        count = int(np.ceil(np.log(outer / inner) / RING_STEP))
        edges: Float = inner * np.exp(np.arange(count + 1) / count * np.log(outer / inner))
        within = self.within(edges)
        return np.sqrt(edges[1:] * edges[:-1]), np.diff(within), float(within[0])


def _chord2(one: Float, other: Float) -> Float:
    """Squared chords (n, m) of directions (n, 3) and (m, 3); differences keep small ones exact."""
    difference = one[:, None, 0] - other[None, :, 0]
    total = difference * difference
    for axis in (1, 2):
        difference = one[:, None, axis] - other[None, :, axis]
        total += difference * difference
    return total


def _far(light: Float, view: View, table: _Table) -> Float:
    """Pairs farther than `NEAR_PIXELS`, from centre to centre."""
    directions, omega = view.directions().reshape(-1, 3), view.solid_angles().ravel()
    energy = light.reshape(-1, 3) * omega[:, None]
    rows, columns = np.divmod(np.arange(len(omega)), view.width)
    veil = np.zeros_like(energy)
    step = max(1, BLOCK // len(omega))
    for start in range(0, len(omega), step):
        some = slice(start, start + step)
        value, bend = table.values(_chord2(directions[some], directions))
        # A square pixel has the second moment Ω/12 each way: half of it times the Laplacian.
        value += (omega[some, None] + omega[None, :]) / 24 * bend
        near = abs(rows[some, None] - rows[None, :]) <= NEAR_PIXELS
        near &= abs(columns[some, None] - columns[None, :]) <= NEAR_PIXELS
        value[near] = 0
        veil[some] = value @ energy
    return veil.reshape(light.shape)


def _near(light: Float, view: View, table: _Table) -> Float:
    """Pairs within `NEAR_PIXELS`: of shares sent there and back, Ω·T, the mean."""
    reach = NEAR_PIXELS
    sent = _sent(view, table)
    omega = view.solid_angles()
    padded = np.pad(light, ((reach, reach), (reach, reach), (0, 0)))
    wide = np.pad(sent * omega[..., None, None], ((reach, reach), (reach, reach), (0, 0), (0, 0)))
    veil = np.zeros_like(light)
    for i in range(2 * reach + 1):
        for j in range(2 * reach + 1):
            place = np.s_[i : i + view.height, j : j + view.width]
            # From the pixel at (i, j) to here, and from here to it.
            there = wide[(*place, 2 * reach - i, 2 * reach - j)]
            back = sent[..., i, j] * omega
            # Both are the light exchanged, and differ as the pixels' sizes vary between them.
            veil += ((there + back) / 2 / omega)[..., None] * padded[place]
    return veil


def _sent(view: View, table: _Table) -> Float:
    """(H, W, 2n + 1, 2n + 1) share of each pixel's light that arrives at offsets −n…n."""
    size = 2 * NEAR_PIXELS + 1
    directions, omega = view.directions(), view.solid_angles()
    pixel = np.sqrt(omega)
    # As far as the corner of the box, also where pixels are stretched.
    grid = view.pixel_grid()
    sent = np.zeros((*view.shape, size * size))
    inner = INNER_PIXELS * float(pixel.min())
    outer = min(_reach(view, directions), np.pi)
    angles, shares, inside = table.rings(inner, outer)
    step = max(1, BLOCK // (len(angles) * AZIMUTHS * view.width))
    for start in range(0, view.height, step):
        some = slice(start, start + step)
        at = view.project(_around(directions[some], angles))
        offset = at - grid[some][..., None, None, :]
        for (x, y), part in _split(offset, 1.0):
            ok = (abs(x) <= NEAR_PIXELS) & (abs(y) <= NEAR_PIXELS)
            bins = np.where(ok, (y + NEAR_PIXELS) * size + x + NEAR_PIXELS, 0)
            weight = np.where(ok, part, 0) * (shares[:, None] / AZIMUTHS)
            rows, columns = bins.shape[:2]
            pixels = np.arange(rows * columns, dtype=np.int64).reshape(rows, columns)
            flat = pixels[..., None, None] * size * size + bins
            count = rows * columns * size * size
            sent[some] += np.bincount(flat.ravel(), weight.ravel(), count).reshape(sent[some].shape)
    sent[..., size * size // 2] += inside
    return sent.reshape(*view.shape, size, size)


def _reach(view: View, directions: Float) -> float:
    """Angle that reaches the corner of the box of near offsets from every pixel."""
    longest = 0.0
    for axis in (0, 1):
        if directions.shape[axis] > 1:
            step = np.linalg.norm(np.diff(directions, axis=axis), axis=-1).max()
            longest = max(longest, float(step))
    longest = longest or float(np.sqrt(view.solid_angles().max()))
    return 1.5 * (NEAR_PIXELS + 1) * longest


def _around(directions: Float, angles: Float) -> Float:
    """(…, n, AZIMUTHS, 3) directions on rings of `angles` (n,) about `directions` (…, 3).

    Each ring starts at another azimuth, by the golden section, so that no direction is preferred.
    """
    helper = np.eye(3)[np.argmin(abs(directions), axis=-1)]
    right = np.cross(helper, directions)
    right /= np.linalg.norm(right, axis=-1, keepdims=True)
    down = np.cross(directions, right)
    turn = (np.arange(len(angles)) * 0.6180339887) % 1
    phi = 2 * np.pi * (np.arange(AZIMUTHS) + turn[:, None]) / AZIMUTHS
    across = (np.sin(angles)[:, None] * np.cos(phi))[..., None]
    along = (np.sin(angles)[:, None] * np.sin(phi))[..., None]
    ahead = np.cos(angles)[:, None, None]
    around = ahead * directions[..., None, None, :] + across * right[..., None, None, :]
    return around + along * down[..., None, None, :]


def _split(
    place: Float, width: float
) -> list[tuple[tuple[NDArray[np.int64], NDArray[np.int64]], Float]]:
    """Pixels (column, row) under boxes of `width` ≤ 1 about `place` (…, 2), and their shares.

    NaN (behind a pinhole) is far away.
    """
    known = np.nan_to_num(place, nan=1e9)
    first = np.floor(known - width / 2 + 0.5)
    after = np.clip((known + width / 2 + 0.5 - first - 1) / width, 0, 1)
    low = first.astype(np.int64)
    return [
        (
            (low[..., 0] + i, low[..., 1] + j),
            (after[..., 0] if i else 1 - after[..., 0])
            * (after[..., 1] if j else 1 - after[..., 1]),
        )
        for i in (0, 1)
        for j in (0, 1)
    ]


def _latlong(light: Float, view: View, table: _Table) -> Float:
    """One column of sources, then a circular convolution of columns."""
    weights = _column_far(view, table)
    near = _column_near(view, table)
    is_near = _column_is_near(view)
    weights[is_near] = near[is_near]
    spectrum = np.einsum("jif,ifc->jfc", np.fft.rfft(weights, axis=2), np.fft.rfft(light, axis=1))
    # Where nothing arrives the transform leaves ±1e-16 of the brightest.
    return np.maximum(np.fft.irfft(spectrum, view.width, axis=1), 0)


def _polar(colatitude: NDArray[Any], azimuth: NDArray[Any]) -> Float:
    sine = np.sin(colatitude)
    parts = [sine * np.sin(azimuth), -np.cos(colatitude), sine * np.cos(azimuth)]
    return np.stack(np.broadcast_arrays(*parts), axis=-1)


def _column_is_near(view: View) -> NDArray[np.bool_]:
    """(H, H, W) whether pixels of row j, so many columns on, are near to one of row i."""
    height = np.pi / view.height
    middle = (np.arange(view.height) + 0.5) * height
    columns = np.arange(view.width) * 2 * np.pi / view.width
    one = _polar(middle, np.zeros(1)).reshape(-1, 3)
    other = _polar(middle[:, None], columns).reshape(-1, 3)
    chord2 = _chord2(other, one).reshape(view.height, view.width, view.height)
    return np.moveaxis(chord2, 1, 2) < ((NEAR_PIXELS + 0.5) * height) ** 2


def _column_far(view: View, table: _Table) -> Float:
    """(H, H, W) light at row j per luminance of row i, by columns on; means of 8 points."""
    height, width = np.pi / view.height, 2 * np.pi / view.width
    rows = np.arange(view.height)[:, None] + 0.5 + BOX
    omega = view.solid_angles()[:, 0]
    columns = (np.arange(view.width)[:, None] + TENT) * width
    there = _polar(rows[:, :, None, None] * height, columns).reshape(-1, 3)
    # Weights of the two points of a row, by area.
    area = np.sin(rows * height)
    area /= area.sum(axis=1, keepdims=True)
    weights = np.zeros((view.height, view.height, view.width))
    for i in range(view.height):
        for point in range(2):
            here = _polar(rows[i, point : point + 1] * height, np.zeros(1)).reshape(-1, 3)
            value, _ = table.values(_chord2(there, here))
            value = value.reshape(view.height, 2, view.width, 2).mean(axis=3)
            weights[:, i] += omega[i] * area[i, point] * np.einsum("jpc,jp->jc", value, area)
    return weights


def _column_near(view: View, table: _Table) -> Float:
    """(H, H, W) as `_column_far`, right only where pixels are near: sent from parts of pixels."""
    size, parts = view.height * view.width, LATLONG_PARTS
    height = np.pi / view.height
    finer = View("latlong", view.width * parts, view.height * parts)
    directions = finer.directions()[:, :parts].reshape(view.height, parts * parts, 3)
    area = finer.solid_angles()[:, :parts].reshape(view.height, parts * parts)
    omega = view.solid_angles()[:, 0]
    angles, shares, inside = table.rings(INNER_PIXELS * height, 1.5 * (NEAR_PIXELS + 1) * height)
    sent = np.zeros((view.height, view.height, view.width))
    for i in range(view.height):
        at = view.project(_around(directions[i], angles))
        weight = (area[i] / area[i].sum())[:, None, None] * (shares[:, None] / AZIMUTHS)
        for (x, y), part in _split(at, 1 / parts):
            # Beyond a pole the other side's rows go on; a part of a pixel there is too small.
            bins = np.clip(y, 0, view.height - 1) * view.width + x % view.width
            counts = np.bincount(bins.ravel(), (part * weight).ravel(), size)
            sent[:, i] += counts.reshape(view.height, view.width)
        sent[i, i, 0] += inside
    # Light exchanged is the same both ways, but for the quadrature: their mean is nearer.
    exchanged = sent * omega[None, :, None]
    exchanged = (exchanged + np.roll(np.swapaxes(exchanged, 0, 1)[..., ::-1], 1, axis=2)) / 2
    return exchanged / omega[:, None, None]
