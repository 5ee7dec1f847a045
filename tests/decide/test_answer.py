"""The answer from planted rows: who is named, who is close, and that each of the others has its reason."""

import statistics

import pytest

from mfr_bench.decide.answer import answer_of
from mfr_bench.decide.candidates import NOT_FINISHED, Excluded
from mfr_bench.decide.question import Question
from mfr_bench.measure.elimination import LATE
from mfr_bench.report import data

from ..report import planted

QUESTION = Question((64, 64), 32)


def raced(method, times_ms, stop_reason="time limit"):
    return planted.cell(method, samples_ms=times_ms, values={
        "time_ms_low": min(times_ms), "time_ms": statistics.median(times_ms), "time_ms_high": max(times_ms),
        "stop_reason": stop_reason, "max_error_all": 1e-7})


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
             raced("peel-f2b", [50.0] * 9, "eliminated after 9 frames: 5 times"), raced("ab-array", [10.0] * 9),
             planted.cell("ab-dfb", status="timeout", reason=LATE), raced("ab-sb", [12.0] * 9)]
    excluded = [Excluded("zbuffer", "keeps fewer"), Excluded("kb-ps", NOT_FINISHED)]
    found = answer_of(QUESTION, data.load(planted.folder(tmp_path / "decide", cells)), excluded, "decide.yaml")
    assert [method for method, _ in found.out] == ["ab-sb", "peel-f2b", "ab-dfb", "kb-ps", "kb-mdt64", "zbuffer"]
    said = found.text(200).partition("Not chosen:")[2]
    assert [line.split(": ")[0].strip() for line in said.strip().splitlines()] == [
        "ab-sb", "peel-f2b", "ab-dfb", "kb-ps", "kb-mdt64", "zbuffer"]
    assert [each["method"] for each in found.record()["excluded"]] == [method for method, _ in found.out]


def test_every_method_that_was_not_chosen_has_a_reason(answer):
    found = answer(raced("ab-array", [10.0] * 9), raced("ab-ll", [10.2] * 9), raced("ab-sb", [12.0] * 9),
                   raced("peel-f2b", [50.0] * 9), raced("ab-dfb", [30.0] * 9, "eliminated after 9 frames: 3 times"))
    assert [point.method for point, _ in found.close] == ["ab-ll"]
    assert dict(found.out) == {
        "ab-sb": "slower when the time was up: 1.05 to 2 times the time of ab-array",
        "peel-f2b": "slower when the time was up: 4 to 8 times the time of ab-array",
        "ab-dfb": "eliminated after 9 frames: 3 times"}
