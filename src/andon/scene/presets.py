"""Lamps that have a name: ``preset = "candle"`` instead of a kind, lumens and kelvin.

Each is one real thing whose light is documented; the reason stands beside it. A preset is only a
shorthand: it is written out before the scene is validated, so whatever else the table states wins,
and a scene that is dumped shows the numbers.

- A given quantity of light (cd, lm, cd/m², lx) replaces the preset's, whatever its unit.
- A given colour (chromaticity, temperature, RGB) replaces the preset's.
- Another `kind` keeps of the preset what that kind has: a candle as a sphere has no
  `visible_radius_m`.
- Places and directions are the scene's own: `position`, or for the sun and the moon `direction`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from andon.errors import InputError, nearest_name
from andon.scene.lamp import LAMP_KINDS

__all__ = ["COLOUR_KEYS", "LIGHT_KEYS", "PRESETS", "Preset", "expand_preset", "expand_presets"]

LIGHT_KEYS = ("intensity_cd", "flux_lm", "luminance_cd_m2", "illuminance_lux")
COLOUR_KEYS = ("chromaticity_xy", "temperature_k", "rgb")


@dataclass(frozen=True)
class Preset:
    """One named lamp.

    Attributes
    ----------
    what : the thing, in a few words.
    keys : the table that it stands for.
    source : where its numbers come from.
    """

    what: str
    keys: Mapping[str, Any]
    source: str


def _preset(what: str, source: str, **keys: Any) -> Preset:
    return Preset(what, MappingProxyType(keys), source)


PRESETS: Mapping[str, Preset] = MappingProxyType(
    {
        # A candle is what the candela is named after: 1 cd to all sides is 4π lm. The flame is a
        # black body of soot; it is drawn as a ball of its width, 5000 cd/m².
        "candle": _preset(
            "a candle flame",
            "1 cd (the historical unit); soot at 1850 K",
            kind="point",
            flux_lm=12.57,
            temperature_k=1850.0,
            visible_radius_m=0.008,
        ),
        # The flame of a lamp with a flat wick, of which ten candlepower were usual.
        "oil-lamp": _preset(
            "an oil lamp with a glass",
            "10 candlepower; soot at 1900 K",
            kind="point",
            flux_lm=125.7,
            temperature_k=1900.0,
            visible_radius_m=0.02,
        ),
        "bulb": _preset(
            "an incandescent bulb, 60 W, 230 V",
            "710 lm (EN 60064); tungsten at 2750 K",
            kind="point",
            flux_lm=710.0,
            temperature_k=2750.0,
            visible_radius_m=0.03,
        ),
        "led": _preset(
            "an LED bulb that replaces 60 W",
            "806 lm, what LED lamps need to be called 60 W (EU 244/2009); 4000 K neutral white",
            kind="point",
            flux_lm=806.0,
            temperature_k=4000.0,
            visible_radius_m=0.03,
        ),
        # An 806 lm bulb in a shell of washi that lets half of it out, net: 200 cd/m², which is
        # what such lanterns have: bright, and not dazzling.
        "paper-lantern": _preset(
            "a round paper lantern, 45 cm",
            "806 lm bulb, half of it leaves the paper; 2700 K",
            kind="sphere",
            flux_lm=403.0,
            temperature_k=2700.0,
            radius_m=0.225,
        ),
        # T8, 26 mm, 1.2 m; its ends are offsets from `position`, along X unless given.
        "fluorescent-tube": _preset(
            "a fluorescent tube T8, 36 W, 1.2 m",
            "3350 lm, 4000 K (EN 60081, 840 tri-phosphor)",
            kind="tube",
            flux_lm=3350.0,
            temperature_k=4000.0,
            ends=((-0.59, 0.0, 0.0), (0.59, 0.0, 0.0)),
            radius_m=0.013,
        ),
        # The cone has half of its intensity at 18°, as "36°" on a reflector lamp means.
        "spotlight": _preset(
            "a reflector lamp GU10, 36° beam",
            "345 lm, what LED lamps need to be called 50 W (EU 1194/2012); 3000 K",
            kind="spot",
            flux_lm=345.0,
            temperature_k=3000.0,
            inner_degrees=15.0,
            outer_degrees=24.0,
            visible_radius_m=0.025,
        ),
        # 16:9 of 24 inches; white at the luminance of an office display. Its normal is given.
        "screen": _preset(
            "a computer screen, 24 inch, all white",
            "250 cd/m², as office displays are sold; D65",
            kind="rectangle",
            luminance_cd_m2=250.0,
            temperature_k=6504.0,
            daylight=True,
            width_m=0.531,
            height_m=0.299,
        ),
        # An overcast sky of 10 klx has 10 klx/π = 3200 cd/m² where it is even; double glazing lets
        # 0.8 of that through. Not drawn, since its glass shows the world outside, and lit to one
        # side: it stands in a wall of the photograph, or before it. Its normal points inwards.
        "window": _preset(
            "a window under an overcast sky, 1.2 × 1.4 m",
            "10 klx/π through double glazing (0.8): 2500 cd/m²; D65",
            kind="rectangle",
            luminance_cd_m2=2500.0,
            temperature_k=6504.0,
            daylight=True,
            width_m=1.2,
            height_m=1.4,
            drawn=False,
            two_sided=False,
        ),
        # Full moon high in a clear sky; warmer than the sun because the Moon is.
        "moon": _preset(
            "the full moon, high in a clear sky",
            "0.25 lx (Kyba, Mohar & Posch 2017: 0.05 to 0.3 lx); 4100 K",
            kind="directional",
            illuminance_lux=0.25,
            temperature_k=4100.0,
        ),
        # What is left of 127.5 klx outside the atmosphere is 103 klx; rounded.
        "sun": _preset(
            "the sun at noon, clear sky, without the sky's own light",
            "127.5 klx × exp(−0.21) through a clear sky (IES Lighting Handbook); 5500 K",
            kind="directional",
            illuminance_lux=100_000.0,
            temperature_k=5500.0,
            daylight=True,
        ),
        "overcast-sky": _preset(
            "an overcast sky at noon, evenly bright",
            "10 klx, a usual level at noon (5 to 20 klx); D65",
            kind="sky",
            illuminance_lux=10_000.0,
            temperature_k=6504.0,
            daylight=True,
        ),
    }
)


def expand_preset(table: Mapping[str, Any], field: str, *, file: str | None = None) -> Any:
    """The [[lamp]] table with its preset written out; without one, the table itself.

    Raises `InputError` for a name that no preset has; `field` is where the table stands.
    """
    if "preset" not in table:
        return table
    name = table["preset"]
    preset = PRESETS.get(name) if isinstance(name, str) else None
    if preset is None:
        near = nearest_name(str(name)[:100], list(PRESETS))
        raise InputError(
            f"must be one of {', '.join(PRESETS)}, got {str(name)[:60]!r}",
            file=file,
            field=field,
            remedy=f"did you mean {near!r}?" if near else "andon lamp presets lists them",
        )
    given = {key: value for key, value in table.items() if key != "preset"}
    left_out: set[str] = set()
    if any(key in given for key in LIGHT_KEYS):
        left_out.update(LIGHT_KEYS)
    if any(key in given for key in COLOUR_KEYS):
        left_out.update((*COLOUR_KEYS, "daylight"))
    kept = {key: value for key, value in preset.keys.items() if key not in left_out}
    kind = LAMP_KINDS.get(str(given.get("kind", preset.keys["kind"])))
    if kind is not None:  # an unknown kind is refused by the scene, which knows the nearest
        kept = {key: value for key, value in kept.items() if key in kind.model_fields}
    return kept | given


def expand_presets(tables: Mapping[str, Any], file: str) -> dict[str, Any]:
    """A scene's tables with the presets of its lamps and of its ambient sources written out."""
    expanded = dict(tables)
    expanded |= _expanded(expanded, "lamp", "lamp", file)
    ambient = expanded.get("ambient")
    if isinstance(ambient, Mapping):
        inner: dict[str, Any] = dict(ambient)  # pyright: ignore[reportUnknownArgumentType]
        expanded["ambient"] = inner | _expanded(inner, "source", "ambient.source", file)
    return expanded


def _expanded(tables: Mapping[str, Any], key: str, field: str, file: str) -> dict[str, Any]:
    lamps = tables.get(key)
    if not isinstance(lamps, tuple):
        return {}
    entries: tuple[Any, ...] = lamps  # pyright: ignore[reportUnknownVariableType]
    return {
        key: tuple(
            expand_preset(entry, f"{field}[{index}].preset", file=file)  # pyright: ignore[reportUnknownArgumentType]
            if isinstance(entry, Mapping)
            else entry
            for index, entry in enumerate(entries)
        )
    }
