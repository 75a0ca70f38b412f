"""Speed of the whole picture's veil beside SciPy's Fourier transform and OpenCV's Gaussian.

The transform convolves with one kernel for all pixels, so the two are the same near the optical
axis alone: at 20° they are compared over the whole picture. At 60° ours is compared with the
reference, and the peer is timed for what it would take, right or wrong.

Not a row: Blender's Glare node. Its module (bpy 5.0.1, 0.4 GB, for Python 3.11 and NumPy 1) can be
installed, but is no dependency of a test; rendering its compositor by hand with 2 threads at
1280×720 took 0.65 s of both cores for "Fog Glow" at full size and 0.12 s for "Bloom", which are
sums of filters in pixels and no spread functions.
"""

from __future__ import annotations

import importlib
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.bench.registry import BenchRow, Duel
from andon.glare.kernel import Kernel
from andon.glare.whole_picture import reference
from andon.glare.whole_picture.plan import plan_whole
from andon.glare.whole_picture.stage import WholePictureStage
from andon.gpu.device import open_gpu
from andon.gpu.textures import make_texture
from andon.observer.spread.family import spread_function
from andon.spaces import View, pinhole_view
from andon.verify.registry import NotShown

__all__ = ["ROWS", "planar_kernel"]

Float32 = NDArray[np.float32]

SIZES = {"720p": (1280, 720), "1080p": (1920, 1080)}
WORKERS = 2
# 1 − relative RMS of the difference of two veils. The transform knows no angles: 1.5 % at 20°.
AGREED, AGREED_WITH_REFERENCE = 0.97, 0.995
SOURCES = 60
# Nearer than this, pixels are too coarse to say, or light is not veil.
BESIDE_PX, BESIDE_DEGREES = 6, 0.1
# Offsets in pixels within which the planar kernel is averaged over both pixels, in so many parts.
NEAR, PARTS = 6, 40
# OpenCV's filter reaches 4σ; with this share of the height it covers what ours does of a picture.
SIGMA_OF_HEIGHT = 1 / 4


def _picture(view: View) -> Float32:
    """(H, W, 3) discs of 1 to 12 px and 50 to 3000 units all over, in the dark.

    In the dark, since light that is scattered by less than 0.1° is a matter of each model's.
    """
    generator = np.random.default_rng(1)
    picture = np.zeros((*view.shape, 3), np.float32)
    rows, columns = np.mgrid[: view.height, : view.width]
    for _ in range(SOURCES):
        row, column, radius = generator.uniform((0, 0, 1), (*view.shape, 12))
        disc = np.hypot(rows - row, columns - column) < radius
        picture[disc] = generator.uniform(50, 3000, 3)
    return picture.astype(np.float16).astype(np.float32)


def planar_kernel(
    kernel: Kernel, focal_px: float, shape: tuple[int, int], /
) -> NDArray[np.float64]:
    """(2H + 1, 2W + 1) share of a pixel's light by offset, as if all pixels were on the axis."""
    height, width = shape
    rows, columns = np.mgrid[-height : height + 1, -width : width + 1]
    share = kernel.per_sr(np.arctan(np.hypot(rows, columns) / focal_px), core=True) / focal_px**2
    # Differences of two pixels are spread like a tent.
    fine = (np.arange(-PARTS, PARTS) + 0.5) / PARTS
    tent = (1 - abs(fine)) / PARTS
    for row in range(-NEAR, NEAR + 1):
        for column in range(-NEAR, NEAR + 1):
            distance = np.hypot(row + fine[:, None], column + fine) / focal_px
            value = np.einsum("a,b,ab->", tent, tent, kernel.per_sr(np.arctan(distance), core=True))
            share[height + row, width + column] = value / focal_px**2
    return share


def _scipy(part: str) -> Any:
    try:
        return importlib.import_module(f"scipy.{part}")
    except ImportError as reason:
        raise NotShown(str(reason)) from None


