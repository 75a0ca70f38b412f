"""Glare of one view in float64."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from andon.engines.glare import SceneGlare, taken_share
from andon.engines.glare_lamps import UnpicturedLamps
from andon.glare.gate import gate
from andon.glare.needles.reference import draw
from andon.glare.per_source.reference import halos_of_sources, veil_of_sources
from andon.glare.sources.survey import survey
from andon.glare.whole_picture.reference import scattered
from andon.lamps import Lamp
from andon.quantities import photometric
from andon.spaces import View

__all__ = ["glare_seen"]

Float = NDArray[np.float64]


def glare_seen(
    own: SceneGlare,
    light: Float,
    view: View,
    lamps: Sequence[Lamp],
    hiding: UnpicturedLamps,
    mirrored: Float | None,
    /,
) -> tuple[Float, Float]:
    """What is left of `light` (H, W, 3) cd/m² where it was, and what glare adds.

    `mirrored` (H, W, 3) is the part of it that is highlights.
    """
    shining = light
    if mirrored is not None and not own.highlights:
        shining = np.maximum(light - mirrored, 0)
    found = own.finder(view).find(survey(shining), lambda rows, columns: shining[rows, columns])
    found, unpictured = hiding.split(lamps, found, view, blooms=not own.plans)
    seen, sources = own.around(found, view), [source.rounded() for source in found.sources]
    added = draw(seen.needles, view) + veil_of_sources(unpictured, view, own.kernel)
    if own.ring is not None:
        weights = seen.halo_weights.tolist()
        added += halos_of_sources(sources, view, own.kernel, own.ring, weights=weights)
    share = taken_share(found, seen, own.bloom_share(view))
    least = gate(photometric(shining), found.ambient_cd_m2, contrast=own.contrast)
    taken = shining * share * least[..., None]
    if not own.plans:
        return light - taken, added + veil_of_sources(sources, view, own.kernel)
    whole = scattered(light, own.plans[view.name])
    return whole.picture - whole.glare - taken, added + whole.glare
