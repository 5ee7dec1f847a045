"""The contents of k+-buffers, how they treat equal depths, and what the host chooses between two passes."""

from dataclasses import replace

import numpy as np
import pytest

from mfr_bench.config import Scene as SceneConfig
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.scene_buffer import SceneBuffer
from mfr_bench.gpu.single import shown
from mfr_bench.gpu.targets import Canvas
from mfr_bench.gpu.truth import Truth, true_stats
from mfr_bench.gpu.work import admitted_map
from mfr_bench.methods import catalog
from mfr_bench.methods.kplus import BINS
from mfr_bench.methods.spec import Fitted, Promise
from mfr_bench.oracle.composite import composite, fragment_counts, stats_of
from mfr_bench.oracle.quality import conformance
from mfr_bench.scene import generate

from .drawing import SIZE, assert_shows, drawn, stack

MIXED = generate(SceneConfig(size=(33, 21), depth_complexity=9, fragment_probability=0.5, pixel_density=0.8, seed=2))
BOUNDED = ["kplus-array", "kplus-array-r", "kplus-heap", "kplus-sb"]
COUNTED = 2**21 - 1  # bits of the counter that hold fragments counted; those above hold slots taken

# Payloads of equal depth, none of them in order.
COLOURS = [(200, 10, 30, 120), (10, 200, 30, 90), (90, 90, 250, 60), (200, 10, 30, 200), (0, 0, 0, 40),
           (255, 255, 255, 80)]


def by_payload(colours):
    """Ascending RGBA8 words: alpha counts most, red least."""
    return sorted(colours, key=lambda c: c[::-1])


@pytest.mark.parametrize("method", BOUNDED)
@pytest.mark.parametrize("k", [1, 2, 4, 9, 20])
def test_counts_its_slots_and_releases_its_locks(device, method, k):
    counts = fragment_counts(MIXED)
    with drawn(device, method, MIXED, frames=2, k=k) as frame:
        state = frame.words("counter").reshape(counts.shape)
        np.testing.assert_array_equal(state >> 21, np.minimum(counts, k))
        assert not frame.words("semaphore").any()
        if method == "kplus-array-r":
            np.testing.assert_array_equal(state & COUNTED, counts)


@pytest.mark.parametrize("k", [1, 3, 9])
def test_ranges_hold_exactly_what_is_kept(device, k):
    counts = fragment_counts(MIXED)
    with drawn(device, "kplus-sb", MIXED, k=k) as frame:
        nodes = frame.words("nodes").reshape(-1, 2)
        assert len(nodes) == np.minimum(counts, k).sum()
        assert (nodes[:, 0] != 0xFFFFFFFF).all()


