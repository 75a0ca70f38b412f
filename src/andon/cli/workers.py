"""Who computes a bake: processes of this machine, or a cluster; as it is typed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from andon.errors import InputError

if TYPE_CHECKING:
    from andon.bake.tasks import Workers

__all__ = [
    "CertificateOption",
    "KeyOption",
    "SchedulerOption",
    "TrustedOption",
    "WorkersOption",
    "workers_of",
]

WorkersOption = Annotated[
    int | None,
    typer.Option(min=1, help="Processes on this machine; default: one for each core."),
]
SchedulerOption = Annotated[
    str | None,
    typer.Option(metavar="tcp://HOST:PORT", help="Dask scheduler whose workers compute."),
]
TrustedOption = Annotated[
    Path | None, typer.Option(help="PEM of who is trusted, for a tls:// scheduler.")
]
CertificateOption = Annotated[Path | None, typer.Option(help="PEM of this side's certificate.")]
KeyOption = Annotated[Path | None, typer.Option(help="PEM of this side's key.")]


def workers_of(
    count: int | None, scheduler: str | None, tls: tuple[Path | None, Path | None, Path | None], /
) -> Workers:
    """`count` processes (None: one for each core), or the workers of a scheduler.

    `tls` are the files of who is trusted, this side's certificate and its key. Raises `InputError`
    where these exclude each other, where one of them is missing, and for a file that is not there.
    """
    from andon.bake.tasks import DaskWorkers, LocalWorkers

    if scheduler is None:
        if any(tls):
            raise InputError("belongs to --scheduler", field="--tls-ca, --tls-cert, --tls-key")
        return LocalWorkers(count)
    if count is not None:
        raise InputError(
            "and --scheduler exclude each other", field="--workers", remedy="keep one of them"
        )
    if any(tls) and not all(tls):
        raise InputError("belong together", field="--tls-ca, --tls-cert, --tls-key")
    for path in tls:
        if path is not None and not path.is_file():
            raise InputError("must exist", file=path, field="--tls-ca, --tls-cert, --tls-key")
    ca, cert, key = tls
    return DaskWorkers(scheduler, tls_ca=ca, tls_cert=cert, tls_key=key)
