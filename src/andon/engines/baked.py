"""What a volume's notes say of its bake, and whether the scene is still the one that was baked.

A volume is used long after it was made, by scenes that may have changed. What its light depends on
is kept with each of its states, as texts of ``notes`` named ``<fact> of <state>``:

=============  =====================================================================================
fact           text
=============  =====================================================================================
``dimming``    three numbers: the share of E0 in the light
``E0``         three numbers, lx; of a picture of E0 its means
``lamps``      JSON: the lamps whose light is in it, each with a digest of all that it is
``sky``        JSON: names of those that are a sky or hemisphere
``geometry``   digest of what is seen
``placement``  digest of the tables that place the probes
=============  =====================================================================================
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from andon.composite.model import Ambient
from andon.engines.digest import digest
from andon.lamps import HemisphereLamp, Lamp, SkyLamp
from andon.scene import Scene
from andon.surface.model import SurfaceModel

__all__ = ["BakeFacts", "changes", "dimming_of", "facts_of", "facts_of_notes", "lamps_in_probes"]

Float = NDArray[np.float64]
# Digits of a digest that are kept: nobody makes two scenes alike on purpose.
DIGITS = 16
PLACING = {"place", "placement", "zone"}


@dataclass(frozen=True)
class BakeFacts:
    """What the light of a state depends on; digests are the same on every machine.

    Attributes
    ----------
    dimming, e0 : three numbers as text.
    lamps : name → digest of those in the probes.
    sky : names of those of them that are seen as a sky.
    geometry, placement : digests.
    """

    dimming: str
    e0: str
    lamps: Mapping[str, str]
    sky: tuple[str, ...]
    geometry: str
    placement: str

    def notes(self, state: str, /) -> dict[str, str]:
        """The facts as notes of a volume."""
        texts = {
            "dimming": self.dimming,
            "E0": self.e0,
            "lamps": json.dumps(dict(self.lamps), ensure_ascii=False),
            "sky": json.dumps(list(self.sky), ensure_ascii=False),
            "geometry": self.geometry,
            "placement": self.placement,
        }
        return {f"{fact} of {state}": text for fact, text in texts.items()}


def dimming_of(scene: Scene, /) -> tuple[float, float, float]:
    """The share of E0 that is left, in three channels; 1 without [ambient]."""
    stated = 1.0 if scene.ambient is None else scene.ambient.dimming
    share: Float = np.broadcast_to(np.asarray(stated, float), 3)
    return float(share[0]), float(share[1]), float(share[2])


def lamps_in_probes(scene: Scene, lamps: Sequence[Lamp], /) -> list[Lamp]:
    """Those of `lamps` whose light bakes capture."""
    left_out = {table.name for table in scene.lamp if not table.in_probes}
    return [lamp for lamp in lamps if (lamp.owner or lamp.name) not in left_out]


def facts_of(
    scene: Scene, surface: SurfaceModel, ambient: Ambient, lamps: Sequence[Lamp], /
) -> BakeFacts:
    """What a bake of `scene` would depend on; `lamps` are all, at the start of the session."""
    own = lamps_in_probes(scene, lamps)
    parts = [part for part in (surface.real, surface.objects) if len(part.triangles)]
    placing = None if scene.probes is None else scene.probes.model_dump(include=PLACING)
    lux = np.zeros(3) if scene.ambient is None else ambient.mean_lux
    return BakeFacts(
        _numbers(np.array(dimming_of(scene))),
        _numbers(np.asarray(lux)),
        {lamp.name: digest(lamp, single=True)[:DIGITS] for lamp in own},
        tuple(lamp.name for lamp in own if isinstance(lamp, SkyLamp | HemisphereLamp)),
        digest(parts, single=True)[:DIGITS],
        digest(placing)[:DIGITS],
    )


def _numbers(values: Float) -> str:
    return " ".join(f"{value:.5g}" for value in values)


def facts_of_notes(notes: Mapping[str, str], state: str, /) -> BakeFacts | None:
    """What the notes of a volume say of a state; None where they do not: another program's."""
    try:
        lamps, sky = (json.loads(notes[f"{fact} of {state}"]) for fact in ("lamps", "sky"))
        texts = [notes[f"{fact} of {state}"] for fact in ("dimming", "E0", "geometry", "placement")]
    except (KeyError, ValueError):
        return None
    if not isinstance(lamps, dict) or not isinstance(sky, list):
        return None
    return BakeFacts(
        texts[0],
        texts[1],
        {str(name): str(value) for name, value in lamps.items()},  # pyright: ignore[reportUnknownVariableType, reportUnknownArgumentType]
        tuple(str(name) for name in sky),  # pyright: ignore[reportUnknownVariableType, reportUnknownArgumentType]
        texts[2],
        texts[3],
    )


def changes(now: BakeFacts, baked: Sequence[BakeFacts], /) -> list[str]:
    """What is otherwise than in every one of `baked`: the states that are seen."""
    found: list[str] = []
    if all(facts.geometry != now.geometry for facts in baked):
        found.append("what stands in it")
    if all(facts.placement != now.placement for facts in baked):
        found.append("the places of probes")
    for name, value, of_old in (
        ("dimming", now.dimming, [facts.dimming for facts in baked]),
        ("E0", now.e0, [facts.e0 for facts in baked]),
    ):
        if value not in of_old:
            found.append(f"{name} (baked {of_old[0]}, now {value})")
    return found + _changed_lamps(now, baked)


def _changed_lamps(now: BakeFacts, baked: Sequence[BakeFacts]) -> list[str]:
    found: list[str] = []
    for name, value in now.lamps.items():
        known = [facts.lamps[name] for facts in baked if name in facts.lamps]
        if not known:
            found.append(f"the lamp {name!r} is new")
        elif value not in known:
            found.append(f"the lamp {name!r}")
    for name in baked[0].lamps:
        if name not in now.lamps and all(name in facts.lamps for facts in baked):
            found.append(f"the lamp {name!r} is gone")
    return found
