"""`mfr-bench race` and `shader --json`, as a user meets them."""

import json
import signal
import subprocess
from pathlib import Path

import pytest

from mfr_bench.race import build
from mfr_bench.race.campaign import parse_replay, written

from ..patience import until
from .conftest import command, environment


def test_a_kept_promise_is_one_line(mfr):
    ended = mfr("race", "kplus-array", "--schedules", "200", "--fragments", "3")
    assert ended.status == 0 and ended.out.count("\n") == 1
    assert "every one gives the image that it promises" in ended.out


def test_hazards_are_counted_and_break_no_promise(mfr):
    ended = mfr("race", "kb", "--schedules", "200", "--fragments", "4")
    assert ended.status == 0 and "it promises nothing" in ended.out


def test_a_cache_that_cannot_be_written_is_one_line(mfr, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    ended = mfr("race", "kplus-array", "--schedules", "20")
    assert ended.status == 1 and "XDG_CACHE_HOME names where compiled machines are kept" in ended.complaint
    assert str(tmp_path / "file") in ended.complaint


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


@pytest.fixture
def campaign(mfr, tmp_path):
    """A campaign of one method with few schedules, kept in `tmp_path`."""
    def run(*more: str):
        few = ("--schedules", "20", "--scenes", "1", "--out", str(tmp_path))
        return mfr("race", "adaptive", "--campaign", *few, *more)
    return run


def test_a_campaign_has_a_line_for_each_machine(campaign, tmp_path):
    ended = campaign()
    lines = ended.out.splitlines()
    assert ended.status == 0 and lines[-1].endswith("0 violations")
    assert [line.split()[0] for line in lines[:3]] == ["strong", "weak", "lockstep"] and len(lines) % 3 == 1
    assert len((tmp_path / "races.csv").read_text().splitlines()) == len(lines)


def test_a_campaign_goes_on_with_what_its_table_lacks(campaign, tmp_path):
    first = campaign("--json")
    table = tmp_path / "races.csv"
    kept = table.read_text().splitlines(keepends=True)
    table.write_text("".join(kept[:-2]))
    campaign("--json")
    assert table.read_text().splitlines(keepends=True)[:-2] == kept[:-2]  # with the CPU time of the first run
    assert len(table.read_text().splitlines()) == len(kept)
    assert json.loads(first.out.splitlines()[0])["violations"] == 0


def test_a_campaign_runs_again_what_has_other_code(campaign, plant, tmp_path):
    campaign()
    plant("methods/adaptive/store.frag", "atomicAdd(counter[p], 1u)", "counter[p]++")
    again = campaign("--schedules", "2000")
    assert again.status == 3 and "1 violations" in again.out and "--replay" in again.out
    assert len((tmp_path / "races.csv").read_text().splitlines()) == len(again.out.splitlines())


@pytest.mark.parametrize(("arguments", "said"), [
    (["--campaign", "--weak"], "--weak: not allowed with --campaign"), (["kb", "--jobs", "2"], "only with --campaign"),
    (["--weak"], "METHOD is missing"),
])
def test_options_that_say_nothing_are_a_mistake(mfr, arguments, said):
    ended = mfr("race", *arguments)
    assert ended.status == 2 and said in ended.err and ended.err.count("\n") == 1


def test_a_table_that_is_none_is_one_line(campaign, tmp_path):
    (tmp_path / "races.csv").write_text("a,b\n1,2\n")
    ended = campaign()
    assert ended.status == 1 and "is no table of races" in ended.err and ended.err.count("\n") == 1


def test_a_broken_promise_ends_with_status_3_and_can_be_replayed(mfr, plant):
    plant("methods/array/store.frag", "atomicAdd(counter[p], 1u)", "counter[p]++")
    ended = mfr("race", "ab-array", "--fragments", "3", "--schedules", "2000")
    assert ended.status == 3 and "methods/array/store.frag" in ended.out
    word = ended.out.rpartition("--replay ")[2].strip()
    again = mfr("race", "ab-array", "--fragments", "3", "--replay", word)
    assert again.status == 3 and f"--replay {word}" in again.out


def at_work(pid: int) -> bool:
    """Whether it is a compiled machine that runs."""
    try:
        stat = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        return stat[0] != "Z" and "/mfr-bench/race/" in Path(f"/proc/{pid}/cmdline").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return False


def children(pid: int) -> list[int]:
    return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


@pytest.mark.parametrize("ending", [signal.SIGTERM, signal.SIGKILL])
def test_the_program_of_the_machine_dies_with_the_command(ending, mfr):
    """Its schedules would go on for minutes: nothing else ends it."""
    assert mfr("race", "kplus-array", "--schedules", "10").status == 0  # the program is compiled
    process = subprocess.Popen(command("race", "kplus-array", "--schedules", "100000000"), env=environment(),
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        until(lambda: any(map(at_work, children(process.pid))), "the program does not run")
        running = list(filter(at_work, children(process.pid)))
    finally:
        process.send_signal(ending)
        process.wait()
    until(lambda: not any(map(at_work, running)), "the program outlives the command")
