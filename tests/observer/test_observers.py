"""Named observers, and the eye of a scene's."""

import pytest

from andon.errors import InputError
from andon.observer.presets import adaptation_of, eye_of, observer_preset
from andon.observer.pupil import moon_spencer_mm, watson_yellott_mm
from andon.observer.spread.family import spread_function
from andon.observer.spread.model import Eye
from andon.scene.eye import Atmosphere, Observer


def test_names():
    old = observer_preset("old", eyes="blue", worn="contact-lenses")
    assert (old.age, old.pigment) == (70, 1.0)
    assert (old.glasses, old.glasses_dioptres) == ("contact-lenses", -4)
    plain = observer_preset()
    assert (plain.age, plain.pigment, plain.glasses) == (45, 0.5, "none")
    assert observer_preset("young", worn="short-sighted").glasses == "spectacles"


@pytest.mark.parametrize(
    ("field", "words"),
    [("age", {}), ("eyes", {"eyes": "pink"}), ("worn", {"worn": "monocle"})],
)
def test_names_that_are_none(field, words):
    with pytest.raises(InputError, match=f"{field}: must be one of "):
        observer_preset("ancient" if field == "age" else "old", **words)


@pytest.mark.parametrize(
    ("luminance", "adaptation"),
    [
        (0, "scotopic"), (0.0049, "scotopic"), (0.005, "mesopic"), (1, "mesopic"), (5, "mesopic"),
        (5.01, "photopic"), (1e5, "photopic"),
    ],
)  # fmt: skip
def test_adaptation(luminance, adaptation):
    assert adaptation_of(luminance) == adaptation
    assert eye_of(None, None, luminance).adaptation == adaptation


def test_what_is_stated_is_the_eye_s():
    observer = Observer(
        age=70, pigment=1.2, pupil_mm=3.5, glasses="spectacles", glasses_dioptres=-2
    )
    eye = eye_of(observer, Atmosphere(mist=0.4), 100.0, "scotopic")
    assert eye == Eye(70, 1.2, 3.5, "spectacles", -2, 0.4, "scotopic")


def test_the_pupil_follows_the_light():
    assert eye_of(None, None, 10.0).pupil_mm == watson_yellott_mm(10.0, age_years=25)
    older = Observer(age=70, pupil_model="moon-spencer")
    assert eye_of(older, None, 10.0).pupil_mm == moon_spencer_mm(10.0)
    dark, light = (eye_of(None, None, luminance) for luminance in (0.01, 1000.0))
    near = [spread_function("ijspeert", eye).bloom_per_sr(0.1) for eye in (dark, light)]
    assert near[0] > near[1]


@pytest.mark.parametrize("luminance", [-1.0, float("nan"), float("inf")])
@pytest.mark.parametrize("observer", [None, Observer(pupil_mm=4)])
def test_luminances_that_are_none(luminance, observer):
    with pytest.raises(InputError, match="must be ≥ 0 cd/m²"):
        eye_of(observer, None, luminance)
