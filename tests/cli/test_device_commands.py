"""`methods`, `doctor`, `scene`, `render`, `shader`: what they print and write."""

import csv
import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

from mfr_bench.cli.device_commands import _first_cell
from mfr_bench.cli.main import cli
from mfr_bench.config import load
from mfr_bench.glsl.branches import compiled
from mfr_bench.glsl.code import code_of
from mfr_bench.gpu.device import Listed
from mfr_bench.gpu.single import shown
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Promise
from mfr_bench.oracle.composite import composite
from mfr_bench.plan import expand
from mfr_bench.scene import generate

from .conftest import TINY, apart

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.usefixtures("on_device")

ODD = TINY.replace("size: [32, 24]", "size: [97, 71], pixel_density: 0.4, layout: tiles, seed: 4")


@pytest.fixture
def odd(here):
    (here / "odd.yaml").write_text(ODD)
    return "odd.yaml"


def first_scene(config, *overrides):
    return generate(expand(load(config, catalog(), None, overrides)[0], catalog())[0].scene)


# --- methods -------------------------------------------------------------------------------------


def test_methods_as_json(mfr, device):
    records = json.loads(mfr("methods", "--json").out)
    assert [r["id"] for r in records] == list(catalog())
    for record in records:
        assert {"id", "name", "family", "passes", "guarantee", "needs", "supported", "reason"} <= set(record)
        method = catalog()[record["id"]]
        assert record["passes"] == list(method.pass_names)
        assert record["supported"] == device.features.issuperset(method.variant({}).needs)
        assert (record["reason"] is None) == record["supported"]


def test_a_method_that_lacks_a_feature_says_which(mfr, device, monkeypatch):
    from dataclasses import replace

    needy = replace(catalog()["ab-array"], needs=("levitation",))
    monkeypatch.setattr("mfr_bench.methods.catalog", lambda: {"ab-array": needy})
    record, = json.loads(mfr("methods", "--json").out)
    assert (record["supported"], record["reason"]) == (False, "needs levitation")
    assert "; needs levitation" in mfr("methods").out


