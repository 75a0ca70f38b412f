"""The whole scene as Radiance is told it: a folder of files, octree included."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from andon.files.radiance_programs import run_radiance
from andon.lamps import Body, Lamp, PointLamp
from andon.quantities import Geometry
from andon.transport.baked.radiance.bodies import SIDE_CAL, standing
from andon.transport.baked.radiance.lamps import lamps_text
from andon.transport.baked.radiance.luminaires import POINT_CAL, POINT_FILE
from andon.transport.baked.radiance.materials import MIX_CAL, MIX_FILE
from andon.transport.baked.radiance.surfaces import surfaces_of, without_near
from andon.transport.baked.radiance.textures import TEXTURE_CAL, TEXTURE_FILE

__all__ = ["BOUNCE_OCTREE", "DETAIL_OCTREE", "OCTREE", "radiance_bundle"]

# What stands there, and the lamps; these again of few tiles, for the light that surfaces reflect.
SURFACES, LAMPS, BOUNCE_LAMPS = "surfaces.rad", "lamps.rad", "bounce.rad"
OCTREE, BOUNCE_OCTREE = "scene.oct", "bounce.oct"
# And of many tiles, to correct the light of `OCTREE` by.
DETAIL_LAMPS, DETAIL_OCTREE = "detail.rad", "detail.oct"
# `oconv`: cells are cut until no more things are in them. With 6, its own default, the octree of a
# room of 15,000 triangles has 121 MB, with 16 it has 2.6 MB, the same direct light byte for byte,
# and `rtrace` takes a tenth less time; with 32 it is slower. A frozen octree (-f) would need no
# texts, but is no smaller than both and rounds coordinates.
THINGS = ("-n", "16")
# Tiles of an area lamp: unshadowed light is then off by 0.02 % (rectangle) to 0.4 % (ball) median,
# 0.06 to 1.1 % at the 95th percentile a metre or two away, and a penumbra has so many steps.
TILES = 64
# The same for reflected light.
BOUNCE_TILES = 8
LIMIT_SECONDS = 600.0


def radiance_bundle(
    parts: Sequence[Geometry],
    lamps: Sequence[Lamp],
    bodies: Sequence[Body] = (),
    /,
    *,
    include: Mapping[str, bytes] = {},
    emission: bool = False,
    black: bool = False,
    tiles: int = TILES,
    detail_tiles: int = 0,
    time_limit_seconds: float = LIMIT_SECONDS,
) -> dict[str, bytes]:
    """Name → contents of the files from which `rtrace`, run in their folder, computes.

    ``scene.oct`` has the lamps in all detail, ``bounce.oct`` of few tiles, for the light that
    surfaces reflect, and ``detail.oct``, if asked for, of many.

    Identical inputs give identical bytes.

    Parameters
    ----------
    parts : what stands in the scene, with `Material.reflectance` and textures.
    lamps : what shines; for a lamp's map all of its parts (one `owner`).
    bodies : all luminous bodies of the moment; those of other lamps are dark, but stand there.
    include : name → contents of more things, metres and +Y up: scene texts (``.rad``), and the
        files that they name.
    emission : whether `Material.emissive_cd_m2` shines: it belongs to the photograph, not to a
        lamp, so not in a lamp's map.
    black : nothing reflects; with a sky, ``-ab 1`` is then its direct light.
    tiles : about how many flat pieces stand for each area lamp; the time of direct light grows
        with them. More where something stands close to a lamp.
    detail_tiles : the same for ``detail.oct``, by which that light is corrected; without more
        tiles than ``scene.oct`` has there is no such file.
    time_limit_seconds : for each run of a program.

    Raises
    ------
    InputError : a lamp or material that cannot be: negative, not finite.
    MachineError : Radiance's programs are missing, or fail.
    """
    for lamp in lamps:
        shadow = getattr(lamp, "shadow", None)
        if isinstance(lamp, PointLamp) and shadow is not None:
            parts = [without_near(part, lamp.position_m, shadow.near_m) for part in parts]
    there = standing(lamps, bodies, black=black)
    shining = lamps_text(there.lamps, tiles=tiles, opaque=there.opaque)
    few = lamps_text(there.lamps, tiles=tiles, opaque=there.opaque, most=BOUNCE_TILES)
    many = lamps_text(there.lamps, tiles=max(tiles, detail_tiles), opaque=there.opaque)
    octrees = {OCTREE: (LAMPS, shining.text), BOUNCE_OCTREE: (BOUNCE_LAMPS, few.text)}
    if many.text != shining.text:
        octrees[DETAIL_OCTREE] = (DETAIL_LAMPS, many.text)
    surfaces = surfaces_of(parts, emission=emission, black=black)
    files: dict[str, bytes] = {
        POINT_FILE: POINT_CAL.encode("ascii"),
        MIX_FILE: (MIX_CAL + SIDE_CAL).encode("ascii"),
        TEXTURE_FILE: TEXTURE_CAL.encode("ascii"),
        **shining.files,
        **surfaces.pictures,
        SURFACES: (surfaces.text + there.text).encode("ascii"),
        **{name: text.encode("ascii") for name, text in octrees.values()},
    }
    more = [name for name in include if name.endswith(".rad")]
    texts = {octree: [SURFACES, name, *more] for octree, (name, _) in octrees.items()}
    return _built(files | dict(include), surfaces.meshes, texts, time_limit_seconds)


def _built(
    files: dict[str, bytes],
    meshes: Mapping[str, bytes],
    texts: Mapping[str, list[str]],
    limit: float,
) -> dict[str, bytes]:
    """The files, the meshes and the octrees that Radiance's programs make of them.

    `texts` : octree → names of the scene texts of which it is.
    """
    with TemporaryDirectory(prefix="andon-radiance-") as name:
        folder = Path(name)
        for file, contents in files.items():
            (folder / file).write_bytes(contents)
        for mesh, contents in meshes.items():
            (folder / f"{mesh}.obj").write_bytes(contents)
            run_radiance("obj2mesh", [f"{mesh}.obj", f"{mesh}.rtm"], b"", limit, cwd=folder)
            files[f"{mesh}.rtm"] = (folder / f"{mesh}.rtm").read_bytes()
        for octree, names in texts.items():
            files[octree] = run_radiance("oconv", ["-w", *THINGS, *names], b"", limit, cwd=folder)
    return files
