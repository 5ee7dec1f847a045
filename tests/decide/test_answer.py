"""The answer from planted rows: who is named, who is close, and that each of the others has its reason."""

import math
import random
import re
import statistics
from dataclasses import replace

import pytest

from mfr_bench.decide.answer import LIKELY, answer_of
from mfr_bench.decide.candidates import NOT_FINISHED, Excluded
from mfr_bench.decide.question import Question
from mfr_bench.measure.elimination import LATE
from mfr_bench.report import data
from mfr_bench.stats import whole_percents
from mfr_bench.store.status import EXACT_ERROR

from ..report import planted

QUESTION = Question((64, 64), 32)


def raced(method, times_ms, stop_reason="time limit", error=1e-7):
    return planted.cell(method, samples_ms=times_ms, values={
        "time_ms_low": min(times_ms), "time_ms": statistics.median(times_ms), "time_ms_high": max(times_ms),
        "stop_reason": stop_reason, "max_error_all": error})


@pytest.fixture
def answer(tmp_path):
    def of(*cells):
        return answer_of(QUESTION, data.load(planted.folder(tmp_path / "decide", cells)), (), "decide.yaml")
    return of


def test_the_answer_is_the_method_that_frames_of_the_same_rounds_show_to_be_fastest(answer):
    found = answer(raced("ab-array", [10, 10, 10, 90, 90, 90, 90]),  # a burst of load from the fourth round on
                   raced("ab-ll", [11, 11, 11, 89.9, 99, 99, 99]))
    assert found.result.points[1].row["time_ms"] < found.result.points[0].row["time_ms"]
    assert found.best.method == "ab-array" and found.confidence > 0.5


def test_no_answer_says_whether_time_or_the_bounds_are_why(answer):
    """A candidate that the time left unmeasured may keep the bounds."""
    late = planted.cell("ab-ll", status="timeout", reason=LATE)
    wrong = planted.cell("ab-sb", status="over_budget", reason="needs 70 MiB, the budget is 64 MiB")
    assert answer(wrong).untried == 0 and "Nothing keeps these bounds." in answer(wrong).text(80)
    found = answer(late, wrong)
    assert found.best is None and found.untried == 1 and found.record()["method"] is None
    assert "No answer: a candidate was not measured within the time budget" in found.text(200)


def test_a_device_that_fails_self_tests_is_named_in_place_of_an_answer(answer):
    """Neither the time nor the bounds are why."""
    refused = [planted.cell(name, status="unsupported", reason="needs OpenGL", failed_trials=["queries", "blending"])
               for name in ("ab-ll", "ab-sb")]
    late = planted.cell("ab-dfb", status="timeout", reason=LATE)
    for found in (answer(*refused), answer(*refused, late)):
        assert found.failed_trials == ["queries", "blending"] and found.best is None
        said = found.text(200)
        assert "No answer: the device fails self-tests without which any image may be wrong: queries, blending;" in said
        assert "--time-budget, or" not in said and "Nothing keeps" not in said


def test_what_was_not_chosen_begins_with_the_nearest_to_the_answer(tmp_path):
    cells = [planted.cell("kb-mdt64", status="unsupported", reason="needs shader_atomic_int64"),
             raced("peel-f2b", [50.0] * 9, "eliminated after 9 frames: 5 times the time of AB_LL"),
             raced("ab-array", [10.0] * 9), raced("wboit", [1.0], "error above measure.max_error (0.0001)", error=0.2),
             planted.cell("ab-dfb", status="timeout", reason=LATE), raced("ab-sb", [12.0] * 9)]
    excluded = [Excluded("zbuffer", "keeps fewer"), Excluded("kb-ps k=8", NOT_FINISHED)]
    found = answer_of(QUESTION, data.load(planted.folder(tmp_path / "decide", cells)), excluded, "decide.yaml")
    names = ["ab-sb", "peel-f2b", "ab-dfb", "kb-ps k=8", "wboit", "kb-mdt64", "zbuffer"]
    assert [each.method for each in found.out] == names
    said = found.text(200).partition("Not chosen, the nearest to the answer first:\n")[2]
    assert [line.rpartition(": ")[2] for line in said.strip().splitlines()] == [
        "ab-sb (1.20)", "peel-f2b (5.00)", "ab-dfb", "kb-ps k=8", "wboit", "kb-mdt64", "zbuffer"]
    assert [each["method"] for each in found.record()["excluded"]] == names


