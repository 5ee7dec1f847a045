"""Every method against the oracle, on llvmpipe or any other device: a wrong shader fails by its method's name."""

import numpy as np
import pytest

from mfr_bench.config.model import Measure
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted
from mfr_bench.plan import Cell, judge
from mfr_bench.store.status import EXACT_ERROR

from .cases import (
    ALIKE,
    DEEP,
    KS,
    SCENES,
    SLANTED,
    Drawn,
    every_method,
    label,
    options,
    runs_here,
    stats_in,
    variants,
    with_k,
)

METHODS = pytest.mark.parametrize("method", every_method(), ids=lambda m: m.id)
OPTIONS = pytest.mark.parametrize("variant", [v for m in every_method() for v in options(m)], ids=label)
EXACT = [m for m in every_method() if m.guarantee.startswith("exact")]


def skip_unless_it_runs(device, variant):
    if not runs_here(device, variant):
        pytest.skip(f"this device lacks {', '.join(f for f in variant.needs if f not in device.features)}")


def refused(variant, config, stats):
    """Whether a pixel has more fragments than the method has room for, which a run says before it draws anything."""
    deepest = variant.method.deepest
    if not deepest or stats.n <= deepest:
        return False
    cell = Cell("test", variant.method.id, variant.method.id, variant.params, config, Measure(), {})
    assert judge(cell, catalog(), stats, None) == (
        "over_budget", f"a pixel has {stats.n} fragments, the method has room for {deepest}")
    return True


def check(device, variant, scenes):
    """The oracle's image within 1e-4 where the variant promises it, no fragment lost, the memory declared.

    Returns the scenes where it does promise it.
    """
    promised = []
    for name, config in scenes.items():
        if not all(getattr(stats_in(device, config), fact) for fact in variant.asks):
            continue
        if refused(variant, config, stats_in(device, config)):
            continue
        drawn = Drawn(device, variant, config)
        assert drawn.allocated == drawn.declared or (variant.stores_fewer and drawn.fits), name
        assert np.isfinite(drawn.image).all(), name
        if Fitted(variant, stats_in(device, config)).exact():
            promised.append(name)
            assert drawn.lost == 0, name
            assert drawn.error <= EXACT_ERROR, name
    return promised


@METHODS
def test_every_scene(device, method):
    """All layouts and orders, odd sizes, sparse, empty, one layer, rejected fragments."""
    variant = with_k(method.variant({}), 4)
    skip_unless_it_runs(device, variant)
    check(device, variant, SCENES)


@METHODS
def test_slanted_primitives(device, method):
    """Depths that no grid of the scene's holds, and primitives that cross: the device's own fragments, sorted."""
    found = [with_k(variant, 4) for variant in variants(method)]
    running = [variant for variant in found if runs_here(device, variant)]
    skip_unless_it_runs(device, (running or found)[0])
    check(device, running[0], SLANTED)


@pytest.mark.parametrize("variant", [v for m in every_method() for v in options(m) if v.params.get("occupancy")],
                         ids=label)
def test_early_z_on_slanted_primitives(device, variant):
    """The depths that are tested, marked and stored are the same."""
    skip_unless_it_runs(device, with_k(variant, 4))
    check(device, with_k(variant, 4), {"crossing": SLANTED["crossing"]})


@OPTIONS
def test_every_option(device, variant):
    skip_unless_it_runs(device, variant)
    check(device, with_k(variant, 4), {name: SCENES[name] for name in ALIKE})


@pytest.mark.parametrize("method", EXACT, ids=lambda m: m.id)
def test_exact_at_128_layers(device, method):
    """The variant with emulated atomics where the device has no wide ones."""
    choices = [{}, {"atomic64": "emulated"}] if method.param("atomic64") else [{}]
    found = [with_k(method.variant(chosen), 16) for chosen in choices]
    running = [variant for variant in found if runs_here(device, variant)]
    skip_unless_it_runs(device, (running or found)[0])
    assert check(device, running[0], DEEP)


@pytest.mark.parametrize("method", [m for m in EXACT if m.param("k")], ids=lambda m: m.id)
@pytest.mark.parametrize("k", KS)
def test_exact_for_every_k(device, method, k):
    """k = 1 gives the Z-buffer's image, k >= n the A-buffer's."""
    variant = method.variant({"k": k})
    skip_unless_it_runs(device, variant)
    check(device, variant, {"rejecting": SCENES["rejecting"]})


@pytest.mark.parametrize("method", [m for m in every_method() if m.exact_where], ids=lambda m: m.id)
def test_approximate_methods_are_exact_where_they_say_so(device, method):
    """Few and many slots, and every option: each condition holds in some scene, and the image there."""
    chosen = [with_k(variant, k) for variant in [method.variant({}), *options(method)] for k in (4, 16)]
    exact = [name for variant in chosen if runs_here(device, variant)
             for name in check(device, variant, {n: SCENES[n] for n in ("flat", "opaque", "rejecting")})]
    assert exact


@METHODS
def test_every_frame_gives_the_same_image(device, method, record_property):
    """Nothing of a frame may survive into the next; how often a method without that promise differs is recorded."""
    variant = with_k(method.variant({}), 4)
    skip_unless_it_runs(device, variant)
    drawn = Drawn(device, variant, SCENES["scattered"], frames=50)
    record_property("distinct_images", drawn.distinct_images)
    if variant.guarantee.startswith("exact"):
        assert drawn.distinct_images == 1
        assert drawn.lost == 0


@METHODS
def test_what_is_held_is_counted(device, method):
    """A probing frame finds as many fragments as are promised, and leaves the image and the passes as they are."""
    variant = with_k(method.variant({}), 4)
    skip_unless_it_runs(device, variant)
    for name in ALIKE:
        drawn = Drawn(device, variant, SCENES[name], probing=True)
        assert drawn.probed.get("stored_fragments", drawn.kept) == drawn.kept, name
        assert ("stored_fragments" in drawn.probed) == (method.id not in ("floor", "zbuffer") and not method.mixes)
        assert drawn.passes_probing == drawn.passes
        assert np.array_equal(drawn.image_probing, drawn.image)
