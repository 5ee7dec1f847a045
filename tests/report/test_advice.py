"""Advice from planted cells: the fastest within the limits, and whether it is told apart; both ways."""

import json

import pytest

from mfr_bench.report import data
from mfr_bench.report.advice import Bounds, advise, as_json, as_text

from . import planted


def point(method, time_ms, rmse, memory_mib=1.0, params=None, **more):
    values = {"rmse": rmse, "flip": 10 * rmse, "max_error_all": 5 * rmse, "memory_bytes": int(memory_mib * 2**20)}
    return planted.cell(method, method, time_ms, values=values, params=params, **more)


CELLS = [point("wboit", 1, 0.1, 0.5), point("mlab", 2, 0.01, 4.0, {"k": 4}), point("ab-ll", 8, 3e-8, 2.0),
         point("ab-sb", 12, 3e-8, 1.0), planted.cell("floor", "floor", 0.5, values={"rmse": None}),
         point("kb", 0.1, 1e-9, status="wrong"), planted.cell("lin-pre", "lin-pre", None, status="unsupported")]


def found(tmp_path, limits, cells=None, **more):
    return advise([data.load(planted.folder(tmp_path / "r", CELLS if cells is None else cells, **more))], limits)


def methods(advice):
    return [p.method for p in advice.kept]


@pytest.mark.parametrize(("metric", "error", "memory", "expected"), [
    ("rmse", 1.0, None, ["wboit", "mlab", "ab-ll", "ab-sb"]),
    ("rmse", 0.05, None, ["mlab", "ab-ll", "ab-sb"]),
    ("rmse", 0.05, 2.0, ["ab-ll", "ab-sb"]),
    ("rmse", 1e-6, 1.5, ["ab-sb"]),
    ("flip", 0.1, None, ["mlab", "ab-ll", "ab-sb"]),
    ("max", 0.04, None, ["ab-ll", "ab-sb"]),
    ("rmse", 1e-9, None, []),
    ("rmse", 0.05, 0.9, []),
])
def test_the_fastest_that_keeps_both_comes_first(tmp_path, metric, error, memory, expected):
    advice, = found(tmp_path, Bounds(metric, error, memory))
    assert methods(advice) == expected


def test_what_the_intervals_hold_apart_is_sure(tmp_path):
    advice, = found(tmp_path, Bounds("rmse", 0.05))
    assert advice.sure is True
    low, middle, high = advice.ratio(advice.kept[1])
    assert low < middle < high and middle == pytest.approx(4)
    text = as_text([advice], 100)
    assert "Sure: no interval of another reaches it; a method measured twice differs by 0.4 %." in text
    assert "mlab k=4" in text


@pytest.mark.parametrize(("more", "apart"), [({"time_ms": 2.02, "width": 0.05}, False),
                                             ({"time_ms": 2.5, "width": 0.01}, True),
                                             ({"time_ms": 2.5, "count": 3}, None)])
def test_what_they_do_not_is_named(tmp_path, more, apart):
    """Intervals that overlap; that do not; and too few samples for any."""
    rival = point("hybrid", rmse=0.01, params={"k": 2}, **more)
    advice, = found(tmp_path, Bounds("rmse", 0.05), [*CELLS, rival])
    second = advice.kept[1]
    assert second.method == "hybrid"
    assert advice.told_apart(second) is apart
    assert advice.sure is bool(apart)
    assert ("Not told apart from hybrid k=2;" in as_text([advice], 100)) is not bool(apart)


def test_a_difference_below_the_noise_floor_is_none(tmp_path):
    """Intervals that exclude 1, on a machine where a method differs from itself by more."""
    rival = point("hybrid", 2.2, 0.01)
    quiet, = found(tmp_path / "quiet", Bounds("rmse", 0.05), [*CELLS, rival], noise_floor_rel=0.01)
    noisy, = found(tmp_path / "noisy", Bounds("rmse", 0.05), [*CELLS, rival], noise_floor_rel=0.2)
    assert quiet.sure is True
    assert noisy.sure is False
    assert [p.method for p in noisy.rivals] == ["hybrid"]


