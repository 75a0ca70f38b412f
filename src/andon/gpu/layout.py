"""Host structs: one Python definition gives the NumPy dtype and the WGSL declaration.

WGSL's uniform layout (WGSL specification, 14.4.1): a vec3f aligns to 16 bytes and takes 12, a
mat4x4f is four columns of 16, the size of a struct is a multiple of its alignment, here always 16
so that arrays of it may stand in uniform buffers.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

__all__ = ["HostStruct"]

# WGSL type: (NumPy base, shape, alignment, size in bytes)
_TYPES: dict[str, tuple[str, tuple[int, ...], int, int]] = {
    "f32": ("<f4", (), 4, 4),
    "u32": ("<u4", (), 4, 4),
    "i32": ("<i4", (), 4, 4),
    "vec2f": ("<f4", (2,), 8, 8),
    "vec3f": ("<f4", (3,), 16, 12),
    "vec4f": ("<f4", (4,), 16, 16),
    "vec2u": ("<u4", (2,), 8, 8),
    "vec4u": ("<u4", (4,), 16, 16),
    "mat4x4f": ("<f4", (4, 4), 16, 64),
}


@dataclass(frozen=True)
class HostStruct:
    """A struct that host and shader share: `name` and fields as (name, WGSL type) pairs."""

    name: str
    fields: tuple[tuple[str, str], ...]

    @cached_property
    def dtype(self) -> np.dtype[Any]:
        """Structured NumPy dtype with WGSL's offsets.

        A mat4x4f field holds the *transposed* matrix (columns first); `pack` does that.
        """
        names: list[str] = []
        formats: list[tuple[str, tuple[int, ...]]] = []
        offsets: list[int] = []
        end = 0
        for name, kind in self.fields:
            base, shape, alignment, size = _TYPES[kind]
            offset = -(-end // alignment) * alignment
            names.append(name)
            formats.append((base, shape))
            offsets.append(offset)
            end = offset + size
        itemsize = -(-end // 16) * 16
        return np.dtype(
            {"names": names, "formats": formats, "offsets": offsets, "itemsize": itemsize}
        )

    def wgsl(self) -> str:
        """The declaration, as the shader sees it."""
        body = "\n".join(f"  {name}: {kind}," for name, kind in self.fields)
        return f"struct {self.name} {{\n{body}\n}};"

    def pack(self, **values: Any) -> np.ndarray[Any, Any]:
        """One record (shape (1,)) from named values; matrices are given row-major as in NumPy."""
        record = np.zeros(1, self.dtype)
        kinds = dict(self.fields)
        for name, value in values.items():
            array = np.asarray(value)
            record[name] = array.T if kinds[name] == "mat4x4f" else array
        return record
