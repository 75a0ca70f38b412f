"""Golden pictures: the illuminance of one lamp of every kind, in false colours."""

import numpy as np
import pytest

from andon.display.false_colour import false_colour
from andon.pipeline import Renderer
from andon.quantities import photometric
from andon.verify.setting import prepared_of
from comparison import assert_golden
from direct.rooms import SOFT, VIEW, lamps
from worlds import open_room

# The GPU's shadow edges may lie a texel beside the reference's: 3 % of these pixels.
EDGES = {"share": 0.03, "mean": 1.5}


def picture(engine, kind):
    view = VIEW.resized(160, 120)
    frame = Renderer(prepared_of(open_room(), view, (lamps(SOFT)[kind],)), engine).render()
    lux = photometric(np.asarray(frame.illuminance.lux))
    return false_colour(lux, "lx", valid=frame.surface.valid)


@pytest.mark.parametrize("kind", lamps(SOFT))
def test_every_lamp(kind, tmp_path):
    assert_golden(picture("reference", kind), f"direct-{kind.replace(' ', '-')}", tmp_path)


@pytest.mark.parametrize("kind", ["point", "spot", "directional"])
def test_every_shadow_on_the_gpu(kind, tmp_path, gpu):
    name = f"direct-{kind}"
    assert_golden(picture("gpu", kind), name, tmp_path, written=False, **EDGES)
