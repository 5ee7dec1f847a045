"""k-buffers with hazards: right one fragment at a time; what hazards would do is planted, and told or repaired."""

import numpy as np
import pytest

from mfr_bench.config import Scene as SceneConfig
from mfr_bench.hashing import mix
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import EMPTY, Fitted, Loop
from mfr_bench.oracle.composite import composite
from mfr_bench.scene import generate
from mfr_bench.store.status import EXACT_ERROR

from .drawing import chosen, drawn, stack

K = 6
DEPTHS = np.random.default_rng(7).permutation(np.linspace(0.1, 0.9, 20))


def error(frame, layers=K):
    return float(np.abs(frame.image() - composite(frame.scene_buffer.scene, layers)).max())


@pytest.mark.parametrize("method", ["kb", "kb-multi", "kb-mha"])
@pytest.mark.parametrize("k", [1, K, 16])
@pytest.mark.parametrize("depths", [DEPTHS, DEPTHS[:3], [0.5]], ids=["many", "few", "one"])
def test_exact_where_fragments_come_one_by_one(device, method, k, depths):
    if device.kind != "cpu" and method != "kb-multi":
        pytest.skip("this device may shade fragments of a pixel at once")
    with drawn(device, method, stack(depths), k=k) as frame:
        assert error(frame, k) <= EXACT_ERROR


@pytest.mark.parametrize("method", ["kb", "kb-mha"])
def test_memory_is_the_papers(device, method):
    with drawn(device, method, stack(DEPTHS), k=K) as frame:
        assert sum(frame.memory_bytes.values()) == Fitted(frame.variant, frame.stats).model_bytes()


@pytest.fixture
def repaired(device):
    """A frame of the multi-pass k-buffer, drawn without hazards."""
    with drawn(device, "kb-multi", stack(DEPTHS), k=K) as frame:
        yield frame


def rounds(frame, count, damage=None):
    """Rounds of the repairing loop, the slots damaged between store and tidy; then the resolve. Missing per round."""
    loop = next(s for s in frame.variant.steps if isinstance(s, Loop))
    missing = []
    for i in range(count):
        missing.append(frame._run(loop.passes[0], i, None))
        if damage:
            slots = frame.words("nodes").reshape(K, frame.stats.P, 2).copy()
            damage(slots)
            frame.allocation.named("nodes").write(slots.tobytes())
        frame._run(loop.passes[1], i, None)
    frame._run(frame.running[-1], 0, None)
    return missing


def lose(slots, certain=0):
    slots[certain:] = (EMPTY, 0)


def double(slots):
    slots[1:] = slots[:-1].copy()


def tear(slots):
    slots[:, :, 1] = slots[::-1, :, 1].copy()


def fade(slots, certain):
    slots[certain:, :, 1] = 0


@pytest.mark.parametrize("damage", [lose, double, tear])
def test_damage_is_repaired_in_k_passes(repaired, damage):
    rounds(repaired, 1, damage)
    assert error(repaired) > EXACT_ERROR
    missing = rounds(repaired, K)
    assert missing[0] > 0
    assert rounds(repaired, 1) == [0]
    assert error(repaired) <= EXACT_ERROR


@pytest.mark.parametrize("damage", [lose, fade])
def test_each_pass_makes_one_layer_certain_whatever_hazards_do(repaired, damage):
    """Every slot that a hazard could touch is damaged in every round; after i rounds the i nearest are right."""
    repaired._run(repaired.variant.steps[0], 0, None)  # clear
    for certain in range(K):
        rounds(repaired, 1, lambda slots, certain=certain: damage(slots, certain))
        assert error(repaired, certain + 1) <= EXACT_ERROR


def test_a_pass_that_misses_nothing_ends_the_repair(device, repaired):
    passes = repaired.geometry_passes
    assert passes == 2 if device.kind == "cpu" else 2 <= passes <= K
    assert rounds(repaired, 2) == [0, 0]


