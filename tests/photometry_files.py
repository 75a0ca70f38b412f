"""Photometric files written by hand for tests."""

from __future__ import annotations

import numpy as np

V = (0, 30, 60, 90)


def ies(
    *,
    first="IESNA:LM-63-2002",
    labels=("[TEST] 1", "[MANUFAC] Maker", "[LUMINAIRE] A lamp,", "[MORE] continued"),
    tilt="TILT=NONE",
    head="1 -1 1 {v} {h} {type} 2 0.2 0.4 0.1",
    factors="1 1 12.5",
    verticals=V,
    horizontals=(0,),
    candela=None,
    kind=1,
    end="\n",
):
    """An LM-63 file; candela (h, v), default 100 + 10·i + j."""
    shape = (len(horizontals), len(verticals))
    if candela is None:
        candela = 100 + 10 * np.arange(shape[0])[:, None] + np.arange(shape[1])
    rows = [" ".join(f"{x:g}" for x in row) for row in np.broadcast_to(candela, shape)]
    lines = [
        *([first] if first else []),
        *labels,
        tilt,
        head.format(v=shape[1], h=shape[0], type=kind),
        factors,
        " ".join(f"{x:g}" for x in verticals),
        " ".join(f"{x:g}" for x in horizontals),
        *rows,
    ]
    return end.join([*lines, ""])


def ldt(
    *,
    symmetry=1,
    planes=(0, 90, 180, 270),
    angles=V,
    candela=None,
    lumens="2000",
    ratio="80",
    conversion="1",
    lamps="1",
    name="A luminaire",
    sets=1,
    end="\r\n",
):
    """A EULUMDAT file; candela (stored planes, angles) in cd/klm."""
    count = {0: len(planes), 1: 1, 2: len(planes) // 2 + 1, 3: len(planes) // 2 + 1,
             4: len(planes) // 4 + 1}[symmetry]  # fmt: skip
    if candela is None:
        candela = 100 + 10 * np.arange(count)[:, None] + np.arange(len(angles))
    values = [f"{x:g}" for x in np.broadcast_to(candela, (count, len(angles))).ravel()]
    per_set = [lamps, "LED", lumens, "3000", "80", "15,5"]
    lines = [
        "Maker", "1", str(symmetry), str(len(planes)), "90", str(len(angles)), "30", "report",
        name, "number", "file", "date", "1200", "200", "80", "1000", "100", "10", "10", "10",
        "10", "100", ratio, conversion, "0", str(sets), *per_set * sets, *["0"] * 10,
        *[f"{x:g}" for x in planes], *[f"{x:g}" for x in angles], *values,
    ]  # fmt: skip
    return end.join([*lines, ""])
