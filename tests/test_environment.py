"""The machine as a manifest states it: parsed from what the system, git and the driver print; unknown is None."""

from pathlib import Path

import pytest

import mfr_bench
from mfr_bench import environment
from mfr_bench.environment import differences, lasting, nvidia, passing, revision, throttle_reasons

NVIDIA = {"renderer": "NVIDIA H200/PCIe/SSE2", "vendor": "NVIDIA Corporation", "version": "4.6.0 NVIDIA 550.54.15"}
MESA = {"renderer": "llvmpipe (LLVM 15.0.6, 256 bits)", "vendor": "Mesa", "version": "4.5 (Core Profile) Mesa 22.3.6"}
H100 = "NVIDIA H100, 550.54.15, P0, 345, 1593, 1980, 31, 69.12, 0x0000000000000001\n"
H200 = "NVIDIA H200, 550.54.15, P0, 1980, 3201, 1980, 54, 410.50, 0x0000000000000044\n"


def printing(text):
    return lambda command: text


def test_this_machine_is_described():
    found = lasting(MESA)
    assert (found["gpu"], found["gl"], found["mesa"]) == (MESA["renderer"], MESA["version"], "22.3.6")
    assert found["cores"] >= 1 and found["kernel"]
    assert set(passing(MESA)) == {"load", "gpu"} and passing(MESA)["gpu"] is None
    assert len(passing(MESA)["load"]) == 3
    assert environment.versions()["mfr-bench"] == mfr_bench.__version__


def test_a_processor_without_a_name_is_not_made_up(monkeypatch):
    assert environment.cpu_model("processor\t: 0\nmodel name\t: Some  CPU @ 2.0 GHz\n") == "Some CPU @ 2.0 GHz"
    monkeypatch.setattr(environment.platform, "processor", str)
    assert environment.cpu_model("") is None


def test_the_gpu_that_draws_is_the_one_described():
    gpu = nvidia(NVIDIA, printing(H100 + H200))
    assert (gpu["name"], gpu["clocks.sm"], gpu["power.draw"]) == ("NVIDIA H200", 1980, 410.5)
    assert gpu["throttle_reasons"] == ["software power cap", "hardware thermal slowdown"]


@pytest.mark.parametrize("printed", [None, "", "no devices were found\n", H100 + H100])
def test_what_the_driver_does_not_tell_is_none(printed):
    assert nvidia(NVIDIA, printing(printed)) is None


def test_a_field_that_the_driver_does_not_support_is_none_and_not_0():
    gpu = nvidia(NVIDIA, printing("NVIDIA H200, 550.54.15, [N/A], [N/A], 3201, 1980, 54, [Not Supported], [N/A]\n"))
    assert [gpu[name] for name in ("pstate", "clocks.sm", "power.draw", "throttle_reasons")] == [None] * 4
    assert gpu["clocks.mem"] == 3201


def test_other_makers_are_not_asked():
    assert nvidia(MESA, lambda command: pytest.fail("asked")) is None


@pytest.mark.parametrize(("mask", "names"), [("0x0", []), ("0x1", ["idle"]), ("x", None), (None, None)])
def test_throttle_reasons_are_bits(mask, names):
    assert throttle_reasons(mask) == names


def test_a_revision_is_that_of_the_packages_own_checkout(tmp_path):
    package = tmp_path / "mfr_bench"
    package.mkdir()
    said = {"rev-parse": f"{tmp_path}\nabc123\n", "status": " M file\n"}
    run = lambda command: said[command[3]]  # noqa: E731
    assert revision(package, run) is None  # a site-packages folder inside somebody's repository
    (tmp_path / "pyproject.toml").touch()
    assert revision(package, run) == {"commit": "abc123", "dirty": True}
    said["status"] = ""
    assert revision(package, run)["dirty"] is False
    assert revision(package, printing(None)) is None


def test_a_program_that_is_missing_or_fails_says_nothing():
    assert environment.ask(["mfr-bench-has-no-such-program"]) is None
    assert environment.ask(["false"]) is None
    assert revision(Path("/"), environment.ask) is None


def test_differences_leave_out_what_changes_all_the_time():
    before = {"mesa": "22", "cores": 2, "revision": None, "start": {"load": [1]}}
    after = {"mesa": "23", "cores": 2, "revision": {"commit": "abc", "dirty": False}, "start": {"load": [2]}}
    assert differences(before, after) == ["mesa: 22 -> 23", "revision.commit: unknown -> abc",
                                          "revision.dirty: unknown -> False"]
    assert differences(before, before) == []


def test_what_held_the_clocks_back_is_a_difference_and_being_idle_is_not():
    def ends(*reasons):
        return {part: {"load": [1], "gpu": {"throttle_reasons": found}}
                for part, found in zip(("start", "end"), reasons, strict=True)}

    assert differences(ends(["idle"], []), ends([], ["software power cap", "idle"])) == [
        "throttle reasons: none -> software power cap"]
    assert differences(ends(["idle"], []), ends([], None)) == []
    assert differences({"start": {"gpu": None}}, ends(["hardware slowdown"], [])) == [
        "throttle reasons: unknown -> hardware slowdown"]
    assert differences({"start": 3, "end": {"gpu": {"throttle_reasons": 4}}}, {}) == []
