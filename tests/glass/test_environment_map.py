"""Glass by an environment map: directions alone count, both eyes see the same."""

from types import SimpleNamespace

import numpy as np

from andon.glass.backdrops.model import Footprint
from andon.glass.backdrops.reference import look
from andon.glass.environment_map import environment_mapped
from andon.glass.model import Backdrop, Ball, GlassModel, Solid
from andon.glass.paths import trace

SCENE = SimpleNamespace(luminance_per_unit=1.0, dimming=(1.0, 1.0, 1.0))
CENTRE = np.array([0.02, -0.01, 0.1])


def model_of(backdrop):
    pose = np.eye(4)
    pose[:3, 3] = CENTRE
    return GlassModel((Solid("ball", Ball(0.075), pose, backdrop=backdrop),), blur="optical")


def picture():
    random = np.random.default_rng(3)
    return Backdrop(
        "texture",
        picture=random.uniform(0, 1, (30, 40, 3)).astype(np.float32),
        centre_m=np.array([0.0, 0, -0.2]),
        right_m=np.array([0.4, 0, 0]),
        up_m=np.array([0, 0.3, 0]),
    )


def seen(backdrop, origins, directions):
    steps = np.zeros((len(directions), 2, 3))
    return look(backdrop, origins, directions, Footprint(steps, steps), SCENE)


def test_a_picture_is_seen_as_from_the_bodys_centre():
    near = picture()
    (solid,) = environment_mapped(model_of(near)).solids
    random = np.random.default_rng(4)
    directions = np.concatenate([random.uniform(-1.6, 1.6, (200, 2)), -np.ones((200, 1))], axis=1)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    origins = CENTRE + random.uniform(-0.075, 0.075, (200, 3))
    far = seen(solid.backdrop, origins, directions)
    wanted = seen(near, np.broadcast_to(CENTRE, origins.shape), directions)
    assert (far.missed == wanted.missed).mean() > 0.99
    both = ~far.missed & ~wanted.missed
    assert 20 < both.sum() < 200
    np.testing.assert_allclose(far.light[both], wanted.light[both], atol=1e-3)


def test_it_is_bent_once_and_sharp():
    model = environment_mapped(model_of(picture()))
    assert model.blur == "off"
    direction = np.array([[0.05, 0.02, -1.0]])
    direction /= np.linalg.norm(direction)
    traced = trace(model.solids, np.array([[0.0, 0, 0.5]]), direction)
    assert traced.events[0] == 1
    np.testing.assert_allclose(traced.exit_point, traced.point)


def test_frame_and_geometry_become_a_frame_without_end():
    for kind in ("frame", "surface"):
        (solid,) = environment_mapped(model_of(Backdrop(kind))).solids
        assert solid.backdrop.kind == "frame"
        assert solid.backdrop.distance_m > 1e5
