"""Truth on the sphere: an exact quadrature, and lights with closed forms."""

import numpy as np


def gauss_fourier(degree):
    """(n, 3) unit directions and (n,) weights, exact for polynomials up to `degree`.

    Gauss–Legendre in the cosine from the pole, equal steps in azimuth (Fourier).
    """
    cosine, share = np.polynomial.legendre.leggauss(degree // 2 + 1)
    count = degree + 1
    azimuth = (np.arange(count) + 0.3) * 2 * np.pi / count
    sine = np.sqrt(1 - cosine**2)[:, None]
    directions = np.stack(
        [
            sine * np.cos(azimuth),
            sine * np.sin(azimuth),
            np.broadcast_to(cosine[:, None], (len(cosine), count)),
        ],
        axis=-1,
    )
    weights = np.repeat(share[:, None], count, axis=1) * 2 * np.pi / count
    return directions.reshape(-1, 3), weights.ravel()


def units(count, seed):
    """(count, 3) unit vectors, evenly over the sphere."""
    vectors = np.random.default_rng(seed).normal(size=(count, 3))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def cosine_lobe(axis, directions):
    """max(0, axis·d) (...), whose irradiance is known: π·… of its convolution with itself."""
    return np.maximum(directions @ axis, 0)
