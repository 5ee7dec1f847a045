"""One OpenGL device for the whole session (GL has one current context per thread), and how properties are tried."""

import os

import pytest
from hypothesis import settings

# A busy machine is no failure; on a server the same examples are tried each time.
settings.register_profile("mfr-bench", deadline=None, derandomize=bool(os.environ.get("CI")))
settings.load_profile("mfr-bench")


@pytest.fixture(scope="session")
def device():
    """The device that `--device auto` takes. Without a driver the tests that need it fail, and say what to install."""
    from mfr_bench.gpu.device import open_device

    return open_device()
