"""Golden pictures as the paper's figures 5 and 6: a point, and an ellipse, on both engines."""

import numpy as np
import pytest

from andon.display.model import Exposure
from andon.display.reference import encode
from andon.glare.needles import NeedleModel, needles_of, reference
from andon.observer.spread.model import Eye
from andon.responses import SRGB
from comparison import assert_golden

from .stars import close_up, disc, ellipse, lamp
from .test_parity import by_gpu

SHORT_SIGHTED = Eye(pupil_mm=6.0, glasses="spectacles", glasses_dioptres=-4.0)
OUTLINES = {"point": disc(), "ellipse": ellipse(0.36, 0.12, 25)}
WHITE_CD_M2 = 60.0


@pytest.mark.parametrize("shape", OUTLINES)
def test_stars(engine, request, tmp_path, shape):
    view = close_up(150, 0.04)
    source = lamp([1.0, 0.85, 0.65], outline=OUTLINES[shape])
    model = NeedleModel()
    star = needles_of(source, SHORT_SIGHTED, 0.1, 4, model=model)
    if engine == "gpu":
        gpu = request.getfixturevalue("gpu")
        picture = by_gpu(gpu, [star], view, model)
    else:
        picture = reference.draw([star], view)
    codes = encode(picture / WHITE_CD_M2, Exposure(tone="reinhard"), SRGB, 1.0)
    assert np.ptp(codes) > 100
    assert_golden(codes, f"needles_{shape}", tmp_path, written=engine == "reference")
