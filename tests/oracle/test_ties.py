"""The range of right images against every order of equal depths, one by one."""

from itertools import combinations, groupby, permutations, product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mfr_bench.methods import catalog
from mfr_bench.oracle.composite import Fragments, composite
from mfr_bench.oracle.listed import listed
from mfr_bench.oracle.quality import conformance, pixel_errors
from mfr_bench.oracle.ties import ALPHA, answer_of_fragments, answer_of_quads
from mfr_bench.scene.quads import Quads

CLOSE = 1e-12
GREY, RED, BLUE, FAINT = (90, 90, 90, 128), (200, 10, 10, 128), (10, 10, 200, 128), (10, 200, 10, 30)


def quads(*pixels):
    """One pixel for each list of (depth, colour), side by side, each list in order of submission."""
    rect = [(x, 0, x + 1, 1) for x, fragments in enumerate(pixels) for _ in fragments]
    depths = [depth for fragments in pixels for depth, _ in fragments]
    colours = [colour for fragments in pixels for _, colour in fragments]
    return Quads((max(1, len(pixels)), 1), np.array(rect, dtype=np.int32).reshape(-1, 4),
                 np.array(depths, dtype=np.float32), np.array(colours, dtype=np.uint8).reshape(-1, 4), 1.0, 1)


def over(colours):
    colour, transmittance = np.zeros(3), 1.0
    for rgba in colours:
        *rgb, alpha = np.array(rgba) / 255
        colour, transmittance = colour + transmittance * alpha * np.array(rgb), transmittance * (1 - alpha)
    return np.append(colour, 1 - transmittance)


def orders(fragments):
    """Every order of the fragments, nearest first."""
    runs = [list(run) for _, run in groupby(sorted(fragments, key=lambda f: f[0]), key=lambda f: f[0])]
    return [[colour for run in chosen for _, colour in run] for chosen in product(*map(permutations, runs))]


def taken(order, layers, criterion):
    if criterion == "furthest":
        return order[-layers:]
    if criterion == "opaque":
        best = sorted(range(len(order)), key=lambda i: -order[i][ALPHA])[:layers]
        return [order[i] for i in sorted(best)]
    return order[:layers]


def every_image(fragments, layers, criterion):
    return np.array([over(taken(order, layers or len(order), criterion)) for order in orders(fragments)])


def compete(fragments, layers, criterion):
    """Whether fragments of one depth and different looks compete for the last places; True for `opaque`, untold."""
    if criterion == "opaque":
        return True
    ordered = sorted((depth for depth, _ in fragments), reverse=criterion == "furthest")
    last = ordered[layers - 1]
    return ordered[layers] == last and len({colour for depth, colour in fragments if depth == last}) > 1


COLOURS = st.tuples(*[st.sampled_from([0, 10, 200])] * 3, st.sampled_from([0, 30, 128, 255]))
PIXELS = st.lists(st.lists(st.tuples(st.sampled_from([0.25, 0.5, 0.75]), COLOURS), max_size=5), min_size=1, max_size=3)


@given(PIXELS, st.none() | st.integers(1, 4), st.sampled_from(["nearest", "furthest", "opaque"]))
def test_the_range_is_that_of_every_order(pixels, layers, criterion):
    """Of opacity always; of colours where no fragments compete for the last places, else it holds every order."""
    found = answer_of_quads(quads(*pixels), layers, criterion)
    for x, fragments in enumerate(pixels):
        images = every_image(fragments, layers, criterion)
        low, high = images.min(axis=0), images.max(axis=0)
        assert (found.low[0, x] <= low + CLOSE).all()
        assert (found.high[0, x] >= high - CLOSE).all()
        assert (found.low[0, x, ALPHA], found.high[0, x, ALPHA]) == pytest.approx((low[ALPHA], high[ALPHA]), abs=CLOSE)
        if layers is None or layers >= len(fragments) or not compete(fragments, layers, criterion):
            np.testing.assert_allclose(found.low[0, x], low, rtol=0, atol=CLOSE)
            np.testing.assert_allclose(found.high[0, x], high, rtol=0, atol=CLOSE)
    np.testing.assert_array_equal(found.image, composite(quads(*pixels), layers, criterion))


