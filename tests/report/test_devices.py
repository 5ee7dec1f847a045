"""Methods over many devices: ratios, ranks, what differs, and the answers for all of them."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from mfr_bench.report import write_together
from mfr_bench.report.devices import Limits, answers, answers_json, answers_text, as_text, read_experiments
from mfr_bench.report.devices.bands import bands_figure, bands_of
from mfr_bench.report.devices.differs import differences, lacking
from mfr_bench.report.devices.figures import device_figure
from mfr_bench.report.devices.standing import MOST_DEVICES, Standing
from mfr_bench.report.devices.together import by_speed
from mfr_bench.report.figures.files import MOST_PANELS, evenly

from . import planted
from .drawing import all_texts


def device(tmp_path, name, times_ms, driver="1.0", depth=8, **manifest):
    """A folder with a cell for each method at two depths, the second twice as long."""
    about = planted.DEVICE | {"slug": name, "renderer": name, "version": driver}
    cells = [planted.cell(label, time_ms=factor * time_ms, device=about,
                          scene={"depth_complexity": n}, point={"scene.depth_complexity": n})
             for label, time_ms in times_ms.items() for n, factor in ((depth, 1), (2 * depth, 2))]
    return planted.folder(tmp_path / name, cells, device=about, **manifest)


@pytest.fixture
def three(tmp_path):
    return [device(tmp_path, "slow", {"ab-array": 8.0, "ab-ll": 9.0, "ab-sb": 30.0}),
            device(tmp_path, "fast", {"ab-array": 3.0, "ab-ll": 1.1, "ab-sb": 1.0}, driver="2.0"),
            device(tmp_path, "usual", {"ab-array": 2.2, "ab-ll": 2.0, "ab-sb": 2.001})]


def test_ratios_and_ranks_are_those_of_each_device(three):
    (found,) = read_experiments(three)
    standing = Standing(found)
    assert found.entries == ["ab-array", "ab-ll", "ab-sb"] and len(found.places) == 2
    assert np.allclose(standing.ratio[..., 1], [[1, 9 / 8, 30 / 8], [3, 1.1, 1], [1.1, 1, 2.001 / 2]])
    assert standing.rank[..., 1].tolist() == [[1, 2, 3], [3, 2, 1], [3, 1, 2]]
    assert standing.rank[2].tolist() == [[3, 3, 3], [1, 1, 2], [1, 2, 2]]  # 2.001 is not told apart from 2
    low, middle, high = standing.ratio[0, 1]
    assert low < middle < high and math.isclose(middle, 9 / 8)


def test_a_method_that_a_device_lacks_has_no_rank_there(tmp_path, three):
    less = device(tmp_path, "less", {"ab-array": 2.0, "ab-sb": 1.0})
    (found,) = read_experiments([*three, less])
    rank = Standing(found).rank[3]
    assert np.isnan(rank[1]).all() and rank[[0, 2], 1].tolist() == [2, 1]
    assert lacking(found) == [("less", 2)]


def test_noise_keeps_ranks_open(tmp_path):
    folders = [device(tmp_path, name, {"ab-array": 1.0, "ab-ll": 1.1}, noise_floor_rel=noise)
               for name, noise in (("calm", 0.01), ("loud", 0.2))]
    (found,) = read_experiments(folders)
    assert Standing(found).rank.tolist() == [[[1, 1, 1], [2, 2, 2]], [[1, 1, 2], [1, 2, 2]]]


def test_what_differs_is_said(three):
    (found,) = read_experiments(three)
    assert differences(found) == [("driver", [("1.0", ["slow", "usual"]), ("2.0", ["fast"])])]
    text = as_text(found, 100)
    assert "driver: 1.0 (slow, usual); 2.0 (fast)" in text and "3 devices" in text
    assert as_text(found, 100, markdown=True).startswith("# planted: 3 devices")


def test_the_best_on_the_worst_device_and_near_the_best_on_all(three):
    at_first, _ = answers(read_experiments(three, whole_scenes=True), Limits())
    assert at_first.best_on_worst.entry == "ab-ll" and at_first.best_on_worst.worst_on == "slow"
    assert math.isclose(at_first.best_on_worst.worst_ratio, 9 / 8)
    assert at_first.shortest_longest.entry == "ab-array" and at_first.shortest_longest.longest_on == "slow"
    assert [row.entry for row in at_first.near_on_all] == ["ab-ll"]
    assert [row.entry for row in answers(read_experiments(three, True), Limits(), within=0.1)[0].near_on_all] == []
    assert json.loads(answers_json([at_first]))[0]["best_on_worst"]["entry"] == "ab-ll"
    assert "Best on the worst device: ab-ll" in answers_text([at_first], 100)


def test_limits_hold_on_every_device(three):
    nothing, *_ = answers(read_experiments(three, whole_scenes=True), Limits(memory_mib=1e-9))
    assert nothing.best_on_worst is None and "Nothing measured keeps this" in answers_text([nothing], 80)


def test_figures_show_each_device_or_the_spread_of_many(tmp_path, three):
    (found,) = read_experiments(three)
    texts = all_texts(device_figure(Standing(found), "ranks"))
    assert {"slow", "fast", "usual"} <= set(texts)
    many = [device(tmp_path, f"d{i:02}", {"ab-array": 1.0 + i, "ab-ll": 2.0}) for i in range(MOST_DEVICES + 1)]
    (spread,) = read_experiments(many)
    texts = " ".join(" ".join(all_texts(device_figure(Standing(spread), "ratios"))).split())
    assert "10 to 90 %" in texts and "d00" not in texts


def test_panels_stand_from_the_fastest_device_to_the_slowest(tmp_path, three):
    (found,) = read_experiments(three)
    assert [path.rpartition("/")[2] for path in by_speed(found)] == ["fast", "usual", "slow"]
    assert evenly(range(1000), 4) == [0, 333, 666, 999] and evenly([1, 2], 24) == [1, 2]
    names = [path.name for path in write_together(three, tmp_path / "out")]
    assert "planted-ratios.png" in names and (tmp_path / "out" / "planted-devices.md").is_file()


def many(tmp_path, count, **parts):
    """Folders of so many devices: the first has the largest ratio, of 2 + count, at the greater depth."""
    return [device(tmp_path, f"d{i:02}", {"ab-array": 1.0, "ab-ll": 2.0 + count - i, "ab-sb": 1.5}, **parts)
            for i in range(count)]


def test_bands_are_quantiles_over_devices_along_the_figures_axis(tmp_path):
    folders = many(tmp_path, 5, figures=[{"kind": "lines", "x": "depth_complexity", "y": "time_ms"}])
    (found,) = read_experiments(folders)
    bands = bands_of(found)
    slow = found.entries.index("ab-ll")
    assert bands.at == [8, 16] and bands.ratios.shape == (5, 2, 3)
    assert bands.ratios[:, :, slow] == pytest.approx(np.array([[7, 6, 5, 4, 3]] * 2).T)
    assert bands.quantiles[:, 0, slow] == pytest.approx([3, 3.4, 5, 6.6, 7])
    assert bands.ends(slow) == ["3.00 on d04", "7.00 on d00"]


def test_bands_need_an_axis_of_numbers(three):
    (found,) = read_experiments(three)
    assert bands_of(found) is None


def test_bands_along_a_parameter_of_the_methods(tmp_path):
    """A method without the parameter has its one time at each value."""
    folders = []
    for name, factor in (("a", 1.0), ("b", 2.0)):
        about = planted.DEVICE | {"slug": name, "renderer": name}
        cells = [planted.cell("kplus-array", time_ms=factor * k, device=about, params={"k": k}, point={"k": k})
                 for k in (4, 16)]
        cells.append(planted.cell("ab-array", time_ms=8.0, device=about))
        folders.append(planted.folder(tmp_path / name, cells, device=about, figures=[{"kind": "lines", "x": "k"}]))
    (found,) = read_experiments(folders)
    bands = bands_of(found)
    entry = found.entries.index("ab-array")
    assert bands.at == [4, 16] and bands.ratios[:, :, entry] == pytest.approx(np.array([[2.0, 1.0], [1.0, 1.0]]))


def test_very_many_devices_have_bands_and_a_few_panels(tmp_path):
    count = MOST_PANELS + 1
    folders = many(tmp_path, count, figures=[{"kind": "lines", "x": "depth_complexity", "y": "time_ms"}])
    names = {path.name for path in write_together(folders, tmp_path / "out")}
    assert {"planted-bands.png", "planted-bands.svg", "planted-ratios.png", "planted.png"} <= names
    (found,) = read_experiments(folders)
    texts = all_texts(bands_figure(Standing(found), bands_of(found)))
    assert "ab-ll" in texts and f"3.00 on d{count - 1}\n{2 + count}.0 on d00" in texts