@pytest.mark.parametrize("columns", [40, 80, 120])
def test_methods_for_reading(mfr, monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", str(columns))
    lines = mfr("methods").out.splitlines()
    heads = [line.split("  ")[0] for line in lines if not line.startswith(" ")]
    assert heads == list(catalog())
    assert max(map(len, lines)) <= columns + 20  # a name or a formula is never broken
    assert sum(map(len, lines)) / len(lines) < columns


# --- doctor --------------------------------------------------------------------------------------


def test_doctor_for_reading(mfr, device):
    ended = mfr("doctor")
    assert ended.status == 0
    assert f"{device.info['renderer']} ({device.kind})" in ended.out
    assert "MiB per storage block" in ended.out
    assert "pass  atomics: " in ended.out
    assert "FAIL" not in ended.out
    assert "\ntimer: " in ended.out
    assert ended.out.startswith(f"{device.egl.index}   {device.info['renderer']} ({device.kind}), ")


def test_doctor_lists_a_device_that_cannot_be_used(mfr, monkeypatch):
    """A user may have no permission for a device; the others are told all the same."""
    listed = [Listed(0, {"uuid": None, "pci": "0000:01:00.0"}, "eglInitialize failed"), Listed(1, {
        "renderer": "NVIDIA H200", "kind": "gpu", "version": "4.6", "uuid": None, "pci": None})]
    monkeypatch.setattr("mfr_bench.gpu.device.list_devices", lambda: listed)
    lines = mfr("doctor").out.splitlines()
    assert lines[:3] == ["0   cannot be used: eglInitialize failed; PCI 0000:01:00.0", "1   NVIDIA H200 (gpu), 4.6", ""]


def test_doctor_tells_what_a_failed_trial_costs(mfr, plant):
    """The exit status stays 0 where no method depends on it."""
    plant("probe/block_length.frag", "seen[p] = uint(second.length())", "seen[p] = 4u")
    ended = mfr("doctor")
    assert ended.status == 0
    assert "no    block length: 480 of 480" in ended.out
    assert "; avoided by all methods" in ended.out


def test_doctor_as_json(mfr, device):
    record = json.loads(mfr("doctor", "--json").out)
    assert record["device"] == device.info
    assert record["extensions"] == sorted(device.extensions)
    assert record["limits"]["max_block_bytes"] == device.limits.max_block_bytes
    assert {t["name"]: t["passed"] for t in record["self_tests"]}["spin lock"] is True
    assert record["calibration"]["timer"] in ("wall", "gpu")


def test_doctor_fails_with_its_tests(mfr, plant):
    plant("probe/total.frag", "atomicAdd(total[0], 1u)", "atomicAdd(total[0], 2u)")
    ended = mfr("doctor")
    assert ended.status == 1
    assert "FAIL  atomics: " in ended.out


def test_only_a_device_of_the_kind_asked_for_will_do(device):
    absent = "gpu" if device.kind == "cpu" else "cpu"
    if absent == "cpu":
        pytest.skip("a machine with a GPU may have a software driver, too")
    ended = apart("doctor", "--device", absent)
    assert ended.status == 2
    assert ended.complaint.startswith("--device gpu: no such device; allowed: auto, gpu, cpu, or an index, ")
    assert ended.complaint.endswith("; see mfr-bench doctor")


# --- scene ---------------------------------------------------------------------------------------


def test_a_scene_as_arrays(mfr, odd, here):
    ended = mfr("scene", odd, "--out", "new/scene.npz")
    assert ended.status == 0
    scene = first_scene(odd)
    assert ended.out == f"new/scene.npz: {len(scene)} quads for 97 x 71 pixels\n"
    with np.load(here / "new" / "scene.npz") as found:
        assert found["viewport"].tolist() == [97, 71]
        for name, kind in (("rect", np.int32), ("depth", np.float32), ("rgba", np.uint8)):
            assert found[name].dtype == kind
            np.testing.assert_array_equal(found[name], getattr(scene, name))


@pytest.mark.parametrize("config", ["odd", "object.yaml"])
def test_fragments_of_a_scene_are_a_scene(mfr, odd, here, config):
    """Flat quads need no device; a device draws slanted ones. The plan of a run counts what was written."""
    (here / "object.yaml").write_text(OBJECT)
    ended = mfr("scene", odd if config == "odd" else config, "--fragments", "f.npz", "--device", "cpu")
    with np.load(here / "f.npz") as found:
        assert ended.out.startswith(f"f.npz: {len(found['depth'])} fragments for ")
    planned = mfr("run", "--fragments", "f.npz", "--dry-run", "--only", "ab-array", "--device", "cpu")
    assert planned.status == 0 and "fragments-f" in planned.out


OBJECT = ("name: object\nscene: {kind: needles, size: [48, 40], depth_complexity: 12}\n"
          "methods: [ab-array, kplus-array]\n")


@pytest.mark.parametrize("config", ["odd", "object.yaml"])
def test_fragments_in_samples_have_masks_and_colours_as_they_are(mfr, odd, here, device, config):
    """Flat quads cover whole pixels, slanted primitives what the device says. A run takes the samples of the file."""
    if "msaa_4" not in device.features:
        pytest.skip("this device does not rasterize into 4 samples a pixel")
    (here / "object.yaml").write_text(OBJECT)
    ended = mfr("scene", odd if config == "odd" else config, "--set", "scene.msaa=4", "--fragments", "f.npz")
    assert ended.status == 0, ended.err
    with np.load(here / "f.npz") as found:
        assert found["coverage"].dtype == np.uint8 and found["coverage"].max() == 15
        assert (found["coverage"] == 15).all() == (config == "odd")
        colours = first_scene(odd if config == "odd" else config).rgba
        assert set(map(tuple, found["rgba"])) <= set(map(tuple, colours))
    ended = mfr("run", "--fragments", "f.npz", "--only", "ab-array", "--set", "measure.time_limit_s=0.1",
                "--out", "o")
    assert ended.status == 0 and "4 samples a pixel" in ended.err
    with (here / "o" / "results.csv").open(newline="") as rows:
        assert {row["msaa"] for row in csv.DictReader(rows)} == {"4"}


def test_fragments_in_samples_that_the_device_lacks_end_in_a_line(mfr, here, device, monkeypatch):
    (here / "object.yaml").write_text(OBJECT)
    monkeypatch.setattr(type(device), "features", frozenset({"msaa_4"}))
    ended = mfr("scene", "object.yaml", "--set", "scene.msaa=8", "--fragments", "f.npz")
    assert ended.status == 1 and not (here / "f.npz").exists()
    assert ended.err.strip() == ("scene.msaa: this device does not rasterize into 8 samples a pixel; "
                                 "allowed here: 1, 4")


def test_slanted_primitives_are_corners(mfr, here):
    (here / "object.yaml").write_text(OBJECT)
    ended = mfr("scene", "object.yaml", "--out", "scene.npz")
    scene = first_scene("object.yaml")
    assert ended.out == f"scene.npz: {len(scene)} strips for 48 x 40 pixels\n"
    with np.load(here / "scene.npz") as found:
        assert set(found) == {"viewport", "position", "rgba", "fragment_probability", "seed"}
        for name in ("position", "rgba"):
            np.testing.assert_array_equal(found[name], getattr(scene, name))


def test_a_scene_takes_the_first_cell_unless_set(mfr, odd, here):
    mfr("scene", odd, "--out", "a.npz", "--set", "sweep.scene.depth_complexity=[3,9]")
    mfr("scene", odd, "--out", "b.npz", "--set", "scene.depth_complexity=9")
    with np.load(here / "a.npz") as a, np.load(here / "b.npz") as b:
        assert 3 * len(a["depth"]) == len(b["depth"]) > 0


# --- render --------------------------------------------------------------------------------------


@pytest.mark.parametrize(("method", "more", "layers"), [
    ("ab-array", [], None), ("kplus-array", [], 2), ("kplus-array", ["--set", "k=5"], 5), ("zbuffer", [], 1),
])
def test_a_rendered_array_is_the_oracles(mfr, odd, here, method, more, layers):
    ended = mfr("render", odd, "--method", method, "--out", "image.npy", *more)
    assert ended.status == 0
    image = np.load(here / "image.npy")
    assert (image.dtype, image.shape) == (np.float32, (71, 97, 4))
    np.testing.assert_allclose(image, composite(first_scene(odd), layers), rtol=0, atol=1e-4)
    assert ended.out.startswith("image.npy: 97 x 71, ")
    assert ended.out.endswith(", 0 wrong pixels\n")


def test_slanted_primitives_are_rendered_and_checked(mfr, device, here):
    (here / "object.yaml").write_text(OBJECT)
    ended = mfr("render", "object.yaml", "--method", "kplus-array", "--set", "k=3", "--out", "image.npy")
    assert ended.status == 0
    assert ", 0 wrong pixels" in ended.out
    with shown(device, first_scene("object.yaml")) as on:
        right = on.truth.answer(Promise(3))
    image = np.load(here / "image.npy")
    np.testing.assert_allclose(image, np.clip(image, right.low, right.high), rtol=0, atol=1e-4)


def test_what_a_scene_does_not_offer_is_said(mfr, here):
    (here / "object.yaml").write_text(OBJECT)
    ended = mfr("render", "object.yaml", "--method", "peel-srab", "--out", "image.npy")
    assert ended.status != 0
    assert ended.complaint == "peel-srab: unsupported: needs flat primitives that meet no pixel but at its edges"


def test_a_png_is_upright_over_a_checkerboard(mfr, odd, here):
    mfr("render", odd, "--method", "ab-array", "--out", "image.png")
    picture = imread(here / "image.png")
    assert picture.shape[:2] == (71, 97)
    image = composite(first_scene(odd))[::-1]  # row 0 at the top, as a picture has it
    empty = image[..., 3] == 0
    assert 0.2 < empty.mean() < 0.8
    greys = picture[empty][:, :3]
    assert len(np.unique(greys)) == 2
    assert (greys.min(axis=1) == greys.max(axis=1)).all()
    behind = (picture[..., :3] - image[..., :3]) / np.maximum(1 - image[..., 3:], 1e-9)
    see_through = image[..., 3] < 0.9
    assert behind[see_through].min() > 0.6
    assert behind[see_through].max() < 1.01


def test_a_wrong_image_is_exit_3(mfr, odd, plant, here):
    plant("scene/primitive.glsl", "packUnorm4x8(in_rgba)", "packUnorm4x8(in_rgba.brga)")
    ended = mfr("render", odd, "--method", "ab-array", "--out", "image.npy")
    assert ended.status == 3
    assert (here / "image.npy").exists()


def test_an_image_without_a_promise_is_not_compared(mfr, odd):
    ended = mfr("render", odd, "--method", "floor", "--out", "image.npy")
    assert ended.status == 0
    assert ended.out.endswith(", no image to compare\n")


def test_an_image_that_the_device_or_the_budget_forbids_is_one_line(mfr, odd, device, monkeypatch):
    from dataclasses import replace

    ended = mfr("render", odd, "--method", "ab-array", "--out", "a.npy", "--set", "measure.memory_budget_mb=0.01")
    assert ended.status == 1
    assert ended.complaint.startswith("ab-array: over_budget: needs ")
    monkeypatch.setattr(device, "limits", replace(device.limits, features=frozenset()))
    ended = mfr("render", odd, "--method", "kplus-array", "--out", "a.npy", "--set", "sync=interlock")
    assert (ended.status, ended.complaint) == (1, "kplus-array: unsupported: needs fragment_shader_interlock")


def test_a_shader_that_does_not_compile_is_one_line(mfr, odd, plant):
    plant("methods/array/store.frag", "void main() {", "void main() {\n    undeclared = 1;")
    ended = mfr("render", odd, "--method", "ab-array", "--out", "a.npy")
    assert ended.status == 1
    assert ended.complaint.startswith("methods/array/store.frag:")
    assert "(method ab-array, pass store; " in ended.complaint


# --- shader --------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", catalog())
def test_every_methods_glsl_is_printed_expanded(mfr, method):
    ended = mfr("shader", method)
    assert ended.status == 0
    drawn = {p.name for p in catalog()[method].variant({}).passes if p.kind != "clear"}
    assert {name for name in drawn if f"// {method}, pass {name}: " in ended.out} == drawn
    assert "#include" not in ended.out
    assert ended.out.count("void main()") == ended.out.count("#version")


def test_one_pass_with_defines_in_place(mfr):
    ended = mfr("shader", "kplus-array", "--pass", "store", "--set", "k=13")
    assert "#define K 13\n" in ended.out
    heads = [line for line in ended.out.splitlines() if line.startswith("// kplus-array, pass ")]
    assert len(heads) == 2
    assert all(line.startswith("// kplus-array, pass store: ") for line in heads)


def test_set_wins_over_what_the_config_fixes_for_a_method(mfr, here):
    (here / "fixed.yaml").write_text(TINY.replace("kplus-array]", "{id: kplus-array, sort: shell}]"))
    for chosen, others in (("shell", "insertion"), ("insertion", "shell")):
        out = mfr("shader", "kplus-array", "--pass", "resolve", "--config", "fixed.yaml", "--set", f"sort={chosen}").out
        assert f"#define SORT_{chosen.upper()} 1" in out
        assert f"#define SORT_{others.upper()} 0" in out
    assert "#define SORT_SHELL 1" in mfr("shader", "kplus-array", "--pass", "resolve", "--config", "fixed.yaml").out


def test_what_is_printed_is_what_compiles(device, odd, here, mfr):
    """The text that the device gets; programs are known by what is left of its code: branches chosen, macros in use."""
    mfr("render", odd, "--method", "ab-array", "--out", "a.npy")
    text = mfr("shader", "ab-array", "--pass", "resolve", "--config", odd).out
    drawn = [stage for key in device.programs for stage in key]
    stages = text.split("// ab-array, pass resolve: ")[1:]
    assert len(stages) == 2
    assert all(compiled(code_of(stage.partition("\n")[2].removesuffix("\n"))) in drawn for stage in stages)


def test_glslang_accepts_what_is_printed(mfr, here):
    """The reference compiler, where it is installed, judges without a GPU."""
    try:
        subprocess.run(["glslangValidator", "--version"], capture_output=True, check=True)
    except OSError:
        pytest.skip("glslangValidator is not installed")
    text = mfr("shader", "kplus-array", "--pass", "store").out
    fragment = text.rpartition("// kplus-array, pass store: ")[2].partition("\n")[2]
    (here / "store.frag").write_text(fragment)
    assert subprocess.run(["glslangValidator", here / "store.frag"], capture_output=True, check=False).returncode == 0


@pytest.mark.parametrize("each", [m for m in catalog().values() if m.params], ids=lambda m: m.id)
def test_any_parameter_of_any_method_may_be_set_whatever_the_config_lists(here, each):
    """`render CONFIG --method M --set NAME=VALUE`, in the README's own form, where the config lists another method."""
    other = "ab-array" if each.id != "ab-array" else "kplus-array"
    (here / "other.yaml").write_text(f"name: other\nscene: {{size: [8, 8], depth_complexity: 4}}\nmethods: [{other}]\n")
    for param in each.params:
        value = param.choices[-1] if param.choices else param.default
        _, variant = _first_cell("other.yaml", each, None, (f"{param.name}={value}",))
        assert variant.params == each.complete({param.name: value})


def test_a_value_that_another_listed_method_refuses_may_be_set(mfr):
    """`touched: tiles` of the config `smoke`, where peeling has no such way; its figures name the labels of others."""
    assert "TILE" in mfr("shader", "kplus-array", "--set", "touched=tiles").out
    refused = mfr("shader", "kplus-array", "--set", "touched=tile")
    assert (refused.status, refused.err.count("\n")) == (2, 1)


def test_a_parameter_that_the_method_lacks_is_one_line(mfr, here):
    (here / "other.yaml").write_text("name: other\nscene: {size: [8, 8], depth_complexity: 4}\nmethods: [ab-array]\n")
    ended = mfr("render", "other.yaml", "--method", "kplus-array", "--set", "kk=5", "--out", "o.png")
    assert ended.status == 2
    assert ended.err.count("\n") == 1


def test_the_table_of_rounding_is_the_one_of_the_docs(mfr):
    printed = mfr("methods", "--rounding").out
    assert printed.count("\n") > 3
    assert printed in (ROOT / "docs" / "accuracy.md").read_text()


# --- a device that is not there ------------------------------------------------------------------

TAKE_A_DEVICE = {
    "run": ["smoke"], "stress": ["equal-depths"], "methods": [], "doctor": [], "check": ["kplus-array"],
    "decide": ["--size", "16x16", "--layers", "2"], "render": ["smoke", "--method", "ab-array", "--out", "a.npy"],
    "scene": ["smoke", "--fragments", "f.npz"], "versus": [ROOT, ROOT, "smoke"],
}


def test_every_command_with_a_device_is_tried():
    assert {name for name, command in cli.commands.items() if "device" in {p.name for p in command.params}} == {
        *TAKE_A_DEVICE}


@pytest.mark.parametrize("command", [*TAKE_A_DEVICE, "run --dry-run"])
def test_a_device_that_is_not_there_is_2_with_those_that_are(device, here, command):
    name, *more = command.split()
    ended = apart(name, *TAKE_A_DEVICE[name], *more, "--device", "99")
    assert ended.status == 2
    whose = f"versus: {ROOT}: " if command == "versus" else ""
    assert ended.complaint.startswith(f"{whose}--device 99: no such device; allowed: auto, gpu, cpu, or an index, ")
    assert device.info["renderer"] in ended.complaint
