"""Shader text: includes, the prelude, and the way back from a driver's complaint to a file and a line."""

import re

import pytest

from mfr_bench import glsl
from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.errors import ShaderError
from mfr_bench.gpu.context import compile_message
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.scene_buffer import SceneBuffer
from mfr_bench.gpu.targets import Canvas
from mfr_bench.methods.spec import Buffer, Fitted, Method, Param, Pass, SceneStats, Target
from mfr_bench.resources import shaders_dir
from mfr_bench.scene import generate

SIZES = SceneStats(W=8, H=6, n=3, F=144, primitives=3)

FILES = {
    "main.frag": '// A test.\n#include "one.glsl"\nvoid main() { one(); }\n',
    "one.glsl": '// One.\n#include "two.glsl"\n\nvoid one() { two(); }\n',
    "two.glsl": "// Two.\nvoid two() {}\n",
    "twice.frag": '#include "two.glsl"\n#include "one.glsl"\nvoid main() {}\n',
    "round.glsl": '#include "round.frag"\n',
    "round.frag": '#include "round.glsl"\nvoid main() {}\n',
    "lost.frag": '// A test.\n\n#include "middle.glsl"\nvoid main() {}\n',
    "middle.glsl": '#include "nowhere.glsl"\n',
    "slot.frag": "// A test.\n#include <fetch>\nvoid main() {}\n",
    "numbers.frag": "// A test.\nvoid main() { uint a = uint(K) + uint(N) + EMPTY; }\n",
    "choices.frag": "#if SORT_SHELL || SORT_INSERTION\n#endif\nvoid main() {}\n",
    "bare.frag": "void main() {}\n",
    "writes.frag": "void main() { counter[0] = nodes[0].x; out_image = vec4(REJECTS); }\n",
    "loses.frag": "void main() { lost_fragments = 1u; }\n",
    "wrong.frag": '// A test.\n#include "bad.glsl"\nvoid main() { out_image = vec4(bad()) * float(K); }\n',
    "bad.glsl": "// Bad.\nfloat bad() {\n    return undeclared;\n}\n",
    "wrong.vert": "// A test.\nvoid main() {\n    gl_Position = vec3(0.0);\n}\n",
}


@pytest.fixture(autouse=True)
def files(monkeypatch):
    real = glsl.read
    monkeypatch.setattr(glsl.includes, "read", lambda path: FILES[path] if path in FILES else real(path))


def drawing(shader="bare.frag", **more):
    """A method of one pass, which draws with the shader."""
    step = {name: more.pop(name) for name in ("reads", "writes", "into", "defines", "fetch", "kind") if name in more}
    return Method(id="test", name="test", family="test", source="test", summary="", guarantee="none", words="0",
                  ties="", steps=(Pass("draw", step.pop("kind", "fullscreen"), shader, **step),), **more)


def text_of(method, **params):
    variant = method.variant(params)
    return glsl.source(Fitted(variant, SIZES), variant.passes[0]).text


def defines(text):
    """The numbers that a shader is given, by name."""
    return dict(re.findall(r"^#define (\w+) (\d+u?)$", text, re.MULTILINE))


def line_of(source, wanted):
    """The number that `#line` gives to the line with this text."""
    number = 0
    for line in source.text.splitlines():
        number += 1
        if wanted in line:
            return number
        if match := re.match(r"#line (\d+)", line):
            number = int(match[1]) - 1
    raise AssertionError(wanted)


def source_of(shader):
    variant = drawing(shader, into=("image",)).variant({})
    return glsl.source(Fitted(variant, SIZES), variant.passes[0])


# --- includes ------------------------------------------------------------------------------------


def test_includes_come_in_place_however_deep():
    text, files = glsl.expand("main.frag", {})
    assert files == ("prelude", "main.frag", "one.glsl", "two.glsl")
    assert [line for line in text.splitlines() if not line.startswith(("#line", "//")) and line] == [
        "void two() {}", "void one() { two(); }", "void main() { one(); }"]


