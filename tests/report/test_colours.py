"""The colours of methods, families and passes: each its own, the same everywhere, told apart by anyone."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from mfr_bench.methods import catalog
from mfr_bench.report import style


def test_every_method_has_a_colour_of_its_own_by_family_and_place():
    """No method is named: a new one takes the next shade of its family, and a foreign one a colour from its id."""
    colours = style.method_colours()
    assert set(colours) == set(catalog()) and len(set(colours.values())) == len(colours)
    assert style.method_colour("brand-new") == style.method_colour("brand-new") != style.method_colour("other-new")


def test_families_share_no_colour_and_a_new_one_changes_none():
    colours = style.family_colours(families())
    assert len(set(colours.values())) == len(colours) == len(families())
    more = style.family_colours([*families(), "brand-new"])
    assert {family: more[family] for family in colours} == colours


def test_more_families_than_colours_repeat_them():
    many = [f"family {i}" for i in range(3 * len(style.FAMILY_COLOURS))]
    assert list(style.family_colours(many)) and set(style.family_colours(many)) == set(many)


def families():
    return dict.fromkeys(method.family for method in catalog().values())


def test_methods_of_one_figure_can_be_told_apart():
    """The k-buffers of Figs. 6 and 8 and the A-buffers of Fig. 9 of kplus_2015, with normal sight and without red or
    green cones (Machado et al. 2009), in CIE Lab."""
    for together in (("kplus-array", "kplus-heap", "kplus-sb", "kb-ps", "kb-mdt32", "kb-ab-array", "kb-ab-sb", "kb-ll"),
                     ("peel-f2b", "peel-dual", "ab-array", "ab-ll", "ab-sb", "kplus-array", "kplus-sb"),
                     ("lin-post", "lin-pre", "open-post", "open-pre")):
        for sight in (None, PROTAN, DEUTAN):
            seen = {m: lab(style.method_colour(m), sight) for m in together}
            closest = min((np.linalg.norm(seen[a] - seen[b]), a, b) for a, b in combinations(seen, 2))
            assert closest[0] > (12 if sight is None else 6), (sight is not None, closest)


PROTAN = np.array([[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]])
DEUTAN = np.array([[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]])


def lab(colour, sight):
    srgb = np.array([int(colour[i:i + 2], 16) for i in (1, 3, 5)]) / 255
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    linear = linear if sight is None else np.clip(sight @ linear, 0, 1)
    xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]) @ linear
    f = np.cbrt(np.maximum(xyz / (0.9505, 1.0, 1.089), 1e-6))
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def test_variants_of_a_pass_are_lighter_and_unknown_passes_have_a_colour():
    colours = style.pass_colours(["sweep", "store depth", "store", "clear"])
    assert list(colours) == ["clear", "store", "store depth", "sweep"]
    assert len(set(colours.values())) == 4
