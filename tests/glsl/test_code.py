"""The code of a shader, and what depends on it alone."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mfr_bench import glsl
from mfr_bench.config.model import Scene
from mfr_bench.glsl.code import code_of
from mfr_bench.glsl.digest import code_of_programs
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted
from mfr_bench.plan import expected_stats
from mfr_bench.run.jobs import glsl_hash

COUNT = "common/count.frag"


@pytest.mark.parametrize(("text", "code"), [
    ("// A pass.\nuint a;\n", "uint a;"),
    ("uint a; // its unit\n\n\nuint b;", "uint a;\nuint b;"),
    ("uint /* no\n  comment ends here */ a;", "uint   a;"),
    ("#line 100001\nuint a;\n  #line 7\n", "uint a;"),
    ("#define A(x) \\\n    x + \\\n    1\n", "#define A(x)  x +  1"),
    ("// a comment that goes on \\\nuint hidden;\nuint a;", "uint a;"),
    ("a = b / c; // d\n/* e */", "a = b / c;"),
    ("// only a comment", ""),
])
def test_code_is_text_without_comments(text, code):
    assert code_of(text) == code


@given(st.lists(st.sampled_from(["uint a;", "#define B 2", "x = y / z;", "if (a < b) {"]), max_size=8),
       st.lists(st.sampled_from(["// said", "/* said\n twice */", "", "   ", "#line 300001"]), min_size=8, max_size=8))
def test_whatever_comments_stand_between_lines_the_code_is_the_same(lines, between):
    mixed = "\n".join(piece for pair in zip(lines, between, strict=False) for piece in pair)
    assert code_of(mixed) == code_of("\n".join(lines))


@pytest.fixture
def hash_with(monkeypatch):
    """The hash of a method's shaders after a change to one of their files."""
    variant, real = catalog()["ab-precalc"].variant({}), glsl.includes.read

    def hashed(change=lambda text: text):
        monkeypatch.setattr(glsl.includes, "read", lambda path: change(real(path)) if path == COUNT else real(path))
        return glsl_hash(variant, "quad")
    return hashed


def test_a_comment_changes_no_key(hash_with):
    said = hash_with(lambda text: f"// K, N, CLEAR and IS_HELPER are named here.\n\n{text}\n// End.\n")
    assert said == hash_with()


def test_a_change_of_code_changes_the_key(hash_with):
    assert hash_with(lambda text: text.replace("1u", "2u")) != hash_with()


def test_programs_that_differ_in_comments_alone_are_one(device):
    first, second = (glsl.StageSource("screen/triangle.vert", f"#version 430 core\n// {word}\nvoid main() {{}}\n", ())
                     for word in ("one", "two"))
    drawn = glsl.StageSource("probe/rasterized.frag", "#version 430 core\nvoid main() {}\n", ())
    assert device.program((first, drawn), "test") is device.program((second, drawn), "test")


@pytest.mark.parametrize(("other", "shared"), [({"size": (48, 32)}, True), ({"depth_complexity": 9}, False)])
def test_scenes_share_the_programs_whose_constants_are_the_same(other, shared):
    """A larger image changes no program of the A-buffer in arrays, more layers change those that name their number."""
    variant, scene = catalog()["ab-array"].variant({}), Scene(size=(32, 32), depth_complexity=5)
    one, two = (code_of_programs(Fitted(variant, expected_stats(s))) for s in (scene, replace(scene, **other)))
    assert one[0] and one[1] and not one[0].keys() & one[1].keys()
    assert (one == two) == shared


def test_a_continued_line_ends_at_a_line_of_spaces():
    assert code_of("#define A 1 \\\n    \n\n#define B 2\n") == "#define A 1\n#define B 2"
