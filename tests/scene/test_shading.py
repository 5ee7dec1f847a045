"""`shading`: steps that a shaded fragment costs and that change no image; nothing of it is there where it is 0."""

import re

import numpy as np
import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.glsl import stages
from mfr_bench.gpu.single import shown
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted
from mfr_bench.plan import expected_stats
from mfr_bench.scene import generate

PLAIN, SHADED = (SceneConfig(size=(24, 20), depth_complexity=6, seed=3, shading=steps) for steps in (0, 5))
FAMILIES = {method.family: method for method in catalog().values()}  # one method of each
EMULATED = {"atomic64": "emulated"}


def geometry_shaders(method, scene):
    """The fragment shaders of the geometry passes of a method, by pass."""
    fitted = Fitted(method.variant({}), expected_stats(scene))
    return [(step.name, stages(fitted, step)[-1].code) for step in fitted.variant.passes if step.kind == "geometry"]


@pytest.mark.parametrize("method", catalog().values(), ids=lambda method: method.id)
def test_what_takes_a_payload_pays_and_nothing_else_changes(method):
    """Without steps the text knows none; with them it has the loop once, wherever payloads are made."""
    plain, shaded = (geometry_shaders(method, scene) for scene in (PLAIN, SHADED))
    assert len(plain) == len(shaded)
    for (_, before), (_, after) in zip(plain, shaded, strict=True):
        assert "SHADING" not in before and "shaded(" not in before
        pays = "PAYLOAD payload_from(uint" in before
        assert (after.count("#define SHADING 5") == 1) is pays and (after.count("uint shaded(") == 1) is pays
        left = re.sub(r"uint shaded\(uint word\) \{.*?\n\}\nPAYLOAD payload_of_shaded\(.*?\n\}\n"
                      r"#define payload_from payload_of_shaded\n", "", after, flags=re.DOTALL)
        assert left.replace("#define SHADING 5\n", "") == before


@pytest.mark.parametrize("method", FAMILIES.values(), ids=lambda method: method.id)
def test_shading_changes_no_image(method, device):
    images, emulated = [], any(param.name == "atomic64" for param in method.params)
    for scene in (PLAIN, SHADED):
        with shown(device, generate(scene)) as on:
            images.append(on.render(method.variant(EMULATED if emulated else {})))
    np.testing.assert_array_equal(*images)


def test_the_steps_never_reach_the_value_that_would_change_a_colour():
    """From any depth, in the device's own precision: the bound that shading.glsl states."""
    x = np.concatenate([np.linspace(0, 1, 10001), [2.0**-126, 1 - 2.0**-24]]).astype(np.float32)
    for _ in range(500):
        x = np.float32(1.5) - x * x
        assert x.min() >= -0.75 and x.max() <= 1.5


@pytest.mark.parametrize("kind", ["quads", "hairball"])
def test_every_kind_takes_it_and_a_record_has_it_only_where_it_is_not_0(kind):
    shaded = SceneConfig(kind=kind, size=(24, 20), depth_complexity=6, shading=7)
    assert generate(shaded).shading == 7 and shaded.as_dict()["shading"] == 7
    assert "shading" not in SceneConfig(kind=kind, size=(24, 20), depth_complexity=6).as_dict()
