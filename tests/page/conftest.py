"""A planted result folder with figures and kept images, its page, and a real Chromium."""

import shutil

import numpy as np
import pytest
from selenium import webdriver

from mfr_bench.page import write_page
from mfr_bench.store.arrays import write_arrays

from ..report import planted

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")


def image(level: int) -> np.ndarray:
    """A small kept image: a ramp from transparent to opaque."""
    found = np.zeros((24, 32, 4), dtype=np.uint8)
    found[..., 3] = np.linspace(0, 255, 32, dtype=np.uint8)
    found[..., 0] = found[..., 3] // 2 + level
    return found


@pytest.fixture(scope="session")
def results(tmp_path_factory):
    """A sweep of k by every planted method, two of whose cells kept their image."""
    path = tmp_path_factory.mktemp("page") / "planted"
    cells = planted.sweep()
    folder = planted.folder(path, cells, [{"kind": "lines", "x": "k", "y": "time_ms"}], {"k": [4, 8, 16, 32, 64]},
                            environment={"cpu": "A CPU", "host": "secret-host", "revision": {"commit": "0" * 40}},
                            config="/home/somebody/planted.yaml")
    for level, cell in enumerate(cells[1:3]):
        write_arrays(folder, cell["key"], {"image": image(20 * level)})
    return folder


@pytest.fixture(scope="session")
def page(results, tmp_path_factory):
    """The page's file."""
    path = tmp_path_factory.mktemp("html") / "report.html"
    write_page([results], path)
    return path


@pytest.fixture(scope="module")
def browser():
    """Chromium, where it is there with its driver; it keeps what the page says on the console."""
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    started = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
    started.set_script_timeout(60)
    yield started
    started.quit()
