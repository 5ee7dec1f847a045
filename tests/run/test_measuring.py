"""The loop over cells: no time without a checked image, a failure costs one cell, an interruption keeps the rest."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.config.settings import KEPT, Measure
from mfr_bench.gpu.frame import Frame
from mfr_bench.methods import catalog
from mfr_bench.oracle import truth
from mfr_bench.run import answers, measuring
from mfr_bench.run.bench import Bench, Phases
from mfr_bench.run.events import BETWEEN, CHECK, Begun, Finished, Sampled, Synced
from mfr_bench.run.images import Images
from mfr_bench.run.jobs import jobs
from mfr_bench.run.ledger import Ledger
from mfr_bench.run.sheet import Sheet
from mfr_bench.store import ResultFolder
from mfr_bench.store.arrays import read_arrays

from ..effects.test_coverage import SLANTED
from .planted_cells import MEASURE, SCENE, Clock, Run, cell


def test_a_row_has_everything_that_was_measured(run, tmp_path):
    rows, made = run([cell("floor"), cell(), cell("kplus-array", k=2)])
    assert made.sheet.counts == {"ok": 3}
    values = rows["kplus-array", 2]["values"]
    assert (values["fragments"], values["covered_pixels"], values["max_fragments"]) == (960, 192, 5)
    assert (values["time_ms"], values["samples"], values["timer"]) == (1.0, 7, "wall")
    assert values["hit_ratio"] == values["promised_ratio"] == pytest.approx(2 / 5)
    assert values["distinct_images"] is None  # the one image of a frame says nothing
    assert values["max_abs_error"] <= 1e-4 < values["rmse"]  # right for k = 2, and two of five layers are not all
    assert values["memory_bytes"] == sum(rows["kplus-array", 2]["buffers"].values())
    assert tuple(rows["kplus-array", 2]["passes"]) == catalog()["kplus-array"].variant({}).pass_names
    assert len(rows["kplus-array", 2]["samples_ms"]) == 7
    assert len(ResultFolder(tmp_path).cells()) == 3


def test_of_the_first_frames_so_much_is_the_devices_as_later_ones_take(run):
    """Each of these methods draws one frame before its images are read. By the planted clock frames take 1 us, which is
    less than any of the first ones really took.
    """
    _, made = run([cell("floor"), cell(), cell("kplus-array", k=2)], Clock(ms=1e-3))
    spent_s = made.measuring.bench.split.seconds
    assert spent_s["first frames"] == pytest.approx(3 * 1e-6)
    assert spent_s["counting frames"] == pytest.approx(2 * 1e-6)  # the floor has no counters
    assert spent_s["compile"] > 0 and spent_s["count"] > 0


def test_frames_are_interleaved(run):
    """Every method's turn comes before any method's next: of 2 frames to warm up and 3, of 1 that settles and 3, of 2.

    One of them has an A/A pair from the second round on.
    """
    order = []
    timer = Clock(0.01)
    frame_ms = timer.frame_ms
    timer.frame_ms = lambda draw, repeats: (order.append(draw.__self__.variant.method.id), frame_ms(draw))[1]
    longer = Measure(target_rel_ci=1e-9, min_samples=7, max_samples=15)
    run([cell(m, measure=longer) for m in ("floor", "zbuffer", "ab-array")], timer)
    alone, pair = 2 + 3 + (1 + 3) + (1 + 1) + 3 * (1 + 1) + 2 * (1 + 2) + (1 + 1), 2 * (2 + 5 + (1 + 5) + (1 + 5))
    assert sorted(order.count(m) for m in set(order)) == [alone, alone, alone + pair]
    assert sorted(order[:15].count(m) for m in set(order)) == [5, 5, 5]
    assert sorted(order[15:41].count(m) for m in set(order)) == [4, 4, 4 + 14]


def test_frames_too_short_for_the_clock_are_drawn_several_times_in_a_sample(run):
    """Ticks of 0.02 ms: four frames of 1 ms make 200 of them."""
    timer = Clock()
    timer.resolution_ms = 0.02
    rows, _ = run([cell()], timer)
    values = rows["ab-array", None]["values"]
    assert (values["repeats"], values["samples"], values["time_ms"]) == (4, 7, 1.0)


def test_the_same_cell_twice_gives_the_noise_floor(run):
    _, made = run([cell("floor"), cell()])
    assert made.sheet.noise_floor_rel == 0  # the planted clock has no noise
    _, made = run([cell("floor", measure=Measure(min_samples=3, max_samples=3))])
    assert made.sheet.noise_floor_rel is None


def test_the_noise_floor_is_that_of_the_cell_in_the_middle_of_the_frame_times(run):
    """22 samples a side, though the cells themselves need 7; the floor, which promises no image, is none of them."""
    took_ms, drawn, timer = {"floor": 0.25, "ab-sb": 0.5, "ab-array": 2.0, "ab-ll": 8.0}, [], Clock()

    def frame_ms(draw, repeats):
        drawn.append(draw.__self__.variant.method.id)
        return took_ms[drawn[-1]] * (1 + 0.002 * (len(drawn) ** 2 % 11))

    timer.frame_ms = frame_ms
    rows, made = run([cell(m, measure=Measure(target_rel_ci=0.05, min_samples=7)) for m in took_ms], timer)
    assert 0 < made.sheet.noise_floor_rel < 0.05
    alone = 2 + 3 + (1 + 3) + (1 + 1)
    pair = 2 * (2 + 8 + (1 + 8) + (1 + 6))
    assert {m: drawn.count(m) - alone for m in took_ms} == {"floor": 0, "ab-sb": 0, "ab-array": pair, "ab-ll": 0}
    assert all(len(row["samples_ms"]) == 7 for row in rows.values())


def test_each_experiment_has_a_noise_floor_of_its_own(device, tmp_path):
    """Two experiments that share a scene and no cell, a third that has the first one's cell: two cells have one."""
    made = Run(device, [cell("ab-array")], Clock(), tmp_path / "first")
    others = [Sheet(ResultFolder(tmp_path / name), jobs([cell(method)], catalog(), device.info, "wall"))
              for name, method in (("second", "ab-ll"), ("third", "ab-array"))]
    made.ledger = Ledger([made.sheet, *others], device.info)
    made.sheet.jobs |= others[0].jobs  # `hear` looks its jobs up there
    made.sheet.statuses |= dict.fromkeys(others[0].jobs, "ok")
    made.all()
    sampled = [event.key for event in made.events if isinstance(event, Finished) and event.noise_floor_rel is not None]
    assert sorted(sampled) == sorted([*others[0].jobs, *others[1].jobs])
    assert [sheet.noise_floor_rel for sheet in (made.sheet, *others)] == [0, 0, 0]


