"""The command line: parses, calls the pipeline, prints. Exit codes are those of CONVENTIONS.md."""

from __future__ import annotations

import sys

__all__ = ["main"]

INTERRUPTED = 130


def main(arguments: list[str] | None = None) -> None:
    """Runs `andon` and exits: 0 done, 1 our fault, 2 the input, 3 the machine, 130 interrupted."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    debug = "--debug" in words
    words = [word for word in words if word != "--debug"]
    sys.exit(_run(words, debug))


def _run(words: list[str], debug: bool) -> int:
    import typer

    from andon.cli.app import app
    from andon.errors import AndonError

    try:
        result = app(args=words, prog_name="andon", standalone_mode=False)
        if result == INTERRUPTED:  # newer versions of Typer catch the interrupt themselves
            return _say("interrupted", INTERRUPTED)
        return result if isinstance(result, int) else 0
    except AndonError as error:
        if debug:
            raise
        return _say(str(error), error.exit_code)
    except (typer.Abort, KeyboardInterrupt):
        return _say("interrupted", INTERRUPTED)
    except BrokenPipeError:
        return 0
    except Exception as error:
        # Usage errors are Click's or, in newer versions, Typer's own: no common base, one method.
        usage = getattr(error, "format_message", None)
        if usage is not None:
            return _say(f"{usage().rstrip('.')}; see {_command(error)} --help", 2)
        if debug:
            raise
        what = f"{type(error).__name__}: {error}".replace("\n", " ")
        return _say(f"internal error, please report it with the output of --debug: {what}", 1)


def _command(error: Exception) -> str:
    """The command that a usage error is of: that of its context, if it has one."""
    return getattr(getattr(error, "ctx", None), "command_path", None) or "andon"


def _say(message: str, code: int) -> int:
    print(f"andon: {' '.join(message.split())}", file=sys.stderr)
    return code
