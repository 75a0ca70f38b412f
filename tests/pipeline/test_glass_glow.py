"""Glow of luminous bodies that stand behind glass."""

import numpy as np

import andon
from andon.scene import scene_from_dict
from worlds import sheet, write_glb

LAMP = {"kind": "sphere", "position": [0.33, 0, -1.8], "radius_m": 0.05, "luminance_cd_m2": 2e4}
SUN = {"kind": "directional", "direction": [0, 0, -1], "illuminance_lux": 300.0}
GLARE = {"model": "glow", "glow_fraction": 0.5, "glow_sigma_degrees": 4.0}


def test_what_glass_hides_does_not_glow(tmp_path, engine):
    """Light is taken from where a body is seen: behind glass there is none to be taken."""
    write_glb(tmp_path / "wall.glb", sheet((-5, -5, -4), (10, 0, 0), (0, 10, 0)))
    tables = {
        "rig": {"camera": {"width": 96, "height": 72, "fx": 80.0}},
        "surface": {"mesh": "wall.glb"},
        "lamp": [LAMP, SUN],
        "glass": [{"shape": "sphere", "radius_m": 0.3, "position": [0.2, 0, -1.2]}],
    }
    plain = andon.render(scene_from_dict(tables, folder=tmp_path), engine=engine)
    glowing = scene_from_dict(tables | {"glare": GLARE}, folder=tmp_path)
    seen = andon.render(glowing, engine=engine).luminance.cd_m2
    assert (seen >= 0).all()
    covered = plain.glass.layers.coverage == 1
    behind = andon.render(glowing, engine="reference").surface.body_id >= 0
    assert (covered & behind).any(), "the lamp is behind the ball"
    # Nothing is taken where it is hidden, and what glows beside it only adds.
    less = plain.luminance.cd_m2[covered] - seen[covered]
    np.testing.assert_array_less(less, 0.02 * plain.luminance.cd_m2[covered] + 1)
