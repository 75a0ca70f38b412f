"""A photograph that Radiance took, relit, against the photograph that it takes under the new light.

The furnished room, its triangles of many reflectances, stands in the light of two coloured area
lamps: that picture, in 8 bits, and the three-channel E0 of its pixels are all that Andon is given
besides the geometry. Two other area lamps are added and E0 is dimmed. The truth is the sum of
pictures that Radiance takes along the same rays, lamp by lamp and without interreflection.

``ANDON_SHEETS`` names a folder for a sheet: captured, relit, truth, and eight times the difference.
"""

from __future__ import annotations

import os
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from andon.capture.still import frame_from_picture
from andon.composite.model import Ambient
from andon.display.model import Exposure
from andon.engines.prepared import Prepared
from andon.files.pictures import Picture
from andon.lamps import AnyAreaLamp, DiskLamp, PolygonLamp, Shadow, SphereLamp
from andon.pipeline import EngineName, Frame, Renderer
from andon.quantities import Geometry, Material
from andon.responses import SRGB
from andon.spaces import View
from andon.surface.load import surface_of_mesh
from andon.verify.area_lamps import tiles_at
from andon.verify.psnr import psnr_db
from andon.verify.registry import NotShown, Row
from andon.verify.rooms import camera_in
from andon.verify.setting import room

__all__ = [
    "ROWS",
    "relit_frame",
    "relit_psnr",
    "shown_and_truth",
    "truth_noise_db",
    "unlit_share",
]

Float = NDArray[np.float64]
Bytes = NDArray[np.uint8]

WIDTH, HEIGHT = 240, 135
DIMMING = 0.3
SHADOW = Shadow(map_size=1024, samples=64)
SHADES = 12
# Of the lamps' tiles, see `tiles_at`; the second truth has a quarter as many.
CUTS = 1
MARGIN = 1.02


def _captured_lamps() -> tuple[AnyAreaLamp, ...]:
    """A warm one on the ceiling over the camera and a cool one on the wall beside it."""
    over = np.array([(-0.4, 0, -0.3), (0.4, 0, -0.3), (0.4, 0, 0.3), (-0.4, 0, 0.3)])
    beside = np.array([(0, -0.4, 0.3), (0, -0.4, -0.3), (0, 0.4, -0.3), (0, 0.4, 0.3)])
    keys: dict[str, Any] = {"shadow": SHADOW, "drawn": False}
    return (
        PolygonLamp("over", np.array([460.0, 330, 200]), over + np.array([-1.3, 2.9, 0.9]), **keys),
        PolygonLamp(
            "beside", np.array([210.0, 280, 400]), beside + np.array([-2.45, 1.7, 0.2]), **keys
        ),
    )


def _virtual_lamps() -> tuple[AnyAreaLamp, ...]:
    """A ball above the picture and a disk to its left."""
    facing = np.array([0.8, -0.35, 0.0])
    facing /= np.linalg.norm(facing)
    keys: dict[str, Any] = {"shadow": SHADOW, "drawn": False}
    return (
        SphereLamp("ball", np.array([1500.0, 1100, 700]), np.array([0.3, 2.6, 0.4]), 0.12, **keys),
        DiskLamp(
            "disk", np.array([500.0, 900, 800]), np.array([-2.2, 1.5, -0.5]), facing, 0.15, **keys
        ),
    )


def _view() -> View:
    return camera_in(room(), WIDTH, HEIGHT)


@cache
def _papered() -> Geometry:
    """The room, every triangle in one of twelve shades and hues of its material."""
    plain = room()
    random = np.random.default_rng(23)
    factors = random.uniform(0.35, 1.0, (SHADES, 1)) * random.uniform(0.8, 1.0, (SHADES, 3))
    materials = tuple(
        Material(f"{material.name} {shade}", tuple((factor * material.reflectance).tolist()))
        for material in plain.materials
        for shade, factor in enumerate(factors)
    )
    ids = plain.material_ids
    assert ids is not None
    shade = random.integers(0, SHADES, len(ids))
    return replace(plain, materials=materials, material_ids=(ids * SHADES + shade).astype(np.int32))


def _white() -> Geometry:
    """The room in one reflectance of ½, which makes luminance E/2π."""
    return replace(room(), materials=(Material("half", (0.5, 0.5, 0.5)),), material_ids=None)


def _photographed(geometry: Geometry, lamps: tuple[AnyAreaLamp, ...], cuts: int) -> Float:
    """(H, W, 3) cd/m², the sum of one picture for each lamp: lamps do not hide one another."""
    try:
        from andon.verify.truths.radiance import RadianceScene
    except ImportError as error:
        raise NotShown("Radiance is missing: pip install 'andon[radiance]'") from error
    total = np.zeros((HEIGHT, WIDTH, 3))
    for lamp in lamps:
        with RadianceScene(geometry, [lamp], tiles=tiles_at(cuts)) as scene:
            total += scene.luminance(_view())
    return total


@cache
def _truth(cuts: int) -> tuple[Float, Float, Float]:
    """Captured and relit luminance, cd/m², and E0 in lx, all (H, W, 3)."""
    captured = _photographed(_papered(), _captured_lamps(), cuts)
    white = _photographed(_white(), _captured_lamps(), cuts)
    added = _photographed(_papered(), _virtual_lamps(), cuts)
    return captured, DIMMING * captured + added, 2 * np.pi * white


def _white_cd_m2() -> float:
    """The luminance at the end of the range, for both pictures: neither is clipped."""
    captured, relit, _ = _truth(CUTS)
    return MARGIN * max(float(captured.max()), float(relit.max()))


def _encoded(luminance: Float, white: float) -> Float:
    """(H, W, 3) sRGB in [0, 1], not rounded."""
    return np.asarray(SRGB.encode(np.clip(luminance / white, 0, 1)), np.float64)


