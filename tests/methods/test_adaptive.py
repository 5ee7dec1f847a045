"""The adaptive method: which plan a frame gets, that none loses a fragment, and what stopping early costs."""

from dataclasses import replace

import numpy as np
import pytest

from mfr_bench.config.model import Measure
from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.errors import CapacityError
from mfr_bench.gpu import frame as frames
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.scene_buffer import SceneBuffer
from mfr_bench.gpu.targets import Canvas
from mfr_bench.gpu.work import work_of
from mfr_bench.methods import catalog
from mfr_bench.methods.adaptive import DENSE, DIRECT, MOST_ORDERED, ORDERED, PLANES, RANGES, plan
from mfr_bench.methods.shared.bands import bands
from mfr_bench.methods.spec import Fitted, Known, Plan
from mfr_bench.oracle.composite import composite, stats_of
from mfr_bench.plan import Cell, expected_stats, judge
from mfr_bench.scene import generate
from mfr_bench.store.status import EXACT_ERROR

from ..contract.cases import SCENES, SLANTED, Drawn, stats_in
from .drawing import assert_shows, chosen, drawn, over, stack

FEW = SceneConfig(size=(64, 64), depth_complexity=6, seed=3)
STORED = {"flat": "stored", "opaque": "stored", "shallow": "memory"}


def stored(device, scene, frames=1, **params):
    """A frame of the method in which flat and opaque primitives are stored like others."""
    return drawn(device, "adaptive", scene, frames, **(STORED | params))


@pytest.mark.parametrize(("layers", "area", "fragments", "path"), [
    (0, 0, None, DIRECT), (1, 100, None, DIRECT), (1, 100, 30, DIRECT),
    (4, 100, None, RANGES), (4, 100, 400, DENSE), (4, 50, 200, DENSE), (4, 100, 300, RANGES),
    (4, 100, 377, DENSE), (4, 100, 375, RANGES),  # a twentieth of 2f + 2 words in addition
])
def test_the_plan(layers, area, fragments, path):
    assert plan(Known(layers, area, 100, fragments), {}).path == path


def test_a_frame_whose_primitives_all_fill_the_rectangle_has_planes_from_the_first_on():
    assert plan(Known(4, 50, 100, None, reach=200, filled=True), STORED) == Plan(
        PLANES, Known(4, 50, 100, None, reach=200, filled=True), 200)


def test_flat_primitives_that_fill_the_rectangle_are_drawn_in_order_unless_they_are_too_many():
    known = Known(4, 50, 100, None, reach=200, filled=True)
    assert plan(known, {}) == Plan(ORDERED, known, 4)
    assert plan(replace(known, room=1), {"max_error": 0.01}).path == ORDERED
    assert plan(replace(known, layers=MOST_ORDERED + 1), {}).path == PLANES


@pytest.mark.parametrize(("fragments", "reach", "capacity"), [
    (None, 300, None), (300, 300, 300), (300, 320, 320), (300, 321, None), (300, None, None)])
def test_ranges_need_not_be_counted_first_where_the_geometry_cannot_have_many_more(fragments, reach, capacity):
    """A twentieth of 2f + 2 words in addition, here 20 fragments."""
    assert plan(Known(8, 100, 100, fragments, reach=reach), {}).capacity == capacity


def test_a_large_max_error_cuts_deep_frames():
    known = Known(64, 50, 100, 3200, reach=3200, filled=True)
    assert plan(known, {"max_error": 0.01, **STORED}) == Plan(DENSE, known, 3200, cut_off=True)
    assert plan(known, {"max_error": 2.0**-20, **STORED}).path == PLANES
    scattered = replace(known, filled=False)
    assert plan(scattered, {"max_error": 0.01}) == Plan(RANGES, scattered, cut_off=True)
    assert plan(replace(known, layers=39), {"max_error": 0.01}).cut_off is False


