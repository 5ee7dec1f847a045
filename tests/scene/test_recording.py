"""Recorded fragments: written from any scene, drawn by every method, refused in a line where they do not hold."""

import re

import moderngl
import numpy as np
import pytest

from mfr_bench.config import load
from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.errors import UsageError
from mfr_bench.gpu.capture import capture
from mfr_bench.gpu.single import shown
from mfr_bench.gpu.targets import BareFramebuffer
from mfr_bench.gpu.trial_alone import primitive_numbers
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Promise
from mfr_bench.oracle.composite import composite, fragment_counts, stats_of
from mfr_bench.oracle.listed import counts_of, listed, recorded, recorded_quads
from mfr_bench.plan import expand, expected_stats
from mfr_bench.resources import configs_dir
from mfr_bench.scene import generate
from mfr_bench.scene.recording import Recording, recording_of, samples_of

FLAT = [SceneConfig(size=(97, 71), depth_complexity=9, layout="mixed", mean_depth=5, seed=4),
        SceneConfig(size=(97, 71), depth_complexity=9, layout="tiles", pixel_density=0.5, fragment_probability=0.4),
        SceneConfig(size=(33, 20), depth_complexity=9, least_depth=0.3), SceneConfig(size=(5, 3), depth_complexity=0)]
METHODS = ("ab-array", "ab-ll", "peel-f2b", "peel-srab", "kplus-array", "floor")
PAGE = configs_dir().parent / "docs" / "recording.md"


@pytest.fixture
def scene_of(tmp_path):
    """scene_of(path or Recording, 'order: file') -> the scene of a config that draws it."""
    def made(source, keys="order: file", size=None):
        path = source
        if isinstance(source, Recording):
            path = tmp_path / "recorded.npz"
            path.write_bytes(source.packed())
            size = source.viewport
        config = tmp_path / "f.yaml"
        config.write_text(f"name: f\nscene: {{kind: fragments, file: {path.name}, size: {list(size)}, {keys}}}\n"
                          "methods: [ab-array]\n")
        return expand(load(str(config), catalog())[0], catalog())[0].scene
    return made


@pytest.mark.parametrize("config", FLAT)
def test_listing_fragments_is_compositing_by_patches(config):
    scene = generate(config)
    assert (counts_of(scene) == fragment_counts(scene)).all()
    for promise in (Promise(), Promise(3), Promise(3, "furthest"), Promise(3, "opaque")):
        np.testing.assert_allclose(listed(scene).composite(promise.layers, promise.criterion),
                                   composite(scene, promise.layers, promise.criterion), rtol=0, atol=1e-12)


@pytest.mark.parametrize("config", FLAT)
def test_a_recording_of_quads_is_the_same_scene_for_the_oracle_and_for_methods(config, device, scene_of):
    original = generate(config)
    found = recorded_quads(original)
    scene = scene_of(found)
    with shown(device, generate(scene)) as on:
        assert on.stats.histogram == stats_of(original).histogram == expected_stats(scene).histogram
        assert on.stats.F == len(found) == expected_stats(scene).primitives
        np.testing.assert_allclose(on.truth.image(Promise()), composite(original), rtol=0, atol=1e-12)
        for name in METHODS:
            method = catalog()[name].variant({})
            image = on.render(method)
            assert (on.errors(method, image) or {"max_abs_error": 0})["max_abs_error"] <= 1e-4, name


def test_a_recording_of_a_mesh_has_its_fragments_objects_and_sides(device, scene_of, tmp_path):
    one, two = "o one\nv 0 0 0\nv 4 0 0\nv 0 4 0\nf 1 2 3\n", "o two\nv 0 0 1\nv 4 0 1\nv 0 4 1\nf 4 6 5\n"
    (tmp_path / "a.obj").write_text(one + two)
    mesh = SceneConfig(kind="mesh", size=(16, 16), depth_complexity=0, file=str(tmp_path / "a.obj"), alpha=(0.5, 0.5),
                       order="file")
    with shown(device, generate(mesh)) as on:
        found, image = recorded(capture(device, on.scene_buffer, on.canvas)), on.truth.image(Promise())
    assert sorted(set(found.object.tolist())) == [0, 1]
    assert (found.front == (found.object == 0)).all()
    assert (np.diff(found.object) >= 0).all()  # in order of submission
    with shown(device, generate(scene_of(found))) as on:
        np.testing.assert_array_equal(on.truth.image(Promise()), image)
        again = recorded(on.truth._fragments)
    for name in ("pixel", "depth", "rgba", "object", "front"):
        np.testing.assert_array_equal(getattr(again, name), getattr(found, name))