def test_every_method_that_was_not_chosen_has_a_reason(answer):
    """Every ratio is to the time of the answer, whoever led when the method left."""
    found = answer(raced("ab-array", [10.0] * 9), raced("ab-ll", [10.2] * 9), raced("ab-sb", [12.0] * 9),
                   raced("peel-f2b", [50.0] * 9),
                   raced("ab-dfb", [30.0] * 9, "eliminated after 9 frames: 2.5 times the time of AB_SB"))
    assert [point.method for point in found.close] == ["ab-ll"]
    assert {each.method: (each.reason, each.ratio) for each in found.out} == {
        "ab-sb": ("up to 2 times the time of the answer", pytest.approx(1.2)),
        "ab-dfb": ("2 to 4 times the time of the answer", pytest.approx(3)),
        "peel-f2b": ("4 to 8 times the time of the answer", pytest.approx(5))}
    assert "AB_SB" not in found.text(200)


@pytest.mark.parametrize(("most", "said"), [
    (1 / 255, "an error above --max-error, 0.003922"), (EXACT_ERROR, "an error above 0.0001, the most of an ")])
def test_an_error_that_is_too_large_is_told_by_the_option(tmp_path, most, said):
    cells = [raced("ab-array", [10.0] * 9), raced("wboit", [1.0], f"error above measure.max_error ({most:.3g})", 0.2)]
    folder = planted.folder(tmp_path / "decide", cells)
    found = answer_of(replace(QUESTION, max_error=most), data.load(folder), (), "decide.yaml")
    assert found.best.method == "ab-array" and "measure.max_error" not in found.text(200)
    assert said in found.text(200) and said in found.record()["excluded"][0]["reason"]


@pytest.mark.parametrize(("tied_error", "why"), [
    (0.4, "an error above 0.0001, the most of an exact image: of fragments of equal depth it keeps one"),
    (0.0, "an error above 0.0001, the most of an exact image")])
def test_an_exact_method_that_loses_equal_depths_is_left_out_with_that_reason(answer, tied_error, why):
    gone = raced("peel-f2b", [1.0], "error above measure.max_error", error=0.4)
    gone["values"] |= {"max_abs_error": 1e-7, "tied_error": tied_error}
    found = answer(raced("ab-array", [10.0] * 9), gone)
    assert [(each.method, each.reason) for each in found.out] == [("peel-f2b", why)]


def noisy(middle, seed):
    """Frames of a machine that is busy with other work."""
    drawn = random.Random(seed)  # noqa: S311 - noise, no secret
    return [middle * math.exp(drawn.gauss(0, 0.5)) for _ in range(8)]


@pytest.mark.parametrize("seed", range(5))
def test_methods_that_may_be_as_fast_are_named_beside_a_chance_that_is_small(answer, seed):
    """An answer with a chance of a third was printed beside the words that all others take 5 % longer."""
    found = answer(*(raced(method, noisy(time_ms, f"{seed} {method}")) for method, time_ms in (
        ("ab-array", 10), ("ab-ll", 11), ("ab-sb", 12), ("ab-dfb", 13))))
    others = [p for p in found.finalists[1:] if p not in found.close]
    assert all(p.over(found.best)[0] > 1 and found.chances[p.cell["key"]] < LIKELY + 0.99 / 9 / 4 for p in others)
    if found.confidence < 0.9:
        assert found.close and f"may be as fast: {found.close[0].method} (" in found.text(200)
        assert found.record()["close"][0]["chance"] > 0


