"""Image errors on planted differences."""

import math

import numpy as np
import pytest

from mfr_bench.oracle import quality as measured
from mfr_bench.oracle.quality import WRONG_PIXEL, quality
from mfr_bench.oracle.ties import Answer
from mfr_bench.store.status import EXACT_ERROR

ORACLE = np.random.default_rng(1).random((24, 32, 4))
UNTIED = {"tied_pixels": 0, "tied_error": 0, "order_error": 0}


def conformance(image, oracle):
    """The errors against one image that alone is right."""
    return measured.conformance(image, Answer.only(oracle))


def planted(*places, by):
    """The oracle's image with an error `by` at (row, column, channel)."""
    image = ORACLE.astype(np.float32).astype(np.float64)
    for place in places:
        image[place] = ORACLE[place] + by
    return image


def test_the_same_image_has_no_error():
    image = ORACLE.astype(np.float32)
    assert conformance(image, image.astype(np.float64)) == {"max_abs_error": 0, "wrong_pixels": 0} | UNTIED
    assert quality(image, image.astype(np.float64)) == {
        "rmse": 0, "psnr_db": math.inf, "flip": 0, "max_error_all": 0, "wrong_pixels_all": 0}


def test_rounding_to_float32_is_no_error():
    assert conformance(ORACLE.astype(np.float32), ORACLE)["max_abs_error"] < EXACT_ERROR / 1000


@pytest.mark.parametrize("channel", range(4))
def test_an_error_of_any_one_channel_counts(channel):
    found = conformance(planted((3, 5, channel), (7, 9, channel), by=-0.25), ORACLE)
    assert found["max_abs_error"] == pytest.approx(0.25)
    assert found["wrong_pixels"] == 2


def test_a_pixel_with_two_wrong_channels_is_one_wrong_pixel():
    assert conformance(planted((3, 5, 0), (3, 5, 2), by=0.5), ORACLE)["wrong_pixels"] == 1


@pytest.mark.parametrize(("error", "wrong"), [(0.99 * WRONG_PIXEL, 0), (1.01 * WRONG_PIXEL, 1)])
def test_a_wrong_pixel_is_off_by_more_than_half_a_step_of_8_bits(error, wrong):
    assert conformance(planted((0, 0, 1), by=error), ORACLE)["wrong_pixels"] == wrong


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_value_that_is_no_number_is_an_error_of_1(value):
    image = ORACLE.copy()
    image[2, 3, 1] = value
    assert conformance(image, ORACLE) == {"max_abs_error": 1, "wrong_pixels": 1} | UNTIED
    found = quality(image, ORACLE)
    assert found["rmse"] == pytest.approx(math.sqrt(1 / ORACLE.size))
    assert all(map(math.isfinite, found.values()))


def test_an_image_of_nothing_but_nan_is_measured():
    image = np.full_like(ORACLE, math.nan)
    assert conformance(image, ORACLE)["wrong_pixels"] == 24 * 32
    assert quality(image, ORACLE)["psnr_db"] == 0


def test_rmse_and_psnr_are_over_all_channels():
    found = quality(ORACLE + 0.01, ORACLE)
    assert found["rmse"] == pytest.approx(0.01)
    assert found["psnr_db"] == pytest.approx(40)


def test_flip_is_of_the_colours_and_grows_with_the_difference():
    flips = [quality(np.clip(ORACLE + error, 0, 1), ORACLE)["flip"] for error in (0, 0.05, 0.4)]
    assert flips[0] == 0
    assert 0 < flips[1] < flips[2] <= 1


GREY = np.dstack([np.full((48, 48, 3), 128 / 255), np.ones((48, 48))])


def test_flip_sees_alpha():
    """Over black an image whose alpha alone is wrong by 1 everywhere looks right; over white it does not."""
    clear, solid = np.zeros((48, 48, 4)), np.zeros((48, 48, 4))
    solid[..., 3] = 1
    assert quality(clear, solid)["flip"] == quality(solid, clear)["flip"] > 0.9


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 3.0, -0.01])
@pytest.mark.parametrize("channel", range(4))
def test_a_pixel_that_no_screen_shows_is_an_error_of_1_in_flip(value, channel):
    image = GREY.copy()
    image[5, 7, channel] = value
    assert quality(np.full_like(GREY, value), np.zeros_like(GREY))["flip"] == 1
    assert quality(np.full_like(GREY, value), np.ones_like(GREY))["flip"] == 1
    assert 1 / (48 * 48) <= quality(image, GREY)["flip"] < 0.05


def test_flip_is_of_displayed_images_and_far_from_proportional():
    """No error is what 8 bits do not show; the least that they show, 1/255, is 0.03 and half of the range 0.84."""
    def by(difference):
        image = GREY.copy()
        image[..., :3] += difference
        return quality(image, GREY)["flip"]
    assert by(1e-6) == by(1 / 600) == 0
    assert [by(steps / 255) for steps in (1, 10, 100)] == pytest.approx([0.0307, 0.152, 0.715], rel=0.05)