def recording(**arrays):
    given = {"pixel": [[0, 0], [1, 0], [0, 0], [1, 0]], "depth": [0.25, 0.5, 0.75, 0.5],
             "rgba": [[255, 0, 0, 128], [0, 255, 0, 128], [0, 0, 255, 128], [9, 9, 9, 128]]} | arrays
    types = {"pixel": np.int32, "depth": np.float32, "rgba": np.uint8}
    return Recording((2, 1), **{name: np.array(values, types.get(name)) for name, values in given.items()})


def test_depths_that_a_device_may_take_for_0_are_0(scene_of):
    """GLSL lets a device take float32 below the least normal one for 0: one that does has them in any order."""
    pixel = [[1, 0]] * 3
    least = float(np.finfo(np.float32).tiny)
    found = generate(scene_of(recording(pixel=pixel, depth=[1e-40, 1e-45, least], rgba=[[9, 9, 9, 128]] * 3)))
    assert found.depth.tolist() == [0, 0, least]


def test_pixels_with_two_fragments_of_one_depth_are_tied(device, scene_of):
    with shown(device, generate(scene_of(recording()))) as on:
        assert on.truth.answer(Promise()).tied.tolist() == [[False, True]]
        method = catalog()["ab-array"].variant({})
        assert on.errors(method, on.render(method))["tied_pixels"] == 1


@pytest.mark.parametrize(("order", "depths"), [
    ("file", [0.25, 0.5, 0.75, 0.5]), ("front_to_back", [0.25, 0.5, 0.5, 0.75]),
    ("back_to_front", [0.75, 0.5, 0.5, 0.25])])
def test_orders(scene_of, order, depths):
    assert generate(scene_of(recording(), f"order: {order}")).depth.tolist() == depths


def test_a_random_order_is_the_same_for_a_seed(scene_of):
    one, again = (generate(scene_of(recording(), "seed: 3")) for _ in range(2))
    assert one.depth.tolist() == again.depth.tolist()
    assert sorted(one.depth.tolist()) == [0.25, 0.5, 0.5, 0.75]


def test_a_record_names_the_file_and_its_contents_but_no_folder(scene_of, tmp_path):
    first = scene_of(recording()).as_dict()
    assert first["files"] == ["recorded.npz"] and str(tmp_path) not in str(first)
    assert scene_of(recording(depth=[0.25, 0.5, 0.75, 0.6])).as_dict()["digest"] != first["digest"]


GOOD = {"viewport": np.int32([2, 1]), "pixel": np.int32([[0, 0]]), "depth": np.float32([0.5]),
        "rgba": np.uint8([[1, 2, 3, 4]])}
BAD = [
    ({"viewport": None}, "the array viewport is missing; allowed: viewport, pixel, depth, rgba"),
    ({"depth": None}, "the array depth is missing; allowed: viewport, pixel, depth, rgba"),
    ({"viewport": np.int32([2, 0])}, "viewport is int32 [2, 0]; allowed: int32 width and height, each from 1 to 16384"),
    ({"pixel": np.int32([0, 0])}, "pixel is int32 (2,); allowed: int32 (1, 2)"),
    ({"pixel": np.float32([[0, 0]])}, "pixel is float32 (1, 2); allowed: int32 (1, 2)"),
    ({"pixel": np.int32([[2, 0]])}, "pixel of fragment 0 is [2, 0]; allowed: x y from the lower left"),
    ({"depth": np.float32([np.nan])}, "depth of fragment 0 is nan; allowed: a number from 0 to 1"),
    ({"depth": np.float32([1.5])}, "depth of fragment 0 is 1.5; allowed: a number from 0 to 1"),
    ({"depth": np.float64([0.5])}, "depth is float64 (1,); allowed: float32 (1,)"),
    ({"rgba": np.uint8([[1, 2, 3]])}, "rgba is uint8 (1, 3); allowed: uint8 (1, 4)"),
    ({"front": np.int32([1])}, "front is int32 (1,); allowed: bool (1,)"),
    ({"object": np.int32([1, 2])}, "object is int32 (2,); allowed: int32 (1,)"),
    ({"rgba": np.array([[None] * 4])}, "cannot be read (Object arrays cannot be loaded when allow_pickle=False); "),
]


@pytest.mark.parametrize(("change", "line"), BAD)
def test_a_bad_file_is_one_line(tmp_path, change, line):
    path = tmp_path / "bad.npz"
    np.savez(path, **{name: values for name, values in (GOOD | change).items() if values is not None})
    with pytest.raises(UsageError) as error:
        recording_of(path)
    assert len(error.value.lines) == 1 and "\n" not in error.value.lines[0]
    assert error.value.lines[0].startswith(f"{path}: {line}")


