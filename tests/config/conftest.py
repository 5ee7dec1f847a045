import pytest

from mfr_bench import config
from mfr_bench.errors import UsageError

from .fakes import CATALOG

GOOD = """\
name: good
scene: {size: [64, 48], depth_complexity: 32}
methods: [kplus-array, ab-array]
sweep: {k: [4, 16]}
figures: [{kind: lines, x: k, y: time_ms}]
profiles:
  smoke: {scene.size: [16, 16], sweep.k: [2]}
"""


@pytest.fixture
def write(tmp_path):
    """Write a config and give its path."""
    def writer(text, name="a.yaml"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path
    return writer


@pytest.fixture
def load(write):
    """Load config text to its one experiment."""
    def loader(text=GOOD, profile=None, overrides=()):
        [experiment] = config.load(str(write(text)), CATALOG, profile, overrides)
        return experiment
    return loader


@pytest.fixture
def mistakes(write):
    """The error lines of config text, the file called F."""
    def teller(text=GOOD, profile=None, overrides=()):
        path = write(text)
        with pytest.raises(UsageError) as caught:
            config.load(str(path), CATALOG, profile, overrides)
        return [line.replace(str(path), "F") for line in caught.value.lines]
    return teller
