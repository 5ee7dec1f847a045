"""The error of exact methods stays below its bound and below the figures that the project promises."""

import numpy as np
import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted
from mfr_bench.oracle.composite import composite
from mfr_bench.scene import generate

from .drawing import drawn

EXACT = [m.id for m in catalog().values() if m.guarantee.startswith("exact")]
# Without a local array for every fragment of a pixel, which llvmpipe compiles for minutes at this length.
ANY_DEPTH = [("peel-f2b", {}), ("peel-dual", {}), ("peel-bucket", {}), ("peel-kplus", {"k": 32}), ("lin-pre", {})]
AT_128 = generate(SceneConfig(size=(9, 5), depth_complexity=128, alpha=(0.02, 0.1), seed=21))
AT_33 = generate(SceneConfig(size=(9, 5), depth_complexity=33, alpha=(0.02, 0.1), seed=21))
# 1 minus a sum of opacities would stop short of zero here, and let every further layer through: an error of 5e-5.
AT_4096 = generate(SceneConfig(size=(2, 1), depth_complexity=4096, alpha=(0.03, 0.03), seed=22))


def error_of(device, method, scene, **params):
    """Largest channel error against the method's promise, and its bound."""
    with drawn(device, method, scene, **params) as frame:
        promise = Fitted(frame.variant, frame.stats).promise()
        error = np.abs(frame.image() - composite(scene, promise.layers, promise.criterion)).max()
        assert frame.lost_fragments() == 0
        return error, Fitted(frame.variant, frame.stats).error_bound()


@pytest.mark.parametrize("method", EXACT)
def test_128_layers(device, method):
    params = {"k": 128} if catalog()[method].param("k") and method != "peel-kplus" else {}
    if catalog()[method].param("atomic64") and catalog()[method].param("atomic64").acts is None:
        params["atomic64"] = "emulated"
    error, bound = error_of(device, method, AT_128, **params)
    assert error <= min(bound, 2e-6)


@pytest.mark.parametrize(("method", "params"), ANY_DEPTH, ids=[m for m, _ in ANY_DEPTH])
def test_4096_layers(device, method, params):
    error, bound = error_of(device, method, AT_4096, **params)
    assert error <= min(bound, 2e-5)


def test_what_is_approximate_has_no_bound():
    stats = None
    assert Fitted(catalog()["ab-array"].variant({"accumulate": "float16"}), stats).error_bound() is None
    assert Fitted(catalog()["kb"].variant({}), stats).error_bound() is None


@pytest.mark.parametrize(("accumulate", "least", "most"), [("float32", 0, 3e-7), ("compensated", 0, 1e-7),
                                                           ("float16", 1e-5, 2e-3), ("unorm8", 1e-3, 33 / 510)])
def test_what_a_colour_is_accumulated_in_shows(device, accumulate, least, most):
    for sort in ("hybrid", "lplus", "register"):
        with drawn(device, "ab-array", AT_33, accumulate=accumulate, sort=sort) as frame:
            error = np.abs(frame.image() - composite(AT_33)).max()
        assert least <= error <= most
