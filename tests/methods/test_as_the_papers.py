"""Options by which methods run as the papers' did: too few slots, several render passes, offsets of each frame."""

from __future__ import annotations

import numpy as np
import pytest

from mfr_bench.config import Scene as SceneConfig
from mfr_bench.gpu.capture import capture
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.single import shown
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted
from mfr_bench.oracle.composite import composite, fragment_counts
from mfr_bench.oracle.quality import conformance
from mfr_bench.scene import generate

from .drawing import drawn

UNEVEN = generate(SceneConfig(size=(24, 20), depth_complexity=9, least_depth=0.2, seed=3))


def given(method: str) -> dict:
    """Parameters with which a method of gpupro5_ch1 runs on any device."""
    return {"atomic64": "emulated"} if method.startswith("open") else {}


def test_a_pixel_with_more_fragments_than_room_loses_those_that_come_later(device):
    """kplus_2015 §5.3: KB-AB_Array with fewer slots than layers; other pixels keep theirs, and the loss is counted."""
    counts = fragment_counts(UNEVEN)
    with drawn(device, "kb-ab-array", UNEVEN, room=4, k=9) as frame:
        assert frame.lost_fragments() == np.clip(counts - 4, 0, None).sum() > 0
        image, memory = frame.image(), sum(frame.memory_bytes.values())
    np.testing.assert_allclose(image[counts <= 4], composite(UNEVEN)[counts <= 4], atol=1e-5)
    with drawn(device, "kb-ab-array", UNEVEN, k=9) as frame:
        assert sum(frame.memory_bytes.values()) - memory == 4 * 2 * 5 * counts.size


@pytest.mark.parametrize("sort", ["hybrid", "register"])
@pytest.mark.parametrize("method", ["ab-array", "ab-ll"])
def test_a_local_array_shorter_than_a_list_loses_those_that_find_no_room(device, method, sort):
    counts = fragment_counts(UNEVEN)
    with drawn(device, method, UNEVEN, sort=sort, local_array=8) as frame:
        assert frame.lost_fragments() == np.clip(counts - 8, 0, None).sum() > 0
        np.testing.assert_allclose(frame.image()[counts <= 8], composite(UNEVEN)[counts <= 8], atol=1e-5)


def test_more_room_than_fragments_allocates_no_more(device):
    sizes = []
    for room in (0, 9, 100):
        with drawn(device, "ab-array", UNEVEN, room=room) as frame:
            assert frame.lost_fragments() == 0
            sizes.append(sum(frame.memory_bytes.values()))
    assert len(set(sizes)) == 1


@pytest.mark.parametrize("method", ["lin-post", "lin-pre", "open-post", "open-pre"])
def test_several_render_passes_leave_one_image(device, method):
    """gpupro5_ch1 §1.1.2: the build is drawn once, the render pass as often as asked for."""
    images, counts = [], []
    for renders in (1, 3):
        variant = catalog()[method].variant({**given(method), "renders": renders})
        counts.append([p.name for p in variant.passes if p.probes is None].count("render"))
        with drawn(device, method, UNEVEN, renders=renders, **given(method)) as frame:
            images.append(frame.image())
            assert frame.lost_fragments() == 0
            assert frame.probe()["stored_fragments"] == fragment_counts(UNEVEN).sum()
    np.testing.assert_array_equal(*images)
    assert counts[1] == 3 * counts[0] > 0


@pytest.mark.parametrize("insert", ["cas32", "max64"])
def test_sorted_lists_take_cells_in_pages(device, insert):
    """gpupro5_ch1 §1.5.1: PRE-LIN with paged allocation and a cleared array of each pixel's free cell."""
    wide = {"atomic64": "emulated"} if insert == "max64" else {}
    with drawn(device, "lin-pre", UNEVEN, insert=insert, allocation="paged", **wide) as frame:
        np.testing.assert_allclose(frame.image(), composite(UNEVEN), atol=1e-5)
        assert frame.lost_fragments() == 0


