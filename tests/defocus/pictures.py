"""Glass and pictures that the tests of defocus share."""

from dataclasses import fields

import numpy as np

from andon.glass.layers import Layers

__all__ = ["disc_of_glass", "natural", "sheet", "spread"]


def natural(height, width, seed=0):
    """(H, W, 3) in [0, 1] like a photograph: amplitudes fall as 1/f, and there are hard edges."""
    generator = np.random.default_rng(seed)
    down, across = np.fft.fftfreq(height)[:, None], np.fft.rfftfreq(width)[None, :]
    falling = 1 / np.maximum(np.hypot(down, across), 1 / max(height, width))
    picture = np.empty((height, width, 3))
    for channel in range(3):
        spectrum = falling * np.exp(2j * np.pi * generator.random(falling.shape))
        noise = np.fft.irfft2(spectrum, (height, width))
        picture[..., channel] = 0.5 + 0.2 * (noise - noise.mean()) / noise.std()
    for _ in range(12):
        row, column = generator.integers(0, (height, width))
        size = generator.integers(4, 60)
        picture[row : row + size, column : column + size // 2] = generator.random(3)
    return np.clip(picture, 0, 1)


def disc_of_glass(height, width, radius):
    """(H, W) coverage of a ball in the middle: 0 or 1, as one ray a pixel finds it."""
    rows, columns = np.mgrid[:height, :width]
    away = np.hypot(rows - (height - 1) / 2, columns - (width - 1) / 2)
    return (away < radius).astype(np.float64)


def sheet(coverage, **given):
    """Layers that are black and sharp but for what is given; all are cut to the coverage."""
    values = {}
    for name in fields(Layers):
        is_picture = name.name in ("refracted", "surface", "reflected")
        mask = coverage[..., None] * np.ones(3) if is_picture else coverage
        values[name.name] = given.get(name.name, 0.0) * mask
    return Layers(**values | {"coverage": coverage})


def spread(image):
    """Sum, centre (y, x) and second moments (yy, xx, xy) about the centre of an (H, W) image."""
    rows, columns = np.mgrid[: image.shape[0], : image.shape[1]]
    total = image.sum()
    y, x = (image * rows).sum() / total, (image * columns).sum() / total
    dy, dx = rows - y, columns - x
    moments = [(image * a * b).sum() / total for a, b in ((dy, dy), (dx, dx), (dy, dx))]
    return total, (y, x), moments
