"""The study of rounding agrees with what it is a study of, and says what the docs say."""

from pathlib import Path

import numpy as np
import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted, SceneStats
from mfr_bench.oracle import rounding
from mfr_bench.oracle.composite import composite
from mfr_bench.scene import generate

ROOT = Path(__file__).parents[2]
SCENE = generate(SceneConfig(size=(1, 1), depth_complexity=300, alpha=(0.004, 0.1), seed=4))
NEAREST_FIRST = SCENE.rgba[SCENE.depth_order][:, None, :]


def test_the_reference_is_the_oracle():
    np.testing.assert_allclose(rounding.exact(NEAREST_FIRST)[0], composite(SCENE)[0, 0], rtol=0, atol=1e-15)


@pytest.mark.parametrize("way", rounding.WAYS)
def test_every_way_approaches_the_reference(way):
    error = np.abs(rounding.WAYS[way](rounding.payloads(NEAREST_FIRST)) - rounding.exact(NEAREST_FIRST)).max()
    assert error < {"float16": 2e-2, "8 bits": 0.5}.get(way.split(", ")[1], 1e-5)


@pytest.mark.parametrize("alpha", [(1, 1), (8, 8), (1, 30), (26, 153), (255, 255)])
@pytest.mark.parametrize("layers", [1, 128, 4096])
def test_transmittance_keeps_its_bound_and_the_promise(layers, alpha):
    error = rounding.errors(layers, alpha, pixels=16)["by transmittance, float32"]
    stats = SceneStats(W=1, H=1, n=layers, F=layers, primitives=layers)
    bound = Fitted(catalog()["ab-array"].variant({}), stats).error_bound()
    assert error <= min(bound, 2e-6 if layers <= 128 else 2e-5)


def test_a_sum_of_opacities_leaks():
    """Exact methods store transmittance: 1 - alpha stops at the last bit of 1, and every layer shows by it."""
    found = rounding.errors(4096, (8, 8), pixels=16)
    assert found["under, float32"] > 20 * found["by transmittance, float32"]


def test_the_page_holds_the_table():
    assert rounding.as_markdown() in (ROOT / "docs" / "accuracy.md").read_text()
