"""Two-channel colour: the plane, its base colours, what comes back of a colour, and that a device decodes the same."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.gpu.single import shown
from mfr_bench.methods import catalog
from mfr_bench.oracle import twochannel
from mfr_bench.oracle.twochannel import LUMINANCE, Encoding, errors, light
from mfr_bench.scene import colours, generate
from mfr_bench.store.status import EXACT_ERROR

RED, GREEN, BLUE, YELLOW = [255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 0]
colour = st.tuples(*[st.integers(0, 255)] * 3)
colour_sets = st.lists(colour, min_size=1, max_size=30).map(lambda rgb: np.array(rgb, dtype=np.uint8))
STORING = [m for m in catalog().values() if m.param("payload") and "two_channel" in m.param("payload").choices]


def rgba(config: str, count: int = 400) -> np.ndarray:
    made = SceneConfig(size=(4, 4), depth_complexity=1, colours=config)
    return colours.rgba(made, np.arange(count, dtype=np.uint64), 3)


def rounded(linear: np.ndarray) -> np.ndarray:
    return np.rint(255 * np.sqrt(linear)).astype(np.uint8)


@given(colour_sets)
def test_base_colours_are_on_the_silhouette_and_in_the_plane_of_least_squares(rgb):
    """No other plane through black, of a thousand, lies nearer to the weighted colours (§2.2.1)."""
    encoding = Encoding.fit(rgb)
    for base in (encoding.a, encoding.b):
        assert base.max() == 1
        assert base.min() == 0
    weighted = light(rgb) * twochannel.IMPORTANCE
    normal = np.cross(encoding.a, encoding.b) / twochannel.IMPORTANCE
    if np.linalg.norm(normal) > 1e-6:
        best = np.square(weighted @ (normal / np.linalg.norm(normal))).sum()
        others = np.random.default_rng(1).normal(size=(1000, 3))
        others /= np.linalg.norm(others, axis=1, keepdims=True)
        assert best <= np.square(weighted @ others.T).sum(axis=0).min() + 1e-6


@pytest.mark.parametrize(("rgb", "bases"), [
    ([RED, GREEN], [[1, 0, 0], [0, 1, 0]]), ([GREEN, BLUE], [[0, 1, 0], [0, 0, 1]]),
    ([YELLOW, BLUE], [[1, 1, 0], [0, 0, 1]])])
def test_base_colours_by_hand(rgb, bases):
    encoding = Encoding.fit(np.array(rgb, dtype=np.uint8))
    assert sorted([encoding.a.round(9).tolist(), encoding.b.round(9).tolist()]) == sorted(bases)


@pytest.mark.parametrize("rgb", [[[0, 0, 0]], [RED], [BLUE], [[255, 255, 255]], [[7, 7, 7], [0, 0, 0]], []])
def test_sets_of_one_hue_or_none_have_a_plane_too(rgb):
    """The one hue comes back, but for rounding."""
    made = np.array(rgb, dtype=np.uint8).reshape(-1, 3)
    encoding = Encoding.fit(made)
    back = encoding.decode(encoding.encode(made))
    assert np.isfinite(back).all()
    np.testing.assert_allclose(back, made / 255, rtol=0, atol=2.5 / 255)


@given(colour_sets)
def test_luminance_is_kept_to_rounding(rgb):
    """Half a step of its square root, whatever the hue, also where the decoded colour is above 1."""
    encoding = Encoding.fit(rgb)
    back = np.square(encoding.decode(encoding.encode(rgb))) @ LUMINANCE
    assert np.abs(np.sqrt(back) - np.sqrt(light(rgb) @ LUMINANCE)).max() <= 0.5 / 255 + 1e-9


@given(st.floats(0, 1), st.floats(0.05, 1), st.integers(0, 2**32 - 1))
def test_colours_of_the_plane_come_back_to_rounding(blend, bright, seed):
    rng = np.random.default_rng(seed)
    blends, lights = rng.random(50), rng.random(50) ** 2
    blends[0], lights[0] = blend, bright
    mixed = colours.TEAL * (1 - blends[:, None]) + colours.ORANGE * blends[:, None]
    rgb = rounded(mixed * lights[:, None])
    encoding = Encoding.fit(rgb)
    back = encoding.decode(encoding.encode(rgb))
    assert np.abs(np.square(back) - light(rgb)).max() <= 6 / 255
    assert np.abs(back - rgb / 255).mean() <= 2 / 255


def test_what_lies_outside_the_angle_gets_the_nearer_end():
    """The plane of red and green: blue has neither, cyan only green, magenta only red."""
    encoding = Encoding(np.array([1.0, 0, 0]), np.array([0, 1.0, 0]))
    rgb = np.array([RED, GREEN, [0, 255, 255], [255, 0, 255], BLUE, [128, 128, 0]], dtype=np.uint8)
    assert encoding.encode(rgb)[:, 1].tolist() == [0, 255, 255, 0, 0, 128]


def test_hue_errors_grow_with_the_variety_of_colours():
    """The chapter's finding (§2.4, §2.5): one plane holds the hues of few materials."""
    found = {name: errors(rgba(name)) for name in ("hues-1", "hues-2", "plane", "hues-6", "any")}
    assert max(found[name]["hue_error"] for name in ("hues-1", "hues-2", "plane")) < 0.5
    assert min(found[name]["hue_error"] for name in ("hues-6", "any")) > 10
    assert max(e["luminance_error"] for e in found.values()) < 1 / 255


