"""Each method treats equal depths as it says."""

from collections.abc import Sequence
from itertools import permutations

import numpy as np
import pytest

from mfr_bench.methods import catalog
from mfr_bench.methods.shared import TIES_OF_INSERTION
from mfr_bench.scene.quads import Quads

from .drawing import assert_shows, drawn, over, stack

RGBA = np.array([(200, 10, 30, 120), (10, 200, 30, 90), (90, 90, 250, 60), (20, 10, 30, 200)])
DEPTHS = [0.5, 0.25, 0.5, 0.75]
FRONT, TIED, BACK = 1, (0, 2), 3
IMAGES = [m for m in catalog().values() if m.guarantee != "none" and m.id != "zbuffer"]


def alpha_of(kept):
    return 1 - np.prod(1 - RGBA[list(kept), 3] / 255)


@pytest.mark.parametrize("method", IMAGES, ids=lambda m: m.id)
def test_equal_depths_become_what_the_method_says(device, method):
    """All of them count, or one alone, in the opacity, which knows no order."""
    exact = method.guarantee.startswith("exact")
    if device.kind != "cpu" and not exact:
        pytest.skip("this device may shade fragments of a pixel at once")
    params = {"k": 4} if method.param("k") else {}
    if method.param("atomic64"):
        params["atomic64"] = "emulated"
    with drawn(device, method.id, stack(DEPTHS, RGBA), **params) as frame:
        alpha = frame.image()[..., 3]
    assert np.ptp(alpha) == 0
    every = alpha_of(range(len(RGBA)))
    single = [alpha_of((FRONT, tied, BACK)) for tied in TIED]
    told = method.ties.split(",")[0].split(";")[0].split(":")[0]
    assert method.loses_ties == (told != "kept")
    expected = {"kept": [every], "one of them is kept": single, "collide": single,
                "the maximum of each channel is kept": single}[told]
    assert min(abs(alpha[0, 0] - e) for e in expected) < (1e-5 if exact else 0.01)


def arrived(arrival):
    return FRONT, *(i for i in arrival if i in TIED), BACK


def inserted(arrival):
    tied = [i for i in arrival if i in TIED]
    return FRONT, *(tied if FRONT in arrival[:arrival.index(tied[1])] else reversed(tied)), BACK


def lesser_first(_arrival):
    return FRONT, TIED[1], TIED[0], BACK


def larger_first(_arrival):
    return FRONT, *TIED, BACK


# The meaning of each phrase: the layers shown, nearest first, by the order of arrival; each k of which it tells. With
# room for two the k-th place is tied.
ORDERS = {"kept, in order of arrival; the first to arrive has the k-th place": (arrived, (2, 4)),
          TIES_OF_INSERTION: (inserted, (4,)), "the last of them loses the k-th place": (inserted, (2,)),
          "in order of payload, the k-th place included": (lesser_first, (2, 4)),
          "the lesser payload stays": (lesser_first, (2,)),
          "the nearer stays, then the lesser payload": (lesser_first, (2,)),
          "kept, the larger payload as a number first": (larger_first, (4,))}
SAID = [(m.id, phrase, k) for m in IMAGES for phrase, (_, ks) in ORDERS.items() if phrase in m.ties
        for k in ks if k == 4 or (m.param("k") and not m.mixes)]


def test_every_phrase_is_somebodys():
    assert {phrase for _, phrase, _ in SAID} == set(ORDERS)


def every_arrival(depths: Sequence[float] = DEPTHS) -> tuple[list[tuple[int, ...]], Quads]:
    """The orders in which the four may arrive, and a row of pixels, one for each."""
    arrivals = list(permutations(range(4)))
    rect = [[x, 0, x + 1, 1] for x in range(len(arrivals)) for _ in range(4)]
    order = np.ravel(arrivals)
    return arrivals, Quads((len(arrivals), 1), np.array(rect, dtype=np.int32),
                           np.array(depths, dtype=np.float32)[order], RGBA[order].astype(np.uint8), 1.0, 0)


@pytest.mark.parametrize(("method", "phrase", "k"), SAID)
def test_the_order_of_equal_depths_is_the_one_that_is_said(device, method, phrase, k):
    """The second of the tied payloads is the lesser."""
    if device.kind != "cpu" and "payload" not in phrase:
        pytest.skip("this device may shade fragments of a pixel at once")
    params = {name: value for name, value in (("k", k), ("atomic64", "emulated")) if catalog()[method].param(name)}
    arrivals, scene = every_arrival()
    expected = [over(RGBA[list(ORDERS[phrase][0](arrival)[:k])]) for arrival in arrivals]
    with drawn(device, method, scene, **params) as frame:
        assert frame.lost_fragments() == 0
        np.testing.assert_allclose(frame.image()[0], expected, rtol=0, atol=1e-5)


