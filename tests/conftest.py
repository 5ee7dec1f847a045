"""One OpenGL device for the whole session (GL has one current context per thread), and how properties are tried."""

import gc
import os
import signal

os.environ["HYPOTHESIS_NO_PLUGINS"] = "1"  # above all that of trio, which takes each worker 0.3 s

import pytest
from hypothesis import settings

# A busy machine is no failure; on a server the same examples are tried each time.
settings.register_profile("mfr-bench", deadline=None, derandomize=bool(os.environ.get("CI")))
settings.load_profile("mfr-bench")


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Let no search for garbage look at some 15,000 collected tests: neither while they are collected nor later."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


@pytest.fixture(scope="session", autouse=True)
def _signals_of_a_terminal():
    """Commands under test obey Ctrl-C and a lost connection, though pytest runs in the background or under nohup."""
    for number, handler in ((signal.SIGINT, signal.default_int_handler), (signal.SIGHUP, signal.SIG_DFL)):
        if signal.getsignal(number) == signal.SIG_IGN:
            signal.signal(number, handler)


@pytest.fixture(scope="session")
def device():
    """The device that `--device auto` takes. Without a driver the tests that need it fail, and say what to install."""
    from mfr_bench.gpu.device import open_device

    opened = open_device()
    opened.times_frames = False  # which spares compilations
    return opened


@pytest.fixture
def plant(monkeypatch):
    """Replaces one piece of a shader, which has to be there."""
    from mfr_bench import glsl

    def planted(path: str, right: str, wrong: str) -> None:
        original = glsl.read
        assert right in original(path), f"{path} no longer says {right!r}; plant the fault elsewhere"
        monkeypatch.setattr(glsl.includes, "read",
                            lambda p: original(p).replace(right, wrong) if p == path else original(p))
    return planted