@pytest.mark.parametrize("config", [
    FEW, SceneConfig(size=(64, 64), depth_complexity=40, pixel_density=0.05, seed=3),
    SceneConfig(size=(64, 64), depth_complexity=6, layout="tiles", pixel_density=0.3, seed=3),
    SceneConfig(size=(64, 64), depth_complexity=6, fragment_probability=0.97, seed=3),
    SceneConfig(size=(64, 64), depth_complexity=1, pixel_density=0.3, seed=3),
])
def test_memory_is_that_of_the_s_buffer_and_a_twentieth(config):
    stats = stats_of(generate(config))
    memory = sum(Fitted(catalog()["adaptive"].variant({}), stats).memory_bytes().values())
    assert memory <= 1.05 * 4 * (2 * stats.F + 2 * stats.P) + 64 + 20 * stats.n


@pytest.mark.parametrize("count", [2, 3, 64, 65, 1000])
@pytest.mark.parametrize("payload", ["rgba8", "rgba16f"])
def test_flat_primitives_are_blended_in_the_order_of_one_pixel(device, count, payload):
    """Nothing is stored but the fragments of one pixel."""
    order, rgba = np.random.default_rng(count).permutation(count), np.random.default_rng(1).integers(1, 40, (count, 4))
    with drawn(device, "adaptive", stack((order + 1) / (count + 2), rgba), frames=2, payload=payload) as frame:
        assert frame.plan == Plan(ORDERED, frame.plan.known, count)
        assert_shows(frame, rgba[np.argsort(order)])
        assert frame.lost_fragments() == 0
        assert frame.probe() == {"stored_fragments": count * 35}


@pytest.mark.parametrize(("shader", "right", "wrong"), [
    ("rank.comp", "other > depth", "other < depth"), ("rank.comp", "= primitive;  // first instance", "= 0u;"),
    ("rank.comp", "place_of(primitive);", "((place_of(primitive) + 1u) % capacity);"),
    ("store_one.frag", "nodes[quad] =", "nodes[quad / 2u] =")])
def test_a_wrong_line_of_the_order_is_seen(device, plant, shader, right, wrong):
    """Each leaves every indirect draw written: one that is not draws as many instances as its memory happens to say."""
    def error() -> float:
        with drawn(device, "adaptive", scene := generate(FEW), frames=2) as frame:
            return np.abs(frame.image() - composite(scene)).max()

    assert error() < 1e-6
    plant(f"methods/adaptive/{shader}", right, wrong)
    assert error() > 1e-3


def test_equal_depths_are_all_drawn_in_order_of_submission(device):
    rgba = np.random.default_rng(2).integers(30, 226, (40, 4))
    depths = np.repeat(np.linspace(0.1, 0.9, 10), 4)
    with drawn(device, "adaptive", stack(depths, rgba)) as frame:
        assert frame.plan.path == ORDERED
        assert_shows(frame, rgba.reshape(10, 4, 4)[:, ::-1].reshape(40, 4))


@pytest.mark.parametrize("payload", ["rgba8", "rgba16f"])
def test_one_layer_is_blended_as_it_comes_with_every_payload(device, payload):
    scene = generate(SceneConfig(size=(32, 24), depth_complexity=1, seed=3))
    with stored(device, scene, payload=payload) as frame:
        assert frame.plan.path == DIRECT
        np.testing.assert_allclose(frame.image(), composite(scene), rtol=0, atol=1e-6)


def test_a_scene_that_thins_out_is_right_in_its_first_frame_and_has_ranges_in_the_next(device):
    """The plan of a frame is made from what the frame before had: it may waste memory once, never a fragment."""
    full = generate(FEW)
    thin = chosen(full, list(range(6)))
    thin.rect[1:, 2] = thin.rect[1:, 0] + 1
    quads, canvas = SceneBuffer(device, full), Canvas(device, (64, 64))
    frame = Frame(device, Fitted(catalog()["adaptive"].variant(STORED), stats_of(full)), quads, canvas)
    try:
        frame.draw_fitting()
        assert frame.plan.path == PLANES
        quads.replace(thin)
        frame.show(thin)
        for path in (DENSE, RANGES):
            frame.draw()
            assert frame.plan.path == path
            np.testing.assert_allclose(frame.image(), composite(thin), rtol=0, atol=1e-4)
        quads.replace(full)
        frame.show(full)
        for _ in range(2):
            frame.draw()
            assert frame.plan.path == PLANES
            np.testing.assert_allclose(frame.image(), composite(full), rtol=0, atol=1e-4)
        assert frame.lost_fragments() == 0
    finally:
        for thing in (frame, canvas, quads):
            thing.release()


