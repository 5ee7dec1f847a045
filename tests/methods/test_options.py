"""The options that methods share: sorts, local array, backwards memory allocation, payload, stage, occupancy."""

import numpy as np
import pytest

from mfr_bench import glsl
from mfr_bench.config import Scene as SceneConfig
from mfr_bench.methods import catalog
from mfr_bench.methods.shared import BMA, CLASS_BOUNDS, LPLUS, SORT
from mfr_bench.methods.spec import Fitted, SceneStats
from mfr_bench.oracle.composite import composite, stats_of
from mfr_bench.scene import generate
from mfr_bench.scene.quads import Quads

from .drawing import SIZE, assert_shows, drawn, stack

RANDOM = np.random.default_rng(4)
MIXED = generate(SceneConfig(size=(33, 21), depth_complexity=70, fragment_probability=0.6, pixel_density=0.8, seed=2))
SHALLOW = generate(SceneConfig(size=(33, 21), depth_complexity=8, fragment_probability=0.6, pixel_density=0.8, seed=2))
SORTS = SORT.choices


def staircase(counts) -> Quads:
    """A pixel for each count, in one row, with so many fragments; the furthest are submitted first."""
    quads = max(counts)
    rect = [[x, 0, x + 1, 1] for x, count in enumerate(counts) for _ in range(count)]
    depth = [(i + 1) / (quads + 1) for count in counts for i in reversed(range(count))]
    rgba = RANDOM.integers(3, 40, (len(rect), 4))
    return Quads((len(counts), 1), np.array(rect, dtype=np.int32), np.array(depth, dtype=np.float32),
                 rgba.astype(np.uint8), 1.0, 0)


def image_of(device, method: str, scene: Quads, **params) -> np.ndarray:
    with drawn(device, method, scene, **params) as frame:
        assert frame.lost_fragments() == 0
        return frame.image()


def discarded_share(frame) -> float:
    return 1 - frame.probe()["shaded_fragments"] / frame.stats.F


@pytest.mark.parametrize("bma", BMA.choices)
@pytest.mark.parametrize("sort", SORTS)
def test_every_sort_gives_the_full_list(device, sort, bma):
    image = image_of(device, "ab-array", MIXED, sort=sort, bma=bma)
    np.testing.assert_allclose(image, composite(MIXED), rtol=0, atol=1e-5)


@pytest.mark.parametrize("sort", SORTS)
def test_every_sort_orders_a_hundred_fragments(device, sort):
    scene = stack(RANDOM.permutation(100) / 128, RANDOM.integers(3, 40, (100, 4)), size=(1, 1))
    np.testing.assert_allclose(image_of(device, "ab-array", scene, sort=sort), composite(scene), rtol=0, atol=1e-5)


@pytest.mark.parametrize("sort", SORTS)
@pytest.mark.parametrize("k", [7, 40])
def test_every_sort_gives_the_k_nearest_of_a_full_list(device, sort, k):
    image = image_of(device, "kb-ab-array", MIXED, sort=sort, k=k)
    np.testing.assert_allclose(image, composite(MIXED, k), rtol=0, atol=1e-5)


@pytest.mark.parametrize("sort", SORTS)
@pytest.mark.parametrize("depths", [[0.5] * 96, [0.25] * 20 + [0.5] * 56 + [0.75] * 20, [0.0] * 48 + [1.0] * 48,
                                    [0.25] * 5 + [0.5] * 70 + [0.75] * 21],
                         ids=["one depth", "three depths", "both ends", "more than a batch between others"])
def test_no_sort_loses_fragments_of_equal_depth(device, sort, depths):
    """The alpha of a pixel does not depend on the order of its fragments: equal payloads among the ties too."""
    rgba = RANDOM.integers(2, 12, (len(depths), 4))
    rgba[::3] = rgba[0]
    image = image_of(device, "ab-array", stack(depths, rgba), sort=sort)
    np.testing.assert_allclose(image[..., 3], 1 - np.prod(1 - rgba[:, 3] / 255), rtol=0, atol=1e-5)


