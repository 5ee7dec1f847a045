"""`mfr-bench check` of scenes and effects, and the packages that `new-scene` and `new-effect` write."""

import math
import os
import re
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from mfr_bench.contract import of_effect, of_scene, suite
from mfr_bench.contract.cases import stage
from mfr_bench.effects import EFFECTS, OWN_EFFECTS, PLAIN, Case, Effect, bring
from mfr_bench.errors import MfrError
from mfr_bench.methods.spec.maker import Maker, Number
from mfr_bench.scene import Scene

from .test_effects import EXAMPLE as MEDIAN
from .test_effects import GLSL, MODEL, changed
from .test_outside import mfr
from .test_scenes import EXAMPLE as SPIRAL
from .test_scenes import MAKER


def copied(example, folder):
    """A copy of an example in a folder, or the one that is there."""
    if not (folder / example.name).exists():
        shutil.copytree(example, folder / example.name, ignore=shutil.ignore_patterns("__pycache__"))
    return folder / example.name


@pytest.mark.parametrize(("command", "name", "declared", "own", "others"), [
    ("new-scene", "two-rings", "two_rings", "two_rings/two_rings.py", r"\bspiral[-_]scene|maker: spiral"),
    ("new-effect", "far-half", "far_half", "far_half/shaders/effects/far_half.glsl", "median"),
])
def test_what_is_written_is_renamed_and_keeps_its_contract(tmp_path, monkeypatch, command, name, declared, own, others):
    """The package under another name passes every check as it is, and its config can be planned."""
    monkeypatch.setenv("MFR_BENCH_SCENES", str(tmp_path / "cache"))
    done = mfr(tmp_path, command, name)
    assert done.returncode == 0, done.stderr
    files = {path.relative_to(tmp_path) for path in (tmp_path / name).rglob("*") if path.is_file()}
    *written, named, following = done.stdout.splitlines()
    assert {Path(line) for line in written} == files and Path(name, own) in files
    assert named.endswith(f" is named {declared}, since the name of a Python module has no hyphen")
    assert following == f"next: mfr-bench check {declared} --methods {name}"
    assert not any(re.search(others, f"{path}\n{(tmp_path / path).read_text()}") for path in files)
    checked = mfr(tmp_path, "check", declared, "--methods", name)
    assert checked.returncode == 0 and checked.stdout.endswith(f"{declared}: every check passed\n"), checked.stdout
    planned = mfr(tmp_path, "run", f"{name}/{name}.yaml", "--methods", name, "--dry-run")
    assert planned.returncode == 0, planned.stderr
    assert mfr(tmp_path, command, name).returncode == 2


@pytest.mark.parametrize(("example", "file", "name"), [
    (SPIRAL, MAKER, "spiral"), (MEDIAN, MODEL, "median")])
def test_a_folder_that_declares_nothing_is_named(tmp_path, example, file, name):
    """An empty file, as an editor leaves it before the first line is written."""
    folder = copied(example, tmp_path)
    (folder / file).write_text("")
    done = mfr(tmp_path, "check", name, "--methods", example.name)
    said, unknown = done.stderr.splitlines()
    assert done.returncode == 2 and unknown.startswith(f"NAME: unknown method, scene or effect {name!r}")
    assert said.startswith(f"{(folder / file).parent}: declares no method, scene or effect; allowed: a file with ")


@pytest.mark.parametrize(("command", "name", "said"), [
    ("new-effect", "layers", "new-effect: 'layers' is an effect already; allowed: a name of its own"),
    ("new-scene", "Two_rings", "new-scene: 'Two_rings' is no name of a scene; allowed: small letters and digits"),
    ("check", "thicknes", "NAME: unknown method, scene or effect 'thicknes'; nearest: 'thickness'; allowed: "),
])
def test_a_name_that_does_not_do_is_one_line(tmp_path, command, name, said):
    done = mfr(tmp_path, command, name)
    assert done.returncode == 2 and not done.stdout
    line, = done.stderr.splitlines()
    assert line.startswith(said)


