"""What a test needs besides the package: skipped where it is missing, but a failure in CI."""

import importlib
import os

import pytest

__all__ = ["missing", "required"]


def required(name):
    """The module `name`."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        return missing(str(error))


def missing(reason):
    """Ends the test, or the module that is being collected."""
    if os.environ.get("CI") == "true":
        pytest.fail(reason, pytrace=False)
    pytest.skip(reason, allow_module_level=True)