@pytest.mark.parametrize(("sort", "room"), [*((s, 16) for s in SORTS if s != "lplus"), ("register", 64)])
def test_a_local_array_that_is_too_small_counts_what_it_loses(device, sort, room):
    """In one block of registers, and in two."""
    scene = staircase([0, 3, room, room + 1, room + 8])
    with drawn(device, "ab-array", scene, sort=sort, local_array=room) as frame:
        assert frame.lost_fragments() == 1 + 8
    with drawn(device, "kb-ab-array", scene, sort=sort, local_array=room, k=room + 4) as frame:
        assert frame.lost_fragments() == 1 + 4


def test_the_last_class_of_pixels_has_those_with_more_fragments_than_the_local_array(device):
    with drawn(device, "ab-array", staircase([0, 3, 16, 17, 40]), sort="insertion", local_array=16, bma="on") as frame:
        assert frame.lost_fragments() == 1 + 24


@pytest.mark.parametrize(("sort", "bma"), [("hybrid", "off"), ("hybrid", "on"), ("lplus", "off"), ("register", "off")])
def test_a_local_array_that_is_longer_than_needed_changes_nothing(device, sort, bma):
    scene = staircase([0, 3, 17, 20])
    for method, layers in (("ab-array", None), ("kb-ab-array", 8)):
        image = image_of(device, method, scene, sort=sort, bma=bma, local_array=64, k=8)
        np.testing.assert_allclose(image, composite(scene, layers), rtol=0, atol=1e-5)


@pytest.mark.parametrize("k", [7, LPLUS + 1, LPLUS + 8, 2 * LPLUS + 6])
def test_lplus_takes_none_of_what_lies_behind_its_batch(device, plant, k):
    """Whatever the local array holds before the first batch, and the nearer batches' fragments behind a shorter one."""
    begin = "    vec4 colour = nothing_yet();\n    uint from"
    furthest = "fragment_of(0xFFFFFFFEu, PAYLOAD(0xFFFFFFFFu))"
    plant("common/resolve_lplus.glsl", begin,
          f"    for (uint i = 0u; i < uint(LOCAL); ++i) fragments[i] = {furthest};\n{begin}")
    image = image_of(device, "kb-ab-array", MIXED, sort="lplus", k=k)
    np.testing.assert_allclose(image, composite(MIXED, k), rtol=0, atol=1e-5)


@pytest.mark.parametrize("length", [1, 5, LPLUS])
def test_lplus_needs_no_more_than_its_batches(device, length):
    scene = staircase([0, 1, 31, 32, 33, 64, 65, 100])
    image = image_of(device, "ab-array", scene, sort="lplus", local_array=length)
    np.testing.assert_allclose(image, composite(scene), rtol=0, atol=1e-5)


def test_what_a_limit_of_iterations_leaves_out_is_counted(device):
    """Some drivers end the loops of a shader after 65,535 iterations; the opacity tells how many layers are shown."""
    layers, alpha = 1000, 1
    with drawn(device, "ab-array", stack(np.linspace(0.9, 0.1, layers), [(9, 9, 9, alpha)] * layers, size=(1, 1)),
               sort="lplus", local_array=16) as frame:
        shown = np.log1p(-float(frame.image()[0, 0, 3])) / np.log1p(-alpha / 255)
        assert shown + frame.lost_fragments() == pytest.approx(layers, abs=0.1)


@pytest.mark.parametrize("stage", ["fragment", "compute"])
@pytest.mark.parametrize("method", ["ab-array", "ab-ll", "kplus-array"])
def test_each_class_of_pixels_is_resolved_once(device, method, stage):
    """Pixels at both ends of every class up to 128 fragments, and empty ones.

    Where the default sorts in registers, which takes seconds to compile for all classes, is tested of one method.
    """
    counts = [0] + [c for bound in CLASS_BOUNDS[:5] for c in (bound - 1, bound, bound + 1)] + [0, 1]
    scene = staircase(counts)
    sort = "auto" if (method, stage) == ("ab-array", "fragment") else "insertion"
    image = image_of(device, method, scene, bma="on", resolve=stage, sort=sort, k=200)
    np.testing.assert_allclose(image, composite(scene), rtol=0, atol=1e-5)


def test_only_the_classes_that_a_frame_can_have_are_drawn():
    variant = catalog()["ab-array"].variant({"bma": "on"})
    classes = [p for p in variant.passes if "CLASS" in p.defines]
    for n, drawn_classes in ((1, 1), (8, 1), (9, 2), (32, 3), (33, 4), (1024, 8), (5000, 8)):
        stats = SceneStats(W=1, H=1, n=n, F=n, primitives=n)
        assert sum(Fitted(variant, stats).needed(p) for p in classes) == drawn_classes
    fitted = Fitted(variant, SceneStats(W=1, H=1, n=100, F=100, primitives=100))
    deepest = {p.defines["CLASS"]: fitted.value(p.defines["LOCAL"]) for p in classes}
    assert [deepest[i] for i in range(5)] == [8, 16, 32, 64, 100]