@pytest.fixture
def broken_scene(tmp_path, monkeypatch):
    """The entry and the config of the example's scene, with a text of its module replaced."""
    def of(right, wrong):
        folder = copied(SPIRAL, tmp_path)
        changed(folder, MAKER, right, wrong)
        maker = Maker("arms", {"arms": Number(3, 1, 64), "layers": Number(8, 1, 256), "turns": Number(2.0, 0.0, 16.0)},
                      {"name": "spiral-scene", "version": None, "hash": "0"}, str(folder / "spiral_scene"))
        monkeypatch.setattr("mfr_bench.scene.made.scene_makers", lambda: {"spiral": maker})
        monkeypatch.setenv("MFR_BENCH_SCENES", str(tmp_path / "cache"))
        return maker, Scene(kind="outside", maker="spiral", size=of_scene.SIZE, depth_complexity=0, order="file")

    return of


@pytest.mark.parametrize(("right", "wrong", "check", "said"), [
    ("default_rng(seed)", "default_rng()", of_scene.same_each_time, "seed 1: pixel differs from one time to the next"),
    ("np.mgrid[:height, :width]", "np.mgrid[:40, :48]", of_scene.every_size,
     "^size 1x1: scene spiral: pixel of fragment 0 is .*; allowed: x y from the lower left, within the viewport"),
    ("on_arm.sum())", "0 * on_arm.sum())", of_scene.every_size, "size 48x40: scene spiral: .*ValueError"),
    ("< 0.5", "< 0.0", of_scene.every_size, "no fragment in 48x40 pixels with every key at its default"),
], ids=["seed", "size", "raises", "empty"])
def test_a_scene_that_breaks_its_contract_is_found(broken_scene, right, wrong, check, said):
    _, scene = broken_scene(right, wrong)
    assert re.search(said, "\n".join(check(scene)))


def test_the_bounds_of_keys_are_tried(broken_scene):
    maker, scene = broken_scene("layers + 1, on_arm", "9 - layers // 200, on_arm")
    assert list(of_scene.every_bound(maker, scene)) == []
    maker, scene = broken_scene("9 - layers // 200", "9 - layers // 20")
    line, = of_scene.every_bound(maker, scene)
    assert line.startswith("layers=256: scene spiral: ") and "ValueError" in line


@pytest.mark.parametrize(("number", "ends"), [
    (Number(3, 1, 64), [1, 64]), (Number(3, 0.5, 7.5), [1, 7]), (Number(0.5, 0.0, math.inf), [0.0]),
    (Number(0.5, 0.25, 4.0), [0.25, 4.0])])
def test_bounds_are_values_that_the_key_takes(number, ends):
    assert of_scene.bounds_of(number) == ends and [number.parse(str(end)) for end in ends] == ends


def test_a_scene_whose_fragments_share_a_depth_is_told(device, broken_scene):
    broken_scene("(random.permutation(len(pixel)) + 0.5) / max(len(pixel), 1)", "np.full(len(pixel), 0.5)")
    _, scene = broken_scene("random.integers(1, layers", "random.integers(layers, layers")
    line, = of_scene.can_be_compared(device, scene)
    assert re.fullmatch(r"every one of \d+ covered pixels has fragments of one depth and different colours", line)


@pytest.fixture
def broken_effect(tmp_path):
    """The checks of the example's effect, with a text of its module replaced."""
    def of(right, wrong, **entry):
        changed(copied(MEDIAN, tmp_path), MODEL, right, wrong)
        effect = replace(Effect("the middle", ordered=True, place=str(tmp_path / MEDIAN.name / "median_layer"),
                                package={"name": "median-layer", "version": None, "hash": "0"}), **entry)
        bring({"median": effect})
        return dict(of_effect.checks(None, "median", effect, tmp_path))

    yield of
    bring({})


FRAGMENTS = ((0.2, (255, 0, 0, 128)), (0.4, (0, 255, 0, 64)))
CASES, COLOURS, ALONE, SAYS = (
    "the model shows the cases of the entry", "the model gives premultiplied colours, and nothing without fragments",
    "the model takes each pixel by itself", "the model keeps to what the entry says it reads")


