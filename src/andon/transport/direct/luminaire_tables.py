"""Distributions of luminaires, as the shaders read them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.gpu.device import Gpu
from andon.lamps import GoniometricLamp, Lamp
from andon.lamps.goniometry import maximum_cd
from andon.lamps.uniform import uniform_grid

__all__ = ["LuminaireTables"]


class LuminaireTables:
    """Tables of relative intensity, one for each distribution, however many lamps have it.

    Attributes
    ----------
    tables : lamp name → first value, rows (γ) and columns (C).
    buffer : float32, all tables.
    """

    def __init__(self, gpu: Gpu, lamps: Sequence[Lamp]) -> None:
        import wgpu

        self.tables: dict[str, tuple[int, int, int]] = {}
        known: dict[int, tuple[int, int, int]] = {}
        parts: list[NDArray[np.float32]] = []
        first = 0
        for lamp in lamps:
            if not isinstance(lamp, GoniometricLamp):
                continue
            key = id(lamp.distribution)
            if key not in known:
                grid = uniform_grid(lamp.distribution).candela
                parts.append((grid / maximum_cd(lamp.distribution)).astype(np.float32).ravel())
                known[key] = (first, *grid.shape)
                first += grid.size
            self.tables[lamp.name] = known[key]
        values = np.concatenate(parts) if parts else np.zeros(1, np.float32)
        self.buffer = gpu.device.create_buffer_with_data(
            data=values, usage=wgpu.BufferUsage.STORAGE
        )