@pytest.mark.parametrize("method", ["ab-array", "ab-ll", "ab-sb", "ab-precalc", "lin-post", "kplus-array",
                                    "kplus-heap"])
def test_half_floats_keep_8_bit_colours(device, method):
    plain = image_of(device, method, SHALLOW, k=100)
    wide = image_of(device, method, SHALLOW, k=100, payload="rgba16f")
    np.testing.assert_allclose(wide, plain, rtol=0, atol=1e-6)


@pytest.mark.parametrize("method", ["ab-array", "ab-ll", "ab-sb", "kplus-array"])
def test_a_wide_payload_is_a_word_more_per_fragment(method):
    stats = stats_of(MIXED)
    plain, wide = (catalog()[method].variant({"payload": p, "k": 8}) for p in ("rgba8", "rgba16f"))
    nodes = "cells" if method == "ab-ll" else "nodes"
    assert 2 * Fitted(wide, stats).memory_bytes()[nodes] == 3 * Fitted(plain, stats).memory_bytes()[nodes]
    stored = {"ab-array": stats.n * stats.P, "kplus-array": 8 * stats.P}.get(method, stats.F)
    assert Fitted(wide, stats).model_bytes() - Fitted(plain, stats).model_bytes() == 4 * stored


@pytest.mark.parametrize("method", ["ab-array", "ab-ll", "lin-pre", "ab-sb", "kplus-array", "kb-mdt32"])
def test_compute_gives_the_image_of_the_draw(device, method):
    in_draw = image_of(device, method, SHALLOW, k=5)
    in_compute = image_of(device, method, SHALLOW, k=5, resolve="compute")
    np.testing.assert_allclose(in_compute, in_draw, rtol=0, atol=1e-6)


@pytest.mark.parametrize("intervals", [32, 64, 128])
@pytest.mark.parametrize("method", ["kplus-array", "kplus-sb", "kb-mdt32", "kb-ps", "kb-ab-array"])
def test_occupancy_discards_only_what_is_beyond_the_k_nearest(device, method, intervals):
    with drawn(device, method, MIXED, k=4, occupancy=intervals) as frame:
        np.testing.assert_allclose(frame.image(), composite(MIXED, 4), rtol=0, atol=1e-5)
        share = discarded_share(frame)
        kept = stats_of(MIXED).bounded(4) / stats_of(MIXED).F
        assert 0.5 * (1 - kept) < share <= 1 - kept
        assert frame.lost_fragments() == 0


@pytest.mark.parametrize("depths", [[0.5], [0.5] * 12, [0.0, 1.0], [0.25, 0.25 + 2**-23, 0.25 + 2**-22],
                                    [0.0, 0.5, 1.0]],
                         ids=["one", "zero range", "both ends", "narrow", "far bound"])
def test_occupancy_keeps_the_bounds_of_the_depth_range(device, depths):
    rgba = RANDOM.integers(2, 40, (len(depths), 4))
    with drawn(device, "kplus-array", stack(depths, rgba), k=len(depths), occupancy=32) as frame:
        assert discarded_share(frame) == 0
        np.testing.assert_allclose(frame.image()[..., 3], 1 - np.prod(1 - rgba[:, 3] / 255), rtol=0, atol=1e-5)


@pytest.mark.parametrize("depths", [[0.30748048, 0.82578546, 0.9985538], [0.19500334, 0.4958479, 0.88264805]])
def test_occupancy_keeps_a_depth_that_rounding_puts_beyond_its_interval(device, depths):
    """The middle depth is one step of float32 beyond the end of the interval that it is counted in."""
    near, middle, far = np.float32(depths)
    interval = np.floor((middle - near) / (far - near) * np.float32(32))
    assert middle > near + (far - near) * ((interval + np.float32(1)) / np.float32(32))
    with drawn(device, "kplus-array", stack(depths[::-1]), k=2, occupancy=32) as frame:
        np.testing.assert_allclose(frame.image(), composite(frame.scene_buffer.scene, 2), rtol=0, atol=1e-5)


