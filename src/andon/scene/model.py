"""The whole scene: every table of the file, and the rules between tables."""

from __future__ import annotations

import os
from collections.abc import Iterable
from itertools import count
from pathlib import Path
from typing import Any, cast

from pydantic import Field, PrivateAttr, model_validator

from andon.errors import InputError
from andon.quantities import Photometry
from andon.scene.ambient import Ambient, Baked
from andon.scene.base import Table, refusal
from andon.scene.capture import Capture
from andon.scene.eye import Atmosphere, Display, Gaze, Glare, Observer
from andon.scene.lamp import AnyLamp
from andon.scene.objects import Glass, SceneObject
from andon.scene.probes import Probes
from andon.scene.rig import About, Rig
from andon.scene.surface import Surface

__all__ = ["Scene"]


class Scene(Table):
    """Everything that a frame needs. Attribute paths are those of the file.

    Tables that are ``None`` are absent, and so is their stage. `folder` is what paths in the
    scene are relative to and confined to; `file` is named in messages.
    """

    scene: About = Field(
        default=About(),
        description="The session as a whole.",
    )
    rig: Rig | None = Field(
        default=None,
        description="One camera or two eyes.",
    )
    capture: Capture | None = Field(
        default=None,
        description="The pictures and what their numbers mean.",
    )
    surface: Surface | None = Field(
        default=None,
        description="The real geometry that receives light.",
    )
    ambient: Ambient | None = Field(
        default=None,
        description="E0, the light of the photograph.",
    )
    lamp: tuple[AnyLamp, ...] = Field(
        default=(),
        description="[[lamp]]: what emits.",
    )
    baked: Baked | None = Field(
        default=None,
        description="Precomputed illuminance maps.",
    )
    probes: Probes | None = Field(
        default=None,
        description="Light probes.",
    )
    object: tuple[SceneObject, ...] = Field(
        default=(),
        description="[[object]]: virtual objects.",
    )
    glass: tuple[Glass, ...] = Field(
        default=(),
        description="[[glass]]: transparent bodies.",
    )
    observer: Observer = Field(
        default=Observer(),
        description="Whose eyes.",
    )
    gaze: Gaze | None = Field(
        default=None,
        description="Where the observer looks.",
    )
    atmosphere: Atmosphere = Field(
        default=Atmosphere(),
        description="What is in the air.",
    )
    glare: Glare | None = Field(
        default=None,
        description="Light scattered in the observer's eye.",
    )
    display: Display = Field(
        default=Display(),
        description="From luminance to the screen.",
    )

    _folder: Path = PrivateAttr(default=Path())
    _trusted: dict[str, Path] = PrivateAttr(default_factory=dict[str, Path])
    _file: str = PrivateAttr(default="scene.toml")

    @property
    def folder(self) -> Path:
        """What the scene's paths are relative to, and stay inside."""
        return self._folder

    @property
    def file(self) -> str:
        """The name of the scene file, for messages."""
        return self._file

    @property
    def has_photograph(self) -> bool:
        """There is a picture to relight; else all that is seen is virtual."""
        return self.capture is not None and self.capture.source is not None

    @property
    def photometry(self) -> Photometry:
        """``absolute`` or ``relative``: the word that every number carries."""
        return self.scene.photometry

    def placed_at(self, folder: Path, file: str) -> Scene:
        """The same scene with its paths relative to `folder` and `file` named in messages."""
        copy = self.model_copy()
        copy._folder, copy._file = folder, file
        return copy

    def trusting(self, paths: Iterable[Path]) -> Scene:
        """The same scene, allowed to name these files wherever they are.

        For files that the *user* named, on a command line or in a program: confinement is there
        for what a stranger's scene file names. `paths` are relative to the current folder; the
        scene has them as absolute paths, so that none is taken for a file beside the scene.
        """
        copy = self.model_copy()
        copy._trusted = self._trusted | {os.path.abspath(path): Path(path) for path in paths}
        return copy

    def path(self, reference: str, field: str) -> Path:
        """The file that `reference` names, confined to `folder`; `field` is for the message.

        Raises `InputError` if the reference leaves the folder.
        """
        from andon.files.paths import confined

        if reference in self._trusted:
            return self._trusted[reference]
        try:
            return confined(reference, self._folder)
        except InputError as error:
            raise InputError(
                error.rule, file=self._file, field=field, remedy=error.remedy
            ) from error

    def at(self, time_seconds: float) -> Scene:
        """The scene at one moment: keyframes of lamps resolved, none left."""
        from andon.scene.keyframes import lamp_at

        lamps: list[Any] = []
        for index, lamp in enumerate(self.lamp):
            if lamp.path is not None:
                raise InputError(
                    "motion from a file is in the schema but not built yet",
                    file=self._file,
                    field=f"lamp[{index}].path",
                    remedy="use [[lamp.key]]",
                )
            lamps.append(lamp_at(lamp, time_seconds))
        return self.model_copy(update={"lamp": tuple(lamps)})

    def steady(self) -> Scene:
        """The scene with lamps that do not flicker: each has its mean light."""
        lamps: tuple[Any, ...] = tuple(
            lamp.model_copy(update={"flicker": None}) for lamp in self.lamp
        )
        return self.model_copy(update={"lamp": lamps})

    def to_toml(self) -> str:
        """The scene as TOML; parsing it gives an equal scene."""
        from andon.scene.dump import dump_scene

        return dump_scene(self)

    @model_validator(mode="before")
    @classmethod
    def _name_lamps(cls, value: Any) -> Any:
        if not isinstance(value, dict):
            return value
        tables = dict(cast(dict[str, Any], value))
        ambient = tables.get("ambient")
        sources = cast(dict[str, Any], ambient).get("source") if isinstance(ambient, dict) else ()
        lamps, known = _named(tables.get("lamp"), sources)
        if "lamp" in tables:
            tables["lamp"] = lamps
        if isinstance(ambient, dict) and "source" in ambient:
            tables["ambient"] = cast(dict[str, Any], ambient) | {"source": known}
        return tables

    @model_validator(mode="after")
    def _check_between_tables(self) -> Scene:
        self._check_names()
        self._check_baked()
        if self.ambient is not None and self.ambient.probes and self.probes is None:
            raise refusal(
                "needs a [probes] table", key="ambient.probes", remedy="add probes.volume"
            )
        return self

    def _check_names(self) -> None:
        sources = self.ambient.source if self.ambient is not None else ()
        places = [(f"lamp[{index}]", lamp.name) for index, lamp in enumerate(self.lamp)]
        places += [(f"ambient.source[{index}]", lamp.name) for index, lamp in enumerate(sources)]
        first: dict[str, str] = {}
        for place, name in places:
            if name in first:
                raise refusal(
                    f"the name {name!r} is taken by {first[name]}",
                    key=f"{place}.name",
                    remedy="names are unique",
                )
            first[name] = place

    def _check_baked(self) -> None:
        inside = self.baked.lamps if self.baked is not None else ()
        transports = {lamp.name: lamp.transport for lamp in self.lamp}
        baked = frozenset(inside)
        for index, name in enumerate(inside):
            key = f"baked.lamps[{index}]"
            if name not in transports:
                raise refusal(f"there is no lamp {name!r}", key=key)
            if transports[name] == "direct":
                raise refusal(
                    f"the lamp {name!r} has transport 'direct' and would count twice",
                    key=key,
                    remedy="give it transport 'baked' or 'direct+bounce'",
                )
        for index, lamp in enumerate(self.lamp):
            if lamp.transport != "direct" and lamp.name not in baked:
                raise refusal(
                    f"{lamp.transport!r} needs {lamp.name!r} in baked.lamps",
                    key=f"lamp[{index}].transport",
                )


def _named(*lists: Any) -> tuple[Any, ...]:
    """Lists of lamps whose missing names are filled in: the kind and the first free number.

    All lists are numbered together, so that no two lamps of a scene get one name.
    """
    taken = {str(entry["name"]) for lamps in lists for entry in _tables(lamps) if "name" in entry}
    counters: dict[str, count[int]] = {}

    def named(entry: Any) -> Any:
        if not isinstance(entry, dict) or "name" in entry:
            return cast(Any, entry)
        table = cast(dict[str, Any], entry)
        kind = str(table.get("kind", "lamp"))[:40]
        numbers = counters.setdefault(kind, count(1))
        name = next(name for number in numbers if (name := f"{kind}-{number}") not in taken)
        return table | {"name": name}

    return tuple(
        tuple(map(named, cast(tuple[Any, ...], lamps))) if isinstance(lamps, tuple) else lamps
        for lamps in lists
    )


def _tables(lamps: Any) -> list[dict[str, Any]]:
    entries = cast(tuple[Any, ...], lamps) if isinstance(lamps, tuple) else ()
    return [cast(dict[str, Any], entry) for entry in entries if isinstance(entry, dict)]