@pytest.mark.parametrize("method", ["lin-post", "lin-pre"])
def test_cells_come_from_a_dedicated_counter(device, method):
    """gpupro5_ch1 §1.2, Listing 1.1: atomicCounterIncrement, in the passes that take cells; a list still grows."""
    variant = catalog()[method].variant({"allocation": "dedicated"})
    assert [p.atomics for p in variant.passes if p.kind == "geometry"] == [("cell_counter",)]
    with drawn(device, method, UNEVEN, frames=3, allocation="dedicated") as frame:
        assert frame.words("cell_counter")[0] == fragment_counts(UNEVEN).sum()
        np.testing.assert_allclose(frame.image(), composite(UNEVEN), atol=1e-5)
        assert frame.lost_fragments() == 0


def test_probe_offsets_are_drawn_anew_before_each_frame(device):
    """gpupro5_ch1 §1.3.1; the image stays the same."""
    scene = generate(SceneConfig(size=(120, 100), depth_complexity=9, seed=3))  # a table of many times 256 cells
    offsets, images = [], []
    with drawn(device, "open-post", scene, atomic64="emulated") as frame:
        for _ in range(3):
            frame.draw_fitting()
            offsets.append(frame.words("offsets"))
            images.append(frame.image())
    assert all((a != b).mean() > 0.9 for a, b in ((offsets[0], offsets[1]), (offsets[1], offsets[2])))
    np.testing.assert_allclose(images[0], images[2], atol=1e-6)


def test_fragments_are_counted_by_blending(device):
    """sbuffer_2012 §3.1: the same counts, image and order of passes; and a texture of one word per pixel."""
    found = {}
    for counting in ("atomic", "blended"):
        with drawn(device, "ab-sb", UNEVEN, frames=2, counting=counting) as frame:
            np.testing.assert_array_equal(frame.words("counter"), fragment_counts(UNEVEN).ravel())
            np.testing.assert_allclose(frame.image(), composite(UNEVEN), atol=1e-5)
            found[counting] = sum(frame.memory_bytes.values())
    assert found["blended"] - found["atomic"] == 4 * fragment_counts(UNEVEN).size


BOXES = {
    "quads": SceneConfig(size=(40, 32), depth_complexity=40, pixel_density=0.5, seed=3),
    "hairball": SceneConfig(kind="hairball", size=(40, 32), depth_complexity=40, mean_depth=20, seed=3),
    "temple": SceneConfig(kind="temple", size=(40, 32), depth_complexity=30, mean_depth=12, seed=3),
    "slanted": SceneConfig(size=(40, 32), depth_complexity=30, slant=0.5, seed=3),
}


@pytest.mark.parametrize("kind", BOXES)
def test_no_fragment_lies_beyond_the_box_around_the_scene(device, kind):
    with shown(device, generate(BOXES[kind])) as on:
        depths = capture(device, on.scene_buffer, on.canvas).depth.view(np.float32)
        near, far = on.scene_buffer.scene.depth_bounds
        assert 0 <= np.float32(near) <= depths.min()
        assert depths.max() <= np.float32(far) <= 1
        assert far - near < 1.1 * (depths.max() - depths.min()) + 1e-3


@pytest.mark.parametrize("kind", BOXES)
def test_bounds_by_a_box_save_a_geometry_pass_and_keep_the_k_nearest(device, kind):
    """occupancy_2015, Algorithm, step 1: a bounding box is drawn in place of the scene."""
    found = {}
    with shown(device, generate(BOXES[kind])) as on:
        for bounds in ("geometry", "box"):
            variant = catalog()["kplus-array"].variant({"k": 4, "occupancy": 64, "occupancy_bounds": bounds})
            frame = Frame(device, Fitted(variant, on.stats), on.scene_buffer, on.canvas)
            frame.draw_fitting()
            error = conformance(frame.image(), on.truth.answer(frame.fitted.promise()))["max_abs_error"]
            assert error < 1e-4
            found[bounds] = frame.geometry_passes, frame.probe()["shaded_fragments"]
            frame.release()
    assert found["box"][0] == found["geometry"][0] - 1
    assert found["geometry"][1] <= 1.05 * found["box"][1] < on.stats.F  # tighter bounds discard about as many, or more