@pytest.mark.parametrize("k", [8, 32])
def test_occupancy_reports_the_share_that_never_reaches_the_store(device, k):
    """64 equally spaced depths fill 64 intervals, one each. The end of the k-th culls the rest; k = 32 ends a word."""
    depths = np.arange(1, 65) / 128
    with drawn(device, "kplus-array", stack(depths[::-1]), k=k, occupancy=64) as frame:
        frame.draw()
        passes = frame.geometry_passes
        assert discarded_share(frame) == 1 - k / 64
        assert frame.geometry_passes == passes == 3
    with drawn(device, "kplus-array", stack(depths[:3], size=SIZE), k=k) as frame:
        assert "shaded_fragments" not in frame.probe()


OCCUPANCY_METHODS = [m.id for m in catalog().values() if m.param("occupancy") and "k" in m.variant({}).params]
LAYERED = generate(SceneConfig(size=(33, 21), depth_complexity=8, fragment_probability=0.4, layout="random",
                               quad_size=(17, 13), seed=9))


def occupied_frame(device, method: str, scene: Quads, **params):
    """Emulated atomics where the device has no others; a k that the method has slots or samples for."""
    declared = catalog()[method]
    if declared.param("atomic64"):
        params["atomic64"] = "emulated"
    if method == "kb-sr":
        params["k"] = min(params["k"], 4)
    if method != "kb-sr" and declared.variant(params).needs:
        params["k"] = 16
    return params["k"], drawn(device, method, scene, **params)


def test_every_k_buffer_has_occupancy():
    bounded = {m.id for m in catalog().values() if m.param("k") and m.guarantee != "exact all" and not m.mixes}
    assert set(OCCUPANCY_METHODS) == bounded
    assert catalog()["kplus-sb-dynamic"].param("occupancy")


@pytest.mark.parametrize("intervals", [32, 64, 128])
@pytest.mark.parametrize("k", [1, 7, 100])
@pytest.mark.parametrize("method", [m for m in OCCUPANCY_METHODS if m != "kb-sr"])
def test_occupancy_changes_no_image(device, method, k, intervals):
    """Rejected fragments, pixels with fewer than k, overlapping quads; k = 1, some and more than there are."""
    if device.kind != "cpu" and catalog()[method].guarantee == "approximate":
        pytest.skip("this device may shade fragments of a pixel at once")
    k, drawing = occupied_frame(device, method, LAYERED, k=k, occupancy=intervals)
    with drawing as frame:
        np.testing.assert_allclose(frame.image(), composite(LAYERED, k), rtol=0, atol=1e-5)
        assert frame.lost_fragments() == 0
        counted, kept = frame.probe(), stats_of(LAYERED).bounded(k)
        assert counted["stored_fragments"] == kept <= counted["shaded_fragments"] <= stats_of(LAYERED).F
        if k < 16:
            assert counted["shaded_fragments"] < stats_of(LAYERED).F


@pytest.mark.parametrize("depths", [[0.5], [0.0], [1.0], [0.0, 1.0], [0.25, 0.25 + 2**-23, 0.25 + 2**-22]],
                         ids=["one", "near plane", "far plane", "both ends", "narrow"])
@pytest.mark.parametrize("method", OCCUPANCY_METHODS)
def test_occupancy_keeps_depth_ranges_of_zero_and_their_bounds(device, method, depths):
    _, drawing = occupied_frame(device, method, stack(depths), k=len(depths), occupancy=32)
    with drawing as frame:
        assert discarded_share(frame) == 0
        np.testing.assert_allclose(frame.image(), composite(frame.scene_buffer.scene), rtol=0, atol=1e-5)


@pytest.mark.parametrize("multisampling", ["on", "off"])
def test_routing_takes_the_first_of_those_that_occupancy_leaves(device, multisampling):
    """A culled fragment takes no turn: the samples go to the four nearest, which are submitted last."""
    depths = np.arange(1, 33)[::-1] / 64
    scene = stack(depths)
    with drawn(device, "kb-sr", scene, k=4, occupancy=128, multisampling=multisampling) as frame:
        np.testing.assert_allclose(frame.image(), composite(scene, 4), rtol=0, atol=1e-5)
        assert discarded_share(frame) == 1 - 4 / 32


