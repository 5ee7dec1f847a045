"""The config `device-features` measures every variant that needs more of a device than llvmpipe has."""

import csv
from collections import defaultdict
from pathlib import Path

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


def test_zink_over_lavapipe_measures_nearly_all_of_them_and_none_is_wrong():
    place = Path(__file__).parents[2] / "results" / "zink-llvmpipe-amd-epyc-2-cores" / "device-features"
    statuses = defaultdict(set)
    with (place / "results.csv").open(newline="") as rows:
        for row in csv.DictReader(rows):
            if row["method"] != "floor":
                statuses[row["label"]].add(row["status"])
    assert set().union(*statuses.values()) <= {"ok", "unsupported"}
    measured = [label for label, found in statuses.items() if found == {"ok"}]
    assert len(measured) >= 0.95 * len(statuses) > 70
