"""A small textured corner under two lamps, photographed without them and with them."""

from dataclasses import replace

import numpy as np

from andon import PointLamp, View
from andon.calibrate.lamps.terms import Painter, Term, prepared_with
from andon.engines.arrays import prepare_arrays
from andon.pipeline import Renderer
from andon.responses import SRGB

__all__ = [
    "COOL",
    "VIEW",
    "WARM",
    "codes_of",
    "corner_depth",
    "lit",
    "photographed",
    "room",
    "texture",
]

VIEW = View("pinhole", 96, 72, 90.0, 90.0, 47.5, 35.5)
WARM, COOL = "warm", "cool"


def corner_depth():
    """A wall 2.5 m away and a floor 0.8 m below the camera; a hole in the wall."""
    directions = VIEW.directions()
    down = directions[..., 1] / directions[..., 2]
    depth = np.minimum(2.5, 0.8 / np.maximum(down, 1e-9))
    depth[4:12, 80:92] = np.nan
    return depth


def texture(seed=3):
    """(72, 96, 3) linear values 0.03…0.5: blocks of colour with grain in them."""
    random = np.random.default_rng(seed)
    blocks = np.kron(random.uniform(0.05, 0.45, (12, 16, 3)), np.ones((6, 6, 1)))
    return blocks * random.uniform(0.8, 1.1, (72, 96, 1))


def room(photograph=None, *, response=SRGB, ambient_lux=100.0, lamps=None):
    """The corner as `Prepared`, with two lamps of 50 cd."""
    both = (
        PointLamp(WARM, np.array([-0.7, 0.3, -1.6]), np.full(3, 50.0)),
        PointLamp(COOL, np.array([0.8, -0.2, -1.9]), np.full(3, 50.0)),
    )
    linear = texture() if photograph is None else photograph
    return prepare_arrays(
        codes_of(linear, response) if linear.dtype != np.uint8 else linear,
        VIEW,
        both if lamps is None else lamps,
        depth_m=corner_depth(),
        ambient_lux=ambient_lux,
        dimming=1.0,
        response=response,
        photometry="absolute",
    )


def lit(prepared, factors, exposure=1.0):
    """(72, 96, 3) linear values with the lamps at `factors` times their light."""
    terms = [Term("lamp", name) for name in factors]
    amounts = np.array([np.broadcast_to(value, 3) for value in factors.values()], float)
    frame = Renderer(prepared_with(prepared, terms, amounts), "reference").render()
    return exposure * Painter.linear(frame)


def codes_of(linear, response=SRGB, *, noise=None):
    """8-bit codes of a camera that clips; `noise` seeds that of few photons."""
    if noise is not None:
        random = np.random.default_rng(noise)
        spread = np.sqrt(4e-7 + 1.7e-4 * np.maximum(linear, 0))
        linear = linear + spread * random.normal(size=linear.shape)
    encoded = np.clip(response.encode(np.clip(linear, 0, 1)), 0, 1)
    return np.round(255 * encoded).astype(np.uint8)


def photographed(factors, *, exposure=1.0, response=SRGB, noise=True):
    """The corner of a noisy photograph, and the reference with the lamps at `factors`."""
    clean = room(response=response)
    without = codes_of(texture(), response, noise=1 if noise else None)
    reference = codes_of(lit(clean, factors, exposure), response, noise=2 if noise else None)
    return room(without, response=response), reference


def without_clipping(prepared):
    """The same with no pixel of the photograph called clipped."""
    frames = {name: replace(frame, clipped=None) for name, frame in prepared.frames.items()}
    return replace(prepared, frames=frames)