@pytest.mark.parametrize("f_p", [1.0, 0.3])
def test_a_culled_count_makes_room_for_no_more_than_is_stored(device, f_p):
    scene = generate(SceneConfig(size=(33, 21), depth_complexity=40, fragment_probability=f_p, seed=3))
    with drawn(device, "kb-ab-sb", scene, frames=2, k=4, occupancy=64) as frame:
        arrived = frame.probe()["shaded_fragments"]
        assert frame.memory_bytes["nodes"] == 8 * arrived < 8 * stats_of(scene).F
        np.testing.assert_allclose(frame.image(), composite(scene, 4), rtol=0, atol=1e-5)


@pytest.mark.parametrize("k", [3, 32, 40, 75, 90])
def test_lplus_keeps_k_fragments_where_depths_are_equal(device, k):
    """Fragments of one depth have one colour here, so that it does not matter which of them stay."""
    depths = [0.25] * 5 + [0.5] * 70 + [0.75] * 21
    rgba = [{0.25: (200, 10, 30, 9), 0.5: (10, 200, 30, 5), 0.75: (20, 10, 200, 12)}[depth] for depth in depths]
    order = np.random.default_rng(2).permutation(len(depths))
    scene = stack([depths[i] for i in order], [rgba[i] for i in order])
    with drawn(device, "kb-ab-array", scene, k=k, sort="lplus") as frame:
        assert_shows(frame, rgba[:k])  # nearest first


BOUNDED = [m.id for m in catalog().values() if m.param("bound")]


@pytest.mark.parametrize("method", BOUNDED)
@pytest.mark.parametrize("bound", ["uniform", "constant"])
def test_a_bound_is_the_same_as_a_uniform_and_as_a_constant(device, method, bound):
    more = {"atomic64": "emulated"} if catalog()[method].param("atomic64") else {}
    scene = staircase([0, 1, 2, 3, 4])
    image = image_of(device, method, scene, k=4, bound=bound, **more)
    np.testing.assert_allclose(image, composite(scene), rtol=0, atol=1e-5)


@pytest.mark.parametrize(("bound", "texts"), [("uniform", 1), ("constant", 2)])
def test_a_store_that_knows_k_as_a_uniform_is_the_same_for_each_k(bound, texts):
    stats = SceneStats(W=8, H=6, n=9, F=432, primitives=9)
    variants = [catalog()["kb-ps"].variant({"k": k, "bound": bound}) for k in (4, 8)]
    stores = {glsl.source(Fitted(v, stats), step).code for v in variants for step in v.passes if step.name == "store"}
    assert len(stores) == texts


@pytest.mark.parametrize("bma", BMA.choices)
@pytest.mark.parametrize(("n", "resolver"), [(16, "register"), (512, "register"), (513, "local")])
def test_the_automatic_sort_is_the_one_for_the_length_of_the_local_array(n, resolver, bma):
    fitted = Fitted(catalog()["ab-array"].variant({"bma": bma}), SceneStats(W=8, H=6, n=n, F=48 * n, primitives=n))
    drawn_last = [p for p in fitted.variant.passes if p.resolver and fitted.needed(p)][-1]
    assert drawn_last.resolver == f"common/resolve_{resolver}.glsl"
    assert fitted.value(drawn_last.defines["LOCAL"]) >= n


WAYS_OF_SOURCES = [("kplus-sb", {"sums": "fragment"}), ("kplus-sb-dynamic", {"sums": "fragment"}),
                   ("mlab", {"stores": "all"})]


@pytest.mark.parametrize(("method", "params"), WAYS_OF_SOURCES)
@pytest.mark.parametrize("more", [{}, {"touched": "bounds"}, {"reuse_count": "on"}])
def test_the_way_of_the_source_gives_the_same_image(device, method, params, more):
    """Drawn twice: with reuse_count the second frame uses what the first has counted."""
    if not all(catalog()[method].param(name) for name in more):
        pytest.skip(f"{method} has no {', '.join(more)}")
    scene = staircase([0, 1, 2, 3, 4, 7, 4, 0, 2])
    images = []
    for chosen in ({}, params):
        k = {"k": 4} if catalog()[method].param("k") else {}
        with drawn(device, method, scene, frames=2, **k, **chosen, **more) as frame:
            images.append(frame.image())
            assert frame.lost_fragments() == 0
    np.testing.assert_array_equal(*images)
