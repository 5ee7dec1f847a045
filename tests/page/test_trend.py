"""The page of nights: a planted change is found on its night with its commit, and none where there is none."""

import random
import re

import pytest

from mfr_bench.page import write_trend
from mfr_bench.page.trend import Night, changes, pettitt
from mfr_bench.store import ResultFolder

from ..report import planted

NIGHTS = 30
CHANGED = 18  # the first night of the slower method


def test_pettitt_is_what_its_definition_says():
    """K is the largest sum of signs between the values before and after a place."""
    rng = random.Random(0)  # noqa: S311 - planted noise
    for n in (2, 5, 9, 20):
        values = [rng.choice((1, 2, 3, 4)) for _ in range(n)]
        sums = {at: sum((a > b) - (a < b) for a in values[:at] for b in values[at:]) for at in range(1, n)}
        at, chance = pettitt(values)
        assert abs(sums[at]) == max(map(abs, sums.values()))
        assert 0 <= chance <= 1
    assert pettitt([1.0]) == (0, 1.0)


def nights(factors, rng, noise=0.01):
    return [Night(f"2026-01-{i + 1:02}", f"{i:012x}", f * (1 + rng.gauss(0, noise))) for i, f in enumerate(factors)]


def test_two_changes_are_found_where_they_are():
    rng = random.Random(1)  # noqa: S311 - as above
    found = changes(nights([1.0] * 30 + [1.1] * 30 + [0.9] * 30, rng), 0.001)
    assert [f.night.commit for f in found] == [f"{30:012x}", f"{60:012x}"]
    assert [f.ratio for f in found] == [pytest.approx(1.1, rel=0.02), pytest.approx(0.82, rel=0.1)]


def test_no_change_is_found_in_noise_or_in_one_bad_night():
    rng = random.Random(2)  # noqa: S311 - as above
    assert sum(bool(changes(nights([1.0] * 40, rng, 0.05), 0.01)) for _ in range(100)) <= 3
    assert changes(nights([1.0] * 20 + [3.0] + [1.0] * 20, rng), 0.01) == []


@pytest.fixture
def folder(tmp_path):
    """Thirty nights of one config; from one of them on a method takes 1.2 times as long."""
    rng = random.Random(3)  # noqa: S311 - as above
    for night in range(NIGHTS):
        slower = 1.2 if night >= CHANGED else 1.0
        cells = [planted.cell(method, time_ms=time_ms * factor * (1 + rng.gauss(0, 0.01)))
                 for method, time_ms, factor in (("ab-array", 2.0, 1.0), ("kplus-array", 5.0, slower), ("floor", 1, 1))]
        planted.folder(tmp_path / f"{night:02}" / "planted", cells, started=f"2026-03-{night + 1:02}T02:00:00Z",
                       environment={"revision": {"commit": f"{night:012x}{0:028x}", "dirty": False}})
    return tmp_path


def test_the_page_names_night_commit_and_ratio(folder, tmp_path):
    target = tmp_path / "trend.html"
    found = write_trend([ResultFolder(path.parent) for path in sorted(folder.glob("*/planted/manifest.json"))], target)
    changed = [(trend, change) for group in found for trend in group.trends for change in trend.changes]
    (trend, change), = changed
    assert trend.name == "kplus-array" and change.night.commit == f"{CHANGED:012x}"
    assert change.ratio == pytest.approx(1.2, rel=0.01)
    text = target.read_text()
    assert f"2026-03-{CHANGED + 1:02}: × {change.ratio:.3f}, commit <code>{change.night.commit}</code>" in text
    assert str(folder) not in text and "src=\"http" not in text
    assert re.search(r'<img src="data:image/png;base64,', text)
    assert f"{NIGHTS} nights, 2026-03-01 to 2026-03-30" in text