def test_a_ratio_that_is_not_the_quotient_of_the_times_is_explained(tmp_path):
    """A load that came when half of the samples of both were taken; the other has more samples without it."""
    rival = point("hybrid", 2.0, 0.01)
    one, other = ([1.0] * 10 + [3.0] * 12, [2.0] * 10 + [6.0] * 12 + [2.0] * 11)
    cells = [point("ab-ll", 2, 0.01) | {"samples_ms": one}, rival | {"samples_ms": other}]
    for made, time_ms in zip(cells, (3.0, 2.0), strict=True):
        made["values"] = made["values"] | {"time_ms": time_ms, "time_ms_low": time_ms, "time_ms_high": time_ms}
    advice, = found(tmp_path, Bounds("rmse", 0.05), cells)
    assert [p.method for p in advice.kept] == ["ab-ll", "hybrid"]
    assert advice.ratio(advice.kept[1])[1] == pytest.approx(2)
    text = " ".join(as_text([advice], 60).split())
    assert "So the ratio of hybrid is another than the quotient of the times." in text
    assert max(map(len, as_text([advice], 60).splitlines())) <= 60
    usual, = found(tmp_path / "usual", Bounds("rmse", 0.05))
    assert "quotient" not in as_text([usual], 100)


def test_an_unsteady_machine_is_told_of(tmp_path):
    advice, = found(tmp_path, Bounds("rmse", 0.05), calibration_drift="the same work took 2 times as long")
    assert "Unsteady: the same work took 2 times as long." in as_text([advice], 200)
    assert json.loads(as_json([advice]))[0]["unsteady"] == "the same work took 2 times as long"


def test_one_alone_is_neither_sure_nor_unsure(tmp_path):
    advice, = found(tmp_path, Bounds("rmse", 1e-6, 1.5))
    assert advice.sure is None
    assert "Nothing else that was measured keeps the limits. 1 of 4 cells keep the limits." in as_text([advice], 100)


def test_where_nothing_keeps_the_limits_the_nearest_is_told(tmp_path):
    advice, = found(tmp_path, Bounds("rmse", 0.05, 0.9))
    assert as_text([advice], 200).splitlines()[-1] == (
        "Nothing measured keeps this. Within the memory the least rmse is 0.100: wboit. Within the error the least "
        "memory is 1.00 MiB: ab-sb.")


def test_scenes_are_advised_apart(tmp_path):
    deep = {"depth_complexity": 64}
    cells = [*CELLS, point("wboit", 3, 0.3, scene=deep), point("ab-ll", 20, 1e-8, scene=deep)]
    shallow, deeper = found(tmp_path, Bounds("rmse", 0.2), cells)
    assert methods(shallow)[0] == "wboit"
    assert methods(deeper) == ["ab-ll"]
    assert deeper.place.name == "n = 64"


def test_cells_without_the_metric_are_not_taken(tmp_path):
    """Records of before the column was there."""
    old = [planted.cell("ab-ll", "ab-ll", 2.0)]
    advice, = found(tmp_path, Bounds("max", 1.0), old)
    assert methods(advice) == []
    assert "No cell with max_error_all was measured; mfr-bench run planted --force" in as_text([advice], 200)


def test_planned_cells_without_a_record_are_counted(tmp_path):
    advice, = found(tmp_path, Bounds("rmse", 1.0))
    assert advice.unmeasured == 0
    folder = planted.folder(tmp_path / "less", CELLS[:2])
    folder.write_manifest(folder.manifest() | {"cells": [c["key"] for c in CELLS]})
    advice, = advise([data.load(folder)], Bounds("rmse", 1.0))
    assert advice.unmeasured == len(CELLS) - 2
    assert "5 planned cells have no record: mfr-bench run planted." in as_text([advice], 200)