def with_losses(fragments):
    """Every list of fragments in which each depth keeps one or more of its own."""
    runs = [list(run) for _, run in groupby(sorted(fragments, key=lambda f: f[0]), key=lambda f: f[0])]
    kept = [[chosen for count in range(1, len(run) + 1) for chosen in combinations(run, count)] for run in runs]
    return [[fragment for run in chosen for fragment in run] for chosen in product(*kept)]


@given(PIXELS, st.none() | st.integers(1, 4), st.sampled_from(["nearest", "furthest"]))
def test_the_range_of_a_method_that_loses_equal_depths_is_that_of_every_choice_of_them(pixels, layers, criterion):
    found = answer_of_fragments(listed(quads(*pixels)), layers, criterion)
    found = found.losing or found
    for x, fragments in enumerate(pixels):
        images = np.concatenate([every_image(kept, layers, criterion) for kept in with_losses(fragments)])
        assert (found.low[0, x] <= images.min(axis=0) + CLOSE).all()
        assert (found.high[0, x] >= images.max(axis=0) - CLOSE).all()
        if layers is None or layers >= len(fragments):
            np.testing.assert_allclose(found.low[0, x], images.min(axis=0), rtol=0, atol=CLOSE)
            np.testing.assert_allclose(found.high[0, x], images.max(axis=0), rtol=0, atol=CLOSE)


def test_a_pixel_that_lost_every_fragment_of_a_depth_is_in_no_range():
    answer = answer_of_quads(quads([(0.25, GREY), (0.5, RED), (0.5, BLUE), (0.75, FAINT)]))
    lost, kept = (over([GREY, *of, FAINT]).reshape(1, 1, 4) for of in ((), (RED,)))
    assert pixel_errors(kept, answer.losing).max() < CLOSE < 0.1 < pixel_errors(kept, answer).max()
    assert pixel_errors(lost, answer.losing).max() > 0.1


@pytest.mark.parametrize(("pixels", "blamed"), [(200, False), (20, True)])
def test_who_loses_one_of_two_like_fragments_is_blamed_where_that_is_no_chance(pixels, blamed):
    """Like fragments tie nothing, for who keeps both; one pixel in 200 has them, or one in 20."""
    scene = quads([(0.5, GREY), (0.5, GREY)], *[[(0.5, RED)]] * (pixels - 1))
    promised = answer_of_fragments(listed(scene))
    image = promised.image.copy()
    image[0, 0] = over([GREY])
    assert not promised.tied.any()
    assert (conformance(image, promised, promised.losing)["max_abs_error"] > 0.1) == blamed
    assert conformance(image, promised)["max_abs_error"] > 0.1


@given(PIXELS, st.none() | st.integers(1, 4), st.sampled_from(["nearest", "furthest", "opaque"]))
def test_fragments_of_a_device_have_the_range_of_flat_quads(pixels, layers, criterion):
    scene = quads(*pixels)
    counts = np.array([[len(fragments) for fragments in pixels]])
    fragments = Fragments.of(scene, counts, scene.depth.view(np.uint32).copy(),
                             np.arange(len(scene), dtype=np.uint32))
    found, flat = answer_of_fragments(fragments, layers, criterion), answer_of_quads(scene, layers, criterion)
    for name in ("image", "low", "high"):
        np.testing.assert_allclose(getattr(found, name), getattr(flat, name), rtol=0, atol=CLOSE)


def tied(*fragments, layers=None):
    return answer_of_quads(quads(fragments), layers).tied.tolist() == [[True]]


def test_a_pixel_is_tied_by_different_colours_of_one_depth():
    assert tied((0.5, RED), (0.5, BLUE))
    assert tied((0.25, GREY), (0.5, RED), (0.5, BLUE), (0.75, GREY))
    assert not tied((0.5, RED), (0.5, RED))
    assert not tied((0.5, RED), (0.25, BLUE))
    assert not tied()
    assert tied((0.0, RED), (-0.0, BLUE))