def test_a_list_that_is_sorted_by_compare_and_swap_keeps_the_order_of_arrival(device):
    if device.kind != "cpu":
        pytest.skip("this device may shade fragments of a pixel at once")
    arrivals, scene = every_arrival()
    with drawn(device, "lin-pre", scene, insert="cas32") as frame:
        expected = [over(RGBA[list(arrived(arrival))]) for arrival in arrivals]
        np.testing.assert_allclose(frame.image()[0], expected, rtol=0, atol=1e-5)


def test_the_furthest_of_a_core_is_the_first_to_arrive(device):
    """The tail is the other tied fragment and what lies behind."""
    if device.kind != "cpu":
        pytest.skip("this device may shade fragments of a pixel at once")
    core, tail = over(RGBA[[FRONT, TIED[0]]]), RGBA[[TIED[1], BACK]] / 255
    colour = (tail[:, :3] * tail[:, 3:]).sum(axis=0) / tail[:, 3].sum()
    opacity = 1 - (1 - tail[:, 3].mean()) ** 2
    expected = core + (1 - core[3]) * np.append(opacity * colour, opacity)
    with drawn(device, "hybrid", stack(DEPTHS, RGBA), k=2) as frame:
        np.testing.assert_allclose(frame.image()[0, 0], expected, rtol=0, atol=1e-5)


def test_dual_peeling_shows_the_maximum_of_each_channel(device):
    """The maximum is that of the premultiplied colours, or of what they are behind the layers in front of them."""
    straight = RGBA / 255
    premultiplied = np.concatenate([straight[:, :3] * straight[:, 3:], straight[:, 3:]], axis=1)
    expected = premultiplied[FRONT]
    for layer in (premultiplied[list(TIED)].max(axis=0), premultiplied[BACK]):
        expected = expected + (1 - expected[3]) * layer
    with drawn(device, "peel-dual", stack(DEPTHS, RGBA)) as frame:
        np.testing.assert_allclose(frame.image()[0, 0], expected, rtol=0, atol=1e-5)


def test_steps_of_equal_depth_do_not_hide_each_other(device):
    """Adaptive transparency: both are seen through the front alone, the back through all three."""
    straight = RGBA / 255
    through = 1 - straight[:, 3]
    seen = {FRONT: 1.0, **dict.fromkeys(TIED, through[FRONT]), BACK: through[:3].prod()}
    expected = sum(seen[i] * straight[i, 3] * straight[i, :3] for i in seen)
    with drawn(device, "aoit", stack(DEPTHS, RGBA), k=4) as frame:
        np.testing.assert_allclose(frame.image()[0, 0, :3], expected, rtol=0, atol=1e-5)


@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize("structure", ["array", "heap"])
def test_of_equally_opaque_fragments_the_nearer_then_the_lesser_payload_stays(device, structure, order):
    colours = [(9, 200, 30, 90), (200, 10, 30, 90), (90, 9, 30, 90), (20, 10, 30, 90)]
    depths = [0.75, 0.5, 0.25, 0.5]
    scene = stack(depths[::order], colours[::order])
    with drawn(device, "kplus-generic", scene, k=2, criterion="opaque", structure=structure) as frame:
        assert_shows(frame, [colours[2], colours[3]])  # red counts least in the word: 20 is less than 200


@pytest.mark.parametrize("method", [m for m in IMAGES if m.guarantee.startswith("exact")], ids=lambda m: m.id)
def test_depths_that_differ_by_their_last_bit_are_not_equal(device, method):
    """In every order of arrival; where a method keeps so many, the two nearest; where it mends an order, with least."""
    _, scene = every_arrival(0.75 + np.arange(4) * 2.0**-24)
    params = {name: value for name, value in (("k", 2), ("window", 1), ("atomic64", "emulated")) if method.param(name)}
    with drawn(device, method.id, scene, **params) as frame:
        assert frame.lost_fragments() == 0
        expected = over(RGBA[:frame.fitted.promise().layers])
        np.testing.assert_allclose(frame.image()[0], [expected] * scene.viewport[0], rtol=0, atol=1e-5)


@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize("structure", ["array", "heap"])
def test_of_equally_far_fragments_the_lesser_payload_stays(device, structure, order):
    scene = stack(DEPTHS[::order], RGBA[::order])
    with drawn(device, "kplus-generic", scene, k=2, criterion="furthest", structure=structure) as frame:
        assert_shows(frame, RGBA[[TIED[1], BACK]])


def test_the_depth_test_keeps_the_last_submitted(device):
    assert catalog()["zbuffer"].ties == "the last submitted is kept"
    with drawn(device, "zbuffer", stack([0.5, 0.25, 0.25], RGBA[:3])) as frame:
        np.testing.assert_allclose(frame.image()[..., 3], RGBA[2, 3] / 255, rtol=0, atol=1e-6)
