"""What a bake is to do, kept beside what it has done."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

from andon.bake.tasks.model import Task
from andon.bake.tasks.store import PLAN
from andon.errors import InputError, MachineError
from andon.files.atomic import write_bytes

__all__ = ["read_plan", "write_plan"]

KIND = "andon tasks 1"
# A task takes about 200 bytes.
MAX_BYTES = 1 << 28


def write_plan(folder: Path, suffix: str, tasks: Mapping[str, Task], /) -> None:
    """Writes names and keys of `tasks`, in their order. Raises `MachineError` where it cannot."""
    listed = [{"key": key, "name": task.name} for key, task in tasks.items()]
    value = {"kind": KIND, "suffix": suffix, "tasks": listed}
    data = json.dumps(value, ensure_ascii=False, indent=0).encode() + b"\n"
    write_bytes(folder / PLAN, data)


def read_plan(folder: Path, /) -> tuple[str, dict[str, str]] | None:
    """(suffix, key → name) of the tasks of the bake that ran last; None: there was none.

    Raises `InputError` for a file that is none of ours, `MachineError` if it cannot be read.
    """
    path = folder / PLAN
    try:
        if path.stat().st_size > MAX_BYTES:
            raise _refused(path)
        value: Any = json.loads(path.read_bytes())
        if value["kind"] != KIND:
            raise _refused(path)
        listed = cast("list[dict[str, Any]]", value["tasks"])
        return str(value["suffix"]), {str(each["key"]): str(each["name"]) for each in listed}
    except FileNotFoundError:
        return None
    except OSError as error:
        raise MachineError(
            f"{path}: cannot be read: {error.strerror or error}", remedy="let it be read"
        ) from error
    except (ValueError, TypeError, KeyError, RecursionError) as error:
        raise _refused(path) from error


def _refused(path: Path) -> InputError:
    return InputError("is no plan of a bake", file=path, remedy="bake again")