def test_a_file_comes_once():
    text, files = glsl.expand("twice.frag", {})
    assert text.count("void two()") == 1
    assert files == ("prelude", "twice.frag", "two.glsl", "one.glsl")


def test_files_that_include_each_other_end():
    assert glsl.expand("round.frag", {})[1] == ("prelude", "round.frag", "round.glsl")


def test_a_missing_include_names_the_way_to_it():
    with pytest.raises(ShaderError) as caught:
        glsl.expand("lost.frag", {})
    assert str(caught.value) == "lost.frag:3: middle.glsl:1: nowhere.glsl: cannot be read: No such file or directory"


def test_a_method_chooses_what_a_slot_includes():
    assert glsl.expand("slot.frag", {"fetch": "two.glsl"})[1] == ("prelude", "slot.frag", "two.glsl")
    with pytest.raises(ShaderError, match=r"^slot\.frag:2: the method gives no include for <fetch>$"):
        glsl.expand("slot.frag", {})


def test_a_missing_shader_is_named():
    with pytest.raises(ShaderError, match=r"^absent\.frag: cannot be read: No such file or directory$"):
        text_of(drawing("absent.frag"))


# --- lines ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(("text", "place"), [
    ("void two()", "two.glsl:2"), ("void one()", "one.glsl:4"), ("void main()", "main.frag:3"),
    ("// A test.", "main.frag:1"), ("#version", "prelude:1"),
])
@pytest.mark.parametrize("form", ["0:{}(7): error: no good", "0({}) : error C1008: no good"])
def test_a_drivers_line_leads_to_the_file(text, place, form):
    source = source_of("main.frag")
    located = source.located("log:\n" + form.format(line_of(source, text)))
    assert re.fullmatch(re.escape(place) + r": error.*no good", located.splitlines()[1])


def test_what_names_no_line_stays():
    log = "error: linking with uncompiled shader\n0:99900000(1): error: somewhere else"
    assert source_of("main.frag").located(log) == log


@pytest.mark.parametrize(("stages", "said"), [
    ((None, "wrong.frag"), r"bad\.glsl:3: error: .*undeclared.*\(method m, pass p; (\w+=\d+u? )*K=5( \w+=\d+u?)*\)"),
    (("wrong.vert", "bare.frag"), r"wrong\.vert:3: error: .*\(method m, pass p; .*\)"),
])
def test_the_drivers_own_complaint_is_one_line(device, stages, said):
    method = drawing(stages[1], into=("image",), params=(Param("k", 5, ""),))
    variant = method.variant({})
    sources = tuple(glsl.source(Fitted(variant, SIZES), variant.passes[0], entry) for entry in
                    (stages[0] or "screen/triangle.vert", stages[1]))
    with pytest.raises(ShaderError) as caught:
        device.program(sources, "method m, pass p")
    assert re.fullmatch(said, str(caught.value)), str(caught.value)


def test_a_complaint_without_a_line_is_still_one_line():
    source = source_of("bare.frag")
    said = compile_message("GLSL Linker failed\n\nerror:  too many\nvaryings\n", (source,), "method m, pass p")
    assert said == "GLSL Linker failed error: too many varyings (method m, pass p; )"


# --- prelude -------------------------------------------------------------------------------------


def test_only_numbers_that_a_shader_names_are_defined():
    method = drawing("numbers.frag", params=(Param("k", 5, ""), Param("other", 6, "")))
    found = defines(text_of(method))
    assert found == {"K": "5", "N": "3", "EMPTY": "4294967295u"}
    assert defines(text_of(drawing("bare.frag", params=(Param("k", 5, ""),)))) == {}


def test_programs_are_shared_between_parameters_that_no_shader_names():
    method = drawing("bare.frag", params=(Param("k", 5, ""),))
    assert text_of(method, k=5) == text_of(method, k=6)
    other = drawing("numbers.frag", params=(Param("k", 5, ""),))
    assert text_of(other, k=5) != text_of(other, k=6)