@pytest.mark.parametrize(("right", "wrong", "entry", "check", "said"), [
    ("(rays.counts - 1) // 2", "rays.counts // 2", {"cases": (Case(FRAGMENTS, (1.0, 0.0, 0.0, 1.0)),)}, CASES,
     r"case 1: the model shows \[0.0, 1.0, 0.0, 1.0\], the case has \[1.0, 0.0, 0.0, 1.0\]"),
    ("(rays.counts - 1) // 2", "rays.counts // 2", {"ordered": False}, SAYS,
     "equal depths: the order of fragments of one depth matters; allowed: with ordered=True"),
    ("    return image", "    return image * rays.depth.max(initial=0.5)", {}, SAYS, "differences of depth matter"),
    ("    return image", "    return image / settings.layer", {}, SAYS, "layer matters; allowed: with 'layer' in the"),
    ("    return image", "    image[:, 3] = 1.0\n    return image", {}, COLOURS, "a colour where there is no fragment"),
    ("/ 255.0, 1.0", "/ 128.0, 1.0", {}, COLOURS, "closed objects: a colour below 0, above its opacity"),
    ("rays.rgba[middle, :3]", "rays.rgba[middle[::-1], :3]", {}, ALONE, "closed objects: a pixel shows .* among"),
], ids=["case", "ordered", "lengths", "key", "empty", "colour", "alone"])
def test_a_model_that_breaks_its_contract_is_found(broken_effect, right, wrong, entry, check, said):
    found = "\n".join(broken_effect(right, wrong, **entry)[check]())
    assert re.search(said, found), found


def test_the_model_of_the_example_keeps_its_contract(broken_effect):
    found = broken_effect("", "", cases=(Case(FRAGMENTS, (1.0, 0.0, 0.0, 1.0)),))
    assert [fault for name in (CASES, COLOURS, ALONE, SAYS) for fault in found[name]()] == []


def test_glsl_that_differs_from_its_model_is_found(tmp_path):
    changed(copied(MEDIAN, tmp_path), GLSL, "(median_count - 1u) / 2u", "median_count / 2u")
    done = mfr(tmp_path, "check", "median", "--methods", MEDIAN.name)
    assert done.returncode == 3 and "Traceback" not in done.stderr, done.stdout + done.stderr
    assert re.findall("^FAILED +(.*)", done.stdout, re.MULTILINE) == ["methods draw what the model computes"]
    assert {"ab-array", "kplus-array-k=4"} <= set(re.findall(r"^ +(\S+), closed objects: the image is off by",
                                                              done.stdout, re.MULTILINE))


@pytest.mark.parametrize("name", [name for name in OWN_EFFECTS if name != PLAIN.name])
def test_effects_of_the_program_keep_the_contract(device, tmp_path, name):
    found = list(suite.run(of_effect.checks(device, name, EFFECTS[name], tmp_path)))
    assert [(each.name, each.faults) for each in found if each.faults] == [] and len(found) == 5


@pytest.mark.parametrize(("fragments", "keys"), [
    ((0.5,), {}), (((0.5, (1, 2, 3)),), {}), (((0.5, (1, 2, 3, 256)),), {}), (((2.0, (1, 2, 3, 4)),), {}),
    (((0.5, (1, 2, 3, 4)), (0.4, (1, 2, 3, 4))), {}), (((0.5, (1, 2, 3, 4), 0, True),), {}), ((), {"layer": 2}),
], ids=["tuple", "colour", "channel", "depth", "order", "object", "key"])
def test_a_case_that_is_none_says_what_is_allowed(fragments, keys):
    case = Case(fragments, (0.0, 0.0, 0.0, 0.0), keys)
    with pytest.raises(MfrError, match=r"^case 1 (is|has) .*; allowed: "):
        of_effect.rays_of_case(case, Effect("nothing"), "case 1")


def test_a_case_of_an_effect_on_objects_has_objects_and_fronts():
    thickness = replace(EFFECTS["thickness"], cases=(
        Case(((0.25, (0, 0, 0, 255), 0, True), (0.75, (0, 0, 0, 255), 0, False)), (0.5, 0.5, 0.5, 1.0)),))
    rays = of_effect.rays_of_case(thickness.cases[0], thickness, "case 1")
    assert rays.counts.tolist() == [2] and rays.rgba.shape == (2, 4)


def test_a_scene_that_became_another_under_its_name_is_drawn_anew(broken_scene, device):
    """What one process keeps of a scene is kept by what is in it, not by its name alone."""
    _, scene = broken_scene("% 1 < 0.5", "% 1 < 0.4")
    few = stage(device, scene).stats.F
    _, scene = broken_scene("% 1 < 0.4", "% 1 < 0.9")
    shutil.rmtree(os.environ["MFR_BENCH_SCENES"])
    assert 1.5 * few < stage(device, scene).stats.F
