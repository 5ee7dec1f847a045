"""What the compiler goes on with: chosen branches, macros in use; all of it where the compiler alone can choose."""

import re
import shutil
import subprocess

import pytest

from mfr_bench.config.model import Scene
from mfr_bench.glsl import stages
from mfr_bench.glsl.branches import active_lines, compiled
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted
from mfr_bench.plan import expected_stats

CHOSEN = """#define K 4u
#define ROOM 2
#if K > 3 && !defined(LOOPS) || ROOM == 9
a K
#ifdef ROOM
b
#endif
#elif K == 4
c
#else
d
#endif
#ifndef ROOM
e
#elif (ROOM + 2 * 3) != 8
f
#elif !(ROOM == 2)
g
#else
h
#endif"""
OPEN = """#define LINE 1
#if LINE == 2
a
#elif defined(GL_EXT_x)
#define K 2
b
#else
c
#endif
#if K == 2
d
#endif
#if GL_EXT_y
#if LINE
e
#else
f
#endif
#endif"""


def test_lines_of_branches_that_are_not_chosen_are_left_out():
    assert compiled(CHOSEN).splitlines() == ["#define K 4u", "a K", "b", "h"]


def test_branches_that_the_compiler_chooses_stay():
    kept = ["#if defined(GL_EXT_x)", "#define K 2", "b", "#else", "c", "#endif", "#if K == 2", "d", "#endif",
            "#if GL_EXT_y", "e", "#endif"]
    assert compiled(OPEN).splitlines() == kept


@pytest.mark.parametrize("condition", ["K % 2", "SQUARE(K)", "0x10", "010 == 8", "K ? 1 : 0", "__VERSION__ >= 430",
                                       "K +", "(K", "NO_TEXT", "defined", "defined(", "defined(K", "defined()"])
def test_a_condition_that_is_not_read_stays(condition):
    text = f"#define K 2\n#define SQUARE(x) (x)*(x)\n#define NO_TEXT\n#if {condition}\na\n#else\nb\n#endif"
    assert active_lines(text)[3:] == [f"#if {condition}", "a", "#else", "b", "#endif"]


@pytest.mark.parametrize("text", ["a\n#endif", "#else\na", "#elif 1\na", "#if 1\na", "#if 1\n#else\n#else\n#endif",
                                  "#if GL_EXT_x\n#else\n#elif 1\n#endif", "#if 0\n#if 1\n#endif"])
def test_branches_that_do_not_pair_are_left_to_the_compiler_to_complain_of(text):
    assert compiled(text) == text


def test_a_macro_that_is_undefined_holds_no_more():
    assert active_lines("#define K 1\n#undef K\n#if K\na\n#endif\n#ifdef K\nb\n#endif") == ["#define K 1", "#undef K"]


def test_macros_that_only_macros_out_of_use_name_are_left_out():
    text = "#define QUADS 16\n#define LAYERS (QUADS + 1)\n#define SORT(a) MERGE(a)\n#define MERGE(a) a\nvoid main() {}"
    assert compiled(text) == "void main() {}"
    assert compiled(f"{text} // SORT(1)").startswith("#define SORT(a) MERGE(a)\n#define MERGE(a) a\n")


@pytest.mark.parametrize("text", ["#define CAT(a, b) a##b\n#define XY 1\nint v = CAT(X, Y);",
                                  "#define OF(n) SORT ## n ## _AT\n#define SORT8_AT 1\nint v = OF(8);"])
def test_a_macro_whose_name_is_made_by_pasting_stays(text):
    assert compiled(text) == text


def test_a_macro_that_no_pasting_can_make_is_left_out():
    assert compiled("#define OF(n) block##n\n#define OTHER 1\nOF(2)") == "#define OF(n) block##n\nOF(2)"


@pytest.mark.skipif(not shutil.which("cpp"), reason="no C preprocessor")
@pytest.mark.parametrize("method", ["ab-ll-bucket", "adaptive", "kplus-array", "mboit", "open-pre", "peel-kplus"])
def test_a_preprocessor_makes_the_same_of_both(method):
    """C's preprocessor leaves the same of every pass with default parameters; extensions count as absent."""
    fitted = Fitted(catalog()[method].variant({}), expected_stats(Scene(size=(24, 20), depth_complexity=12)))
    for step in fitted.variant.passes:
        for stage in stages(fitted, step) if step.kind != "clear" else ():
            assert preprocessed(stage.compiled) == preprocessed(stage.code)


def preprocessed(text: str) -> list[str]:
    bare = re.sub(r"^#(version|extension).*$", "", text, flags=re.MULTILINE)
    return subprocess.run(["cpp", "-P", "-undef", "-w"], input=bare, capture_output=True, text=True,
                          check=True).stdout.split()


def test_one_program_serves_scenes_that_differ_in_a_number_it_does_not_use():
    """A store that rejects nothing names the scene's number of quads in a branch alone that is not chosen."""
    method = catalog()["ab-ll"]
    few, many = (Fitted(method.variant({}), expected_stats(Scene(size=(24, 20), depth_complexity=n))) for n in (8, 9))
    store = next(step for step in method.variant({}).passes if step.name == "store")
    one, other = (stages(fitted, store)[1] for fitted in (few, many))
    assert one.code != other.code
    assert one.compiled == other.compiled
