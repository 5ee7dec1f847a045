"""Every method against the oracle, on llvmpipe or any other device: a wrong shader fails by its method's name."""

import numpy as np
import pytest

from mfr_bench.quality import EXACT_ERROR

from .cases import DEEP, KS, SCENES, Drawn, every_method, label, runs_here, variants, with_k

VARIANTS = pytest.mark.parametrize("variant", [v for m in every_method() for v in variants(m)], ids=label)
METHODS = pytest.mark.parametrize("method", every_method(), ids=lambda m: m.id)
EXACT = [m for m in every_method() if m.guarantee.startswith("exact")]


def skip_unless_it_runs(device, variant):
    if not runs_here(device, variant):
        pytest.skip(f"this device lacks {', '.join(variant.needs)}")


@VARIANTS
def test_exact_on_every_scene(device, variant):
    """The oracle's image within 1e-4 and no fragment lost, on all layouts, orders and odd sizes."""
    skip_unless_it_runs(device, variant)
    if not variant.method.guarantee.startswith("exact"):
        pytest.skip("promises no exact image")
    for name, config in SCENES.items():
        drawn = Drawn(device, with_k(variant, 4), config)
        assert drawn.lost == 0, name
        assert drawn.error <= EXACT_ERROR, name


@pytest.mark.parametrize("method", EXACT, ids=lambda m: m.id)
def test_exact_at_128_layers(device, method):
    variant = with_k(method.variant({}), 16)
    skip_unless_it_runs(device, variant)
    for name, config in DEEP.items():
        drawn = Drawn(device, variant, config)
        assert drawn.lost == 0, name
        assert drawn.error <= EXACT_ERROR, name


@pytest.mark.parametrize("method", [m for m in EXACT if m.param("k")], ids=lambda m: m.id)
@pytest.mark.parametrize("k", KS)
def test_exact_for_every_k(device, method, k):
    """k = 1 gives the Z-buffer's image, k >= n the A-buffer's."""
    variant = method.variant({"k": k})
    skip_unless_it_runs(device, variant)
    drawn = Drawn(device, variant, SCENES["rejecting"])
    assert drawn.lost == 0
    assert drawn.error <= EXACT_ERROR


@VARIANTS
def test_allocates_what_it_declares(device, variant):
    skip_unless_it_runs(device, variant)
    for name in ("sparse", "empty"):
        drawn = Drawn(device, variant, SCENES[name])
        assert drawn.allocated == drawn.declared, name


@pytest.mark.parametrize("method", EXACT, ids=lambda m: m.id)
def test_every_frame_gives_the_same_image(device, method):
    """Nothing of a frame may survive into the next."""
    variant = with_k(method.variant({}), 4)
    skip_unless_it_runs(device, variant)
    once, often = (Drawn(device, variant, SCENES["tiles"], frames) for frames in (1, 3))
    np.testing.assert_array_equal(once.image, often.image)
    assert often.lost == 0
