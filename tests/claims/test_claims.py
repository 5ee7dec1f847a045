"""Each claim on planted measurements: borne out, contradicted, and out of reach for every reason there is."""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest

from mfr_bench.claims import CLAIMS, judge_all, load_runs
from mfr_bench.claims.verdict import FAILS, HOLDS, NOT_TESTABLE, VERDICTS

from . import planted

BY_ID = {claim.id: claim for claim in CLAIMS}
IDS = list(BY_ID)
TIMED = [i for i in IDS if i not in planted.COUNTED]


def verdict(tmp_path, claim_id, cells, device=planted.GPU, **manifest):
    made = planted.folder(tmp_path / "run", planted.CASES[claim_id][0], cells, device, **manifest)
    (judged,) = judge_all([BY_ID[claim_id]], load_runs([made]))
    return judged


def cells(claim_id, good=True):
    return planted.CASES[claim_id][1](good)


def test_every_claim_is_there_once():
    """Under an id of its own, and in their order each with cells to test it on."""
    assert list(planted.CASES) == IDS
    assert len(CLAIMS) == len(IDS)


@pytest.mark.parametrize("claim_id", IDS)
def test_holds_where_measurements_bear_it_out(tmp_path, claim_id):
    judged = verdict(tmp_path, claim_id, cells(claim_id))
    assert (judged.verdict, judged.reason) == (HOLDS, ""), [f.text for f in judged.findings]
    assert all(f.comparisons for f in judged.findings)


@pytest.mark.parametrize("claim_id", IDS)
def test_does_not_hold_where_they_contradict_it(tmp_path, claim_id):
    judged = verdict(tmp_path, claim_id, cells(claim_id, good=False))
    assert judged.verdict == FAILS, (judged.reason, [f.text for f in judged.findings])
    assert any(re.match(r"does not hold: ", f.text) for f in judged.findings)


@pytest.mark.parametrize(("claim_id", "shown"),
                         [(i, what) for i, sets in planted.ALSO_AGAINST.items() for what in sets])
def test_does_not_hold_where_they_contradict_it_otherwise(tmp_path, claim_id, shown):
    judged = verdict(tmp_path, claim_id, planted.ALSO_AGAINST[claim_id][shown])
    assert judged.verdict == FAILS, (judged.reason, [f.text for f in judged.findings])


def test_a_verdict_says_where_another_reading_decides_otherwise(tmp_path):
    """Times that are linear in the depth complexity are quadratic in each pixel, at a fixed number of fragments."""
    lines = verdict(tmp_path, "gp-quadratic", planted.quadratic(True, power=1))
    assert lines.verdict == FAILS
    assert lines.decided_by == (
        "the reading decides: 'the time of a frame is quadratic in the depth complexity, as the text says', but by "
        "'a cost of each pixel that is quadratic, which at a fixed number of fragments makes a line': holds")
    assert lines.record()["otherwise"][0]["verdict"] == HOLDS


@pytest.mark.parametrize("claim_id", [claim.id for claim in CLAIMS if claim.otherwise])
def test_every_claim_of_several_readings_says_when_one_decides(tmp_path, claim_id):
    judged = verdict(tmp_path, claim_id, planted.READ_APART[claim_id])
    apart = [reading.words for reading, other, _ in judged.others if other in {HOLDS, FAILS} - {judged.verdict}]
    assert apart
    assert judged.decided_by.startswith(f"the reading decides: '{BY_ID[claim_id].reading}', but by ")
    assert all(f"'{words}': " in judged.decided_by for words in apart)
    assert judged.record()["decided_by"] == judged.decided_by


def test_a_reading_that_cannot_be_tested_decides_nothing(tmp_path):
    judged = verdict(tmp_path, "oc-gain", cells("oc-gain"))
    assert {other for _, other, _ in judged.others} == {NOT_TESTABLE}
    assert (judged.verdict, judged.decided_by) == (HOLDS, "")


def test_readings_that_agree_are_not_told_apart(tmp_path):
    assert verdict(tmp_path, "oc-gain", planted.occupancy(True, intervals=(32, 128))).decided_by == ""