def test_scenes_and_their_oracles_are_made_once(run, monkeypatch):
    made, composited = [], []
    monkeypatch.setattr(answers, "generate", lambda *a, real=answers.generate: (made.append(a), real(*a))[1])
    monkeypatch.setattr(truth, "answer_of_quads",
                        lambda *a, real=truth.answer_of_quads: (composited.append(a[1:]), real(*a))[1])
    run([cell("ab-array"), cell("ab-ll"), cell("kplus-array", k=2), cell("kplus-heap", k=2), cell("kplus-array", k=99)])
    assert len(made) == 1
    assert len(composited) == len(set(composited)) == 2


# --- interruptions -------------------------------------------------------------------------------


def interrupt():
    raise KeyboardInterrupt


def test_an_interruption_keeps_every_cell_with_samples_enough(run, tmp_path):
    """Two cells, from the second round on with the A/A pair of one, 22 samples a side: 60 frames in three rounds."""
    measure = Measure(target_rel_ci=1e-9, min_samples=7, max_samples=1000)
    cells = [cell("floor", measure=measure), cell("ab-array", measure=measure)]
    with pytest.raises(KeyboardInterrupt):
        run(cells, Clock(0.01, at={62: interrupt}))
    kept = {c["method"]: c for c in ResultFolder(tmp_path).cells()}
    assert set(kept) == {"floor", "ab-array"}
    assert all(c["status"] == "ok" and c["values"]["stop_reason"] == "interrupted" for c in kept.values())
    assert all(c["values"]["noisy"] and c["values"]["samples"] >= 7 for c in kept.values())
    assert all(c["passes"] for c in kept.values())