def test_what_nobody_sees_ties_nothing():
    assert not tied((0.5, (9, 9, 9, 0)), (0.5, RED))
    assert not tied((0.25, (9, 9, 9, 255)), (0.5, RED), (0.5, BLUE))
    assert not tied((0.25, GREY), (0.5, RED), (0.5, BLUE), layers=1)
    assert tied((0.25, GREY), (0.5, RED), (0.5, BLUE), layers=2)


@pytest.mark.parametrize("layers", [None, 2, 3])
def test_an_image_that_lacks_a_tied_fragment_is_outside(layers):
    """So is one that shows one of them twice: no order gives either."""
    fragments = [(0.25, GREY), (0.5, RED), (0.5, BLUE), (0.75, FAINT)]
    kept = [colour for _, colour in fragments[:layers]]
    found = answer_of_quads(quads(fragments), layers)
    for lost in combinations(kept, len(kept) - 1):
        image = over(lost)
        assert ((image < found.low[0, 0] - 0.01) | (image > found.high[0, 0] + 0.01)).any()
    if layers != 2:
        image = over([GREY, RED, RED, FAINT][:layers])
        assert ((image < found.low[0, 0] - 0.01) | (image > found.high[0, 0] + 0.01)).any()


def test_patches_and_rejected_fragments_are_told_apart():
    rect = np.array([(0, 0, 4, 4), (2, 0, 6, 4), (0, 0, 6, 2)], dtype=np.int32)
    depth = np.array([0.5, 0.5, 0.25], dtype=np.float32)
    whole = Quads((6, 4), rect, depth, np.array([RED, BLUE, GREY], dtype=np.uint8), 1.0, 3)
    assert answer_of_quads(whole).tied.tolist() == [[False] * 2 + [True] * 2 + [False] * 2] * 4
    some = Quads((6, 4), rect, depth, whole.rgba, 0.5, 3)
    both = np.zeros((4, 6), dtype=bool)
    both[:, 2:4] = some.kept(0, 2, 0, 4, 4) & some.kept(1, 2, 0, 4, 4)
    np.testing.assert_array_equal(answer_of_quads(some).tied, both)
    assert both.any()


def test_one_depth_in_different_places_ties_nothing():
    rect = np.array([(0, 0, 3, 4), (3, 0, 6, 4)], dtype=np.int32)
    scene = Quads((6, 4), rect, np.array([0.5, 0.5], dtype=np.float32), np.array([RED, BLUE], dtype=np.uint8), 1.0, 3)
    found = answer_of_quads(scene)
    assert found.unique
    np.testing.assert_array_equal(found.image, composite(scene))


def test_two_channels_are_ranges_of_the_colours_that_come_back():
    payload = np.array([[0.5, 1.5, 0.25, 0.5], [0.25, 0.25, 0.25, 0.5]])
    found = answer_of_quads(quads([(0.5, RED), (0.5, BLUE)]), payload=payload)
    np.testing.assert_allclose(found.high[0, 0, 1], 0.75 + 0.25 * 0.25)
    np.testing.assert_allclose(found.low[0, 0, 1], 0.125 + 0.5 * 0.75)


@pytest.mark.parametrize("method", catalog().values(), ids=lambda m: m.id)
def test_a_method_that_spoils_equal_depths_alone_leaves_their_pixels_open(method):
    answer = answer_of_quads(quads([(0.25, RED), (0.25, BLUE)], [(0.25, RED)]))
    given = answer.given_by(method)
    assert (given is answer) == (not method.loses_ties)
    assert (given.high > 1).any(axis=-1).tolist() == [[method.spoils_ties, False]]


def test_the_faintest_fragments_of_one_depth_are_tied():
    answer = answer_of_quads(quads([(0.5, (200, 10, 10, 1)), (0.5, (10, 10, 200, 1))], [(0.5, RED)]))
    assert answer.tied.tolist() == [[True, False]]