def test_the_readings_of_presorted_scenes_are_told_apart(tmp_path):
    """KB is slower than KB-PS where it takes two passes only, and KB-SR of 4 samples slower than KB."""
    quick = planted.presorted(True, **{"kb-ps": 8.5}) + planted.presorted(True, k=8)
    judged = verdict(tmp_path, "k-sorted", quick)
    assert judged.verdict == FAILS
    assert judged.decided_by == (
        "the reading decides: 'KB faster than KB-PS at every k, and KB-SR by 32 samples a pass', but by 'KB faster "
        "than KB-PS where one pass of 8 layers holds k': holds")


@pytest.mark.parametrize("claim_id", IDS)
def test_an_experiment_that_was_not_run_is_named(tmp_path, claim_id):
    made = planted.folder(tmp_path / "run", "smoke", cells(claim_id))
    (judged,) = judge_all([BY_ID[claim_id]], load_runs([made]))
    assert judged.verdict == NOT_TESTABLE
    assert judged.reason.startswith("not measured: ")
    assert BY_ID[claim_id].experiments[0] in judged.reason
    assert judged.findings == ()


@pytest.mark.parametrize("claim_id", IDS)
def test_an_experiment_without_cells_counts_as_not_run(tmp_path, claim_id):
    assert verdict(tmp_path, claim_id, []).reason.startswith("not measured: ")


@pytest.mark.parametrize("claim_id", IDS)
def test_a_device_that_refuses_the_methods_shows_nothing(tmp_path, claim_id):
    refused = [planted.planted.cell(c["method"], time_ms=None, params=c["params"], scene=c["scene"],
                                    status="unsupported", reason="needs fragment_shader_interlock")
               for c in cells(claim_id)]
    judged = verdict(tmp_path, claim_id, refused)
    assert judged.verdict == NOT_TESTABLE
    assert BY_ID[claim_id].gpu_timer or "unsupported: needs fragment_shader_interlock" in judged.reason


@pytest.mark.parametrize("claim_id", TIMED)
def test_too_few_samples_decide_nothing(tmp_path, claim_id):
    few = [c | {"samples_ms": c["samples_ms"][:3], "passes": {n: s[:3] for n, s in c["passes"].items()}}
           for c in cells(claim_id)]
    judged = verdict(tmp_path, claim_id, few)
    assert judged.verdict == NOT_TESTABLE
    assert "too few samples" in judged.reason


