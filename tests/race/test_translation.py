"""GLSL becomes C++ that computes the same; what the machine does not know ends in one line that names it."""

import pytest

from mfr_bench.errors import ShaderError
from mfr_bench.methods import catalog
from mfr_bench.race.build import compiler
from mfr_bench.race.check import Checker, How
from mfr_bench.race.parser import parse
from mfr_bench.race.scenes import row_of
from mfr_bench.race.syntax import Binary, Call, Declaration, Function, If, Loop
from mfr_bench.race.tables import preprocessed


def where(line: int) -> str:
    return f"test.glsl:{line}"


def body_of(text: str) -> tuple:
    return parse(f"void main() {{\n{text}\n}}", where).functions[0].body.body


def test_precedence_is_that_of_the_language():
    value = body_of("uint a = 1u + 2u * 3u << 1u;")[0].variables[0].value
    assert isinstance(value, Binary)
    assert value.operator == "<<" and value.left.operator == "+" and value.left.right.operator == "*"


def test_declarations_are_told_from_constructors():
    declared, evaluated = body_of("float y[3] = float[](1.0, 2.0, 3.0);\nvec2(1.0, 2.0);")
    assert isinstance(declared, Declaration) and isinstance(declared.variables[0].value, Call)
    assert declared.variables[0].value.array and not isinstance(evaluated, Declaration)


def test_functions_give_arrays():
    shader = parse("const int SIDE = 3;\nfloat[SIDE] forward(float x, out uint y) { float a[SIDE]; return a; }", where)
    function = shader.functions[0]
    assert isinstance(function, Function) and len(function.result.lengths) == 1
    assert [p.direction for p in function.parameters] == ["in", "out"]


def test_every_statement_of_the_language_that_shaders_use_is_read():
    body = body_of("if (a) b(); else c();\nfor (;;) break;\nwhile (x) continue;\ndo y(); while (z);")
    kinds = [type(s) for s in body]
    assert kinds == [If, Loop, Loop, Loop]


@pytest.mark.parametrize(("text", "named"), [
    ("switch (x) { }", "'switch'"), ("mat3 m;", "'mat3'"), ("x @ y;", "'@'"), ("uint a = ;", "a name before ';'"),
])
def test_an_unknown_construct_is_named_with_its_line(text, named):
    with pytest.raises(ShaderError) as error:
        body_of(f"uint first;\n{text}")
    assert named in str(error.value)
    assert str(error.value).startswith("test.glsl:3: the race machine") and "\n" not in str(error.value)


def test_lines_are_right_behind_a_branch_with_an_include():
    """A preprocessor skips `#line` in a branch that it skips."""
    text = ("#line 100001\n#if 0\n#line 200001\nint skipped;\nint more;\n#line 100004\n#else\nint here;\n#endif\n"
            "int last;\n")
    found = {g.variable.name: g.line for g in parse(preprocessed(text, compiler()), where).globals}
    assert found == {"here": 100005, "last": 100007}


def test_every_pass_of_every_method_is_read():
    for method in catalog().values():
        for step in Checker(method.variant({}), row_of((2,))).frame.passes:
            if step.sources:
                parse(preprocessed(step.own.text, compiler()), where)


@pytest.mark.parametrize("params", [
    {"payload": "rgba16f"}, {"payload": "two_channel"}, {"sort": "shell"}, {"sort": "register"}, {"sort": "bubble"},
    {"sort": "lplus"}, {"bma": "on"}, {"resolve": "compute"}, {"accumulate": "compensated"}, {"touched": "tiles"},
    {"touched": "bounds"}, {"stop_opacity": 0.9}, {"accumulate": "float16"}, {"accumulate": "unorm8"},
], ids=str)
def test_the_machine_computes_the_oracle_s_image(params):
    """One fragment after the other: `images` holds every order's image against the float64 oracle."""
    checker = Checker(catalog()["ab-array"].variant(params), row_of((5, 0, 3)))
    assert len(checker.images) >= 1
    assert checker.check(How(schedules=20)).failure is None