class _Ours:
    """The stage and its picture."""

    def __init__(self, size: str, hfov_degrees: float) -> None:
        self.gpu = open_gpu()
        width, height = SIZES[size]
        focal = width / 2 / np.tan(np.radians(hfov_degrees / 2))
        self.view = pinhole_view(width, height, float(focal))
        self.kernel = Kernel(spread_function("cie135"))
        self.picture = _picture(self.view)
        self.plan = plan_whole(self.view, self.kernel)
        source, self.target = (
            make_texture(self.gpu, "rgba16float", width, height, label=name)
            for name in ("picture", "seen")
        )
        source.write(np.dstack([self.picture, np.ones(self.view.shape, np.float32)]))
        self.stage = WholePictureStage(self.gpu, source, self.target, self.plan, finite=True)

    def draw(self) -> None:
        """The picture with its veil."""
        encoder = self.gpu.device.create_command_encoder()
        self.stage.encode(encoder)
        self._finish(encoder)

    def veil(self) -> NDArray[np.float64]:
        """(H, W, 3) the veil alone."""
        encoder = self.gpu.device.create_command_encoder()
        self.stage.encode_glare(encoder, self.target)
        self._finish(encoder)
        return self.target.read()[..., :3].astype(np.float64)

    def adapter(self) -> str:
        """And what it costs there."""
        taps, bytes_ = self.stage.cost()
        pixels = self.view.width * self.view.height
        return f"{self.gpu.adapter_name}; {taps / pixels:.1f} taps, {bytes_ / pixels:.0f} bytes/px"

    def _finish(self, encoder: Any) -> None:
        self.gpu.device.queue.submit([encoder.finish()])
        self.gpu.wait()

    def likeness(self, expected: NDArray[Any]) -> float:
        """1 − relative RMS of the veil, where it is a few pixels beside all sources."""
        ndimage = _scipy("ndimage")
        veil = self.veil()
        least = max(BESIDE_PX, np.radians(BESIDE_DEGREES) * self.view.fx)
        beside = np.asarray(ndimage.distance_transform_edt(self.picture.max(axis=-1) == 0))
        beside = beside >= least
        off, whole = (veil - expected)[beside], expected[beside]
        return 1 - float(np.sqrt(np.sum(off**2) / np.sum(whole**2)))

    def likeness_with_reference(self) -> float:
        """Of the reference's veil."""
        return self.likeness(reference.scattered(self.picture, self.plan).glare)


def _against_fft(size: str, hfov_degrees: float) -> Duel:
    """Both from picture to veil; the peer's kernel is transformed beforehand."""
    fft = _scipy("fft")
    ours = _Ours(size, hfov_degrees)
    height, width = ours.view.shape
    kernel = planar_kernel(ours.kernel, ours.view.fx, ours.view.shape)
    # Zeros as wide as the picture, so that nothing comes round.
    padded: tuple[int, ...] = tuple(fft.next_fast_len(2 * n, real=True) for n in ours.view.shape)
    whole = np.zeros(padded)
    rows, columns = np.mgrid[-height : height + 1, -width : width + 1]
    np.add.at(whole, (rows % padded[0], columns % padded[1]), kernel)
    spectrum = fft.rfft2(whole.astype(np.float32), workers=WORKERS)
    planes = np.ascontiguousarray(np.moveaxis(ours.picture, -1, 0))

    def peer() -> Float32:
        seen = fft.rfft2(planes, padded, workers=WORKERS)
        seen *= spectrum
        return np.asarray(fft.irfft2(seen, padded, workers=WORKERS)[:, :height, :width])

    if hfov_degrees > 20:
        same, agreed = ours.likeness_with_reference(), AGREED_WITH_REFERENCE
    else:
        same, agreed = ours.likeness(np.moveaxis(peer(), 0, -1)), AGREED
    return Duel(ours.draw, peer, same, agreed, ours.adapter(), peer_repeats=11)


def _against_opencv(size: str, hfov_degrees: float) -> Duel:
    """Another function, of the same reach; ours is compared with the reference."""
    import cv2

    ours = _Ours(size, hfov_degrees)
    sigma = SIGMA_OF_HEIGHT * ours.view.height

    def peer() -> Any:
        return cv2.GaussianBlur(ours.picture, (0, 0), sigma, borderType=cv2.BORDER_CONSTANT)

    same = ours.likeness_with_reference()
    return Duel(ours.draw, peer, same, AGREED_WITH_REFERENCE, ours.adapter(), peer_repeats=3)


def _row(size: str, degrees: int, peer: str) -> BenchRow:
    width, height = SIZES[size]
    name = f"glare.whole.{size}.{degrees}_degrees.{peer}"
    if peer == "fft":
        what = f"SciPy rfft2, float32, {WORKERS} threads, one kernel for all pixels"
        prepare, bar = partial(_against_fft, size, float(degrees)), 4.0
    else:
        what = f"OpenCV GaussianBlur, float32, σ = {SIGMA_OF_HEIGHT * height:g} px"
        prepare, bar = partial(_against_opencv, size, float(degrees)), None
    return BenchRow(name, "glare", what, width * height, prepare, bar=bar)


ROWS: tuple[BenchRow, ...] = tuple(
    _row(size, degrees, peer)
    for peer in ("fft", "opencv")
    for size in SIZES
    for degrees in (20, 60)
    if peer == "fft" or degrees == 20
)