THICK = (60, 90, 120, 40)  # a layer of which eight show, and yet let pixels no longer be taken for faint


@pytest.mark.parametrize("count", [2, 3, 5, 9, 17, 32, 33, 64, 65, 86, 87, 1024, 1030])
@pytest.mark.parametrize("taken_for", ["faint", "thick"])
def test_stacks_of_every_network_of_several_sweeps_and_of_merged_blocks(device, count, taken_for):
    """So little is hidden that all fragments count, whatever block and sweep they come in.

    Eight thick layers that come first, behind all others, let a pixel deeper than 64 be swept instead of merged. With
    86 or 87 in front of them the third sweep meets 32, as many as it keeps, or 33.
    """
    back, random = 8 * (taken_for == "thick"), np.random.default_rng(count)
    order = random.permutation(count)
    rgba = np.column_stack([random.integers(0, 256, (count, 3)), random.integers(1, 2 if count > 100 else 12, count)])
    scene = stack([*np.linspace(0.9999, 0.99991, back), *(order + 1) / (count + 2)], [*[THICK] * back, *rgba])
    with stored(device, scene) as frame:
        assert_shows(frame, [*rgba[np.argsort(order)], *[THICK] * back])


@pytest.mark.parametrize(("shader", "right", "wrong", "back"), [
    ("halves.glsl", "OPPOSITE(COMPARE)", "", 0),
    ("halves.glsl", "SECOND32(CLEAN32)", "", 0),
    ("nearest.glsl", "nodes[at] = block##i", "nodes[at] = block0", 0),
    ("nearest.glsl", "& 31u) == 0u", "& 31u) == 1u", 0),
    ("nearest.glsl", "depths[b] >= depth", "depths[b] <= depth", 0),
    ("nearest.glsl", "fragment.x >= from", "fragment.x > from", 8),
    ("nearest.glsl", "block##b.x < block##a.x", "block##b.x > block##a.x", 8)])
def test_a_wrong_line_of_a_deep_resolve_is_seen(device, plant, shader, right, wrong, back):
    """In stacks of 40 and of 100, faint in front of as many thick layers as are said, submitted first."""
    def wrong_images() -> bool:
        return any(deep_error(device, count, back) > 1e-5 for count in (40, 100))

    assert not wrong_images()
    plant(f"methods/adaptive/{shader}", right, wrong)
    assert wrong_images()


def deep_error(device, count: int, back: int) -> float:
    rgba = np.array([*[THICK] * back, *np.random.default_rng(1).integers(1, 12, (count, 4))])
    depths = [*np.linspace(0.9999, 0.99991, back), *(np.random.default_rng(count).permutation(count) + 1) / (count + 2)]
    with stored(device, stack(depths, rgba)) as frame:
        return np.abs(frame.image() - over(rgba[np.argsort(depths)])).max()


@pytest.mark.parametrize("equal", [2, 31, 32, 33, 70])
@pytest.mark.parametrize("taken_for", ["faint", "thick"])
def test_equal_depths_at_the_end_of_a_sweep_are_all_kept(device, equal, taken_for):
    """20 nearer, `equal` at one depth and 40 further: those of one depth are alike, so that their order is none."""
    count = 60 + equal
    depths = np.concatenate([np.linspace(0.1, 0.3, 20), np.full(equal, 0.5), np.linspace(0.6, 0.9, 40)])
    rgba = np.random.default_rng(2).integers(1, 9, (count, 4))
    rgba[20:20 + equal] = (200, 100, 50, 6)
    back = 8 * (taken_for == "thick")
    order = np.random.default_rng(3).permutation(count)
    scene = stack([*np.linspace(0.95, 0.96, back), *depths[order]], [*[THICK] * back, *rgba[order]])
    with stored(device, scene) as frame:
        assert_shows(frame, [*rgba, *[THICK] * back])


