"""FLIP of parts: the blocks around what differs give to the bit what the whole images give."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest

from mfr_bench.oracle import flip
from mfr_bench.oracle.flip import REACH, OnScreen, displayed, flip_map


def whole(reference: np.ndarray, test: np.ndarray) -> np.ndarray:
    import flip_evaluator

    images = [image.astype(np.float32) / np.float32(255) for image in (reference, test)]
    return flip_evaluator.evaluate(*images, "LDR", applyMagma=False, computeMeanError=False)[0][..., 0]


def pair(shape, places):
    """An image of noise, and one that differs from it in these pixels."""
    reference = np.random.default_rng(3).integers(0, 256, (*shape, 3), np.uint8)
    test = reference.copy()
    for place in places:
        test[place] = 255 - test[place]
    return reference, test


@pytest.fixture
def sizes(monkeypatch):
    """The shapes of the images that FLIP is evaluated of."""
    found, evaluated = [], flip._evaluated
    monkeypatch.setattr(flip, "_evaluated", lambda *images: found.append(images[0].shape) or evaluated(*images))
    return found


@pytest.mark.parametrize("places", [
    [(90, 100)], [(0, 0)], [(0, 189)], [(179, 0)], [(179, 189)], [(3, 60), (9, 71), (178, 5)],
    [np.s_[40:50, 60:75]], [np.s_[0:3, :]], [(90, 100), (90, 101 + REACH), (91 + 2 * REACH, 100)],
], ids=str)
def test_parts_give_what_the_whole_gives(places, sizes):
    reference, test = pair((180, 190), places)
    assert np.array_equal(flip_map(reference, test), whole(reference, test))
    assert np.prod(sizes[0][:2]) < 180 * 190


@pytest.mark.parametrize("shape", [(1, 1), (5, 40), (64, 64), (180, 190)], ids=str)
def test_images_that_differ_everywhere_or_are_small_are_taken_whole(shape, sizes):
    reference, test = pair(shape, [np.s_[:, :]])
    assert np.array_equal(flip_map(reference, test), whole(reference, test))
    assert sizes == [(*shape, 3)]


@pytest.mark.parametrize("shape", [(1, 1), (37, 260), (512, 300)], ids=str)
@pytest.mark.parametrize("share", [0.0002, 0.01, 1.0])
def test_the_blocks_are_those_with_a_pixel_that_differs(shape, share):
    differ = np.random.default_rng(5).random(shape) < share
    differ[-1, -1] = True
    side, blocks = flip._blocks(differ)
    assert blocks.tolist() == np.unique(np.argwhere(differ) // side * side, axis=0).tolist()
    assert all(len(blocks) * flip._width(side) ** 2 <= len(other) * flip._width(size) ** 2 for size in flip.SIDES
               for other in [np.unique(np.argwhere(differ) // size, axis=0)])


def patches(cuts_y, cuts_x, speckles, seed=4):
    """Two images of rectangles between these lines, whose colours differ, with some single pixels of their own."""
    random = np.random.default_rng(seed)
    found = []
    for _ in range(2):
        colours = random.integers(0, 256, (len(cuts_y) - 1, len(cuts_x) - 1, 3), np.uint8)
        image = np.repeat(np.repeat(colours, np.diff(cuts_y), axis=0), np.diff(cuts_x), axis=1)
        for place in speckles:
            image[place] = random.integers(0, 256, 3, np.uint8)
        found.append(image)
    return found


@pytest.mark.parametrize(("cuts_y", "cuts_x", "speckles"), [
    ([0, 180], [0, 190], []),  # one colour
    ([0, 60, 180], [0, 95, 190], []), ([0, 5, 26, 48, 180], [0, 21, 43, 190], []),
    ([0, 30, 150, 180], [0, 190], [(90, 100)]), ([0, 180], [0, 40, 190], [(0, 0), (179, 189), (60, 0)]),
], ids=str)
def test_large_areas_of_one_colour_give_what_all_their_pixels_give(cuts_y, cuts_x, speckles, sizes):
    reference, test = patches(cuts_y, cuts_x, speckles)
    assert np.array_equal(flip_map(reference, test), whole(reference, test))
    assert np.prod(sizes[0][:2]) < 0.6 * 180 * 190


@pytest.mark.parametrize("length", range(2 * REACH - 1, 2 * REACH + 5))
def test_runs_about_as_long_as_the_filters_reach_are_told_apart(length):
    reference, test = patches([0, 9, 9 + length, 30 + length], [0, 7, 7 + length, 29 + length], [])
    assert np.array_equal(flip_map(reference, test), whole(reference, test))


def test_images_that_a_screen_shows_alike_have_one_digest():
    image, oracle = np.full((8, 8, 4), 0.25, np.float32), np.full((8, 8, 4), 0.5)
    nearly, other, unseen = image + np.float32(1e-6), image.copy(), image.copy()
    other[2, 3, 3], unseen[2, 3, 0] = 0.9, np.nan
    digests = [OnScreen.of(each, oracle).digest for each in (image, nearly, other, unseen)]
    assert digests[0] == digests[1] and len(set(digests)) == 3


def test_a_pixel_is_seen_as_far_as_the_filters_reach_and_no_further():
    found = flip_map(*pair((60, 60), [(30, 30)])) > 0
    ys, xs = np.nonzero(found)
    assert (ys.min(), ys.max(), xs.min(), xs.max()) == (30 - REACH, 30 + REACH, 30 - REACH, 30 + REACH)


def test_images_that_a_screen_shows_alike_are_equal():
    image = np.full((8, 8, 4), 0.25)
    assert OnScreen.of(image + 1e-4, image).equal
    assert not OnScreen.of(image + 1 / 255, image).equal
    assert not OnScreen.of(np.where(np.arange(8)[:, None, None] == 3, 1.1, image), np.clip(image * 2, 0, 1)).equal
    assert np.array_equal(displayed(np.full((1, 1, 4), np.nan), 0.0), np.zeros((1, 1, 3)))


FLIPPED = """
import os
import subprocess
import sys

import numpy as np
from mfr_bench.oracle.flip import flip_map
flip_map(np.zeros((9, 6, 3), np.uint8), np.full((9, 6, 3), 255, np.uint8))
"""


@pytest.mark.parametrize("given", [{}, {"OMP_WAIT_POLICY": "active"}], ids=["by default", "spinning"])
def test_its_threads_wait_asleep_unless_the_user_says_otherwise(given):
    """The library that runs them tells how often they spin when it is loaded."""
    inherited = {name: value for name, value in os.environ.items() if name != "OMP_WAIT_POLICY"}
    told = subprocess.run([sys.executable, "-c", FLIPPED], env={**inherited, **given, "OMP_DISPLAY_ENV": "verbose"},
                          capture_output=True, text=True, check=True).stderr
    assert ("GOMP_SPINCOUNT = '0'" in told) == (not given), told
