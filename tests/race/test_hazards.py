"""Hazards are counted by fragments, k and number in flight, and drawn; both say everywhere that they are simulated."""

import csv

import numpy as np
import pytest

from mfr_bench.methods import catalog
from mfr_bench.race import hazards, picture

SIDE = 12


@pytest.fixture
def few(monkeypatch):
    """A small table, and a small picture."""
    monkeypatch.setattr(hazards, "FRAGMENTS", (4,))
    monkeypatch.setattr(hazards, "KEPT", (2,))
    monkeypatch.setattr(picture, "SIDE", SIDE)
    monkeypatch.setattr(picture, "QUADS", 10)


def panels():
    """One that races, and one that does not."""
    return picture.panels([catalog()[name].variant({"k": picture.K}) for name in ("kb", "kplus-array")])


@pytest.mark.usefixtures("few")
def test_more_in_flight_is_more_wrong(tmp_path):
    found = list(hazards.hazards([catalog()["kb"]], 2000, 1))
    assert [h.in_flight for h in found] == [2, 4]
    assert 0 < found[0].share < found[1].share
    with open(hazards.write(found, tmp_path), newline="") as file:
        rows = list(csv.DictReader(file))
    assert "simulated" in hazards.TABLE and {row["simulated"] for row in rows} == {"true"}


def test_what_promises_its_image_has_no_hazards():
    assert hazards.promising_nothing(catalog()["kb-ll"], 2) is None
    assert hazards.promising_nothing(catalog()["kplus-array"], 2).params["sync"] == "none"


@pytest.mark.usefixtures("few")
def test_one_fragment_in_flight_is_always_right(monkeypatch):
    monkeypatch.setattr(picture, "IN_FLIGHT", 1)
    assert all(panel.wrong_share == 0 for panel in panels())


@pytest.mark.usefixtures("few")
def test_the_picture_shows_what_races_and_says_that_it_is_simulated(tmp_path):
    made = panels()
    assert [panel.wrong_share > 0.05 for panel in made] == [True, False]
    assert made[1].wrong_share == 0 and np.isfinite(made[0].image).all()
    paths = picture.write(made[:1], made[1:], tmp_path)
    assert {path.suffix for path in paths} == {".png", ".svg", ".csv"}
    assert all(path.name.startswith("simulated-") and path.stat().st_size for path in paths)
    texts = [text.get_text() for text in picture.figure(made[:1], made[1:]).texts]
    assert texts[0].startswith("Simulated") and texts[1].startswith("Simulated")