def widened(samples):
    """The same median, with samples from a thousandth of it to a thousand times as much, in an order of their own."""
    middle = sorted(samples)[len(samples) // 2]
    found = [middle * 1000 ** ((i % 21 - 10) / 10) for i in range(20)]
    random.Random(repr(samples)).shuffle(found)  # noqa: S311 - times, not secrets
    return found


@pytest.mark.parametrize("claim_id", TIMED)
def test_overlapping_intervals_decide_nothing(tmp_path, claim_id):
    wide = [c | {"samples_ms": widened(c["samples_ms"]) if c["samples_ms"] else [],
                 "passes": {n: widened(s) for n, s in c["passes"].items()}} for c in cells(claim_id)]
    judged = verdict(tmp_path, claim_id, wide)
    assert judged.verdict == NOT_TESTABLE
    assert "the interval reaches over the limit" in judged.reason


@pytest.mark.parametrize("claim_id", TIMED)
def test_differences_within_the_noise_floor_decide_nothing(tmp_path, claim_id):
    judged = verdict(tmp_path, claim_id, cells(claim_id), noise_floor_rel=1000.0)
    assert judged.verdict == NOT_TESTABLE
    assert "noise floor" in judged.reason


@pytest.mark.parametrize("claim_id", sorted(planted.COUNTED))
def test_what_is_counted_needs_neither_samples_nor_quiet(tmp_path, claim_id):
    few = [c | {"samples_ms": c["samples_ms"][:3]} for c in cells(claim_id)]
    assert verdict(tmp_path, claim_id, few, noise_floor_rel=1000.0).verdict == HOLDS


@pytest.mark.parametrize("claim_id", [i for i in IDS if BY_ID[i].hardware])
def test_a_software_driver_cannot_show_what_rests_on_hardware(tmp_path, claim_id):
    """It is said why, and what was measured is shown all the same."""
    judged = verdict(tmp_path, claim_id, cells(claim_id, good=False), planted.CPU)
    assert judged.verdict == NOT_TESTABLE
    assert judged.reason == f"a software driver cannot show it: {BY_ID[claim_id].hardware}"
    assert all(f.comparisons for f in judged.findings)


@pytest.mark.parametrize("claim_id", [i for i in IDS if BY_ID[i].gpu_timer])
def test_short_passes_need_a_gpu_timer(tmp_path, claim_id):
    wall = [c | {"values": c["values"] | {"timer": "wall"}} for c in cells(claim_id)]
    assert "timed between two finishes" in verdict(tmp_path, claim_id, wall).reason


@pytest.mark.parametrize("claim_id", IDS)
def test_labels_do_not_matter(tmp_path, claim_id):
    labelled = [c | {"label": f"series {i}"} for i, c in enumerate(cells(claim_id))]
    assert verdict(tmp_path, claim_id, labelled).verdict == HOLDS


@pytest.mark.parametrize("claim_id", IDS)
def test_a_wrong_image_is_not_evidence(tmp_path, claim_id):
    wrong = [c | {"status": "wrong", "reason": "max_abs_error 0.3"} for c in cells(claim_id) if c["status"] == "ok"]
    judged = verdict(tmp_path, claim_id, wrong)
    assert judged.verdict == NOT_TESTABLE if claim_id != "k-memory" else judged.verdict != HOLDS


def broken(cell, what):
    """The cell as another program, or an older one, may have left it."""
    odd = {"params": dict.fromkeys(cell["params"], "?"), "scene": dict.fromkeys(cell["scene"], "?") | {"size": [0, 0]},
           "values": dict.fromkeys(cell["values"]), "samples_ms": [0.0] * 20, "device": "somewhere",
           "passes": {name: [0.0] * 20 for name in cell["passes"]}}
    return cell | {what: odd[what]}


@pytest.mark.parametrize("what", ["params", "scene", "values", "samples_ms", "passes"])
@pytest.mark.parametrize("claim_id", IDS)
def test_foreign_cells_are_no_stumbling_block(tmp_path, claim_id, what):
    """They lack what they lack, and are used for what they have."""
    judged = verdict(tmp_path, claim_id, [broken(c, what) for c in cells(claim_id)])
    assert judged.verdict in VERDICTS
    assert judged.record()


def test_a_foreign_manifest_is_read_as_far_as_it_goes(tmp_path):
    made = planted.folder(tmp_path / "run", "kplus2015-fig6", [c | {"device": "somewhere"} for c in cells("k-heap")],
                          "somewhere", noise_floor_rel="little")
    assert [v.device for v in judge_all(CLAIMS, load_runs([made]))] == ["somewhere"] * len(CLAIMS)


@pytest.mark.parametrize("claim_id", IDS)
def test_it_says_where_it_comes_from_and_how_it_is_tested(claim_id):
    """Every claim names its paper, states the rule, and the experiment it needs."""
    claim = BY_ID[claim_id]
    assert re.match(r"(sbuffer_2012|kplus_201[45]|gpupro5_ch[12]|occupancy_2015)", claim.source)
    assert claim.sentence.endswith(".")
    assert claim.paper
    assert claim.rules
    assert all(rule.text and rule.needs for rule in claim.rules)


def test_experiments_are_spelled_as_configs_are():
    """paperYEAR-what, as the shipped configs are named."""
    names = {name for claim in CLAIMS for name in claim.experiments}
    assert all(re.fullmatch(r"[a-z]+\d{4}-[a-z0-9-]+|gpupro5-[a-z0-9-]+|twochannel-fig4", name) for name in names)
    configs = Path(__file__).parents[2] / "configs"
    shipped = {path.stem for path in configs.glob("*.yaml")}
    assert {"kplus2015-fig6", "kplus2015-fig9-abuffer"} <= shipped & names