@pytest.mark.parametrize("data", [b"", b"no archive", "cut"])
def test_a_damaged_file_is_one_line(tmp_path, data):
    path = tmp_path / "bad.npz"
    path.write_bytes(recording().packed()[:-40] if data == "cut" else data)
    with pytest.raises(UsageError, match=r"bad.npz: cannot be read \(.*record it again"):
        recording_of(path)


def test_more_than_the_memory_holds_is_refused_before_it_is_read(tmp_path, monkeypatch):
    path = tmp_path / "big.npz"
    path.write_bytes(recording().packed())
    monkeypatch.setattr("mfr_bench.scene.recording.MEMORY_MB", 1e-3)
    with pytest.raises(UsageError, match=r"above the limit of 0 MiB; allowed: fewer fragments"):
        recording_of(path)


@pytest.mark.parametrize(("keys", "line"), [
    ("alpha: 0.5", "alpha has no use in kind fragments"), ("order: object", "order 'object' has no use"),
    ("fragment_probability: 0.5", "fragment_probability has no use in kind fragments")])
def test_keys_that_a_recording_has_no_use_for(scene_of, keys, line):
    with pytest.raises(UsageError, match=line):
        scene_of(recording(), keys)


def test_the_viewport_is_the_file_s(scene_of):
    scene = scene_of(recording())
    with pytest.raises(UsageError, match=r"\[4, 4\] where recorded.npz has \[2, 1\] pixels; allowed: the viewport of"):
        scene_of(scene.file_path, size=(4, 4))


# --- the page ---

VERTICES = """#version 430 core
in vec3 at;
in vec4 tint;
out vec4 colour;
void main() { gl_Position = vec4(at, 1.0); colour = tint; }
"""


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


def recorded_by(shader, device, samples):
    """The count and the bytes of the list that the page's shader leaves of two draw calls of two triangles each."""
    ctx = device.ctx
    program = ctx.program(vertex_shader=VERTICES, fragment_shader=shader)
    count, nodes = ctx.buffer(bytes(4)), ctx.buffer(reserve=24 * 64)
    target = BareFramebuffer(device.gl, (4, 4), samples)
    target.use(colour=False, depth=False)
    ctx.disable(moderngl.CULL_FACE)
    corners = np.float32([[-1, -1], [1, -1], [-1, 1], [1, 1]])
    program["capacity"] = 64
    for draw, (z, tint, order) in enumerate([(0.5, (1, 0, 0, 0.5), (0, 1, 2, 2, 1, 3)),
                                             (-0.5, (0, 1, 0, 0.25), (0, 2, 1, 2, 3, 1))]):
        program["draw_call"] = draw
        data = np.float32([[*corners[i], z, *tint] for i in order])
        count.bind_to_storage_buffer(0)
        nodes.bind_to_storage_buffer(1)
        ctx.vertex_array(program, [(ctx.buffer(data.tobytes()), "3f 4f", "at", "tint")]).render()
    ctx.memory_barrier()
    found = int(np.frombuffer(count.read(), np.uint32)[0]), nodes.read()
    for made in (count, nodes, target):
        made.release()
    return found


@pytest.mark.parametrize("samples", [1, 4])
def test_the_shader_of_the_page_records_a_file_that_is_drawn(samples, device, scene_of, tmp_path):
    """Two draw calls of two triangles each, of which the second shows its back: 16 fragments, 4 twice in samples."""
    if samples > 1 and f"msaa_{samples}" not in device.features:
        pytest.skip(f"this device does not rasterize into {samples} samples a pixel")
    if not primitive_numbers(device)[0]:
        pytest.skip("this device fails the trial 'primitive numbers'")
    each = 16 if samples == 1 else 20
    shader, = blocks("glsl")
    script, = blocks("python")
    held = {}
    exec(compile(script, str(PAGE), "exec"), held)  # noqa: S102 - the page's own code
    found, written = recorded_by(shader, device, samples)
    path = tmp_path / "page.npz"
    held["write_fragments"](path, (4, 4), found, written, samples)
    read = recording_of(path)
    assert found == len(read) == 2 * each
    assert read.object.tolist() == [0] * each + [1] * each
    assert read.front.tolist() == [True] * each + [False] * each
    assert set(map(float, read.depth[:each])) == {0.75} and set(map(float, read.depth[each:])) == {0.25}
    assert samples_of(path) == samples
    with shown(device, generate(scene_of(path, f"order: file, msaa: {samples}", size=(4, 4)))) as on:
        image = on.render(catalog()["ab-array"].variant({}))
    a, b = (64 / 255, 128 / 255) if samples == 1 else (16 / 63, 32 / 63)
    np.testing.assert_allclose(image[0, 0], [(1 - a) * b, a, 0, 1 - (1 - a) * (1 - b)], atol=1e-6)