@pytest.mark.parametrize("max_error", [1 / 512, 0.05])
def test_what_is_left_out_is_within_the_bound_and_is_said(device, max_error):
    rgba = np.random.default_rng(4).integers(20, 40, (90, 4))
    with stored(device, stack(np.linspace(0.1, 0.9, 90), rgba), max_error=max_error) as frame:
        error = np.abs(frame.image() - over(rgba)).max()
        assert frame.variant.guarantee == "approximate"
    assert 1e-6 < error <= max_error + 1e-6


@pytest.mark.parametrize("config", [
    SceneConfig(size=(64, 48), depth_complexity=40, alpha=(0.5, 0.5), seed=5),
    SceneConfig(size=(64, 48), depth_complexity=40, fragment_probability=0.6, layout="tiles", pixel_density=0.5),
    SceneConfig(size=(64, 48), depth_complexity=30, alpha=(0.01, 1.0), layout="random", seed=6),
    SceneConfig(size=(64, 48), depth_complexity=40, alpha=(1.0, 1.0), seed=7),
    SceneConfig(size=(64, 48), depth_complexity=40, alpha=(0.004, 0.01), seed=8)])
@pytest.mark.parametrize("max_error", [1 / 512, 0.05])
def test_what_the_cut_discards_is_within_the_bound(device, config, max_error):
    scene = generate(config)
    with stored(device, scene, max_error=max_error) as frame:
        assert frame.plan.cut_off and frame.lost_fragments() == 0
        assert np.abs(frame.image() - composite(scene)).max() <= max_error + 1e-5
        held = frame.probe()["stored_fragments"]
    faint = config.alpha[1] < 0.1
    assert (held == stats_of(scene).F) == faint


def test_every_frame_cuts_at_the_first_quarter_that_is_opaque_enough(device):
    """16 of 64 layers of opacity 1/2 lie in the first quarter, and let 2^-16 through."""
    scene = generate(SceneConfig(size=(32, 16), depth_complexity=64, alpha=(0.5, 0.5), seed=7))
    with stored(device, scene, frames=0, max_error=1 / 512) as frame:
        assert [frame.probe()["stored_fragments"] for _ in range(3)] == [16 * 32 * 16] * 3


@pytest.mark.parametrize(("shader", "right", "wrong"), [
    ("classify.frag", "classify(count)", "classify(1u)"), ("cut.frag", "16.0 + 0.5", "8.0")])
def test_a_wrong_line_of_the_cut_is_seen(device, plant, shader, right, wrong):
    scene = generate(SceneConfig(size=(64, 48), depth_complexity=90, alpha=(0.1, 0.2), seed=7))

    def error() -> float:
        with stored(device, scene, max_error=1 / 512) as frame:
            assert frame.plan.path == DENSE and frame.plan.cut_off
            return np.abs(frame.image() - composite(scene)).max()

    assert error() <= 1 / 512 + 1e-5
    plant(f"methods/adaptive/{shader}", right, wrong)
    assert error() > 1 / 512 + 1e-5


def test_the_default_error_is_a_third_of_what_exact_images_may_differ_by():
    variant = catalog()["adaptive"].variant({})
    assert variant.guarantee == "exact all"
    assert Fitted(variant, stats_of(generate(FEW))).error_bound() < 1e-4 / 2


# A budget of memory

FULL = SceneConfig(size=(64, 64), depth_complexity=6, seed=12)
DEEP_ROWS = SceneConfig(size=(140, 6), depth_complexity=40, seed=11)
BANDED = {name: SCENES[name] for name in ("sorted", "tiles", "rejecting", "scattered", "sparse")} | {
    "deep rows": DEEP_ROWS, "hairball": SLANTED["hairball"], "crossing": SLANTED["crossing"]}


