"""What a declaration has to say, and what its shaders have to look like; no GL."""

import re

import pytest

from mfr_bench.config import Scene
from mfr_bench.glsl import read, stages
from mfr_bench.gpu.scene_buffer import LAYOUTS
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted, SceneStats, evaluate
from mfr_bench.plan import expected_stats
from mfr_bench.report.reference import find
from mfr_bench.resources import shaders_dir

from .cases import every_method, label, variants, with_k
from .preprocess import active

SIZES = expected_stats(Scene(size=(64, 48), depth_complexity=12, pixel_density=0.5))
ENTRY_SUFFIXES = (".vert", ".frag", ".comp")
MOST_LINES = 150

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
    assert re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", method.id)


@METHODS
def test_says_what_a_reader_needs(method):
    assert all([method.name, method.family, method.source, method.summary, method.ties])
    assert method.guarantee in ("exact all", "exact k nearest", "exact k best", "approximate", "none")
    assert (method.failure is not None) == (method.guarantee == "approximate")
    assert not method.exact_where or method.guarantee == "approximate"
    assert all(p.doc for p in method.params)


@METHODS
def test_every_stage_of_every_variant_expands(method):
    for variant in variants(method):
        for step in variant.passes:
            for stage in stages(Fitted(variant, SIZES), step) if step.kind != "clear" else ():
                assert "#include" not in stage.text, label(variant)
                assert (shaders_dir() / stage.entry).is_file()


@METHODS
def test_passes_name_only_declared_resources(method):
    brought = [resource for step in method.passes for resource in (*step.buffers, *step.targets)]
    names = {resource.name for resource in (*method.buffers, *method.targets, *brought)} | {"image"}
    for step in method.passes:
        used = {ref.partition(".")[0] for ref in (*step.reads, *step.writes, *step.into, *step.clears)}
        assert used <= names, f"pass {step.name}"


@METHODS
def test_every_buffer_and_target_says_what_it_contains(method):
    for variant in variants(method):
        for resource in (*variant.buffers, *variant.targets):
            assert resource.doc, resource.name
            assert "\n" not in resource.doc


@METHODS
def test_a_shader_shows_what_its_buffers_contain(method):
    fitted = Fitted(method.variant({}), SIZES)
    docs = {b.name: b.doc for b in fitted.variant.buffers}
    for step in (s for s in fitted.variant.passes if s.kind != "clear"):
        text = stages(fitted, step)[-1].text
        for name in {ref.partition(".")[0] for ref in (*step.reads, *step.writes)} & set(docs):
            said = rf"buffer Block\d+ .* {name}(_\w+)?\[\]; }};  // {re.escape(docs[name])}$"
            assert re.search(said, text, re.MULTILINE), f"pass {step.name}: {name}"


@METHODS
def test_atomics_touch_only_what_the_pass_declares_to_write(method):
    """Mesa lets an atomic through on a readonly buffer, and a barrier would then be missing."""
    for variant in variants(method):
        for step in variant.passes:
            text = "".join(active(s.text) for s in stages(Fitted(variant, SIZES), step)) if step.kind != "clear" else ""
            written = {ref.partition(".")[0] for ref in step.writes}
            assert set(re.findall(r"\batomic[A-Z]\w*\(\s*(\w+)\s*\[", text)) <= written, f"pass {step.name}"


@METHODS
def test_memory_formulas_have_values(method):
    for variant in variants(method):
        assert all(size > 0 for size in Fitted(variant, SIZES).memory_bytes().values())
        assert Fitted(variant, SIZES).model_bytes() >= 0


def test_memory_grows_with_what_the_formula_names():
    words = [evaluate("3*f + 1", SceneStats(W=4, H=4, n=2, F=fragments, primitives=2), {}) for fragments in (0, 16, 32)]
    assert words == [1, 4, 7]


@FILES
def test_shader_opens_with_its_contract_and_stays_short(path):
    lines = read(path).splitlines()
    assert lines[0].startswith("// ")
    assert len(lines) <= MOST_LINES


@FILES
def test_entry_points_have_one_main_and_includes_none(path):
    assert len(re.findall(r"^void main\(\)", read(path), re.MULTILINE)) == path.endswith(ENTRY_SUFFIXES)


def test_every_shader_is_used():
    used = {"screen/triangle.vert", "scene/opaque.vert", "scene/opaque.frag"} | {f"scene/{n}.vert" for n in LAYOUTS}
    for method in every_method():
        weakened = [method.variant({p.name: 0.5}) for p in method.params if p.real and p.weakens]
        for variant in (*variants(method), *weakened):
            for step in variant.passes:
                for stage in stages(Fitted(variant, SIZES), step) if step.kind != "clear" else ():
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
    """Whatever k is, and for every option but those whose words the page of all methods states once."""
    shared = {"occupancy", "bma", "touched"}
    shares = [p for p in method.params if p.name in shared]
    plain = [v for v in variants(method) if all(v.params[p.name] == p.default for p in shares)]
    differs = [label(v) for v in plain for k in (7, 8)
               if sum(Fitted(with_k(v, k), SIZES).memory_bytes().values()) != Fitted(with_k(v, k), SIZES).model_bytes()]
    assert bool(method.beside) or not differs


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
