"""One OpenGL device for the whole session: GL has one current context per thread."""

import pytest


@pytest.fixture(scope="session")
def device():
    from mfr_bench.gpu.device import open_device

    return open_device()
