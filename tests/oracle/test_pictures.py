"""Pictures in two channels: what comes back, what is lost, and the materials that are made here."""

import hashlib
import json

import numpy as np
import pytest
from PIL import Image

from mfr_bench.oracle import twochannel
from mfr_bench.oracle.pictures import Encoded
from mfr_bench.scene.materials import picture, texels

from ..cli.conftest import here, mfr  # noqa: F401 - fixtures


def of_plane(shape=(40, 30)):
    """A picture whose light is a blend of two colours: all of it lies in one plane through black."""
    rng = np.random.default_rng(3)
    blend, bright = rng.random((2, *shape, 1))
    light = bright * ((1 - blend) * np.array([0.0, 0.8, 1.0]) + blend * np.array([1.0, 0.45, 0.0]))
    return np.rint(255 * np.sqrt(light)).astype(np.uint8)


def test_a_picture_of_one_plane_comes_back_within_what_8_bits_round():
    encoded = Encoded.of(of_plane())
    record = encoded.record()
    assert record["luminance_error_max"] < 0.01 and record["hue_error_degrees"] < 1.0
    assert record["psnr_db"] > 45 and record["flip"] < 0.05
    assert record["bytes_before"] == 3 * 1200 and record["bytes_after"] == 2 * 1200 + 24


def test_a_picture_of_all_hues_keeps_its_luminance_and_loses_hues():
    rng = np.random.default_rng(4)
    record = Encoded.of(rng.integers(0, 256, (40, 30, 3), dtype=np.uint8)).record()
    assert record["luminance_error_mean"] < 0.03
    assert record["hue_error_degrees"] > 5 and record["psnr_db"] < 25


def test_a_grey_picture_is_only_luminance():
    grey = np.repeat(np.arange(256, dtype=np.uint8).reshape(16, 16, 1), 3, axis=-1)
    assert np.abs(Encoded.of(grey).decoded.astype(int) - grey).max() <= 3


def test_what_comes_back_is_what_the_payload_of_fragments_decodes_to():
    colours = of_plane().reshape(-1, 3)
    straight = twochannel.straight(np.hstack([colours, np.full((len(colours), 1), 255, np.uint8)]))[:, :3]
    shown = np.rint(255 * np.clip(straight, 0, 1)).astype(np.uint8)
    np.testing.assert_array_equal(Encoded.of(of_plane()).decoded.reshape(-1, 3), shown)


@pytest.mark.parametrize(("name", "digest"), [("grass", "52026ef9"), ("rock", "a9535be6"), ("sand", "47fa4fb2")])
def test_a_material_is_the_same_everywhere_and_of_few_hues(name, digest):
    made = picture(name, (96, 64))
    assert made.shape == (64, 96, 3)
    assert hashlib.sha256(made.tobytes()).hexdigest()[:8] == digest
    assert Encoded.of(made).record()["hue_error_degrees"] < 1.5
    assert texels(name, np.arange(5, dtype=np.uint64), 1).shape == (5, 3)


def test_the_command_tells_and_writes_what_it_does(mfr, here):  # noqa: F811
    Image.fromarray(of_plane()).save(here / "p.png")
    ended = mfr("twochannel", "p.png", "grass", "--out", "two", "--json")
    found = json.loads(ended.out)
    assert ended.status == 0 and list(found) == ["p.png", "grass"]
    assert found["p.png"]["psnr_db"] == pytest.approx(Encoded.of(of_plane()).record()["psnr_db"])
    with Image.open(here / "two" / "p-twochannel.png") as image:
        assert image.size == (2 * 30 + 8, 40)
    assert "PSNR" in mfr("twochannel", "rock").out


@pytest.mark.parametrize(("name", "line"), [
    ("nope.png", "nope.png: no such file; allowed: a picture, or one of grass, rock, sand"),
    ("text.png", "text.png: no picture that can be read (")])
def test_what_is_no_picture_is_one_line(mfr, here, name, line):  # noqa: F811
    (here / "text.png").write_text("no picture")
    ended = mfr("twochannel", name)
    assert ended.status == 2 and ended.complaint.startswith(line)


def test_a_picture_that_loses_nothing_is_json_of_the_standard(mfr, here):  # noqa: F811
    Image.fromarray(np.zeros((1, 1, 3), np.uint8)).save(here / "black.png")
    found = json.loads(mfr("twochannel", "black.png", "--json").out, parse_constant=pytest.fail)
    assert found["black.png"]["psnr_db"] == "inf"


def test_two_pictures_are_never_written_to_one_file(mfr, here):  # noqa: F811
    (here / "sub").mkdir()
    for path in (here / "p.png", here / "sub" / "p.png"):
        Image.fromarray(of_plane()).save(path)
    ended = mfr("twochannel", "p.png", "sub/p.png", "--out", "two")
    assert ended.status == 2 and not (here / "two").exists()
    assert ended.complaint.startswith("--out: p.png and sub/p.png would both be written to p-twochannel.png; allowed: ")
    assert mfr("twochannel", "p.png", "p.png", "--out", "two").status == 0


@pytest.mark.parametrize("error", [SyntaxError("broken PNG file"), ValueError("too large"), IndexError("out of range")])
def test_whatever_a_decoder_raises_is_one_line(mfr, here, monkeypatch, error):  # noqa: F811
    def raising(*_):
        raise error

    Image.fromarray(of_plane()).save(here / "p.png")
    monkeypatch.setattr(Image.Image, "convert", raising)
    ended = mfr("twochannel", "p.png")
    assert ended.status == 2 and ended.complaint.startswith("p.png: no picture that can be read (")
