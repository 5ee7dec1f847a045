"""The config `device-features` measures every variant that needs more of a device than llvmpipe has."""

from mfr_bench.config import load
from mfr_bench.methods import catalog

from .cases import every_method, variants

OF_LLVMPIPE = {"points_16", "samples_4"}  # of Mesa 22.3.6, as `mfr-bench doctor` lists them


def chosen(method, params):
    return method.id, tuple(sorted(method.complete(params).items()))


def test_every_variant_that_llvmpipe_lacks_the_features_of_is_measured():
    experiment, = load("device-features", catalog())
    measured = {chosen(catalog()[entry.id], entry.params) for entry in experiment.methods}
    lacking = {chosen(method, variant.params) for method in every_method() for variant in variants(method)
               if set(variant.needs) - OF_LLVMPIPE}
    assert len(lacking) > 70
    assert measured >= lacking
    assert len(measured) == len(experiment.methods)