def test_choices_become_truth_values():
    sort = Param("sort", "shell", "", choices=("insertion", "shell", "hybrid"))
    assert defines(text_of(drawing("choices.frag", params=(sort,)))) == {"SORT_SHELL": "1", "SORT_INSERTION": "0"}


def test_a_passs_own_defines_are_formulas():
    method = drawing("numbers.frag", params=(Param("k", 5, ""),), defines={"N": "2*n + k"})
    assert defines(text_of(method))["N"] == "11"


def test_buffers_are_bound_in_order_and_readonly_where_they_are_only_read():
    method = drawing("writes.frag", writes=("counter",), reads=("nodes",), into=("image",),
                         buffers=(Buffer("counter", "P", coherent=True), Buffer("nodes", "P", type="uvec2")))
    text = text_of(method)
    assert "layout(std430, binding = 0) coherent buffer Block0 { uint counter[]; };" in text
    assert "layout(std430, binding = 1) readonly buffer Block1 { uvec2 nodes[]; };" in text
    assert "layout(location = 0) out vec4 out_image;" in text
    assert defines(text) == {"REJECTS": "0"}


def test_targets_that_are_read_are_samplers():
    method = drawing("bare.frag", reads=("depth",), targets=(Target("depth", "r32f"),))
    assert "layout(binding = 0) uniform sampler2D depth;" in text_of(method)


def test_more_buffers_than_gl_guarantees_are_refused():
    names = [f"b{i}" for i in range(8)]
    method = drawing("bare.frag", reads=tuple(names), buffers=tuple(Buffer(n, "P") for n in names))
    with pytest.raises(ShaderError, match="test: pass 'draw' uses 8 buffers; at most 7"):
        text_of(method)


def test_clearing_gives_every_element_its_value(device):
    method = drawing("common/clear.frag", writes=("one", "three", "heads", "odd"), buffers=(
        Buffer("one", "P", clear="7u"), Buffer("three", "3*P", clear="8u"), Buffer("odd", "5", clear="9u"),
        Buffer("heads", "2*P", clear="6u", clear_heads=True)))
    scene = generate(SceneConfig(size=(8, 6), depth_complexity=0))
    quads, canvas = SceneBuffer(device, scene), Canvas(device, scene.viewport)
    frame = Frame(device, Fitted(method.variant({}), SIZES), quads, canvas)
    frame.draw()
    found = {name: frame.words(name).tolist() for name in ("one", "three", "heads", "odd")}
    for thing in (frame, canvas, quads):
        thing.release()
    assert found["one"] == [7] * 48
    assert found["three"] == [8] * 144
    assert found["odd"] == [9] * 5
    assert found["heads"][:48] == [6] * 48


def test_no_shader_asks_a_storage_block_for_its_length():
    """A driver may answer wrongly behind a divergent loop: the number is passed, as `<buffer>_length`."""
    texts = {path: path.read_text() for path in shaders_dir().rglob("*") if path.is_file()}
    assert [path.name for path, text in texts.items() if ".length()" in text] == ["block_length.frag"]  # the trial
    text = text_of(drawing("common/clear.frag", writes=("counter",), buffers=(Buffer("counter", "3*P", clear="0u"),)))
    assert "uniform uint counter_length;" in text and "i < counter_length" in text


def test_lost_fragments_are_counted_only_where_a_shader_counts_them():
    assert "Diagnostics" in text_of(drawing("loses.frag"))
    assert "Diagnostics" not in text_of(drawing("bare.frag"))


def test_a_compute_pass_has_one_stage():
    for kind, entries in (("compute", ["bare.frag"]), ("geometry", ["scene/quad.vert", "bare.frag"])):
        method = drawing("bare.frag", kind=kind)
        assert [s.entry for s in glsl.stages(Fitted(method.variant({}), SIZES), method.passes[0])] == entries
