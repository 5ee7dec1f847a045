"""A failure costs its cell alone: errors, fragments without room, wrong images, lost fragments."""

from __future__ import annotations

import re

import numpy as np
import pytest

from mfr_bench import glsl
from mfr_bench.config.model import Measure
from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.gpu.frame import Frame
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted
from mfr_bench.plan import expected_stats
from mfr_bench.run import answers, measuring
from mfr_bench.run.outcome import failure

from .planted_cells import SCENE, cell


@pytest.mark.parametrize(("error", "status", "reason"), [
    (MemoryError(), "out_of_memory", "out of memory"), (MemoryError("no room"), "out_of_memory", "no room"),
    (ValueError("two\nlines"), "crashed", "ValueError('two\\nlines')"),
])
def test_an_error_is_a_status_and_one_line(error, status, reason):
    assert failure(error) == (status, reason)


@pytest.mark.parametrize("error", [MemoryError("no room"), RuntimeError("no good")])
@pytest.mark.parametrize("when", ["allocating", "sampling"])
def test_a_cell_that_fails_costs_itself_alone(run, monkeypatch, error, when):
    name = "__init__" if when == "allocating" else "draw"
    real = getattr(Frame, name)

    def failing(self, *arguments):
        variant = arguments[1].variant if when == "allocating" else self.variant
        self.drawn = getattr(self, "drawn", 0) + 1
        if variant.method.id == "ab-array" and (when == "allocating" or self.drawn > 3):
            raise error
        return real(self, *arguments)

    monkeypatch.setattr(Frame, name, failing)
    rows, made = run([cell("floor"), cell("ab-array"), cell("ab-ll")])
    assert rows["ab-array", None]["status"] == failure(error)[0]
    assert "time_ms" not in rows["ab-array", None]["values"]
    assert rows["ab-array", None]["values"]["fragments"] == 960
    assert made.sheet.counts == {"ok": 2, failure(error)[0]: 1}
    assert len(made.rows) == 3


def test_fragments_that_fit_no_buffer_are_an_overflow_with_their_number(run, device, monkeypatch):
    """More fragments come than was planned for: the list starts with half of the room that they need."""
    variant = catalog()["ab-ll"].variant({})
    stats = expected_stats(SCENE)
    start, end = Fitted(variant, stats).start_capacity(), Fitted(variant, stats).capacity()
    assert start < stats.F <= end
    largest = max(Fitted(variant, stats).block_bytes(buffer, end) for buffer in variant.buffers)
    monkeypatch.setattr(measuring, "judge", lambda *arguments: None)
    assert device.limits.max_block_bytes >= largest  # which are known from here on
    monkeypatch.setattr(type(device), "max_block_bytes", largest - 1)
    rows, made = run([cell(), cell("ab-ll")])
    row = rows["ab-ll", None]
    assert row["status"] == "overflow"
    assert re.fullmatch(rf"960 fragments do not fit: \w+ would grow to {largest} bytes, a storage block holds "
                        rf"{largest - 1}", row["reason"])
    assert "time_ms" not in row["values"]
    assert made.sheet.counts == {"ok": 1, "overflow": 1}


def test_a_scene_without_room_is_rows(run, monkeypatch):
    def none(*arguments):
        raise MemoryError("no room for the scene")

    monkeypatch.setattr(answers, "generate", none)
    rows, _ = run([cell("floor"), cell()])
    assert {r["status"] for r in rows.values()} == {"out_of_memory"}


def test_an_image_that_goes_wrong_while_it_is_timed_is_wrong(run, monkeypatch):
    """The first image was right; the one after the last sample counts as well."""
    def wrong_later(self, real=Frame.image):
        self.shown = getattr(self, "shown", 0) + 1
        return real(self) + np.float32(0.01 * (self.shown > 1))

    monkeypatch.setattr(Frame, "image", wrong_later)
    rows, _ = run([cell()])
    row = rows["ab-array", None]
    assert row["status"] == "wrong"
    assert row["values"]["max_abs_error"] == pytest.approx(0.01, rel=1e-3)
    assert row["values"]["wrong_pixels"] == 192


