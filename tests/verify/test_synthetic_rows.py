"""A thinned `relight.synthetic`: a small picture, coarse lamps."""

import numpy as np
import pytest

from andon.verify.psnr import psnr_db
from andon.verify.registry import rows
from andon.verify.rows import synthetic
from andon.verify.run import chosen, measured
from requirements import required

required("pyradiance")


@pytest.fixture
def small(monkeypatch):
    monkeypatch.setattr(synthetic, "WIDTH", 80)
    monkeypatch.setattr(synthetic, "HEIGHT", 45)
    monkeypatch.setattr(synthetic, "CUTS", 0)
    caches = synthetic._truth, synthetic.relit_frame, synthetic.relit_psnr
    for cache in caches:
        cache.cache_clear()
    yield
    for cache in caches:
        cache.cache_clear()


@pytest.mark.usefixtures("small")
def test_what_was_lit_is_relit(monkeypatch, tmp_path):
    from PIL import Image

    monkeypatch.setenv("ANDON_SHEETS", str(tmp_path))
    assert synthetic.relit_psnr("reference", True, lit_only=True) > 38
    assert synthetic.relit_psnr("reference", False, lit_only=True) > 45
    assert synthetic.unlit_share() < 0.05
    with Image.open(tmp_path / "synthetic-reference.png") as sheet:
        assert sheet.size == (160, 90)
    captured, relit, _ = synthetic._truth(0)
    white = synthetic._white_cd_m2()
    unchanged = psnr_db(synthetic._encoded(captured, white), synthetic._encoded(relit, white))
    assert unchanged < 25, "the light has to change for the figure to mean something"


@pytest.mark.usefixtures("small", "gpu")
def test_shaders_relight_it_too():
    assert synthetic.relit_psnr("gpu", True, lit_only=True) > 38


def test_psnr():
    black = np.zeros((2, 2, 3))
    assert psnr_db(black, black + 0.1) == pytest.approx(20)


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["reference", "gpu"])
def test_the_whole_picture_holds(engine, request):
    if engine == "gpu":
        request.getfixturevalue("gpu")
    names = [f"relight.synthetic.psnr.lit.{engine}", "relight.synthetic.truth_noise"]
    for entry in chosen(names, rows()):
        assert measured(entry)["holds"] is True, measured(entry)