def test_the_chances_that_are_told_add_up(answer):
    """After one round nothing is known but its times: thirty methods have the rest of the chances together."""
    times_ms = [10.0, 10.8, *(20.0 + i for i in range(30))]
    found = answer(*(raced(f"m{i}", [time_ms]) for i, time_ms in enumerate(times_ms)))
    said = " ".join(found.text(200).split())
    whole, others = (sum(found.chances[p.cell["key"]] for p in points) for points in (
        found.finalists, [p for p in found.finalists[1:] if p not in found.close]))
    assert whole == pytest.approx(1.0) and others > 0.4
    assert sum(map(int, re.findall(r"(\d+) %", said.partition("Not chosen")[0].partition("Answer")[2]))) == 100
    assert "m31 (51.0)" not in said.partition("Not chosen")[0]


def test_the_command_of_an_answer_is_one_line_to_be_copied(answer):
    found = answer(raced("a", noisy(10.0, "a")), raced("b", noisy(20.0, "b")))
    lines = found.text(60).splitlines()
    assert f"  in full: {found.command}" in lines
    assert all(len(line) <= 60 for line in lines if "in full: " not in line)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize(("count", "dropped"), [(2, False), (2, True), (3, True), (14, False)])
def test_the_percents_of_an_answer_are_100_together(answer, seed, count, dropped):
    """55 and 44 % were told of two, where a third had left: it has the hundredth that dropping it may be wrong."""
    cells = [raced(f"m{i}", noisy(10 + 0.01 * i, f"{seed} {i}")) for i in range(count)]
    gone = [raced("gone", [50.0] * 9, "eliminated after 9 frames: 5 times")] if dropped else []
    found = answer(*cells, *gone)
    said = found.text(10000).partition("Not chosen")[0].partition("Answer")[2]
    assert sum(map(int, re.findall(r"(?<!below )\b(\d+) %", said))) == 100
    assert ("the chance of all others together is " in said) >= dropped
    assert sum(found.chances.values()) == pytest.approx(0.99 if dropped else 1.0)
    assert f"with a chance of {round(100 * found.marked['confidence'])} %" in said


@pytest.mark.parametrize(("shares", "told"), [
    ([0.5549, 0.4451], [55, 45]), ([0.5544, 0.4356, 0.01], [55, 44, 1]), ([1 / 3] * 3, [34, 33, 33]), ([1.0], [100]),
    ([0.999, 0.001], [99, 1]), ([1.0, 0.0], [100, 0]), ([0.004] * 250, [1] * 100 + [0] * 150)])
def test_percents_add_up_by_the_largest_remainders(shares, told):
    assert whole_percents(shares) == told


def test_a_clear_answer_says_that_no_other_was_as_fast(answer):
    said = answer(raced("ab-array", [10.0] * 9), raced("ab-ll", [20.0] * 9)).text(200)
    assert "no other that was timed was as fast; the chance of all others together is 5 %" in said
    gone = raced("ab-ll", [20.0] * 9, "eliminated after 9 frames: 2 times")
    said = answer(raced("ab-array", [10.0] * 9), gone).text(200)
    assert "no other that was timed was as fast; the chance of all others together is 1 %\n" in said
    assert "with a chance of 99 %" in said and "may be as fast: " not in said


def test_an_unsteady_machine_is_told_of(tmp_path):
    folder = planted.folder(tmp_path / "decide", [raced("ab-array", [10.0] * 9)],
                            calibration_drift="the same work took 2 times as long")
    found = answer_of(QUESTION, data.load(folder), (), "decide.yaml")
    assert "  unsteady: the same work took 2 times as long" in found.text(200).splitlines()
    assert found.record()["unsteady"] == "the same work took 2 times as long"
