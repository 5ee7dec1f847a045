"""FLIP of parts: the blocks around what differs give to the bit what the whole images give."""

from __future__ import annotations

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
