"""Shader files open with a paragraph that says what the file does, and a line of the buffers that its code names."""

import re

import pytest

from mfr_bench.glsl.code import code_of
from mfr_bench.gpu import capture, probes, selftest, trials
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Method
from mfr_bench.resources import shaders_dir

FILES = sorted(str(p.relative_to(shaders_dir())) for p in shaders_dir().rglob("*.*"))
LINE = re.compile(r"^// Buffers: (.+)$", re.MULTILINE)
PROBES = [value for module in (capture, probes, selftest, trials) for value in vars(module).values()
          if isinstance(value, Method)]
LOCAL = {  # a local or shared array has the name of another method's buffer
    "methods/adaptive/nearest.glsl": {"depths"},
    "methods/precalc/block_scan.glsl": {"sums"},
}


def buffers(method):
    """Names of every buffer that the method may have."""
    choices = [{p.name: choice} for p in method.params for choice in (*p.choices, *p.of)]
    return {b.name for given in ({}, *choices) for b in method.variant(given).buffers}


NAMES = set().union(*map(buffers, (*catalog().values(), *PROBES)))


def opening(text):
    return text[:re.search(r"^(?!//)", text, re.MULTILINE).start()]


@pytest.mark.parametrize("path", FILES)
def test_a_file_opens_with_sentences(path):
    text = opening((shaders_dir() / path).read_text())
    assert text.startswith("// ")
    assert text.rstrip().endswith((".", ")"))


@pytest.mark.parametrize("path", FILES)
def test_the_line_of_buffers_names_what_the_code_accesses(path):
    text = (shaders_dir() / path).read_text()
    line = LINE.search(opening(text))
    said = set(re.findall(r"\w+", line[1])) & (NAMES | {f"{name}_previous" for name in NAMES}) if line else set()
    code = re.sub(r"\b(\w+)_at\(", r"\1[", code_of(text))  # readers, of buffers through textures or as they lie
    accessed = set(re.findall(r"\b(\w+)\[", code)) | set(re.findall(r"#define BUFFER64 (\w+)", code))
    used = {name for name in accessed if name.removesuffix("_previous") in NAMES} - LOCAL.get(path, set())
    assert used <= said, "the line leaves them out"
    assert said <= set(re.findall(r"\w+", code)) | {"nodes", "address"}, "the code never names them"
