"""What each method says of equal depths is what it does."""

import numpy as np
import pytest

from mfr_bench.methods import catalog

from .drawing import drawn, stack

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
    expected = {"kept": [every], "one of them is kept": single, "collide": single,
                "the maximum of each channel is kept": single}[told]
    assert min(abs(alpha[0, 0] - e) for e in expected) < (1e-5 if exact else 0.01)


def test_the_depth_test_keeps_the_last_submitted(device):
    assert catalog()["zbuffer"].ties == "the last submitted is kept"
    with drawn(device, "zbuffer", stack([0.5, 0.25, 0.25], RGBA[:3])) as frame:
        np.testing.assert_allclose(frame.image()[..., 3], RGBA[2, 3] / 255, rtol=0, atol=1e-6)
