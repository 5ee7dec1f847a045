"""The verdict on a cell where fragments of one depth leave its image open."""

import numpy as np
import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.gpu.single import shown
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted, SceneStats
from mfr_bench.run.outcome import verdict
from mfr_bench.scene import generate
from mfr_bench.store.status import EXACT_ERROR

TIED = SceneConfig(size=(9, 6), depth_complexity=6, alpha=(0.1, 0.6), depth_copies=2, copies="different", seed=4)
LOSING = {"peel-f2b", "peel-dual", "peel-bucket", "kb-mdt32"}
EXACT = [m for m in catalog().values() if m.guarantee.startswith("exact")]


@pytest.mark.parametrize("method", EXACT, ids=lambda m: m.id)
@pytest.mark.parametrize("k", [2, 3, 16])
def test_of_equal_depths_any_order_is_right_and_a_loss_is_wrong(device, method, k):
    """With k = 3 two fragments compete for the last place."""
    chosen = {name: value for name, value in {"k": k, "atomic64": "emulated"}.items() if method.param(name)}
    variant = method.variant(chosen)
    if not device.features.issuperset(variant.needs):
        pytest.skip("this device lacks what the method needs")
    with shown(device, generate(TIED)) as on:
        errors = on.errors(variant, on.render(variant))
        found, reason = verdict(Fitted(variant, on.stats), errors, lost=0)
    assert errors["tied_pixels"] == 54
    assert found == ("wrong" if method.id in LOSING else "ok"), reason
    assert found == "ok" or reason.endswith(" wrong pixels, 54 pixels tied")


@pytest.mark.parametrize(("tied", "stored", "status"), [(0, 0.4, "ok"), (1, 0.4, "ok"), (2, 0.499, "wrong"),
                                                        (2, 0.5, "ok"), (2, 0.6, "ok"), (2, None, "ok")])
def test_where_colours_are_open_the_stored_fragments_are_counted(tied, stored, status):
    """More than 1 tied pixel of 100."""
    stats = SceneStats(W=10, H=10, n=4, F=400, primitives=4, histogram=(0, 0, 0, 0, 100))
    found = {"max_abs_error": 0.0, "wrong_pixels": 0, "tied_pixels": tied, "hit_ratio": stored, "promised_ratio": 0.5}
    assert verdict(Fitted(catalog()["kplus-array"].variant({"k": 2}), stats), found, lost=0)[0] == status


@pytest.mark.parametrize(("error", "lost", "distinct", "status"), [
    (EXACT_ERROR, 0, 1, "ok"), (1.01 * EXACT_ERROR, 0, 1, "wrong"), (0.0, 1, 1, "wrong"), (0.0, 0, 2, "wrong")])
def test_the_least_that_is_wrong(error, lost, distinct, status):
    found = {"max_abs_error": error, "wrong_pixels": 0, "tied_pixels": 0}
    fitted = Fitted(catalog()["ab-array"].variant({}), SceneStats(W=1, H=1, n=2, F=2, primitives=2))
    assert verdict(fitted, found, lost, distinct)[0] == status


def test_a_scene_without_equal_depths_has_no_tied_pixel(device):
    variant = catalog()["ab-array"].variant({})
    with shown(device, generate(SceneConfig(size=(9, 6), depth_complexity=6, copies="different"))) as on:
        image = on.render(variant)
        assert on.errors(variant, image)["tied_pixels"] == 0
        assert np.isfinite(image).all()
