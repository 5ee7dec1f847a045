"""Each method treats equal depths as it says."""

import numpy as np
import pytest

from mfr_bench.methods import catalog

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


# The meaning of each phrase: the layers shown with room for all, and with room for two, the k-th place tied.
ALL_OF_THEM, TWO_OF_THEM = (FRONT, *TIED, BACK), (FRONT, TIED[0])
ORDERS = {"in order of arrival": (4, ALL_OF_THEM), "the first to arrive": (2, TWO_OF_THEM),
          "the first in the list": (2, (FRONT, TIED[1])), "the lesser payload stays": (2, (FRONT, TIED[1]))}
SAID = [(m.id, phrase) for m in IMAGES for phrase in ORDERS if phrase in m.ties and m.param("k")]


def test_every_phrase_is_somebodys():
    assert {phrase for _, phrase in SAID} == set(ORDERS)


@pytest.mark.parametrize(("method", "phrase"), [said for said in SAID if said != ("hybrid", "the first to arrive")])
def test_the_order_of_equal_depths_is_the_one_that_is_said(device, method, phrase):
    """A list begins with the last that came; of the tied payloads the second is the lesser."""
    if device.kind != "cpu" and "payload" not in phrase:
        pytest.skip("this device may shade fragments of a pixel at once")
    k, layers = ORDERS[phrase]
    with drawn(device, method, stack(DEPTHS, RGBA), k=k) as frame:
        assert_shows(frame, RGBA[list(layers)])


def test_the_furthest_of_a_core_is_the_first_to_arrive(device):
    """The tail is the other tied fragment and what lies behind."""
    if device.kind != "cpu":
        pytest.skip("this device may shade fragments of a pixel at once")
    core, tail = over(RGBA[list(TWO_OF_THEM)]), RGBA[[TIED[1], BACK]] / 255
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


def test_the_depth_test_keeps_the_last_submitted(device):
    assert catalog()["zbuffer"].ties == "the last submitted is kept"
    with drawn(device, "zbuffer", stack([0.5, 0.25, 0.25], RGBA[:3])) as frame:
        np.testing.assert_allclose(frame.image()[..., 3], RGBA[2, 3] / 255, rtol=0, atol=1e-6)
