"""Which files may be opened: regular ones, of bounded size, inside the folder that they belong to.

A file that was opened on the user's word may name others (textures, buffers, material libraries).
Those names are a stranger's words, so they are *confined*: after every decoding and every symbolic
link they must still lie in the folder of the file that names them. A folder that somebody changes
between the check and the opening is not defended against.
"""

from __future__ import annotations

import re
import stat
from pathlib import Path
from urllib.parse import unquote

from andon.errors import InputError
from andon.files.limits import DEFAULT_LIMITS, Limits

__all__ = ["check_file", "confined", "open_bounded"]

# RFC 3986, 3.1; one letter counts too, so that a drive ("C:") is caught by the same rule.
SCHEME = re.compile(r"^[A-Za-z][A-Za-z0-9+.\-]*:")
CONTROL = re.compile(r"[\x00-\x1f\x7f]")
MAX_REFERENCE = 1024  # characters; file systems stop at 255 per name, 4096 per path


def confined(
    reference: str,
    folder: Path,
    *,
    file: str | Path | None = None,
    percent_encoded: bool = False,
) -> Path:
    """The path that `reference` means, which lies inside `folder` (it need not exist).

    Parameters
    ----------
    reference : relative path found in a file. Backslashes count as separators, as programs on
        Windows write them.
    folder : the folder that must not be left; its own symbolic links are followed first.
    file : the file that holds the reference, for the message.
    percent_encoded : decode ``%xx`` first, once (glTF URIs); otherwise ``%`` is a letter.

    Raises
    ------
    InputError
        if the reference is empty, absolute, has a scheme, contains control characters or
        leaves the folder by ``..`` or by a symbolic link.
    """
    shown = repr(reference if len(reference) <= 80 else reference[:77] + "...")

    def refuse(rule: str) -> InputError:
        return InputError(
            f"{rule}, got {shown}",
            file=file,
            field="reference",
            remedy="put the file beside the one that names it and use a relative path",
        )

    decoded = reference
    if percent_encoded:
        try:
            decoded = unquote(reference, errors="strict")
        except UnicodeDecodeError as error:
            raise refuse("a reference must be UTF-8 after percent-decoding") from error
    for text in (reference, decoded):
        if SCHEME.match(text):
            raise refuse("a reference must not have a scheme or a drive")
    if not decoded.strip() or len(decoded) > MAX_REFERENCE or CONTROL.search(decoded):
        raise refuse("a reference must be 1…1024 characters without control characters")
    slashed = decoded.replace("\\", "/")
    if slashed.startswith(("/", "~")):
        raise refuse("a reference must be relative")
    try:
        base = folder.resolve()
        path = (base / slashed).resolve()
    except (OSError, RuntimeError, ValueError) as error:  # a loop of links, a name too long
        raise refuse("a reference must be a path that can be followed") from error
    if not path.is_relative_to(base) or path == base:
        raise refuse("a reference must stay inside the folder of the file that names it")
    return path


def check_file(path: str | Path, limits: Limits = DEFAULT_LIMITS) -> Path:
    """The path, if it is a regular, readable, non-empty file of at most `max_file_bytes`."""
    _stat_bounded(Path(path), limits.max_file_bytes)
    return Path(path)


def open_bounded(
    path: str | Path, limits: Limits = DEFAULT_LIMITS, *, max_bytes: int | None = None
) -> bytes:
    """All bytes of a regular file of at most `max_bytes` (`limits.max_file_bytes`).

    Raises
    ------
    InputError
        if it is missing, a folder, a device or pipe, unreadable, empty or too large.
    """
    most = limits.max_file_bytes if max_bytes is None else max_bytes
    path = Path(path)
    size = _stat_bounded(path, most)
    try:
        with path.open("rb") as stream:
            # Not read(most + 1): Python allocates what it is asked for, not what is there.
            data = stream.read(size + 1)
    except OSError as error:
        raise InputError(f"must be readable: {error.strerror}", file=path) from error
    if len(data) > size:
        raise InputError("must not grow while it is read", file=path)
    return data


def _stat_bounded(path: Path, most: int) -> int:
    try:
        found = path.stat()
    except (FileNotFoundError, NotADirectoryError) as error:
        raise InputError("must exist", file=path, remedy="check the name and the folder") from error
    except (OSError, ValueError) as error:
        raise InputError(f"must be readable: {error}", file=path) from error
    if stat.S_ISDIR(found.st_mode):
        raise InputError("must be a file, not a folder", file=path)
    if not stat.S_ISREG(found.st_mode):
        raise InputError("must be a regular file, not a device or a pipe", file=path)
    if found.st_size == 0:
        raise InputError("must not be empty", file=path)
    if found.st_size > most:
        raise InputError(f"must have at most {most} bytes, has {found.st_size}", file=path)
    return found.st_size
