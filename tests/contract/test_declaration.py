"""Declarations say what they have to, and shaders look as they have to; no GL."""

from dataclasses import replace
from itertools import product

import pytest

from mfr_bench.contract import declaration
from mfr_bench.contract.declaration import SIZES
from mfr_bench.contract.preprocess import active
from mfr_bench.effects import EFFECTS, Settings
from mfr_bench.glsl import stages
from mfr_bench.gpu.scene_buffer import LAYOUTS
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted, SceneStats, evaluate
from mfr_bench.report.reference import find
from mfr_bench.resources import shaders_dir

from .cases import every_method, variants

METHODS = pytest.mark.parametrize("method", every_method(), ids=lambda m: m.id)
FILES = pytest.mark.parametrize("path", sorted(str(p.relative_to(shaders_dir())) for p in shaders_dir().rglob("*.*")))


OF_THE_PAPERS = {
    "floor", "zbuffer", "peel-f2b", "peel-dual", "peel-bucket", "peel-srab", "peel-kplus",
    "ab-array", "ab-ll", "ab-ll-paged", "ab-ll-bucket", "ab-sb", "ab-lbuffer", "ab-precalc", "ab-precalc-fixed",
    "ab-dfb", "lin-post", "lin-pre", "open-post", "open-pre",
    "kb", "kb-multi", "kb-sr", "kb-ps", "kb-mdt32", "kb-mdt64", "kb-mha", "kb-ab-array", "kb-ab-ll", "kb-ab-sb",
    "kb-ll", "kplus-array", "kplus-array-r", "kplus-heap", "kplus-sb", "kplus-sb-dynamic", "kplus-generic",
}


def test_all_37_methods_of_the_papers_are_found():
    assert len(OF_THE_PAPERS) == 37
    assert set(catalog()) >= OF_THE_PAPERS


@METHODS
def test_name_round_trips(method):
    assert catalog()[method.id] is method


@METHODS
def test_says_what_a_reader_needs(method):
    assert list(declaration.what_a_reader_needs(method)) == []


@METHODS
def test_every_stage_of_every_variant_expands(method):
    assert list(declaration.stages_expand(variants(method))) == []


@METHODS
def test_passes_name_only_declared_resources(method):
    assert list(declaration.resources_declared(method)) == []


@METHODS
def test_every_buffer_and_target_says_what_it_contains(method):
    assert list(declaration.resources_explained(variants(method))) == []


@METHODS
def test_a_shader_shows_what_its_buffers_contain(method):
    assert list(declaration.shaders_show_contents(method)) == []


@METHODS
def test_atomics_touch_only_what_the_pass_declares_to_write(method):
    assert list(declaration.atomics_declared(variants(method))) == []


@METHODS
def test_memory_formulas_have_values(method):
    assert list(declaration.memory_has_values(variants(method))) == []


def test_memory_grows_with_what_the_formula_names():
    words = [evaluate("3*f + 1", SceneStats(W=4, H=4, n=2, F=fragments, primitives=2), {}) for fragments in (0, 16, 32)]
    assert words == [1, 4, 7]


@FILES
def test_shader_is_short_opens_with_its_contract_and_has_one_main_or_none(path):
    assert list(declaration.shader_is_short(path)) == []


def test_every_shader_is_used():
    used = {"screen/triangle.vert", "scene/opaque.vert", "scene/opaque.frag"} | {f"scene/{n}.vert" for n in LAYOUTS}
    for method in every_method():
        weakened = [method.variant({p.name: 0.5}) for p in method.params if p.real and p.weakens]
        for variant in (*variants(method), *weakened):
            for step in variant.passes:
                for stage in stages(Fitted(variant, SIZES), step) if step.kind != "clear" else ():
                    used |= set(stage.files)
    special = [replace(SIZES, shading=1), *(replace(SIZES, effect=Settings(name)) for name in EFFECTS),
               replace(SIZES, effect=Settings(msaa=4))]
    for variant, sizes in product((catalog()["ab-array"].variant({}), catalog()["floor"].variant({})), special):
        for step in variant.passes:
            for stage in stages(Fitted(variant, sizes), step) if step.kind != "clear" else ():
                used |= set(stage.files)
    files = {str(p.relative_to(shaders_dir())) for p in shaders_dir().rglob("*.*")}
    assert {f for f in files - used if not f.startswith("probe/")} == set()


TABLE_1 = [row for row in find(paper="kplus2015", quantity="words_per_pixel") if row.condition is None]


def test_words_are_those_of_table_1():
    """kplus_2015, Table 1, every row; rows with attribute packing are of payloads that no method here has."""
    assert len(TABLE_1) == 14
    assert {row.method: catalog()[row.method].words for row in TABLE_1} == {row.method: row.formula for row in TABLE_1}


@METHODS
def test_every_difference_from_the_words_is_explained(method):
    assert list(declaration.words_explained(method, variants(method))) == []


def test_shared_options_take_the_words_that_the_page_states():
    array = catalog()["kb-ab-array"]
    plain = sum(Fitted(array.variant({}), SIZES).memory_bytes().values())
    for intervals in (32, 64, 128):
        occupied = sum(Fitted(array.variant({"occupancy": intervals}), SIZES).memory_bytes().values())
        assert occupied - plain == 4 * SIZES.P * (3 + intervals // 32)
    assert sum(Fitted(array.variant({"bma": "on"}), SIZES).memory_bytes().values()) - plain == 4 * SIZES.P
    tiles = -(-SIZES.W // 16) * -(-SIZES.H // 16)
    assert sum(Fitted(array.variant({"touched": "tiles"}), SIZES).memory_bytes().values()) - plain == 4 * (tiles + 8)
    assert sum(Fitted(array.variant({"touched": "bounds"}), SIZES).memory_bytes().values()) == plain


def test_atomics_are_found_in_code_that_a_compiler_would_refuse_or_alone_can_choose():
    found = active("#define C counter\n#if SQUARE(2) % 2\natomicAdd(C[0], 1u);\n#endif\n#endif // one too many")
    assert "atomicAdd(counter[0], 1u);" in found
