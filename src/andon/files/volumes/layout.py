"""The names and numbers of the probe volume format; ``docs/probe-volume.md`` explains them."""

from __future__ import annotations

from andon.files.volumes.model import ProbeRole

__all__ = [
    "CONVENTIONS",
    "EXTENSION",
    "MAX_SQUARE_PX",
    "MAX_STATES",
    "MAX_ZONES",
    "ROLES",
    "VERSION",
]

EXTENSION = "ANDON_light_probes"
VERSION = 1

# A file says what its numbers mean, and a reader that means something else refuses it. Other
# meanings would be other words here, not another version.
CONVENTIONS = {
    "quantity": "luminance that arrives",
    "unit": "cd/m²",
    "channels": "linear RGB, Rec.709 primaries, D65",
    "basis": "real orthonormal spherical harmonics",
    "sign": "without Condon-Shortley phase",
    "index": "l*l+l+m",
    "axes": "world, right-handed, +Y up",
    "length": "m",
    "precision": "float32",
}

# In the file a role is its number in this list, which stands beside them.
ROLES: tuple[ProbeRole, ...] = ("general", "sky", "bounce", "bleeding")

# More of them than anybody makes, and few enough that checking each costs nothing.
MAX_ZONES = 4096
MAX_STATES = 256
# Side of a probe's octahedral picture: DDGI's have 16; a side of 256 would be a map, not a hint.
MAX_SQUARE_PX = 256