@pytest.mark.parametrize("lost", [(0, 3), (3, 0)])
def test_a_fragment_lost_in_any_frame_is_wrong(run, monkeypatch, lost):
    losses = iter(lost)
    monkeypatch.setattr(Frame, "lost_in_a_frame", lambda self: next(losses))
    rows, _ = run([cell()])
    assert (rows["ab-array", None]["status"], rows["ab-array", None]["reason"]) == ("wrong", "3 fragments lost")
    assert rows["ab-array", None]["values"]["lost_fragments"] == 3


def test_hit_ratio_is_what_the_method_holds(run, monkeypatch):
    """Not what it should hold: a shader that forgets the last of its slots is seen."""
    read = glsl.read
    monkeypatch.setattr(glsl.includes, "read",
                        lambda path: read(path).replace("BOUND * pixels", "(BOUND - 1u) * pixels"))
    rows, _ = run([cell("kb-mdt32", k=4), cell("kb", k=4)])
    assert rows["kb-mdt32", 4]["values"]["hit_ratio"] == pytest.approx(3 / 5)
    assert rows["kb", 4]["values"]["hit_ratio"] == pytest.approx(3 / 5)
    assert rows["kb", 4]["values"]["promised_ratio"] == pytest.approx(4 / 5)


def test_frames_of_different_images_are_counted_and_wrong_where_one_is_promised(run, monkeypatch):
    def flickers(self, real=Frame.image):
        self.shown = getattr(self, "shown", 0) + 1
        return real(self) + np.float32(1e-6 * (self.shown % 3))

    monkeypatch.setattr(Frame, "image", flickers)
    measure = Measure(target_rel_ci=1e-9, min_samples=7, max_samples=7, repeat_images=5)
    rows, _ = run([cell(measure=measure), cell("kb", k=4, measure=measure)])
    assert rows["ab-array", None]["values"]["distinct_images"] == rows["kb", 4]["values"]["distinct_images"] == 3
    assert (rows["ab-array", None]["status"], rows["kb", 4]["status"]) == ("wrong", "ok")
    assert rows["ab-array", None]["reason"] == "3 different images of one scene"


def test_images_that_differ_where_equal_depths_leave_them_open_are_one(run, monkeypatch):
    """Every pixel is tied, and every image another."""
    monkeypatch.setattr(Frame, "image", lambda self, real=Frame.image: real(self) + np.float32(1e-6 * self.drawn))
    scene = SceneConfig(size=(9, 6), depth_complexity=6, alpha=(0.1, 0.6), depth_copies=2, copies="different", seed=4)
    measure = Measure(target_rel_ci=1e-9, min_samples=7, max_samples=7, repeat_images=5)
    rows, _ = run([cell("ab-ll", scene, measure)])
    row = rows["ab-ll", None]
    assert (row["values"]["tied_pixels"], row["values"]["distinct_images"], row["status"]) == (54, 1, "ok")


def test_the_worst_of_all_repeated_images_counts(run, monkeypatch):
    """Neither the first nor the last check sees the one frame that lacks something."""
    def lacks_once(self, real=Frame.image):
        self.shown = getattr(self, "shown", 0) + 1
        return real(self) * np.float32(1 - 0.5 * (self.shown == 5))

    monkeypatch.setattr(Frame, "image", lacks_once)
    measure = Measure(target_rel_ci=1e-9, min_samples=7, max_samples=7, repeat_images=9)
    rows, _ = run([cell(measure=measure), cell("kb", k=4, measure=measure)])
    for row in rows.values():
        assert (row["values"]["distinct_images"], row["values"]["wrong_pixels"]) == (2, 192)
        assert row["values"]["max_abs_error"] > 0.1
    assert (rows["ab-array", None]["status"], rows["kb", 4]["status"]) == ("wrong", "ok")
