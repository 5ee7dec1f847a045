"""Effects: what a method does with the sorted fragments of a pixel, against the float64 model and by hand."""

from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from mfr_bench.config.model import Measure
from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.effects import EFFECTS, TRANSPARENCY, Settings
from mfr_bench.gpu.single import shown
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import SCENE_FACTS
from mfr_bench.plan import Cell, judge
from mfr_bench.resources import shaders_dir
from mfr_bench.scene import generate
from mfr_bench.store.status import EXACT_ERROR

BLOCK = {"size": (24, 20), "depth_complexity": 6, "seed": 3, "pixel_density": 0.8, "fragment_probability": 0.7}
SCENES = {
    "layers": SceneConfig(**BLOCK, effect="layers", layer=3),
    "x-ray": SceneConfig(**BLOCK, effect="layers", layer=0),
    "coplanar": SceneConfig(**BLOCK, effect="coplanar", depth_copies=3),
}


def variant_of(method):
    return method.variant({"atomic64": "emulated"} if method.param("atomic64") else {})


EXACT = [m for m in catalog().values() if variant_of(m).hands_on and variant_of(m).guarantee.startswith("exact")]


@pytest.fixture(scope="module")
def stages(device):
    with shown(device, generate(SCENES["layers"])) as layers, shown(device, generate(SCENES["x-ray"])) as rays, \
            shown(device, generate(SCENES["coplanar"])) as coplanar:
        yield dict(zip(SCENES, (layers, rays, coplanar), strict=True))


@pytest.mark.parametrize("method", EXACT, ids=lambda m: m.id)
def test_every_exact_method_that_hands_fragments_on_agrees_with_the_models(method, stages, device):
    """Each method gives the model's image, of all fragments or of the k nearest, as it promises."""
    variant = variant_of(method)
    if not device.features.issuperset(variant.needs):
        pytest.skip(f"needs {', '.join(variant.needs)}")
    for name, on in stages.items():
        found = on.errors(variant, on.render(variant))
        assert found["max_abs_error"] <= EXACT_ERROR, name


@pytest.mark.parametrize("chosen", [{"sort": "lplus"}, {"sort": "register"}, {"sort": "insertion"}, {"bma": "on"},
                                    {"resolve": "compute"}, {"payload": "rgba16f"}], ids=str)
def test_every_way_to_resolve_agrees_with_the_models(chosen, stages):
    variant = catalog()["ab-array"].variant(chosen)
    for name, on in stages.items():
        assert on.errors(variant, on.render(variant))["max_abs_error"] <= EXACT_ERROR, name


@pytest.mark.parametrize(("method", "chosen"), [("wboit", {}), ("peel-f2b", {}), ("ab-ll-bucket", {}),
                                                ("ab-array", {"stop_opacity": 0.9}),
                                                ("ab-array", {"accumulate": "compensated"}),
                                                ("ab-array", {"payload": "two_channel"})])
def test_what_does_not_hand_fragments_on_is_unsupported_and_says_why(method, chosen, stages):
    declared, config = catalog()[method], SCENES["layers"]
    params = declared.complete(chosen)
    cell = Cell("effects", method, method, params, config, Measure(), {})
    said = judge(cell, catalog(), stages["layers"].stats, None)
    assert said[0] == "unsupported" and SCENE_FACTS["blended"] in said[1]


@pytest.mark.parametrize("effect", EFFECTS)
def test_keys_that_are_no_depths_have_no_lengths(effect, stages):
    """Scaled depths of KB-MDT gave lengths near 0, without notice; their order is good for the other effects."""
    params = catalog()["kb-mdt32"].complete({"key": "fixed", "k": 8})
    cell = Cell("effects", "kb-mdt32", "kb-mdt32", params, SCENES["layers"], Measure(), {})
    said = judge(cell, catalog(), replace(stages["layers"].stats, effect=Settings(effect)), None)
    assert said == (("unsupported", f"needs {SCENE_FACTS['lengthless']}") if EFFECTS[effect].measures else None)


def test_the_layers_of_a_pixel_are_its_quads_by_depth(device):
    """Opaque quads of known depths: layer n shows the n-th, and none where there are fewer."""
    for layer in (1, 4, 7):
        scene = generate(SceneConfig(size=(4, 4), depth_complexity=6, seed=5, effect="layers", layer=layer))
        with shown(device, scene) as on:
            image = on.render(catalog()["ab-ll"].variant({}))
        wanted = [*scene.rgba[scene.depth_order[layer - 1], :3] / 255, 1] if layer <= 6 else [0, 0, 0, 0]
        np.testing.assert_allclose(image, np.broadcast_to(wanted, image.shape), atol=1e-6)


def test_a_k_buffer_sees_no_layer_behind_its_k(stages):
    """Its image is right of what it keeps, and misses what it does not."""
    on = stages["layers"]
    variant = catalog()["kplus-array"].variant({"k": 2})
    image = on.render(variant)
    assert on.errors(variant, image)["max_abs_error"] == 0 and not image.any()


def test_coplanar_fragments_are_counted(device):
    """Six quads in groups of three at one depth: all share theirs, in groups of 3 sixteenths."""
    with shown(device, generate(SceneConfig(size=(8, 8), depth_complexity=6, depth_copies=3, effect="coplanar"))) as on:
        image = on.render(catalog()["ab-ll"].variant({}))
    np.testing.assert_array_equal(image, np.broadcast_to(np.float32([1, 3 / 16, 0, 1]), image.shape))


def test_records_of_scenes_without_an_effect_know_none():
    assert not {"effect", "layer"} & SceneConfig(size=(8, 8), depth_complexity=2).as_dict().keys()
    record = SceneConfig(size=(8, 8), depth_complexity=2, effect="layers", layer=4).as_dict()
    assert (record["effect"], record["layer"]) == ("layers", 4)


@pytest.mark.parametrize("name", [name for name in EFFECTS if name != TRANSPARENCY])
def test_every_effect_has_a_shader_a_model_and_a_row_in_the_docs(name):
    assert (shaders_dir() / "effects" / f"{name}.glsl").is_file()
    assert callable(import_module(f"mfr_bench.effects.{name}").model)
    page = Path(__file__).parents[2] / "docs" / "effects.md"
    row = next(line for line in page.read_text().splitlines() if line.startswith(f"| `{name}` |"))
    assert all(f"`{key}`" in row for key in EFFECTS[name].keys)


def test_the_default_is_the_effect_that_changes_nothing():
    assert next(iter(EFFECTS)) == TRANSPARENCY == SceneConfig(size=(8, 8), depth_complexity=2).effect
