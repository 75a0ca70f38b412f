"""Golden pictures: the eye on the surface, on what is seen through it, and on nothing of it."""

import numpy as np
import pytest

from andon.glass.defocus.reference import blurred
from andon.glass.defocus.stage import DefocusStage
from andon.gpu.textures import make_texture
from comparison import assert_golden
from defocus.pictures import disc_of_glass, sheet

HEIGHT, WIDTH = 110, 150
BALL = disc_of_glass(HEIGHT, WIDTH, 42)
# Diameters of what is refracted, sticks to the surface, is mirrored.
FOCI = {"surface": (22.0, 0.0, 9.0), "background": (0.0, 16.0, 12.0), "neither": (12.0, 30.0, 24.0)}


def scene(focus):
    """A ball with a chequered sticker before a grid and a red bar; a lamp is mirrored in it."""
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    lines = ((rows % 12 < 2) | (columns % 12 < 2))[..., None]
    behind = np.where(lines, [0.1, 0.12, 0.2], [0.75, 0.7, 0.6])
    behind = np.where((abs(rows - 50) < 6)[..., None], [0.7, 0.1, 0.05], behind)
    alpha = 0.4 * ((rows // 9 + columns // 9) % 2)
    lamp = (np.hypot(rows - 40, columns - 60) < 3)[..., None] * [8.0, 7.2, 5.6]
    refracted_px, surface_px, reflected_px = FOCI[focus]
    layers = sheet(
        BALL,
        refracted=0.9 * behind[::-1, ::-1],
        surface=alpha[..., None] * np.array([0.1, 0.35, 0.6]),
        surface_alpha=alpha,
        reflected=0.04 + lamp,
        refracted_px=refracted_px,
        surface_px=surface_px,
        reflected_px=reflected_px,
    )
    return layers, behind


def codes(picture):
    return np.round(255 * np.clip(picture, 0, 1) ** (1 / 2.2)).astype(np.uint8)


@pytest.mark.parametrize("focus", FOCI)
def test_what_the_eye_sees(focus, tmp_path):
    layers, behind = scene(focus)
    assert_golden(codes(blurred(layers).over(behind)), f"defocus_{focus}", tmp_path)


@pytest.mark.parametrize("focus", FOCI)
def test_the_gpu_shows_the_same(gpu, focus, tmp_path):
    """Discs of 6 texels have softer rims: 2 % of the pixels may differ by more than 5 codes."""
    layers, behind = scene(focus)
    none = np.zeros(BALL.shape)
    pictures = {
        "refracted": [layers.refracted, layers.refracted_px],
        "surface": [layers.surface, layers.surface_alpha],
        "reflected": [layers.reflected, layers.reflected_px],
        "sizes": [BALL, layers.surface_px, none, none],
        "target": [behind, none],
    }
    made = {name: make_texture(gpu, "rgba16float", WIDTH, HEIGHT) for name in pictures}
    for name, parts in pictures.items():
        made[name].write(np.dstack(parts))
    encoder = gpu.device.create_command_encoder()
    stage = DefocusStage(gpu, **made, kind="optical", size=(WIDTH, HEIGHT))
    stage.encode(encoder, (32, 12, 86, 86), FOCI[focus])
    gpu.device.queue.submit([encoder.finish()])
    picture = codes(made["target"].read()[..., :3].astype(np.float64))
    assert_golden(picture, f"defocus_{focus}", tmp_path, written=False, share=0.02)
