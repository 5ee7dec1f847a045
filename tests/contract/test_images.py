"""Every method against the oracle, on llvmpipe or any other device: a wrong shader fails by its method's name."""

import pytest

from mfr_bench.contract import images
from mfr_bench.contract.images import Held

from .cases import ALIKE, KS, SCENES, SLANTED, Drawn, every_method, label, options, runs_here, variants, with_k

METHODS = pytest.mark.parametrize("method", every_method(), ids=lambda m: m.id)
OPTIONS = pytest.mark.parametrize("variant", [v for m in every_method() for v in options(m)], ids=label)
EXACT = [m for m in every_method() if m.guarantee.startswith("exact")]


def skip_unless_it_runs(device, variant):
    if not runs_here(device, variant):
        pytest.skip(f"this device lacks {', '.join(f for f in variant.needs if f not in device.features)}")


@METHODS
def test_every_scene(device, method):
    """All layouts and orders, odd sizes, sparse, empty, one layer, rejected fragments."""
    variant = with_k(method.variant({}), 4)
    skip_unless_it_runs(device, variant)
    assert list(images.every_scene(device, method)) == []


@METHODS
def test_slanted_primitives(device, method):
    """Depths that no grid of the scene's holds, and primitives that cross: the device's own fragments, sorted."""
    found = [with_k(variant, 4) for variant in variants(method)]
    running = [variant for variant in found if runs_here(device, variant)]
    skip_unless_it_runs(device, (running or found)[0])
    assert list(images.slanted(device, variants(method))) == []


@pytest.mark.parametrize("variant", [v for m in every_method() for v in options(m) if v.params.get("occupancy")],
                         ids=label)
def test_early_z_on_slanted_primitives(device, variant):
    """The depths that are tested, marked and stored are the same."""
    skip_unless_it_runs(device, with_k(variant, 4))
    assert Held(device, with_k(variant, 4), {"crossing": SLANTED["crossing"]}).faults == []


@OPTIONS
def test_every_option(device, variant):
    skip_unless_it_runs(device, variant)
    assert list(images.option(device, variant)) == []


@pytest.mark.parametrize("method", EXACT, ids=lambda m: m.id)
def test_exact_at_128_layers(device, method):
    """The variant with emulated atomics where the device has no wide ones."""
    found = images.deep_variants(method)
    skip_unless_it_runs(device, images.running(device, found) or found[0])
    assert list(images.deep(device, method)) == []


@pytest.mark.parametrize("method", [m for m in EXACT if m.param("k")], ids=lambda m: m.id)
@pytest.mark.parametrize("k", KS)
def test_exact_for_every_k(device, method, k):
    """k = 1 gives the Z-buffer's image, k >= n the A-buffer's."""
    variant = method.variant({"k": k})
    skip_unless_it_runs(device, variant)
    assert list(images.every_k(device, method, k)) == []


@pytest.mark.parametrize("method", [m for m in every_method() if m.exact_where], ids=lambda m: m.id)
def test_approximate_methods_are_exact_where_they_say_so(device, method):
    """Few and many slots, and every option: each condition holds in some scene, and the image there."""
    assert list(images.exact_where_it_says(device, method, variants(method))) == []


@METHODS
def test_every_frame_gives_the_same_image(device, method, record_property):
    """Nothing of a frame may survive into the next; how often a method without that promise differs is recorded."""
    variant = with_k(method.variant({}), 4)
    skip_unless_it_runs(device, variant)
    drawn = images.fifty_frames(device, method)
    record_property("distinct_images", drawn.distinct_images)
    assert list(images.frames_are_alike(drawn, method)) == []


@METHODS
def test_what_is_held_is_counted(device, method):
    """A probing frame finds as many fragments as are promised, and leaves the image and the passes as they are."""
    variant = with_k(method.variant({}), 4)
    skip_unless_it_runs(device, variant)
    assert list(images.counts_what_it_holds(device, method)) == []
    probed = Drawn(device, variant, SCENES[ALIKE[0]], probing=True).probed
    assert ("stored_fragments" in probed) == (method.id not in ("floor", "zbuffer") and not method.mixes)
