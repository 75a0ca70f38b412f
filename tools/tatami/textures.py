"""Textures by noise: wood, plaster, washi, cloth, a painted landscape and a scroll.

All but the two paintings repeat without a seam, because their noise is filtered in the frequency
domain. Values are sRGB; those of a material that is tinted by its factor are light and neutral.
"""

from __future__ import annotations

import io

import numpy as np
from numpy.typing import NDArray

Float = NDArray[np.float64]
QUALITY = 90


def jpeg(rgb: Float) -> bytes:
    """(h, w, 3) in 0…1 as JPEG."""
    from PIL import Image

    codes = np.clip(rgb * 255 + 0.5, 0, 255).astype(np.uint8)
    stream = io.BytesIO()
    Image.fromarray(codes).save(stream, "JPEG", quality=QUALITY, subsampling=0, optimize=True)
    return stream.getvalue()


def noise(shape: tuple[int, int], scale_px: tuple[float, float], seed: int) -> Float:
    """Periodic noise of mean 0 and deviation 1, blurred by `scale_px` along rows and columns."""
    white = np.random.default_rng(seed).standard_normal(shape)
    fy, fx = (np.fft.fftfreq(n)[:, None] for n in shape)
    sy, sx = scale_px
    window = np.exp(-2 * np.pi**2 * ((sy * fy) ** 2 + (sx * fx.T) ** 2))
    out = np.fft.ifft2(np.fft.fft2(white) * window).real
    out -= out.mean()
    return out / out.std()


def wood(height: int = 512, width: int = 256) -> Float:
    """Straight grain, upright: year rings, fibres and a few darker streaks."""
    u = np.arange(width)[None, :] / width
    wander = 0.035 * noise((height, width), (120, 40), 1) + 0.004 * noise(
        (height, width), (18, 6), 2
    )
    phase = 2 * np.pi * (u + wander)
    rings = 0.5 + 0.5 * np.sin(9 * phase + 1.3 * np.sin(2 * phase) + 0.8 * np.sin(5 * phase))
    fibres = noise((height, width), (22, 0.7), 3)
    streaks = np.clip(noise((height, width), (60, 3.0), 4) - 1.0, 0, 3)
    value = 0.86 - 0.12 * rings**2.2 + 0.022 * fibres - 0.035 * streaks
    warm = np.array([1.0, 0.955, 0.89]) ** ((0.95 - value[..., None]) * 5)
    return value[..., None] * warm


def plaster(side: int = 384) -> Float:
    """Earthen plaster: fine sand, some straw."""
    sand = noise((side, side), (0.7, 0.7), 5)
    clouds = noise((side, side), (30, 30), 6)
    straw = np.clip(noise((side, side), (0.8, 5.0), 7) - 2.3, 0, 1)
    value = 0.88 + 0.022 * sand + 0.010 * clouds + 0.05 * straw
    return np.repeat(value[..., None], 3, axis=2)


def paper(side: int = 256) -> Float:
    """Washi: long pale fibres in all directions."""
    value = np.full((side, side), 0.955) + 0.006 * noise((side, side), (2.5, 2.5), 8)
    for seed in range(5):
        fibres = noise((side, side), (0.7, 8), 30 + seed)
        value += 0.004 * _sheared(fibres, seed - 2) + 0.004 * _sheared(fibres.T, seed - 2).T
    return np.repeat(value[..., None], 3, axis=2)


def _sheared(values: Float, slope: int) -> Float:
    """Each column moved down by `slope` pixels more than the one before it; stays periodic."""
    rows, columns = np.indices(values.shape)
    return values[(rows + slope * columns) % len(values), columns]


def cloth(side: int = 128) -> Float:
    """A plain weave with slubs."""
    y, x = np.mgrid[:side, :side] / side
    threads = np.sin(2 * np.pi * 32 * x) * np.sin(2 * np.pi * 32 * y)
    slubs = noise((side, side), (0.6, 6), 11) + noise((side, side), (6, 0.6), 12)
    value = 0.86 + 0.05 * threads + 0.025 * slubs
    return np.repeat(value[..., None], 3, axis=2)


def landscape(height: int = 512, width: int = 512) -> Float:
    """Ink hills in mist, for two sliding doors."""
    x = np.arange(width)[None, :] / width
    y = 1 - np.arange(height)[:, None] / height
    ink = np.zeros((height, width))
    layers = [
        (0.52, 0.085, 2.1, 0.3, 0.10),
        (0.42, 0.075, 2.9, 1.9, 0.15),
        (0.30, 0.055, 4.3, 4.2, 0.22),
    ]
    for base, swing, rate, phase, depth in layers:
        ridge = base + swing * (
            np.sin(rate * 2.2 * x + phase)
            + 0.45 * np.sin(rate * 5.3 * x + 2 * phase)
            + 0.16 * np.sin(rate * 13.7 * x + 3 * phase)
            + 0.06 * np.sin(rate * 37.0 * x + 5 * phase)
        )
        below = np.clip((ridge - y) / 0.006, 0, 1)
        ink = np.maximum(ink, depth * below * np.exp(-np.clip(ridge - y, 0, 1) / 0.12))
    ground = paper(512)[:height, :width]
    colour = np.array([0.94, 0.92, 0.85])
    return ground * colour * (1 - ink[..., None] * np.array([1.0, 0.93, 0.84]))


def scroll(height: int = 512, width: int = 192) -> Float:
    """A hanging scroll: green silk, a band, white paper with one brush stroke, a circle."""
    y, x = np.mgrid[:height, :width].astype(float)
    weave = 1 + 0.02 * noise((height, width), (0.6, 4), 13)[..., None]
    out = np.array([0.42, 0.46, 0.37]) * weave
    out = np.where(_inside(x, y, 18, 74, width - 18, height - 62), [0.66, 0.60, 0.43], out)
    white = _inside(x, y, 22, 96, width - 22, height - 84)
    out = np.where(white, np.array([0.93, 0.91, 0.84]), out)
    dx, dy = (x - width / 2) / 50.0, (y - height * 0.47) / 50.0
    radius, angle = np.hypot(dx, dy), np.mod(np.arctan2(dy, dx) + 2.2, 2 * np.pi)
    share = angle / (2 * np.pi)
    middle = 1.0 + 0.03 * np.sin(3 * angle)
    half = 0.15 * (1 - 0.72 * share) + 0.012 * np.sin(9 * angle)
    edge = np.clip((half - np.abs(radius - middle)) / 0.02 + 0.5, 0, 1)
    bristles = np.interp(radius, np.linspace(0.6, 1.5, 91), np.random.default_rng(14).random(91))
    dry = np.clip((share - 0.55) * 2.6, 0, 0.9) * (bristles > 0.45)
    ink = np.where(share < 0.93, edge * (1 - dry), 0)
    seal = _inside(x, y, width / 2 + 34, height - 128, width / 2 + 48, height - 112)
    out = out * (1 - 0.88 * ink[..., None])
    return np.where(seal, [0.62, 0.16, 0.12], out)


def _inside(x: Float, y: Float, left: float, top: float, right: float, bottom: float) -> Float:
    return ((x >= left) & (x < right) & (y >= top) & (y < bottom))[..., None]