def test_an_interruption_loses_cells_with_too_few_samples(run, tmp_path):
    with pytest.raises(KeyboardInterrupt):
        run([cell("floor"), cell("ab-array")], Clock(at={9: interrupt}))
    assert ResultFolder(tmp_path).cells() == []


def test_a_cell_that_was_done_waits_for_no_other(run, tmp_path):
    """Its sampler has stopped in the round that is interrupted: it is finished all the same."""
    slow = Measure(target_rel_ci=1e-9, min_samples=7, max_samples=1000)
    with pytest.raises(KeyboardInterrupt):
        run([cell("floor", measure=MEASURE), cell("ab-array", measure=slow)], Clock(0.01, at={50: interrupt}))
    kept = {c["method"]: c["values"]["stop_reason"] for c in ResultFolder(tmp_path).cells()}
    assert kept.get("floor", "most samples") == "most samples"
    assert kept


def test_a_wish_to_stop_is_met_between_frames(run, tmp_path):
    timer = Clock(0.01)
    with pytest.raises(KeyboardInterrupt):
        run([cell("floor"), cell()], timer, interrupted=lambda: timer.frames >= 8)
    assert timer.frames == 8
    assert ResultFolder(tmp_path).cells() == []


def test_what_is_kept_is_not_measured_again(run):
    run([cell("floor"), cell()])
    timer = Clock()
    rows, made = run([cell("floor"), cell()], timer)
    assert (rows, timer.frames, made.sheet.kept, made.sheet.counts) == ({}, 0, 2, {"ok": 2})
    rows, made = run([cell("floor"), cell()], force=True)
    assert (len(rows), made.sheet.kept) == (2, 0)


def test_a_kept_cell_takes_its_place_in_the_experiment(run, tmp_path):
    run([cell("kplus-array", k=2)])
    run([replace(cell("kplus-array", k=2), experiment="other", point={})])
    kept, = ResultFolder(tmp_path).cells()
    assert (kept["experiment"], kept["point"]) == ("other", {})
    assert kept["samples_ms"]


# --- scenes that move ----------------------------------------------------------------------------


def test_an_animation_cycles_through_its_seeds(run, monkeypatch):
    seeds = []
    real = Frame.show
    monkeypatch.setattr(Frame, "show", lambda self, scene: (seeds.append(scene.seed), real(self, scene))[1])
    scene = SceneConfig(size=(16, 12), depth_complexity=5, fragment_probability=0.5, animate=True, seed=40)
    rows, _ = run([cell(scene=scene), cell("ab-ll", scene=scene)])
    assert {r["status"] for r in rows.values()} == {"ok"}
    assert set(seeds) >= {40, 41, 46}


@pytest.mark.parametrize("limit", ["LIVE_BYTES", "LIVE_SHARE"])
def test_cells_that_do_not_fit_together_are_measured_in_turns(run, device, monkeypatch, limit):
    monkeypatch.setattr(measuring, limit, 0)
    assert device.limits  # found by drawing, which is not to be counted
    alive = []
    monkeypatch.setattr(Frame, "__init__", lambda self, *a, real=Frame.__init__: (alive.append(1), real(self, *a))[1])
    monkeypatch.setattr(Frame, "release", lambda self, real=Frame.release: (alive.append(-1), real(self))[1])
    _, made = run([cell(), cell("ab-ll"), cell("kplus-array", k=2)])
    assert made.sheet.counts == {"ok": 3}
    assert alive == [1, -1] * 3