def test_images_of_different_sizes_are_refused():
    with pytest.raises(ValueError, match=r"image \(24, 31, 4\) against oracle \(24, 32, 4\)"):
        conformance(ORACLE[:, 1:], ORACLE)


def test_what_is_compared_is_left_alone():
    image, oracle = ORACLE.astype(np.float32), ORACLE.copy()
    image[0, 0, 0] = math.nan
    quality(image, oracle)
    assert math.isnan(image[0, 0, 0])
    np.testing.assert_array_equal(oracle, ORACLE)


def test_tied_pixels_are_held_against_every_order():
    """A channel of an open pixel may lie anywhere between its ends; the error is the way to the nearer."""
    low, high = ORACLE.copy(), ORACLE.copy()
    low[3, 5, 0] -= 0.25
    high[1, 1, 3] += 0.5
    promised = Answer(ORACLE, low, high)

    def found(*places, by):
        return measured.conformance(planted(*places, by=by), promised)

    none, some = pytest.approx(0, abs=1e-7), pytest.approx(0.125)
    assert found((3, 5, 0), by=-0.125) == {
        "max_abs_error": none, "wrong_pixels": 0, "tied_pixels": 2, "tied_error": none, "order_error": some}
    assert found((3, 5, 0), by=0.125) == {
        "max_abs_error": some, "wrong_pixels": 1, "tied_pixels": 2, "tied_error": some, "order_error": some}
    assert found((3, 5, 0), by=-0.375)["tied_error"] == pytest.approx(0.125)
    assert found((1, 1, 0), by=0.1)["tied_error"] == pytest.approx(0.1)
    beside = found((2, 2, 1), by=0.5)
    assert (beside["max_abs_error"], beside["wrong_pixels"]) == (pytest.approx(0.5), 1)
    assert beside["tied_error"] < 1e-7


def test_against_all_fragments_tied_pixels_may_have_every_order_but_lose_none():
    """rmse and FLIP were against the order of submission, so that an order of its own counted as an error there."""
    high, lowest = ORACLE.copy(), ORACLE.copy()
    high[3, 5, 0] += 0.25
    lowest[3, 5, 0] -= 0.5
    full = Answer(ORACLE, ORACLE.copy(), high, Answer(ORACLE, lowest, high))

    def found(by):
        return quality(planted((3, 5, 0), by=by), full.image, orders=full)

    other = found(0.25)
    assert (other["max_error_all"], other["wrong_pixels_all"]) == (pytest.approx(0, abs=1e-7), 0)
    assert (other["rmse"], other["flip"]) == (pytest.approx(0, abs=1e-7), 0)
    assert other["psnr_db"] > 100
    lost = found(-0.5)
    assert lost["rmse"] == pytest.approx(0.5 / math.sqrt(ORACLE.size), rel=1e-3) and lost["flip"] > 0
    assert (lost["max_error_all"], lost["wrong_pixels_all"]) == (pytest.approx(0.5), 1)
    beyond = found(0.375)
    assert (beyond["max_error_all"], beyond["wrong_pixels_all"]) == (pytest.approx(0.125), 1)
    assert beyond["rmse"] == pytest.approx(0.125 / math.sqrt(ORACLE.size), rel=1e-3)


@pytest.mark.parametrize(("tied", "error"), [(7, 0), (8, 0.5)])
def test_what_is_lost_by_chance_is_forgiven_to_a_method_that_loses_equal_depths(tied, error):
    """Up to a hundredth of the 768 pixels; the error of tied pixels says it all the same."""
    high, lowest = ORACLE.copy(), ORACLE.copy()
    high[0, :tied, 0] += 0.25
    lowest[0, :tied, 3] -= 0.5
    promised = Answer(ORACLE, ORACLE.copy(), high, Answer(ORACLE, lowest, high))
    image = planted((0, 0, 3), by=-0.5)
    found = measured.conformance(image, promised, promised.losing)
    assert (found["max_abs_error"], found["tied_error"]) == (pytest.approx(error, abs=1e-7), pytest.approx(0.5))
    assert measured.conformance(image, promised)["max_abs_error"] == pytest.approx(0.5)
    beyond = measured.conformance(planted((0, 0, 3), by=-0.75), promised, promised.losing)
    assert beyond["max_abs_error"] == pytest.approx(0.25 if tied == 7 else 0.75)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_value_that_is_no_number_is_an_error_of_1_in_a_tied_pixel_too(value):
    image, high = ORACLE.copy(), ORACLE.copy()
    image[3, 5, 0], high[3, 5, 0] = value, 2
    assert measured.conformance(image, Answer(ORACLE, ORACLE.copy(), high))["tied_error"] == 1