def test_a_torn_slot_reads_as_empty(device):
    """Colours moved by a slot: what the two bits of code find is left out, the rest shows the wrong colour."""
    with drawn(device, "kb-mha", stack(DEPTHS, size=(1, 1)), k=K) as frame:
        words, colours = frame.words("depths").astype(np.uint64), frame.words("colours").copy()
        assert coded(words & 0x3FFFFFFF, colours.astype(np.uint64)).tolist() == words.tolist()
        torn = np.roll(colours, 1)
        frame.allocation.named("colours").write(torn.tobytes())
        frame._run(frame.running[-1], 0, None)
        whole = coded(words & 0x3FFFFFFF, torn.astype(np.uint64)) == words
        assert not whole.all()
        depth = (words & 0x3FFFFFFF).astype(np.uint32).view(np.float32)
        shown = stack(depth[whole], size=(1, 1))
        shown.rgba[:] = torn[whole].view(np.uint8).reshape(-1, 4)
        assert np.abs(frame.image() - composite(shown)).max() <= EXACT_ERROR


def coded(depth, colour):
    return depth | (mix(depth ^ mix(colour)) & 0xC0000000)


@pytest.mark.parametrize("method", ["kb", "kb-multi", "kb-mha"])
def test_sixteen_slots_are_the_most(method):
    assert catalog()[method].variant({"k": 16}).needs == ()
    assert catalog()[method].variant({"k": 17}).needs == ("draw_buffers_16",)


def test_a_reconstruction_says_so():
    assert "reconstruction" in catalog()["kb-mha"].name


@pytest.mark.parametrize("per_pass", [2, 4, 8])
@pytest.mark.parametrize("k", [1, K, 16, 20])
def test_several_passes_keep_what_one_pass_has_no_slots_for(device, k, per_pass):
    if device.kind != "cpu":
        pytest.skip("this device may shade fragments of a pixel at once")
    with drawn(device, "kb", stack(DEPTHS), k=k, per_pass=per_pass) as frame:
        slots = min(k, per_pass)
        whole = -(-k // slots) * slots
        assert frame.fitted.promise().layers == whole
        assert error(frame, whole) <= EXACT_ERROR
        assert frame.geometry_passes == min(whole // slots, -(-len(DEPTHS) // slots))


def test_several_passes_end_in_each_pixel_by_itself(device):
    """A pixel whose fragments are all composited takes none of them again while others go on."""
    if device.kind != "cpu":
        pytest.skip("this device may shade fragments of a pixel at once")
    scene = generate(SceneConfig(size=(16, 12), depth_complexity=9, fragment_probability=0.5, seed=3))
    with drawn(device, "kb", scene, k=8, per_pass=2) as frame:
        assert error(frame, 8) <= EXACT_ERROR


def test_several_passes_need_the_slots_of_one_and_a_word(device):
    with drawn(device, "kb", stack(DEPTHS), k=64, per_pass=8) as frame:
        assert sum(frame.memory_bytes.values()) == 4 * (2 * 8 + 1) * frame.stats.P
        assert frame.variant.needs == ()


def test_a_pass_begins_behind_the_last_even_at_the_nearest_depth(device):
    """Depth 0 is before every boundary, and the end of one pass is not drawn again by the next."""
    if device.kind != "cpu":
        pytest.skip("this device may shade fragments of a pixel at once")
    with drawn(device, "kb", stack([0.5, 0.0, 1.0, 0.25]), k=4, per_pass=2) as frame:
        assert error(frame, 4) <= EXACT_ERROR


def test_an_equal_depth_that_finds_no_slot_in_its_pass_is_lost(device):
    if device.kind != "cpu":
        pytest.skip("this device may shade fragments of a pixel at once")
    scene = stack([0.5, 0.5, 0.5, 0.75])
    with drawn(device, "kb", scene, k=4, per_pass=2) as frame:
        kept = chosen(scene, [0, 1, 3])
        assert np.abs(frame.image() - composite(kept)).max() <= EXACT_ERROR