def test_errors_by_hand():
    """In the plane of red and green a dark blue turns red or green, 90 degrees away; the mean of three is 30."""
    found = errors(np.array([[255, 0, 0, 9], [0, 255, 0, 9], [0, 0, 40, 9]], dtype=np.uint8))
    assert found["hue_error"] == pytest.approx(30, abs=0.1)
    assert errors(np.zeros((0, 4), dtype=np.uint8)) == {"luminance_error": 0, "hue_error": 0}


def test_a_word_holds_24_bits():
    encoding, stored = twochannel.words(rgba("any"))
    assert stored.dtype == np.uint8
    assert not stored[:, 2].any()
    np.testing.assert_array_equal(stored[:, :2], encoding.encode(rgba("any")[:, :3]))
    np.testing.assert_array_equal(stored[:, 3], rgba("any")[:, 3])


@pytest.mark.parametrize("name", ["any", "plane", "hues-3"])
def test_a_device_decodes_as_numpy_does(device, name):
    """Opaque tiles, one colour each: a pixel is what came back of its primitive's colour."""
    scene = generate(SceneConfig(size=(256, 192), depth_complexity=1, layout="tiles", alpha=(1, 1), colours=name))
    with shown(device, scene) as on:
        image = on.render(catalog()["ab-array"].variant({"payload": "two_channel"}))
    expected = twochannel.straight(scene.rgba)
    for (x0, y0, *_), colour_back in zip(scene.rect, expected, strict=True):
        np.testing.assert_allclose(image[y0, x0], colour_back, rtol=0, atol=1e-5)


@pytest.mark.parametrize("method", STORING, ids=lambda m: m.id)
def test_a_method_is_exact_in_the_colours_that_come_back(device, method):
    """The payload alone is approximate; the rest of the method keeps its promise."""
    variant = method.variant({"payload": "two_channel"} | ({"k": 4} if method.param("k") else {}))
    if not device.features.issuperset(variant.needs):
        pytest.skip(f"this device lacks {', '.join(set(variant.needs) - device.features)}")
    assert variant.guarantee == "approximate"
    for config in (SceneConfig(size=(40, 31), depth_complexity=9, colours="hues-5"),
                   SceneConfig(size=(40, 31), kind="hairball", depth_complexity=9, mean_depth=4)):
        with shown(device, generate(config)) as on:
            found = on.errors(variant, on.render(variant))
            plain = on.errors(variant, on.render(method.variant(variant.params | {"payload": "rgba8"})))
            if method.guarantee.startswith("exact"):
                assert found["max_abs_error"] <= EXACT_ERROR
                assert plain["max_abs_error"] > 0.01  # the colours do differ
