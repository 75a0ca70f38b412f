"""Speed of relighting: the furnished room at 1280×720."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from andon.bench.registry import BenchRow, Duel
from andon.pipeline import Renderer
from andon.verify.registry import NotShown

__all__ = ["PIXELS", "ROWS", "steady"]

WIDTH, HEIGHT = 1280, 720
PIXELS = WIDTH * HEIGHT
# Luminance that the peer's 8-bit target calls white.
WHITE_CD_M2 = 60.0


def steady(renderer: Renderer) -> Callable[[], None]:
    """G-buffer, shading and composite of one frame, maps kept; without the display."""
    engine = renderer._engine  # pyright: ignore[reportPrivateUsage]
    prepared = renderer.prepared
    moment = prepared.at(0.0)
    name = renderer.view_names[0]
    frame = prepared.frames[name]

    def step() -> None:
        seen = engine.see(name, moment)
        engine.compose(frame, seen, engine.illuminate(seen, moment), moment)
        engine.finish()

    return step


def _diffuse(renderer: Renderer) -> NDArray[np.float64]:
    """(H, W, 3) cd/m² that the lamps alone make on the room's own reflectance: ρ·E/π."""
    frame = renderer.render()
    return frame.surface.reflectance * np.asarray(frame.illuminance.lux, float) / np.pi


def _room(lamps: int) -> Renderer:
    from andon.verify.setting import room_setting

    return Renderer(room_setting(lamps, WIDTH, HEIGHT), "gpu")


def _against_pygfx(lamps: int) -> Duel:
    from andon.bench.peers.pygfx_room import PygfxRoom, agreement
    from andon.verify.rooms import camera_in
    from andon.verify.setting import room, room_lamps

    renderer = _room(lamps)
    bulbs = room_lamps(lamps)
    peer = PygfxRoom(
        room(),
        camera_in(room(), WIDTH, HEIGHT),
        [lamp.position_m for lamp in bulbs],
        [lamp.intensity_cd for lamp in bulbs],
        white_cd_m2=WHITE_CD_M2,
        shadows="kept",
    )
    same = agreement(_diffuse(renderer), peer.luminance(), white_cd_m2=WHITE_CD_M2)
    return Duel(
        steady(renderer),
        peer.draw,
        same,
        0.95,
        renderer._engine.adapter,  # pyright: ignore[reportPrivateUsage]
        close=peer.close,
        peer_repeats=11,
    )


def _against_radiance() -> Duel:
    from andon.verify.rooms import camera_in
    from andon.verify.setting import room, room_lamps

    try:
        from andon.verify.truths.radiance import RadianceScene, time_view
    except ImportError as error:
        raise NotShown("Radiance is missing: pip install 'andon[radiance]'") from error
    renderer, view = _room(4), camera_in(room(), WIDTH, HEIGHT)
    scene = RadianceScene(room(), room_lamps(4))
    scene.__enter__()
    ours, truth = _diffuse(renderer), scene.luminance(view)
    close = np.abs(ours - truth).max(axis=-1) <= 0.05 * truth.max(axis=-1) + 1e-3
    return Duel(
        steady(renderer),
        lambda: time_view(scene, view),
        float(close.mean()),
        0.95,
        renderer._engine.adapter,  # pyright: ignore[reportPrivateUsage]
        close=lambda: scene.__exit__(None, None, None),
        peer_repeats=3,
    )


def _against_reference(lamps: int) -> Duel:
    from andon.verify.setting import room_setting

    renderer = _room(lamps)
    slow = Renderer(room_setting(lamps, WIDTH, HEIGHT), "reference")
    ours, truth = _diffuse(renderer), _diffuse(slow)
    close = np.abs(ours - truth).max(axis=-1) <= 0.05 * truth.max(axis=-1) + 1e-3

    def peer() -> None:
        slow._engine._surfaces.clear()  # pyright: ignore[reportPrivateUsage]
        steady(slow)()

    return Duel(
        steady(renderer),
        peer,
        float(close.mean()),
        0.95,
        renderer._engine.adapter,  # pyright: ignore[reportPrivateUsage]
        peer_repeats=2,
    )


def _moved_lamp() -> Duel:
    """One of four lamps moves a centimetre; a room of 28,000 triangles, its 1024² map redrawn."""
    from andon.bench.peers.pygfx_room import PygfxRoom, agreement
    from andon.verify.rooms import camera_in, furnished_room
    from andon.verify.setting import prepared_of, room_lamps

    geometry = furnished_room(28_000)
    view = camera_in(geometry, WIDTH, HEIGHT)
    bulbs = room_lamps(4)
    first = bulbs[0]
    clock = iter(range(1, 1_000_000))

    def at(time_seconds: float) -> tuple[object, ...]:
        shifted = first.position_m + np.array([0.01 * (time_seconds % 2), 0, 0])
        return (replace(first, position_m=shifted), *bulbs[1:])

    prepared = replace(prepared_of(geometry, view, bulbs), lamps=at)  # type: ignore[arg-type]
    renderer = Renderer(prepared, "gpu")
    places = [lamp.position_m for lamp in bulbs]
    candela = [lamp.intensity_cd for lamp in bulbs]
    drawn = PygfxRoom(geometry, view, places, candela, white_cd_m2=WHITE_CD_M2, shadows="drawn")
    kept = PygfxRoom(geometry, view, places, candela, white_cd_m2=WHITE_CD_M2, shadows="kept")
    same = agreement(_diffuse(renderer), drawn.luminance(), white_cd_m2=WHITE_CD_M2)
    engine = renderer._engine  # pyright: ignore[reportPrivateUsage]

    def move() -> None:
        moment = prepared.at(float(next(clock)))
        engine.direct.encode(engine.encoder, moment.lamps, prepared.casters(moment))
        engine.finish()

    def close() -> None:
        drawn.close()
        kept.close()

    return Duel(
        move,
        drawn.draw,
        same,
        0.95,
        engine.adapter,
        close=close,
        peer_repeats=7,
        peer_less=kept.draw,
        peer_parts=len(bulbs),
    )


ROWS: tuple[BenchRow, ...] = (
    BenchRow(
        "relight.frame.4_lamps.pygfx",
        "relight",
        "pygfx, 4 shadowed point lamps, maps kept",
        PIXELS,
        partial(_against_pygfx, 4),
        bar=30.0,
        bar_is_rate=True,
    ),
    BenchRow(
        "relight.frame.4_lamps.radiance",
        "relight",
        "Radiance rtrace, two processes",
        PIXELS,
        _against_radiance,
        bar=100.0,
    ),
    *(
        BenchRow(
            f"relight.frame.{lamps}_lamps.reference",
            "relight",
            "our reference engine (NumPy, Embree)",
            PIXELS,
            partial(_against_reference, lamps),
        )
        for lamps in (1, 4, 16)
    ),
    BenchRow(
        "relight.moved_lamp.pygfx",
        "relight",
        "pygfx, one cube map redrawn",
        PIXELS,
        _moved_lamp,
        bar=30.0,
        bar_is_milliseconds=True,
    ),
)