def test_a_scene_in_more_samples_than_the_device_has_is_not_even_counted(run, device, monkeypatch):
    """It could not be drawn, and the error of the driver would be taken for one of the next scene."""
    sampled, made = SceneConfig(**SLANTED, msaa=8), []
    monkeypatch.setattr(measuring, "SceneWork", lambda bench, config, real=measuring.SceneWork: (
        made.append(config), real(bench, config))[1])
    monkeypatch.setattr(type(device), "features", device.features - {"msaa_8"})
    rows, _ = run([cell(scene=sampled), cell("ab-ll", sampled), cell("ab-sb", SceneConfig(**SLANTED))])
    assert made == [SceneConfig(**SLANTED)]
    assert {(row["status"], row["reason"]) for row in rows.values()} == {("ok", None), ("unsupported", "needs msaa_8")}
    assert "fragments" not in rows["ab-ll", None]["values"]


# --- progress ------------------------------------------------------------------------------------


def test_phases_and_samples_come_as_they_happen(run):
    """They are what the time left is foretold from."""
    longer = Measure(target_rel_ci=1e-9, min_samples=7, max_samples=30)
    _, made = run([cell(m, measure=longer) for m in ("floor", "ab-array", "ab-ll")], Clock(0.01))
    seen = [(type(event), event.key) for event in made.events if isinstance(event, (Begun, Sampled, Finished))]
    keys = {key for _, key in seen} - {None}
    assert len(keys) == 3
    for key in keys:
        order = [kind for kind, of in seen if of == key]
        assert order[0] is Begun and order[-1] is Finished and order.count(Sampled) > 1
    phases = [event.phase for event in made.events if isinstance(event, Begun) and event.key == seen[-1][1]]
    assert phases[:3] == [BETWEEN, "compile", "first frame"]
    assert phases.index("sampling") < phases.index("last frames")


def test_what_is_no_time_of_a_method_is_done_between_its_steps(run, monkeypatch):
    """Other processes are stopped, and samples kept, within no limit of a cell."""
    met = []
    paused, begin = Bench.paused, Phases.begin
    monkeypatch.setattr(Bench, "paused", lambda self: (met.append("paused"), paused(self))[1])
    monkeypatch.setattr(Phases, "begin", lambda self, phase: (met.append(phase), begin(self, phase))[1])
    _, made = run([cell(), cell("ab-ll")])
    assert met.count("paused") > 3 and {before for before, now in pairwise(met) if now == "paused"} == {BETWEEN}
    at = [event.phase if isinstance(event, Begun) else type(event) for event in made.events
          if isinstance(event, (Begun, Finished, Synced))]
    assert {before for before, now in pairwise(at) if now is Synced} == {BETWEEN, Finished}
    drawn = at.index("first frame")
    assert Synced not in at[:drawn] and at.index(Synced, drawn) < at.index("sampling")  # the parent is done by then


# --- what a cell stores with its numbers ----------------------------------------------------------


def test_a_cell_keeps_the_arrays_that_are_asked_for(run, tmp_path):
    scene = SceneConfig(kind="hairball", size=(32, 24), depth_complexity=12, mean_depth=5, order="front_to_back")
    measure = Measure(target_rel_ci=1e-9, min_samples=7, max_samples=7, keep=KEPT)
    rows, _ = run([cell("kplus-array", scene, measure, k=2), cell("ab-array", scene, measure),
                   cell("zbuffer", scene, k=1)])
    folder = ResultFolder(tmp_path)
    row, arrays = rows["kplus-array", 2], read_arrays(folder, rows["kplus-array", 2]["key"])
    assert set(arrays) == set(KEPT)
    assert arrays["fragments"].sum() == row["values"]["fragments"]
    assert row["values"]["culled_share"] == pytest.approx(arrays["discarded"].sum() / row["values"]["fragments"])
    assert 0.3 < row["values"]["culled_share"] <= 1 - row["values"]["hit_ratio"]
    assert arrays["error"].max() < 1e-4 < arrays["loss"].max()
    assert (arrays["image"][..., 3] > 0).sum() == row["values"]["covered_pixels"]
    assert set(read_arrays(folder, rows["ab-array", None]["key"])) == set(KEPT) - {"discarded"}
    assert "culled_share" not in rows["ab-array", None]["values"]
    assert read_arrays(folder, rows["zbuffer", None]["key"]) == {}