def _codes(luminance: Float) -> Bytes:
    return np.asarray(_encoded(luminance, _white_cd_m2()) * 255 + 0.5, np.uint8)


@cache
def relit_frame(engine: EngineName, encoded: bool, stops_under: float = 0.0) -> Frame:
    """Andon's frame, from a photograph of 8 bits (`encoded`) or of floats.

    The photograph is exposed `stops_under` less than the picture that is made of it.
    """
    captured, _, e0 = _truth(CUTS)
    view, shown_white = _view(), _white_cd_m2()
    white = shown_white * 2**stops_under
    if encoded:
        picture = Picture(np.asarray(_encoded(captured, white) * 255 + 0.5, np.uint8), "srgb")
    else:
        picture = Picture((captured / white).astype(np.float32), "linear")
    frame = frame_from_picture(picture, view, SRGB, luminance_per_unit=white)
    # Where no lamp shone the photograph is black and stays so, whatever E0 is said to be.
    e0 = np.maximum(e0, 1e-3 * np.median(e0))
    prepared = Prepared(
        frames={view.name: frame},
        surface=surface_of_mesh(room(), view.position),
        ambient=Ambient(e0, (DIMMING, DIMMING, DIMMING)),
        lamps=lambda _: _virtual_lamps(),
        exposure=Exposure(1 / shown_white),
    )
    return Renderer(prepared, engine).render()


def shown_and_truth(frame: Frame, /) -> tuple[Float, Float, NDArray[np.bool_]]:
    """A frame and the truth (H, W, 3) in codes that are not rounded; which pixels were lit."""
    ours = np.asarray(frame.luminance.cd_m2, np.float64)
    _, relit, e0 = _truth(CUTS)
    white = _white_cd_m2()
    return 255 * _encoded(ours, white), 255 * _encoded(relit, white), e0.max(axis=-1) > 0


def _relit(engine: EngineName, encoded: bool) -> tuple[Bytes, Float]:
    """Andon's picture (H, W, 3): 8-bit codes, and sRGB in [0, 1] before it is rounded."""
    frame = relit_frame(engine, encoded)
    luminance = np.asarray(frame.luminance.cd_m2, np.float64)
    return frame.image.rgb, _encoded(luminance, _white_cd_m2())


@cache
def relit_psnr(engine: EngineName, encoded: bool, *, lit_only: bool) -> float:
    """PSNR of the relit picture in dB: of codes from an 8-bit photograph, or of unrounded sRGB.

    `lit_only` leaves out pixels without any light in the photograph: black times anything is black.
    """
    codes, values = _relit(engine, encoded)
    _, relit, e0 = _truth(CUTS)
    kept = e0.max(axis=-1) > 0 if lit_only else np.ones(e0.shape[:2], bool)
    if not encoded:
        return psnr_db(values[kept], _encoded(relit, _white_cd_m2())[kept])
    _sheet(engine, codes)
    return psnr_db(codes[kept] / 255, _codes(relit)[kept] / 255)


@cache
def truth_noise_db() -> float:
    """PSNR of the truth whose lamps have a quarter of the triangles."""
    coarse, fine = (_encoded(_truth(cuts)[1], _white_cd_m2()) for cuts in (CUTS - 1, CUTS))
    return psnr_db(coarse, fine)


def unlit_share() -> float:
    """Share of the pixels on which no light of the photograph falls."""
    return float((_truth(CUTS)[2].max(axis=-1) <= 0).mean())


def _sheet(engine: EngineName, codes: Bytes) -> None:
    """Writes captured, relit, truth and difference × 8 side by side where they are wanted."""
    folder = os.environ.get("ANDON_SHEETS")
    if not folder:
        return
    from PIL import Image

    Path(folder).mkdir(parents=True, exist_ok=True)

    captured, relit, _ = _truth(CUTS)
    truth = _codes(relit)
    difference = 127.5 + 8 * (codes.astype(float) - truth)
    tiles = [_codes(captured), codes, truth, np.clip(difference, 0, 255).astype(np.uint8)]
    sheet = np.concatenate([np.concatenate(tiles[:2], axis=1), np.concatenate(tiles[2:], axis=1)])
    Image.fromarray(sheet).save(Path(folder) / f"synthetic-{engine}.png")


TRUTH = "Radiance -ab 0 along the same rays, 240×135, two lamps captured and two added"


def _row(engine: EngineName, encoded: bool, lit_only: bool) -> Row:
    name = "relight.synthetic.psnr" + ("" if encoded else ".linear") + (".lit" * lit_only)
    photograph = "8-bit photograph" if encoded else "float photograph"
    pixels = "pixels that were lit in it" if lit_only else "all pixels"
    return Row(
        f"{name}.{engine}",
        "relight",
        38,
        "dB",
        f"{TRUTH}; {photograph}, {pixels}",
        lambda: relit_psnr(engine, encoded, lit_only=lit_only),
        at_least=True,
    )


def _rows(engine: EngineName) -> tuple[Row, ...]:
    kinds = ((True, False), (True, True), (False, False), (False, True))
    return tuple(_row(engine, encoded, lit_only) for encoded, lit_only in kinds)


ROWS: tuple[Row, ...] = (
    *_rows("reference"),
    *_rows("gpu"),
    Row(
        "relight.synthetic.truth_noise",
        "relight",
        48,
        "dB",
        "the same truth by lamps of a quarter of the triangles",
        truth_noise_db,
        at_least=True,
    ),
    Row(
        "relight.synthetic.unlit",
        "relight",
        None,
        "share",
        "pixels without any light in the photograph",
        unlit_share,
    ),
)