def test_json_says_the_same(tmp_path):
    record, = json.loads(as_json(found(tmp_path, Bounds("rmse", 0.05, 64.0))))
    assert record["best"]["method"] == "mlab"
    assert record["best"]["params"] == {"k": 4}
    assert [r["method"] for r in record["runners_up"]] == ["ab-ll", "ab-sb"]
    assert record["runners_up"][0]["ratio_low"] < 4 < record["runners_up"][0]["ratio_high"]
    assert (record["sure"], record["measured"], record["keep_limits"]) == (True, 4, 3)
    nothing, = json.loads(as_json(found(tmp_path / "none", Bounds("rmse", 1e-12))))
    assert nothing["best"] is None
    assert nothing["runners_up"] == []


def test_size_scene_device_and_date_are_told(tmp_path):
    advice, = found(tmp_path, Bounds("rmse", 0.05))
    text = " ".join(as_text([advice], 100).split())
    assert "planted · llvmpipe" in text and "Measured 2024-05-06: 64×64 pixels; depth complexity n = 32" in text
    record, = json.loads(as_json([advice]))
    assert (record["size"], record["dates"]) == ([64, 64], "2024-05-06")
    assert record["scene"].startswith("64×64 pixels") and record["place"] is None


@pytest.mark.parametrize(("memory_mib", "warned"), [(4.0, False), (31.0, False), (33.0, True), (None, False)])
def test_a_memory_limit_that_decides_nothing_is_called_so(tmp_path, memory_mib, warned):
    """The largest cell takes 4 MiB."""
    advice, = found(tmp_path, Bounds("rmse", 0.5, memory_mib))
    assert bool(advice.warnings) is warned
    text = " ".join(as_text([advice], 100).split())
    said = "WARNING: The memory limit decides nothing here: of 33 MiB no cell takes more than 4.00, at 64×64 pixels"
    assert (said in text) is warned


@pytest.mark.parametrize(("like", "n", "told"), [
    ({"n": 30}, 32, "n 32 where 30 was asked for, 1.07 times apart"),
    ({"n": 64}, 64, "as asked for"),
    ({"n": 50, "size": (128, 128)}, 64, "size 64×64 where 128×128 was asked for, 4.00 times apart"),
])
def test_the_nearest_scene_is_picked_and_its_distance_told(tmp_path, like, n, told):
    cells = [*CELLS, point("wboit", 3, 0.3, scene={"depth_complexity": 64})]
    folder = planted.folder(tmp_path, cells)
    advice, = advise([data.load(folder)], Bounds("rmse", 1.0), like)
    assert advice.place.points[0].at("n") == n
    assert told in advice.distance and told in " ".join(as_text([advice], 200).split())


def test_no_rival_is_faster_than_the_fastest(tmp_path):
    """By its median B is the slower, by the ratios of rounds in which they took turns it surely is the faster."""
    slow, fast = ([2.0 + 0.2 * (i >= 10) for i in range(20)], [1.9 + 0.2 * (i >= 10) for i in range(20)])
    a = point("wboit", 2.0, 0.01) | {"samples_ms": slow}
    b = point("mlab", 2.01, 0.01) | {"samples_ms": fast}
    advice, = found(tmp_path, Bounds("rmse", 0.5), [a, b])
    assert methods(advice) == ["mlab", "wboit"]
    assert advice.ratio(advice.kept[1])[1] > 1


def test_a_ratio_below_one_is_not_printed(tmp_path):
    text = as_text(found(tmp_path, Bounds("rmse", 0.5), [point("wboit", 2.0, 0.01, width=0.2),
                                                         point("mlab", 2.001, 0.01, width=0.2)]), 120)
    assert "times the fastest" in text
    for line in text.partition("times the fastest")[2].splitlines():
        ratio = line.split("   ")[-1].strip()
        assert not ratio.startswith("0."), line


def test_the_hint_names_what_can_be_run(tmp_path):
    folder = planted.folder(tmp_path / "less", CELLS[:2])
    folder.write_manifest(folder.manifest() | {"cells": [c["key"] for c in CELLS]})
    for config, told in (("smoke", "mfr-bench run smoke."), ("", "the command that measured it.")):
        advice, = advise([data.load(folder)], Bounds("rmse", 1.0), config_of=lambda _, config=config: config)
        assert told in as_text([advice], 200)
