"""Luminous bodies: a lamp in a translucent shell, as ordinary lamps and a thing that is seen.

The source paper (section 2.1) puts a point lamp into a shell, gives the shell's outside the
illuminance of its inside (the *inverted normal*: of the emitter's own shell only), and lets the
lamp light the room as t·I. That is exact for receivers that see a whole sphere, and wrong near
their horizon, for soft shadows, for bulbs off the centre, and for shells with openings. So there
are two modes, and both account for every lumen::

        bulb Φ ──┬── 1 − f ─────────────────────────► out through the openings, as it is
                 └── f meets the shell ──┬── t ─────► out through the paper
                                         ├── a ─────► absorbed
                                         └── 1−t−a ─► out through the openings, reflected

t is *net*, as it is measured: interreflection is in it. How much the paper reflects per hit
follows from t, a and the openings; a small radiosity solution on the inside finds it, and with it
how the light is spread. A closed shell absorbs what it does not let through, whatever a is.

================ ============================== =========================================
choice           taken                          instead of
================ ============================== =========================================
outside          an area lamp, ≤ 64 facets      t·I at a point: the paper's mode
openings         flat lids, diffuse             the inside of the far wall seen through
                                                them: a shadow map inside the shell
several parts    what they leave free is one    a lid for every pane's rim
                 opening, seen from the bulb
inside           nothing hides anything, sums   rays: exact for shells that are not convex
                 of form factors made exact
two shells       each receives from its own     more passes: brightness of a shell in
                 lamp, then emits: one pass     another's light is ordinary reflection
================ ============================== =========================================

The shell moves with its lamp (the mesh's origin is where the lamp is), so all this is done once.

Sources: Lambert 1760; van Oosterom & Strackee 1983; Goral et al. 1984.
"""

from __future__ import annotations

from andon.lamps.shells.expand import expand
from andon.lamps.shells.model import Shell

__all__ = ["Shell", "expand"]
