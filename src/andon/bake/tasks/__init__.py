"""Tasks: what is done once, by whom, and what of it is done already.

`run_tasks` sees to it that a `Store` has the artefacts of all tasks, with `LocalWorkers` or
`DaskWorkers`. It may be killed at any moment, and begun again.
"""

from __future__ import annotations

from andon.bake.tasks.cluster import DaskWorkers
from andon.bake.tasks.inputs import write_bundle
from andon.bake.tasks.local import LocalWorkers
from andon.bake.tasks.lock import locked
from andon.bake.tasks.model import Bundle, Task, Work, bundle_digest
from andon.bake.tasks.run import TasksProgress, TasksReport, run_tasks
from andon.bake.tasks.status import FailedTask, TasksStatus, tasks_status
from andon.bake.tasks.store import Store
from andon.bake.tasks.workers import Pool, Workers

__all__ = [
    "Bundle",
    "DaskWorkers",
    "FailedTask",
    "LocalWorkers",
    "Pool",
    "Store",
    "Task",
    "TasksProgress",
    "TasksReport",
    "TasksStatus",
    "Work",
    "Workers",
    "bundle_digest",
    "locked",
    "run_tasks",
    "tasks_status",
    "write_bundle",
]
