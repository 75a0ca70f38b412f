"""Bounces by Radiance: one pass that asks for all of them, at the points that probes see.

Through probes each bounce takes a pass over all of them and sees what the one before has left in
the air: nine coefficients of luminance at a few places. Radiance follows the light from surface to
surface instead, so its cost grows with what is asked, not with how often light is reflected, and
errors of the lookup do not feed each other. It is the slower way, and the one that says how good
the other is.

A probe's pass is a function of the points that it sees and of Radiance's scenes, both files: it
runs on any machine, and the same files give the same bytes.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from andon.bake.journal import Result
from andon.bake.runner import Runner
from andon.bake.task import Look
from andon.bake.tasks.model import bundle_digest
from andon.engines.cubes_radiance import EMITTED, LAMPS, SeenPoints, light_scenes, seen_points
from andon.engines.digest import digest
from andon.harmonics import cube_directions
from andon.scene.probes import Probes
from andon.transport.baked.radiance.quality import QUALITIES, Quality
from andon.transport.baked.radiance.trace import traced_illuminance
from andon.transport.probes.capture import Seen, captured
from andon.transport.probes.placement import Placed

__all__ = ["RadianceBounces", "bounce_notes", "gathered", "traced_light", "traced_points"]

Float = NDArray[np.float64]

# Of what is computed here: results of another version are computed again.
VERSION = 1
POINTS = "points.npy"
# What a worker calls.
WORK = "andon.bake.radiance_bounces:traced_points"


def gathered(
    folders: Mapping[str, Path],
    position: Float,
    normal: Float,
    /,
    *,
    quality: Quality,
    bounces: int,
) -> Float:
    """(n, 3) lux at points after at least one reflection, and of what emits.

    `folders` are those of `light_scenes`; light that leaves the points again has been reflected at
    most `bounces` times then. Raises `MachineError` as `traced_illuminance` does.
    """
    total = np.zeros((len(position), 3))
    if LAMPS in folders:
        total += traced_illuminance(
            folders[LAMPS], position, normal, quality=quality, bounces=bounces - 1, part="bounce"
        )
    if EMITTED in folders:
        # What emits is met by rays of the hemisphere: one more of Radiance's bounces finds it.
        total += traced_illuminance(
            folders[EMITTED], position, normal, quality=quality, bounces=bounces - 1,
            direct_bounces=1,
        )  # fmt: skip
    return total


def traced_points(inputs: Mapping[str, Path], settings: Mapping[str, Any], /) -> bytes:
    """A `Work`: the lux (n, 3) of `gathered` as .npy.

    `inputs` has the folder ``points`` with ``points.npy``, (n, 6) float64 positions and normals,
    beside those of `light_scenes`; `settings` the names ``quality`` and ``bounces``.
    """
    points = np.load(inputs["points"] / POINTS, allow_pickle=False)
    folders = {name: path for name, path in inputs.items() if name in (LAMPS, EMITTED)}
    lux = gathered(
        folders,
        points[:, :3],
        points[:, 3:],
        quality=QUALITIES[settings["quality"]],
        bounces=int(settings["bounces"]),
    )
    stream = io.BytesIO()
    np.lib.format.write_array(stream, lux, allow_pickle=False)
    return stream.getvalue()


class RadianceBounces:
    """The pass of a bake; a context manager, since Radiance reads its scenes from files.

    Parameters
    ----------
    small : takes the pictures whose points are lit.
    placed : the probes.
    quality : a name of `QUALITIES`.
    bounces : see `light_scenes`.

    Raises `InputError` for a scene that Radiance cannot be told, see `light_scenes`.
    """

    def __init__(self, small: Look, placed: Placed, quality: str, bounces: int) -> None:
        self.small, self.placed = small, placed
        self.quality, self.bounces = QUALITIES[quality], bounces
        self.scenes = light_scenes(small.setting, bounces)
        sums = {name: bundle_digest(files) for name, files in self.scenes.items()}
        self.name = digest(
            "radiance", VERSION, _programs(), self.quality, bounces, small.size, sums
        )
        self._temporary: TemporaryDirectory[str] | None = None
        self._folders: dict[str, Path] = {}

    def __enter__(self) -> Self:
        self._temporary = TemporaryDirectory(prefix="andon-probes-")
        for name, files in self.scenes.items():
            folder = Path(self._temporary.name) / name
            folder.mkdir()
            for file, contents in files.items():
                (folder / file).write_bytes(contents)
            self._folders[name] = folder
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._temporary is not None:
            self._temporary.cleanup()
            self._temporary = None
            self._folders = {}

    def reflected(self, index: int, /) -> Result:
        """What surfaces around a probe reflect of light that was reflected, or emitted, (k, 3)."""
        seen, points = self._points(index)
        lux = gathered(
            self._folders,
            points.position,
            points.normal,
            quality=self.quality,
            bounces=self.bounces,
        )
        return self._result(index, seen, points.spread(lux))

    def _points(self, index: int) -> tuple[Seen, SeenPoints]:
        seen, _ = self.small.engine.look(self.placed.capture_positions[index], lit=False)
        return seen, seen_points(seen, float(self.placed.ranges_m[index]))

    def _result(self, index: int, seen: Seen, lux: Float) -> Result:
        small = self.small
        capture = captured(
            seen,
            cube_directions(small.size),
            replace(small.setting.lighting, sky=()),
            lux=lux,
            range_m=float(self.placed.ranges_m[index]),
        )
        return {"reflected": small.projected(capture.reflected_cd_m2)}


def traced_light(
    runner: Runner,
    small: Look,
    placed: Placed,
    probes: Probes,
    own: Sequence[int],
    key: Callable[[int], str],
    /,
) -> Float:
    """(m, k, 3) what surfaces reflect around the probes `own` (m,), each kept under its `key`.

    Raises `InputError` as `RadianceBounces` does, `MachineError` as `Runner.each` does.
    """
    with RadianceBounces(small, placed, probes.bounces_quality, probes.bounces) as traced:
        results = runner.each(
            "bounces by Radiance",
            own,
            lambda index: digest(traced.name, key(index)),
            traced.reflected,
        )
    return np.stack([result["reflected"] for result in results])


def bounce_notes(probes: Probes, /) -> dict[str, str]:
    """What a volume says of who computed its bounces, where it was not the probes."""
    if probes.bounces_by == "probes":
        return {}
    return {"bounces_by": probes.bounces_by, "bounces_quality": probes.bounces_quality}


def _programs() -> str:
    """The version of the wheel that Radiance comes with: another one may compute otherwise."""
    try:
        return version("pyradiance")
    except PackageNotFoundError:
        return "none"