def budgeted(stats, room: int, **params):
    """The method with just the memory that leaves room for so many fragments."""
    some = catalog()["adaptive"].variant({"memory_mb": 1.0, **STORED, **params})
    budget = sum(Fitted(some, stats).memory_bytes(room).values())
    return catalog()["adaptive"].variant({**some.params, "memory_mb": budget / 2**20})


def least_room(stats) -> int:
    return min(stats.F, 32 * stats.n)


@pytest.mark.parametrize("name", BANDED)
@pytest.mark.parametrize("share", [1.0, 0.51, 0.0])
def test_no_budget_loses_a_fragment(device, name, share):
    """In one band, in few, and in as many as the smallest budget asks for."""
    stats = stats_in(device, BANDED[name])
    room = max(least_room(stats), int(share * stats.F))
    variant = budgeted(stats, room)
    assert Fitted(variant, stats).room() == room
    drawn = Drawn(device, variant, BANDED[name], frames=2, probing=True)
    assert drawn.lost == 0 and drawn.error <= EXACT_ERROR
    assert drawn.probed["stored_fragments"] == stats.F
    assert drawn.allocated == drawn.declared
    assert sum(drawn.allocated.values()) <= variant.budget_bytes
    needed = -(-stats.F // room)
    assert Fitted(variant, stats).plan().banded or share == 1.0
    if Fitted(variant, stats).plan().banded:
        assert needed <= drawn.passes - 1 <= 2 * needed + 2 * stats.H * (share == 0.0)


@pytest.mark.parametrize("payload", ["rgba16f", "two_channel"])
def test_a_wider_payload_counts_against_the_budget(device, payload):
    stats = stats_in(device, BANDED["tiles"])
    variant = budgeted(stats, stats.F // 3, payload=payload)
    drawn = Drawn(device, variant, BANDED["tiles"])
    assert drawn.lost == 0 and drawn.error <= EXACT_ERROR and drawn.passes > 3
    assert sum(drawn.allocated.values()) == sum(drawn.declared.values()) <= variant.budget_bytes


def test_bands_give_the_same_image_in_every_frame(device):
    stats = stats_in(device, BANDED["scattered"])
    drawn = Drawn(device, budgeted(stats, stats.F // 4), BANDED["scattered"], frames=50)
    assert drawn.distinct_images == 1 and drawn.lost == 0 and drawn.passes > 4


def test_bands_do_the_work_of_one_once(device):
    """Each fragment is rasterized and stored in one band, each pixel of the viewport cleared and resolved in one."""
    scene = generate(replace(FULL, depth_complexity=20))
    stats = stats_of(scene)
    with stored(device, scene, **budgeted(stats, stats.F // 4).params) as frame:
        work = work_of(frame)
    assert work["store"]["rasterized"] == work["store"]["passed"] == work["store"]["stored"] == stats.F
    assert work["resolve"]["loaded"] == stats.F
    assert work["allocate"]["cleared"] == stats.P


@pytest.mark.parametrize("wrong", [
    lambda b, room: (b[0], b[1], b[2], max(b[3] - 1, 0)), lambda b, room: (b[0], b[1] + 1, b[2], b[3]),
    lambda b, room: (b[0], b[1], b[2], b[3] + 1) if b[1] == 0 else b])
def test_a_band_that_is_off_by_one_row_is_seen(device, monkeypatch, wrong):
    """A row that no band has is missing in the image; one too many in a full band finds no room."""
    stats = stats_in(device, FULL)
    variant = budgeted(stats, 16 * 64 * 6)
    assert not seen(Drawn(device, variant, FULL))
    monkeypatch.setattr(frames, "bands", lambda *given: (wrong(b, given[2]) for b in bands(*given)))
    assert seen(Drawn(device, variant, FULL))


def seen(drawn: Drawn) -> bool:
    return drawn.error > EXACT_ERROR or drawn.lost > 0


def test_a_budget_without_room_for_a_segment_ends_with_its_number(device):
    stats = stats_of(generate(DEEP_ROWS))
    variant = budgeted(stats, 32 * 40 - 1)
    with (pytest.raises(CapacityError, match=r"1280 fragments of 32 pixels in row 0 do not fit: .* 1279"),
          stored(device, generate(DEEP_ROWS), **variant.params)):
        pass


def test_the_smallest_budget_is_judged_before_a_frame_is_drawn():
    """8 bytes a pixel, 4 for each 32 pixels of a row, 148 for the frame, and 32 pixels of 64 fragments."""
    config = SceneConfig(size=(70, 48), depth_complexity=64)
    least = 8 * 70 * 48 + 4 * 3 * 48 + 148 + 8 * 32 * 64

    def judged(memory_mb):
        params = catalog()["adaptive"].complete({"memory_mb": memory_mb, **STORED})
        cell = Cell("test", "adaptive", "adaptive", params, config, Measure(), {})
        return judge(cell, catalog(), expected_stats(config), None)

    assert judged(least / 2**20) is None
    assert judged((least - 8) / 2**20)[0] == "over_budget"
    assert judged(0.01) == ("over_budget", "needs at least 0.042 MiB, memory_mb allows it 0.01 MiB")


@pytest.mark.parametrize("max_error", [1 / 512, 0.05])
def test_bands_of_what_the_cut_leaves_are_within_the_bound(device, max_error):
    config = SceneConfig(size=(64, 48), depth_complexity=40, alpha=(0.1, 0.9), layout="random", seed=6)
    scene = generate(config)
    stats = stats_of(scene)
    variant = budgeted(stats, max(least_room(stats), stats.F // 8), max_error=max_error)
    with stored(device, scene, **variant.params) as frame:
        assert frame.plan.cut_off and frame.plan.banded and frame.lost_fragments() == 0
        assert frame.geometry_passes > 3
        assert np.abs(frame.image() - composite(scene)).max() <= max_error + 1e-5
        assert sum(frame.memory_bytes.values()) <= variant.budget_bytes


def test_a_budget_stays_kept_when_the_scene_changes(device):
    """The frame before is thin, the next is full, and the budget holds a third of it."""
    full = generate(FEW)
    thin = chosen(full, list(range(6)))
    thin.rect[1:, 2] = thin.rect[1:, 0] + 1
    stats = stats_of(full)
    variant = budgeted(stats, stats.F // 3)
    quads, canvas = SceneBuffer(device, thin), Canvas(device, (64, 64))
    frame = Frame(device, Fitted(variant, stats), quads, canvas)
    try:
        for scene in (thin, full, thin, full):
            quads.replace(scene)
            frame.show(scene)
            frame.draw()
            np.testing.assert_allclose(frame.image(), composite(scene), rtol=0, atol=1e-4)
            assert sum(frame.memory_bytes.values()) <= variant.budget_bytes
        assert frame.lost_fragments() == 0
    finally:
        for thing in (frame, canvas, quads):
            thing.release()


def test_no_budget_is_the_default_and_can_be_written():
    adaptive = catalog()["adaptive"]
    assert adaptive.variant({"memory_mb": 0}) == adaptive.variant({})
    assert "sums" not in Fitted(adaptive.variant({}), stats_of(generate(FEW))).memory_bytes()
    with pytest.raises(ValueError, match="allowed: 0 or a number between 0 and 1048576"):
        adaptive.variant({"memory_mb": -1.0})


def test_layers_behind_thousands_of_others_do_not_leak(device):
    """The share that shows through is kept as such: 1 minus a sum of opacities would stop at the last bit of 1."""
    scene = generate(SceneConfig(size=(8, 8), depth_complexity=4096, alpha=(0.004, 0.01), seed=7))
    with stored(device, scene) as frame:
        assert np.abs(frame.image() - composite(scene)).max() < 5e-6