@pytest.mark.parametrize("k", [16, 17])
def test_an_array_or_a_heap_for_each_pixel(device, k):
    """Below 17 slots every pixel has an array; above, pixels of at least k fragments have a heap."""
    scene = generate(SceneConfig(size=(20, 20), depth_complexity=40, fragment_probability=0.45, seed=4))
    full = fragment_counts(scene).ravel() >= k
    assert 0 < full.sum() < full.size
    with drawn(device, "kplus-sb", scene, k=k) as frame:
        assert np.abs(frame.image() - composite(scene, k)).max() < 1e-4
        nodes, first = frame.words("nodes").reshape(-1, 2), frame.words("address")
        ranges = np.stack([nodes[a:a + k, 0] for a in first[full]])
    heaps = np.all([ranges[:, slot] <= ranges[:, slot // 2] for slot in range(1, k)], axis=0)
    assert heaps.all() if k > 16 else not heaps.any()
    assert (ranges[:, 0] == ranges.max(axis=1)).all()


@pytest.mark.parametrize("method", BOUNDED)
@pytest.mark.parametrize("k", range(1, 8))
@pytest.mark.parametrize("order", [1, -1])
def test_of_equal_depths_the_lesser_payloads_stay(device, method, k, order):
    """Which stay does not depend on the order of arrival; that of equal depths in the image does."""
    kept = np.array(by_payload(COLOURS)[:k])
    with drawn(device, method, stack([0.5] * len(COLOURS), COLOURS[::order]), k=k) as frame:
        assert frame.lost_fragments() == 0
        alpha = frame.image()[..., 3]
    np.testing.assert_allclose(alpha, 1 - np.prod(1 - kept[:, 3] / 255), rtol=0, atol=1e-5)


@pytest.mark.parametrize("criterion", ["furthest", "opaque"])
@pytest.mark.parametrize("structure", ["array", "heap"])
@pytest.mark.parametrize("k", [1, 3, 20])
def test_the_best_by_a_criterion(device, criterion, structure, k):
    with drawn(device, "kplus-generic", MIXED, k=k, criterion=criterion, structure=structure) as frame:
        assert np.abs(frame.image() - composite(MIXED, k, criterion)).max() < 1e-4


def test_the_most_opaque_are_found_among_wide_payloads(device):
    with drawn(device, "kplus-generic", MIXED, k=3, criterion="opaque", payload="rgba16f") as frame:
        assert np.abs(frame.image() - composite(MIXED, 3, "opaque")).max() < 1e-4


@pytest.mark.parametrize("payload", ["rgba8", "rgba16f"])
@pytest.mark.parametrize("order", [1, -1])
def test_of_equal_depths_of_one_red_and_green_the_fainter_stays(device, payload, order):
    """It has the lesser payload in both formats."""
    colours = [(200, 10, 30, 120), (200, 10, 90, 60)]
    with drawn(device, "kplus-array", stack([0.5, 0.5], colours[::order]), k=1, payload=payload) as frame:
        assert_shows(frame, colours[1:])


def test_a_fragment_at_the_near_plane_is_kept(device):
    """Depth 0 is the worst that `furthest` can see; an empty slot is worse still."""
    with drawn(device, "kplus-generic", stack([0.0, 0.5], COLOURS[:2]), k=2, criterion="furthest") as frame:
        assert_shows(frame, COLOURS[:2])


@pytest.mark.parametrize("k", range(1, 8))
def test_peeling_loses_no_equal_depths(device, k):
    """Across iterations they go by payload; with k = 1 that orders all of them."""
    colours = [(9, 9, 9, 70), *COLOURS, *COLOURS[:2], (7, 7, 7, 50)]
    depths = [0.25] + [0.5] * (len(colours) - 2) + [0.75]
    with drawn(device, "peel-kplus", stack(depths, colours), k=k) as frame:
        if k == 1:
            assert_shows(frame, [colours[0], *by_payload(colours[1:-1]), colours[-1]])
        alpha = frame.image()[..., 3]
        assert frame.lost_fragments() == 0
    np.testing.assert_allclose(alpha, 1 - np.prod(1 - np.array(colours)[:, 3] / 255), rtol=0, atol=1e-5)


@pytest.mark.parametrize("k", range(1, 6))
@pytest.mark.parametrize("copies", [1, 2, 3, 5, 7])
def test_peeling_loses_no_equal_fragments(device, k, copies):
    """Fragments that cannot be told apart are counted off, over as many iterations as they take."""
    colours = [COLOURS[0]] + [COLOURS[1]] * copies + [COLOURS[2]]
    with drawn(device, "peel-kplus", stack([0.25] + [0.5] * copies + [0.75], colours), k=k, frames=2) as frame:
        assert_shows(frame, colours)


@pytest.mark.parametrize(("layers", "k", "passes"), [(8, 4, 2), (9, 4, 3), (3, 4, 1), (5, 1, 5)])
def test_peeling_takes_as_many_passes_as_the_depth_asks(device, layers, k, passes):
    scene = stack(np.arange(1, layers + 1) / 64, [COLOURS[0]] * layers)
    with drawn(device, "peel-kplus", scene, k=k) as frame:
        assert frame.geometry_passes == passes


def test_peeling_stops_where_a_frame_is_shallower_than_its_sizes(device):
    scene = stack([0.25, 0.5, 0.75], COLOURS[:3])
    quads, canvas = SceneBuffer(device, scene), Canvas(device, SIZE)
    fitted = Fitted(catalog()["peel-kplus"].variant({"k": 2}), replace(stats_of(scene), n=50))
    frame = Frame(device, fitted, quads, canvas)
    frame.draw_fitting()
    assert frame.geometry_passes == 2
    assert_shows(frame, COLOURS[:3])
    for thing in (frame, canvas, quads):
        thing.release()


@pytest.mark.parametrize(("memory_mb", "hit_ratio"), [(200.0, 0.95), (200.0, 0.5), (0.02, 0.95), (0.001, 0.95)])
def test_the_host_chooses_what_the_histogram_asks_for(device, memory_mb, hit_ratio):
    """Histogram, k, memory and image all agree with what the CPU knows of the scene."""
    stats = stats_of(MIXED)
    with drawn(device, "kplus-sb-dynamic", MIXED, frames=2, memory_mb=memory_mb, hit_ratio=hit_ratio) as frame:
        histogram = frame.words("histogram")
        np.testing.assert_array_equal(histogram[:stats.n], stats.histogram[1:])
        assert not histogram[stats.n:].any()
        promise = Fitted(frame.variant, stats).promise()
        assert frame.memory_bytes == Fitted(frame.variant, stats).memory_bytes()
        assert frame.memory_bytes["nodes"] == 8 * stats.bounded(promise.layers)
        assert frame.lost_fragments() == 0
        assert np.abs(frame.image() - composite(MIXED, promise.layers)).max() < 1e-4
    kept = stats.bounded(promise.layers)
    assert promise.layers == 1 or 8 * kept + 12 * stats.P <= memory_mb * 2**20
    if memory_mb == 200:
        assert kept >= hit_ratio * stats.F > stats.bounded(promise.layers - 1)


def test_pixels_with_more_fragments_than_bins_are_counted_in_the_last(device):
    scene = stack(np.linspace(0.1, 0.9, BINS + 6), size=(2, 1))
    scene.rect[:9, 0] = 1  # which leaves the first pixel with fewer
    with drawn(device, "kplus-sb-dynamic", scene, memory_mb=0.001, sort="lplus") as frame:
        assert frame.words("histogram")[BINS - 4:].tolist() == [1, 0, 0, 1]


@pytest.mark.parametrize("method", ["kplus-array-dynamic", "kplus-heap-dynamic"])
@pytest.mark.parametrize(("memory_mb", "hit_ratio", "bounded"), [(200.0, 0.95, False), (200.0, 0.5, False),
                                                                 (0.03, 0.95, True), (0.001, 0.95, True)])
def test_a_budget_bounds_the_slots_of_every_pixel(device, method, memory_mb, hit_ratio, bounded):
    """Eq. 5 and 6: the least k that keeps the ratio, or k_b; nodes are k slots in every pixel."""
    stats = stats_of(MIXED)
    with drawn(device, method, MIXED, frames=2, memory_mb=memory_mb, hit_ratio=hit_ratio) as frame:
        k = frame.chosen_k
        assert frame.memory_bytes == Fitted(frame.variant, stats).memory_bytes()
        assert frame.memory_bytes["nodes"] == 8 * k * stats.P
        assert frame.lost_fragments() == 0
        assert np.abs(frame.image() - composite(MIXED, k)).max() < 1e-4
    bound = max(1, int((memory_mb * 2**20 / stats.P - 8) / 8))
    enough = next(k for k in range(1, stats.n + 1) if stats.bounded(k) >= hit_ratio * stats.F)
    assert k == min(bound, enough)
    assert (k == bound) == bounded


def chosen_directly(counts: np.ndarray, memory_mb: float, hit_ratio: float) -> int:
    """k by Eq. 6 and 7 of kplus_2015 from fragments per pixel: x = 8 bytes a fragment, y = 12 a pixel."""
    best = 1
    for k in range(1, 1025):
        kept = np.minimum(counts, k).sum()
        if k > 1 and 8 * kept > memory_mb * 2**20 - 12 * counts.size:
            return best
        best = k
        if kept >= hit_ratio * counts.sum():
            return best
    return best


@pytest.mark.parametrize(("memory_mb", "hit_ratio"), [(200.0, 0.95), (200.0, 0.7), (0.6, 0.95)])
def test_k_follows_the_frames_of_an_animation(device, memory_mb, hit_ratio):
    """A hairball seen from nearer and nearer: what the device chooses is what follows from its own fragments."""
    config = SceneConfig(kind="hairball", size=(64, 48), depth_complexity=60, mean_depth=15, animate=True)
    chosen = []
    with shown(device, generate(config)) as on:
        variant = catalog()["kplus-sb-dynamic"].variant({"memory_mb": memory_mb, "hit_ratio": hit_ratio})
        frame = Frame(device, Fitted(variant, on.stats), on.scene_buffer, on.canvas)
        for scene in (generate(config, i) for i in range(5)):
            on.scene_buffer.replace(scene)
            frame.show(scene)
            frame.draw()
            truth = Truth(device, on.scene_buffer, on.canvas)
            stats = true_stats(device, on.scene_buffer, on.canvas)
            k = chosen_directly(truth.counts, memory_mb, hit_ratio)
            assert frame.chosen_k == k == Fitted(variant, stats).decision().k
            np.testing.assert_array_equal(frame.words("histogram")[:stats.n], np.bincount(truth.counts.ravel())[1:])
            error = conformance(frame.image(), truth.answer(Promise(k)))
            assert error["max_abs_error"] < 1e-4
            chosen.append(k)
        frame.release()
    assert len(set(chosen)) > 1


@pytest.mark.parametrize("method", ["kplus-array", "kplus-array-r", "kplus-heap", "kplus-sb", "kb-ps"])
@pytest.mark.parametrize(("order", "culling"), [("front_to_back", "on"), ("back_to_front", "on"), ("random", "off")])
def test_culling_refuses_what_the_order_lets_it(device, method, order, culling):
    """Nearest first, only the first k enter; furthest first, or without culling, all do."""
    scene = generate(SceneConfig(size=(33, 21), depth_complexity=12, fragment_probability=0.6, order=order, seed=5))
    counts = fragment_counts(scene)
    expected = np.minimum(counts, 4) if order == "front_to_back" else counts
    with drawn(device, method, scene, k=4, culling=culling) as frame:
        admitted = admitted_map(frame)
        np.testing.assert_array_equal(admitted, expected)


def test_early_z_keeps_fragments_from_the_lock(device):
    scene = generate(SceneConfig(size=(33, 21), depth_complexity=40, order="back_to_front", seed=5))
    with drawn(device, "kplus-array", scene, k=4, occupancy=32) as frame:
        admitted = admitted_map(frame)
        assert admitted.sum() == frame.probe()["shaded_fragments"] < 0.5 * 40 * 33 * 21
        assert admitted.min() >= 4


def test_a_method_that_has_no_lock_or_meets_fragments_again_has_no_map(device):
    scene = generate(SceneConfig(size=(33, 21), depth_complexity=12))
    for method, params in (("kb-mdt32", {"k": 4}), ("peel-kplus", {"k": 4}), ("ab-array", {})):
        with drawn(device, method, scene, **params) as frame:
            assert admitted_map(frame) is None
