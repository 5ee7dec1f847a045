"""The config `device-features` measures every variant that needs more of a device than llvmpipe has."""

from mfr_bench.config import load
from mfr_bench.methods import catalog

from .cases import every_method, variants

OF_LLVMPIPE = {"points_16", "samples_4"}  # of Mesa 22.3.6, as `mfr-bench doctor` lists them


def chosen(method, params):
    return method.id, tuple(sorted(method.complete(params).items()))


def line_of(variant):
    """The variant as a line of the config's `methods`."""
    other = {p.name: variant.params[p.name] for p in variant.method.params if variant.params[p.name] != p.default}
    told = ", ".join(f"{name} {value}" for name, value in other.items())
    keys = "".join(f", {name}: {value}" for name, value in other.items())
    return f'  - {{id: {variant.method.id}, label: "{variant.method.name}{told and f" ({told})"}"{keys}}}'


def test_every_variant_that_llvmpipe_lacks_the_features_of_is_measured():
    experiment, = load("device-features", catalog())
    measured = {chosen(catalog()[entry.id], entry.params) for entry in experiment.methods}
    lacking = [variant for method in every_method() for variant in variants(method) if set(variant.needs) - OF_LLVMPIPE]
    missing = [line_of(variant) for variant in lacking if chosen(variant.method, variant.params) not in measured]
    assert len(lacking) > 70
    assert not missing, "configs/device-features.yaml lacks:\n" + "\n".join(missing)
    assert len(measured) == len(experiment.methods), "a variant stands there twice"
