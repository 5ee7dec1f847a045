"""`mfr-bench race` and `shader --json`, as a user meets them."""

import json

import pytest

from mfr_bench.race import build
from mfr_bench.race.campaign import parse_replay, written


def test_a_kept_promise_is_one_line(mfr):
    ended = mfr("race", "kplus-array", "--schedules", "200", "--fragments", "3")
    assert ended.status == 0 and ended.out.count("\n") == 1
    assert "every one gives the image that it promises" in ended.out


def test_hazards_are_counted_and_break_no_promise(mfr):
    ended = mfr("race", "kb", "--schedules", "200", "--fragments", "4")
    assert ended.status == 0 and "it promises nothing" in ended.out


def test_json_says_what_was_tried(mfr):
    record = json.loads(mfr("race", "ab-ll", "--schedules", "100", "--json").out)
    assert record["schedules"] >= 100 and not record["broken"] and record["replay"] is None


@pytest.mark.parametrize(("arguments", "said"), [
    (["--set", "kk=2"], "no parameter 'kk'"), (["--set", "k=0"], "allowed"), (["--fragments", "x"], "--fragments"),
    (["--fragments", "99"], "--fragments"), (["--replay", "x"], "--replay"), (["--warp", "1"], "--warp"),
])
def test_a_mistake_is_one_line(mfr, arguments, said):
    ended = mfr("race", "kplus-array", *arguments)
    assert ended.status == 2 and said in ended.err and ended.err.count("\n") == 1


def test_no_compiler_is_one_line(mfr, monkeypatch):
    monkeypatch.setenv("CXX", "no-such-compiler")
    forget = (build.compiler.cache_clear, build._own_hash.cache_clear)
    for clear in forget:
        clear()
    ended = mfr("race", "kplus-array")
    for clear in forget:
        clear()
    assert ended.status == 1 and "needs a C++ compiler" in ended.err and ended.err.count("\n") == 1


def test_shader_json_holds_passes_buffers_and_parameters(mfr):
    record = json.loads(mfr("shader", "kplus-array", "--set", "k=3", "--json").out)
    assert [p["name"] for p in record["passes"]] == ["clear", "store", "resolve"]
    store = record["passes"][1]
    assert store["kind"] == "geometry" and "void main()" in store["stages"][-1]["glsl"]
    assert store["writes"] == ["counter", "semaphore", "nodes"] and record["params"]["k"] == 3
    assert {b["name"]: b["coherent"] for b in record["buffers"]} == {"counter": True, "semaphore": True, "nodes": True}


def test_a_schedule_survives_being_written():
    choices = ((-1, 1, 1, 2), (0, 1048587, 0, 3), (2, (5 << 20) + 7, 4, 1))
    assert parse_replay(written(5, choices)) == (5, choices)


def test_a_campaign_has_a_line_for_each_machine(mfr):
    ended = mfr("race", "ab-lbuffer", "--campaign", "--schedules", "20", "--scenes", "1")
    lines = ended.out.splitlines()
    assert ended.status == 0 and lines[-1] == "0 broken"
    assert [line.split()[0] for line in lines[:3]] == ["strong", "weak", "lockstep"] and len(lines) % 3 == 1


def test_a_broken_promise_ends_with_status_3_and_can_be_replayed(mfr, plant):
    plant("methods/array/store.frag", "atomicAdd(counter[p], 1u)", "counter[p]++")
    ended = mfr("race", "ab-array", "--fragments", "3", "--schedules", "2000")
    assert ended.status == 3 and "methods/array/store.frag" in ended.out
    word = ended.out.rpartition("--replay ")[2].strip()
    again = mfr("race", "ab-array", "--fragments", "3", "--replay", word)
    assert again.status == 3 and f"--replay {word}" in again.out
