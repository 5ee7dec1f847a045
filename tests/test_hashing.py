"""One hash for plans, scenes and shaders: Python's whole numbers, numpy's words and GLSL's give the same bits."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mfr_bench import glsl
from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.scene_buffer import SceneBuffer
from mfr_bench.gpu.targets import Canvas
from mfr_bench.hashing import WORD, hash3, mix
from mfr_bench.methods.spec import Buffer, Fitted, Method, Pass
from mfr_bench.oracle.composite import stats_of
from mfr_bench.scene import generate

words = st.integers(0, WORD)
triples = st.lists(st.tuples(words, words, words), min_size=1, max_size=50)

HASH_SHADER = """// Test: the hash of three counters that each pixel makes for itself.
#include "common/pixel.glsl"
#include "common/hash.glsl"

void main() {
    uint p = pixel_index();
    hashes[p] = hash3(p * 2654435761u, ~p, seed);
}
"""
PROBE = Method(id="test-hash", name="hash", family="test", source="test", summary="", guarantee="none", words="0",
               ties="", buffers=(Buffer("hashes", "P"),),
               steps=(Pass("hash", "fullscreen", "test/hash.frag", writes=("hashes",)),))


@given(triples)
def test_numpy_gives_what_whole_numbers_give(counters):
    columns = np.array(counters, dtype=np.uint64).T
    assert hash3(*columns).tolist() == [hash3(*triple) for triple in counters]


@given(words, words)
def test_one_counter_of_many_broadcasts(a, c):
    column = np.arange(5, dtype=np.uint64)
    assert hash3(a, column, c).tolist() == [hash3(a, b, c) for b in range(5)]


@given(words)
def test_mixing_can_be_undone(x):
    """So no two words share an image."""
    y = mix(x)
    y ^= y >> 16
    y = y * pow(0x846CA68B, -1, 2**32) & WORD
    y ^= y >> 15 ^ y >> 30
    y = y * pow(0x7FEB352D, -1, 2**32) & WORD
    assert y ^ y >> 16 == x


def test_bits_never_change():
    assert [mix(x) for x in (0, 1, 2, WORD)] == [0, 0x688990C0, 0xD1132181, 0x6768824A]
    assert hash3(1, 2, 3) == 0xACFD7E59


def test_every_bit_of_every_counter_reaches_half_of_the_result():
    counters = np.random.default_rng(1).integers(0, 2**32, (3, 4000), dtype=np.uint64)
    before = hash3(*counters)
    for place in range(3):
        for bit in range(32):
            changed = counters.copy()
            changed[place] ^= np.uint64(1 << bit)
            flipped = 32 * np.unpackbits((before ^ hash3(*changed)).astype(np.uint32).view(np.uint8)).mean()
            assert flipped == pytest.approx(16, abs=0.5)


@pytest.mark.parametrize("seed", [0, 1, 2**31, WORD])
def test_glsl_gives_the_same_bits(device, monkeypatch, seed):
    real = glsl.read
    monkeypatch.setattr(glsl.includes, "read", lambda path: HASH_SHADER if path == "test/hash.frag" else real(path))
    scene = generate(SceneConfig(size=(97, 71), depth_complexity=0, seed=seed))
    stats = stats_of(scene)
    quads, canvas = SceneBuffer(device, scene), Canvas(device, scene.viewport)
    frame = Frame(device, Fitted(PROBE.variant({}), stats), quads, canvas)
    frame.draw()
    found = frame.words("hashes")
    for thing in (frame, canvas, quads):
        thing.release()
    pixel = np.arange(97 * 71, dtype=np.uint64)
    assert (found == hash3(pixel * 2654435761 & WORD, ~pixel & WORD, seed)).all()
