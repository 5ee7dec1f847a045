"""Counts that stand while the scene does: the same image in every frame, a new count once the scene is another."""

from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.scene_buffer import SceneBuffer
from mfr_bench.gpu.targets import Canvas
from mfr_bench.gpu.truth import true_stats
from mfr_bench.gpu.work import work_of
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted
from mfr_bench.scene import generate
from mfr_bench.store.status import EXACT_ERROR

from ..contract.cases import SLANTED, Drawn

BASE = SceneConfig(size=(75, 53), depth_complexity=7, seed=12, pixel_density=0.05)
STILL = {
    "tiles": replace(BASE, layout="tiles"),
    "full": replace(BASE, pixel_density=1.0),
    "random": replace(BASE, layout="random", quad_size=(9, 7), depth_complexity=2, pixel_density=1.0),
    "rejecting": replace(BASE, pixel_density=1.0, fragment_probability=0.25, seed=17),
    "nothing": replace(BASE, depth_complexity=0),
    "crossing": SLANTED["crossing"],
}
# Pixels of more than 20 fragments: those that have more than their share of slots are heaps.
DEEP = {"deep": replace(BASE, layout="random", quad_size=(9, 7), depth_complexity=9, pixel_density=1.0)}
METHODS = [m for m in catalog().values() if m.param("reuse_count")]
EVERY_METHOD = pytest.mark.parametrize("method", METHODS, ids=lambda m: m.id)
OPTIONS = {"ab-precalc": ({}, {"scan": "fullscreen"}), "kb-ab-sb": ({}, {"occupancy": 32}),
           "kplus-sb": ({}, {"occupancy": 32}, {"k": 20})}


def variant_of(method, reuse="on", **more):
    return method.variant({"k": 4} | more | {"reuse_count": reuse} if method.param("k") else
                          {**more, "reuse_count": reuse})


@contextmanager
def moving(device, method, frames=(0, 1), **more):
    """A frame, and the scenes of an animation that has another depth complexity in each."""
    random = replace(BASE, layout="random", quad_size=(19, 17), depth_complexity=2, pixel_density=1.0)
    scenes = [generate(replace(random, seed=17 + i)) for i in frames]
    quads, canvas = SceneBuffer(device, scenes[0]), Canvas(device, BASE.size)
    stats = []
    for scene in scenes:
        quads.replace(scene)
        stats.append(true_stats(device, quads, canvas))
    quads.replace(scenes[0])
    largest = replace(stats[0], n=max(s.n for s in stats), F=max(s.F for s in stats))
    kept = [Frame(device, Fitted(variant_of(method, reuse, **more), largest), quads, canvas) for reuse in ("on", "off")]
    try:
        yield scenes, quads, *kept
    finally:
        for thing in (*kept, canvas, quads):
            thing.release()


def shown(frame, quads, scene):
    """The image once a scene, or the same again, was drawn, and the fragments lost."""
    if quads.scene is not scene:
        quads.replace(scene)
    frame.show(scene)
    frame.draw_fitting()
    return frame.image(), frame.lost_fragments()


@EVERY_METHOD
def test_frames_of_a_still_scene_are_all_exact(device, method):
    for more in OPTIONS.get(method.id, ({},)):
        for name, config in (STILL | (DEEP if "k" in more else {})).items():
            drawn = Drawn(device, variant_of(method, **more), config, frames=3, probing=True)
            assert drawn.error <= EXACT_ERROR, (more, name)
            assert drawn.lost == 0, (more, name)
            assert drawn.distinct_images == 1, (more, name)
            assert drawn.probed["stored_fragments"] == drawn.kept, (more, name)
            assert drawn.allocated == drawn.declared or (more.get("occupancy") and drawn.fits), (more, name)


@EVERY_METHOD
def test_frames_after_the_first_do_not_count(device, method):
    with moving(device, method) as (scenes, _, frame, counting):
        for one in (frame, counting):
            one.draw()
        assert (frame.geometry_passes, counting.geometry_passes) == (2, 2)
        for one in (frame, counting):
            one.draw()
        assert (frame.geometry_passes, counting.geometry_passes) == (1, 2)
        assert "count" not in work_of(frame)
        assert "count" in work_of(counting)
        frame.show(scenes[1])
        frame.scene_buffer.replace(scenes[1])
        frame.draw()
        assert frame.geometry_passes == 2


@EVERY_METHOD
def test_another_scene_is_counted_anew(device, method):
    with moving(device, method) as (scenes, quads, frame, counting):
        for at in (0, 0, 1, 1, 1, 0, 1, 0, 0):
            image, lost = shown(frame, quads, scenes[at])
            right, _ = shown(counting, quads, scenes[at])
            np.testing.assert_allclose(image, right, rtol=0, atol=1e-6)
            assert lost == 0


@EVERY_METHOD
def test_a_stale_count_is_seen(device, method):
    with moving(device, method) as (scenes, quads, frame, counting):
        shown(frame, quads, scenes[0])
        quads.replace(scenes[1])
        frame.show(scenes[1])
        frame._drawn = scenes[1], frame.allocation.version
        image, lost = shown(frame, quads, scenes[1])
        right, _ = shown(counting, quads, scenes[1])
        assert lost or np.abs(image - right).max() > EXACT_ERROR


@EVERY_METHOD
def test_new_buffers_are_counted_anew(device, method):
    with moving(device, method) as (scenes, quads, frame, counting):
        shown(frame, quads, scenes[0])
        frame._set_capacity(4 * frame.allocation.room)
        image, lost = shown(frame, quads, scenes[0])
        assert frame.geometry_passes == 2
        right, _ = shown(counting, quads, scenes[0])
        np.testing.assert_allclose(image, right, rtol=0, atol=1e-6)
        assert lost == 0


@pytest.mark.parametrize(("method", "path", "right", "wrong"), [
    ("ab-sb", "methods/sbuffer/rewind.frag", "-= counter[p]", "-= 0u"),
    ("ab-precalc", "methods/sbuffer/rewind.frag", "-= counter[p]", "-= 1u"),
    ("kplus-sb", "methods/kplus/empty.frag", "&= COUNTED", "&= ~0u"),
    ("kplus-sb", "methods/kplus/empty.frag", "NODE(p, 0u) = NO_FRAGMENT", "NODE(p, 0u) = FIRST_FRAGMENT"),
], ids=["rewind", "rewind by one", "taken", "first cell"])
def test_a_wrong_line_is_seen_in_the_second_frame(device, plant, method, path, right, wrong):
    plant(path, right, wrong)
    with moving(device, catalog()[method]) as (scenes, quads, frame, counting):
        expected, _ = shown(counting, quads, scenes[0])
        first, _ = shown(frame, quads, scenes[0])
        np.testing.assert_allclose(first, expected, rtol=0, atol=1e-6)
        image, lost = shown(frame, quads, scenes[0])
        assert lost or np.abs(image - expected).max() > EXACT_ERROR


def refused_by(device):
    """Fragments that the store of kplus-sb refuses without its lock, in a frame that uses the count before."""
    with moving(device, catalog()["kplus-sb"]) as (scenes, quads, frame, _):
        shown(frame, quads, scenes[0])
        return work_of(frame)["store"]["refused"]


def test_a_first_cell_that_is_not_emptied_refuses_fragments_too_early(device, plant):
    """The image is right all the same: of a scene that stands, what the frame before kept is kept again."""
    emptied = refused_by(device)
    plant("methods/kplus/empty.frag", "ROOM(p) > 0u", "false")
    assert refused_by(device) > 1.1 * emptied