def test_a_cell_that_is_copied_brings_its_arrays(run, device, tmp_path):
    measure = Measure(target_rel_ci=1e-9, min_samples=7, max_samples=7, keep=("fragments",))
    rows, _ = run([cell("ab-array", measure=measure)])
    key = rows["ab-array", None]["key"]
    sheet = Sheet(ResultFolder(tmp_path / "beside"), jobs([cell("ab-array", measure=measure)], catalog(), device.info,
                                                          "wall"))
    ledger = Ledger([sheet], device.info, elsewhere=[ResultFolder(tmp_path)])
    ledger.settle()
    ledger.close()
    assert sheet.copied == 1
    np.testing.assert_array_equal(read_arrays(sheet.folder, key)["fragments"], np.full((12, 16), 5))


def test_the_frames_of_an_animation_are_in_the_record(run):
    scene = SceneConfig(kind="needles", size=(32, 24), depth_complexity=30, mean_depth=8, animate=True)
    rows, _ = run([cell("kplus-sb-dynamic", scene), cell("kplus-array", scene, k=2)])
    assert [(row["status"], row["reason"]) for row in rows.values()] == [("ok", None)] * 2  # frame 0 is compared
    dynamic, fixed = rows["kplus-sb-dynamic", None]["frames"], rows["kplus-array", 2]["frames"]
    assert [f["frame"] for f in dynamic] == list(range(8))
    for there, here in zip(dynamic, fixed, strict=True):
        pixels = np.array(there["histogram"])
        assert pixels.sum() == 32 * 24
        assert there["fragments"] == (pixels * np.arange(len(pixels))).sum()
        assert there["kept"] == (pixels * np.minimum(np.arange(len(pixels)), there["chosen_k"])).sum()
        assert 0.95 * there["fragments"] <= there["kept"]
        assert (here["histogram"], here["chosen_k"]) == (there["histogram"], None)
        assert here["kept"] == (pixels * np.minimum(np.arange(len(pixels)), 2)).sum()
    assert len({f["chosen_k"] for f in dynamic}) > 1


def test_a_still_scene_has_frames_where_the_method_chooses(run):
    rows, _ = run([cell("kplus-sb-dynamic"), cell()])
    assert len(rows["kplus-sb-dynamic", None]["frames"]) == 1
    assert rows["ab-array", None]["frames"] == []


def test_images_are_compared_in_a_phase_of_their_own_and_frames_drawn_outside_it(device, tmp_path, monkeypatch):
    """Comparing them is no time of the method; drawing them is."""
    assert device.limits  # whose trials draw and compare images of their own
    run, seen = Run(device, [cell()], Clock(), tmp_path), []
    compared, drawn = answers.quality.conformance, Frame.draw
    phase = lambda: next(event.phase for event in reversed(run.events) if isinstance(event, Begun))  # noqa: E731

    def comparing(*args):
        seen.append(("compared", phase()))
        return compared(*args)

    def drawing(self, *args):
        seen.append(("drawn", phase()))
        return drawn(self, *args)

    monkeypatch.setattr(answers.quality, "conformance", comparing)
    monkeypatch.setattr(Frame, "draw", drawing)
    run.all()
    assert {phase for what, phase in seen if what == "compared"} == {CHECK}
    assert CHECK not in {phase for what, phase in seen if what == "drawn"}
    assert [what for what, _ in seen].count("compared") == 2


