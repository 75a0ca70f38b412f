"""Fixtures of all tests.

============================ ====================================================================
environment                  effect
============================ ====================================================================
``ANDON_DATA``               folder of real data; tests that need it skip where it is not set
``ANDON_REQUIRE_DATA=1``     … and fail instead
``ANDON_ENGINE=reference``   tests on the GPU skip, even where there is an adapter
``CI=true``                  a missing adapter is a failure (but for ``ANDON_ENGINE=reference``)
``ANDON_REGENERATE=1``       golden files are written instead of compared, as ``--regenerate``
============================ ====================================================================
"""

import os
import tempfile
from pathlib import Path

import pytest

REGENERATE = "ANDON_REGENERATE"

# Vulkan's loader complains on stderr where there is no desktop session.
os.environ.setdefault("XDG_RUNTIME_DIR", tempfile.gettempdir())


def pytest_addoption(parser):
    parser.addoption(
        "--regenerate", action="store_true", help="write golden files instead of comparing"
    )


def pytest_configure(config):
    # An environment variable, so that helpers that are not fixtures see it too.
    if config.getoption("--regenerate"):
        os.environ[REGENERATE] = "1"


@pytest.fixture(scope="session")
def regenerate():
    """Golden files are to be written."""
    return os.environ.get(REGENERATE) == "1"


@pytest.fixture(scope="session")
def data_dir():
    """The folder of real data as a Path."""
    required = os.environ.get("ANDON_REQUIRE_DATA") == "1"
    folder = os.environ.get("ANDON_DATA")
    if folder and Path(folder).is_dir():
        return Path(folder)
    reason = f"ANDON_DATA is {folder!r}, no folder" if folder else "ANDON_DATA is not set"
    if required:
        pytest.fail(f"{reason}, but ANDON_REQUIRE_DATA=1", pytrace=False)
    pytest.skip(reason)


@pytest.fixture(scope="session")
def gpu():
    """The process's device."""
    if os.environ.get("ANDON_ENGINE") == "reference":
        pytest.skip("ANDON_ENGINE=reference")
    from andon.errors import MachineError
    from andon.gpu.device import open_gpu

    try:
        return open_gpu()
    except MachineError as error:
        if os.environ.get("CI") == "true":
            pytest.fail(f"{error}; or set ANDON_ENGINE=reference", pytrace=False)
        pytest.skip(str(error))


@pytest.fixture(params=["reference", "gpu"])
def engine(request):
    """The name of each engine in turn."""
    if request.param == "gpu":
        request.getfixturevalue("gpu")
    return request.param
