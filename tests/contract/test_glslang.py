"""The reference compiler on what no device at hand may compile: every option, interlock and 64-bit atomics too."""

import shutil
import subprocess
from dataclasses import replace

import pytest

from mfr_bench.config import Scene
from mfr_bench.effects import Settings
from mfr_bench.glsl import stages
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted
from mfr_bench.plan import expected_stats

from .cases import every_method, variants

SIZES = expected_stats(Scene(size=(64, 48), depth_complexity=40, pixel_density=0.5))
IN_SAMPLES = replace(SIZES, geometry="reversed", shading=1, effect=Settings(msaa=8))
OF_ONE_SAMPLE = {"blended", "one_sample", "unmasked"}  # facts that a scene in samples has not
FETCH = "#extension GL_EXT_shader_framebuffer_fetch : enable"
GEOMETRIES = ("quad", "strip", "triangle", "reversed", "masked")


def texts(method):
    """Every stage of every pass by its file's ending, once each."""
    found = {}
    for variant in variants(method):
        for step in (s for s in variant.passes if s.kind != "clear"):
            for geometry in GEOMETRIES:
                for stage in stages(Fitted(variant, replace(SIZES, geometry=geometry)), step):
                    found[stage.text] = stage.entry.rpartition(".")[2]
    plain = method.variant({})
    if not OF_ONE_SAMPLE.intersection(plain.asks):
        for step in (s for s in plain.passes if s.kind != "clear"):
            for stage in stages(Fitted(plain, IN_SAMPLES), step):
                found[stage.text] = stage.entry.rpartition(".")[2]
    return found


def accepted(text):
    """The text without framebuffer fetch, which glslang knows in ES alone: an output can be read as it is."""
    return text.replace(FETCH, "").replace(") inout ", ") out ") if FETCH in text else text


def complaint(folder, sources):
    """The messages of glslang about these sources (text -> file's ending), or nothing."""
    paths = []
    for number, (text, ending) in enumerate(sources.items()):
        paths.append(folder / f"{number}.{ending}")
        paths[-1].write_text(accepted(text))
    ended = subprocess.run(["glslangValidator", *paths], capture_output=True, text=True, check=False)
    return "\n".join(line for line in ended.stdout.splitlines() if "ERROR" in line) if ended.returncode else ""


@pytest.fixture(autouse=True)
def glslang():
    if not shutil.which("glslangValidator"):
        pytest.skip("glslangValidator is not installed (glslang-tools)")


@pytest.mark.parametrize("method", every_method(), ids=lambda m: m.id)
def test_every_stage_is_accepted(method, tmp_path):
    sources = texts(method)
    assert sources
    assert complaint(tmp_path, sources) == ""


def test_a_wrong_line_in_one_of_many_is_told(tmp_path):
    *right, (wrong, ending) = texts(catalog()["kplus-array"]).items()
    sources = dict(right) | {wrong.replace("void main()", "uint x = 0.5; void main()"): ending}
    assert len(sources) > 20
    assert "ERROR" in complaint(tmp_path, sources)