class OfTheLastSample(Clock):
    """Remembers how many frames the cell had drawn when the latest was timed."""

    drawn = None

    def frame_ms(self, draw, repeats=1):
        time_ms = super().frame_ms(draw, repeats)
        self.drawn = draw.__self__.drawn
        return time_ms


def test_a_last_sample_whose_image_is_wrong_is_found(run, monkeypatch):
    clock, image = OfTheLastSample(), Frame.image
    monkeypatch.setattr(Frame, "image", lambda self: image(self) + np.float32(self.drawn == clock.drawn))
    _, made = run([cell()], clock)
    assert made.sheet.counts == {"wrong": 1}


@pytest.mark.parametrize("single", [False, True])
@pytest.mark.parametrize("from_frame", [1, 2, 3])
def test_images_that_are_wrong_from_a_later_frame_on_are_found(run, monkeypatch, single, from_frame):
    """A frame is drawn first, one warms up, one is timed: that is `max_samples: 1`."""
    image = Frame.image
    monkeypatch.setattr(Frame, "image", lambda self: image(self) + np.float32(self.drawn >= from_frame))
    _, made = run([cell(measure=Measure(min_samples=1, max_samples=1) if single else MEASURE)])
    assert made.sheet.counts == {"wrong": 1}


def test_images_that_are_wrong_in_an_interrupted_run_are_found(run, tmp_path, monkeypatch):
    """When it is interrupted it has samples enough for a row."""
    image = Frame.image
    monkeypatch.setattr(Frame, "image", lambda self: image(self) + np.float32(self.drawn >= 4))
    with pytest.raises(KeyboardInterrupt):
        run([cell(measure=Measure(target_rel_ci=1e-9, min_samples=7))], Clock(0.01, at={53: interrupt}))
    assert [row["status"] for row in ResultFolder(tmp_path).cells()] == ["wrong"]


@pytest.mark.parametrize("from_frame", [1, 4])
def test_images_that_are_wrong_in_a_run_that_goes_on_are_found(run, monkeypatch, from_frame):
    measure, image = Measure(target_rel_ci=1e-9, min_samples=30, max_samples=30), Frame.image
    with pytest.raises(KeyboardInterrupt):
        run([cell(measure=measure)], Clock(0.01, at={20: interrupt}))
    monkeypatch.setattr(Frame, "image", lambda self: image(self) + np.float32(self.drawn >= from_frame))
    rows, made = run([cell(measure=measure)], Clock(0.01))
    assert made.sheet.counts == {"wrong": 1} and rows["ab-array", None]["values"]["sessions"] == 2


@pytest.mark.parametrize("scene", [
    replace(SCENE, animate=True),
    SceneConfig(kind="hairball", size=(32, 24), depth_complexity=12, mean_depth=5, animate=True)])
def test_a_method_that_shows_the_first_scene_of_an_animation_alone_right_is_found(run, monkeypatch, scene):
    first, image = {}, Frame.image

    def wrong(frame) -> bool:
        return frame.variant.method.id == "ab-ll" and frame._shown is not first.setdefault(frame, frame._shown)

    monkeypatch.setattr(Frame, "image", lambda self: image(self) + np.float32(wrong(self)))
    rows, _ = run([cell(scene=scene), cell("ab-ll", scene=scene)])
    assert {method: row["status"] for (method, _), row in rows.items()} == {"ab-array": "ok", "ab-ll": "wrong"}


@pytest.mark.parametrize(("scene", "keep", "again"), [
    (SCENE, (), 0), (SCENE, ("fragments",), 0), (SCENE, ("image",), 1), (replace(SCENE, animate=True), (), 2)])
def test_more_frames_are_drawn_where_a_scene_is_animated_or_an_image_is_kept(run, monkeypatch, scene, keep, again):
    drawn, draw_again = [], Images.draw_again
    monkeypatch.setattr(Images, "draw_again", lambda self: (drawn.append(self), draw_again(self)))
    _, made = run([cell(scene=scene, measure=replace(MEASURE, keep=keep))])
    assert made.sheet.counts == {"ok": 1} and len(drawn) == again
