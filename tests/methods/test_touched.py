"""Clears and resolves that touch only what the geometry does: the image is the whole one, whatever stood before."""

from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.gpu import pass_runner as frames
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.scene_buffer import SceneBuffer
from mfr_bench.gpu.targets import Canvas
from mfr_bench.gpu.truth import true_stats
from mfr_bench.gpu.work import work_of
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import IMAGE, TILE_COMMAND, TILE_LIST, Fitted
from mfr_bench.oracle.composite import stats_of
from mfr_bench.scene import generate
from mfr_bench.scene.quads import Quads
from mfr_bench.store.status import EXACT_ERROR

from ..contract.cases import TWO_CLASSES, Drawn, N, label, layers_for, runs_here, stage, variants

BASE = SceneConfig(size=(75, 53), depth_complexity=N, seed=11)
# Quads at random places of which a pixel has so many at most: those of the still scene, and those of the animation.
RANDOM = {N: {"depth_complexity": 2, "seed": 9}, TWO_CLASSES: {"depth_complexity": 3, "seed": 23}}
MOVING = {N: {"depth_complexity": 2, "seed": 7}, TWO_CLASSES: {"depth_complexity": 3, "seed": 8}}


def scenes(layers: int) -> dict[str, SceneConfig]:
    """Scenes that have at most so many fragments in a pixel, all but the last: their programs are the same ones."""
    return {
        **{f"{layout} {density}": replace(BASE, depth_complexity=layers, layout=layout, pixel_density=density)
           for layout in ("block", "tiles") for density in (0.05, 1.0)},
        "random": replace(BASE, layout="random", quad_size=(5, 3), **RANDOM[layers]),
        "crossing": SceneConfig(size=(48, 40), depth_complexity=layers, slant=0.7, layout="mixed", mean_depth=5,
                                seed=10),
        "nothing": replace(BASE, depth_complexity=0),
    }


SCENES = scenes(N)
# Parameters by which full-screen passes come and go, or clear and read other storage.
OPTIONS = {"occupancy", "packed", "insert", "allocation", "scan", "reuse_count", "sync", "multisampling", "precision",
           "moments", "hash", "atomic64", "payload"}
TOUCHING = [m for m in catalog().values() if m.param("touched")]
BY_TILE = [m for m in TOUCHING if "tiles" in m.param("touched").choices]
EXACT = [m for m in BY_TILE if m.guarantee.startswith("exact")]
EACH_CHOICE = pytest.mark.parametrize(("method", "touched"), [
    pytest.param(m, choice, id=f"{m.id}-{choice}") for m in TOUCHING for choice in m.param("touched").choices[1:]])


def in_few(method, **more):
    """The variant with a small k, and emulated atomics where it needs wide ones."""
    wide = method.param("atomic64")
    return method.variant({"k": 4} | ({"atomic64": "emulated"} if wide and wide.acts is None else {}) | more)


def optional(method, touched):
    """The variants with another choice of one of OPTIONS."""
    chosen = [{p.name: c} for p in method.params if p.name in OPTIONS for c in (*p.choices, *p.of) if c != p.default]
    return [in_few(method, touched=touched, **one) for one in ({}, *chosen)]


def resolves(method, touched):
    """The variants with another resolve."""
    stages = [{"resolve": s} for s in ("fragment", "compute")] if method.param("resolve") else [{}]
    classes = [{"bma": on} for on in ("off", "on")] if method.param("bma") else [{}]
    return [in_few(method, touched=touched, **by, **of) for by in stages for of in classes]


def test_scenes_share_their_programs(device):
    """Programs are for the most fragments of a pixel: another number would compile all of them again."""
    for layers in (N, TWO_CLASSES):
        deepest = {name: stage(device, config).stats.n for name, config in scenes(layers).items()}
        assert deepest == dict.fromkeys(SCENES, layers) | {"nothing": 1}
        assert stats_of(animation(layers)[0]).n == layers


@pytest.mark.parametrize("method", catalog().values(), ids=lambda m: m.id)
def test_a_method_without_it_says_why(method):
    """A method has the parameter or a reason, and without its tiles a reason for that."""
    assert (method in TOUCHING) != bool(method.untouched)
    assert method not in TOUCHING or method in BY_TILE or "no tiles, since " in method.param("touched").doc


@pytest.mark.parametrize("method", TOUCHING, ids=lambda m: m.id)
def test_a_pass_that_touches_more_than_the_region_says_why(method):
    """And no other does."""
    for touched in method.param("touched").choices[1:]:
        for variant in variants(method):
            for step in method.variant(variant.params | {"touched": touched}).passes:
                covers = step.kind != "clear" and (step.kind != "geometry" or bool(step.clears))
                assert bool(step.whole) == (covers and not step.region), (step.name, step.shader, label(variant))


@pytest.mark.parametrize("method", EXACT, ids=lambda m: m.id)
def test_every_resolve_by_tiles_is_exact(device, method):
    for variant in resolves(method, "tiles"):
        for name, config in scenes(layers_for(variant)).items():
            drawn = Drawn(device, variant, config, frames=2, probing=True)
            where = f"{label(variant)}, {name}"
            assert drawn.error <= EXACT_ERROR, where
            assert drawn.lost == 0, where
            assert drawn.allocated == drawn.declared or method.family == "open", where
            assert all(held == drawn.kept for counter, held in drawn.probed.items() if counter == "stored_fragments")


def part(scene: Quads, left: int, bottom: int, right: int, top: int) -> Quads:
    """The same quads within a window of the viewport."""
    window = np.clip(scene.rect, [left, bottom] * 2, [right, top] * 2)
    return Quads(scene.viewport, window.astype(np.int32), scene.depth, scene.rgba, 1.0, scene.seed)


def animation(layers: int) -> list[Quads]:
    """Geometry over the whole viewport that shrinks, moves by part of a tile, vanishes, and comes back elsewhere.

    A pixel has few fragments: longer sorts touch no other pixels, and take far longer to compile.
    """
    whole = generate(replace(BASE, layout="random", quad_size=(19, 17), **MOVING[layers]))
    windows = ((0, 0, 75, 53), (37, 9, 61, 30), (40, 15, 75, 47), (0, 0, 0, 0), (1, 1, 18, 16))
    return [part(whole, *window) for window in windows]


@contextmanager
def animated(device, *chosen):
    """The scenes of an animation with their buffer, and a frame of each variant."""
    moving = animation(layers_for(chosen[0]))
    quads, canvas = SceneBuffer(device, moving[0]), Canvas(device, BASE.size)
    stats = true_stats(device, quads, canvas)
    kept = [Frame(device, Fitted(variant, stats), quads, canvas) for variant in chosen]
    try:
        yield moving, *kept
    finally:
        for thing in (*kept, canvas, quads):
            thing.release()


def spoil(frame) -> None:
    """Leave in every buffer, and in the image, what no frame may rely on.

    Whole numbers are small: counts and places that are valid. Fragments have any depth and colour.
    """
    noise = np.random.default_rng(3)
    for buffer in frame.variant.buffers:
        high = 4 if buffer.type == "uint" else 2**32
        if buffer.copies == 1:
            frame.fill(buffer.name, noise.integers(0, high, frame.memory_bytes[buffer.name] // 4))
    texture = frame.canvas.texture
    frame.canvas.framebuffer.use(colour=True, depth=False)
    frame.canvas.framebuffer.clear(texture, (0.25, 0.5, 0.75, 1.0))


def shown(frame, scene) -> np.ndarray:
    """The image of the scene, once everything was spoilt."""
    if frame.scene_buffer.scene is not scene:
        frame.scene_buffer.replace(scene)
    frame.show(scene)
    spoil(frame)
    frame.draw_fitting()
    assert frame.lost_fragments() == 0
    return frame.image()


def differences(device, variant) -> list[float]:
    """Deviation of each frame of the animation from that of the variant that touches the whole viewport."""
    whole = variant.method.variant(variant.params | {"touched": "off"})
    with animated(device, variant, whole) as (moving, frame, other):
        return [float(np.abs(shown(frame, scene) - shown(other, scene)).max()) for scene in moving]


@EACH_CHOICE
def test_geometry_that_moves_leaves_nothing_behind(device, method, touched):
    others = [variant for variant in resolves(method, touched) if variant not in optional(method, touched)]
    for variant in [*optional(method, touched), *others]:
        if runs_here(device, variant):
            assert max(differences(device, variant)) <= 1e-6, label(variant)


@pytest.mark.parametrize(("method", "touched"), [("ab-array", "tiles"), ("peel-f2b", "bounds"), ("kb-sr", "tiles")])
def test_targets_that_are_not_cleared_are_seen(device, monkeypatch, method, touched):
    monkeypatch.setattr(frames.PassRunner, "_clear", lambda *of: None)
    assert max(differences(device, in_few(catalog()[method], touched=touched))) > EXACT_ERROR


@pytest.mark.parametrize(("method", "touched"), [("ab-array", "bounds"), ("peel-dual", "bounds"), ("aoit", "bounds")])
def test_an_image_that_is_not_cleared_beside_the_region_is_seen(device, monkeypatch, method, touched):
    monkeypatch.setattr(frames, "_around", lambda *region: [])
    assert max(differences(device, in_few(catalog()[method], touched=touched))) > EXACT_ERROR


def test_storage_of_no_pixel_that_is_not_cleared_is_seen(device, monkeypatch):
    monkeypatch.setattr(device.gl, "zero", lambda buffer, size: None)
    assert max(differences(device, in_few(catalog()["ab-sb"], touched="bounds"))) > EXACT_ERROR


@pytest.mark.parametrize(("method", "more", "path", "right", "wrong"), [
    ("ab-array", {"touched": "bounds", "resolve": "compute"}, "common/resolve.comp", "!in_extent(xy)", "false"),
    ("ab-array", {"touched": "tiles", "resolve": "compute"}, "common/resolve.comp", "!in_extent(xy)", "false"),
    ("kb-ps", {"touched": "bounds", "resolve": "compute"}, "common/extent.glsl", "FIRST / uint(TILE) + uvec2", "uvec2"),
    ("ab-ll", {"touched": "tiles"}, "common/extent.glsl", "(END - 1u) / uint(TILE) - FIRST / uint(TILE) + 1u",
     "(END - FIRST) / uint(TILE)"),
    ("peel-kplus", {"touched": "tiles"}, "screen/tile.vert", "float(TILE)", "float(TILE) - 1.0"),
], ids=lambda value: value.replace("/", ".") if isinstance(value, str) else "-".join(value.values()))
def test_a_wrong_line_is_seen_where_geometry_moves(device, plant, method, more, path, right, wrong):
    plant(path, right, wrong)
    assert max(differences(device, in_few(catalog()[method], **more))) > EXACT_ERROR


def listed(frame) -> list[int]:
    return sorted(frame.words(TILE_LIST)[:frame.words(TILE_COMMAND)[0]].tolist())


@pytest.mark.parametrize("name", SCENES)
def test_the_list_holds_each_tile_with_fragments_once(device, name):
    on = stage(device, SCENES[name])
    fitted = Fitted(in_few(catalog()["ab-precalc"], touched="tiles"), on.stats)
    frame = Frame(device, fitted, on.scene_buffer, on.canvas)
    try:
        frame.draw_fitting()
        counts = np.flatnonzero(frame.words("counter"))
        tiles = {int(p % on.stats.W // 16 + -(-on.stats.W // 16) * (p // on.stats.W // 16)) for p in counts}
        assert listed(frame) == sorted(tiles)
        assert frame.words(TILE_COMMAND).tolist() == [len(tiles), 1, 0, 0, len(tiles), 1, 1, 0]
    finally:
        frame.release()


def stray_tiles(device) -> int:
    """Tiles that an empty and a small region list beside those with fragments, where all else is spoilt."""
    with animated(device, in_few(catalog()["ab-sb"], touched="tiles")) as (moving, frame):
        shown(frame, moving[3])
        stray = len(listed(frame))
        shown(frame, moving[1])  # columns 32 to 64 and rows 9 to 30
        return stray + len(set(listed(frame)) - {row * 5 + column for row in (0, 1) for column in (2, 3)})


def test_no_tile_is_listed_for_what_stands_beside_the_region(device):
    assert stray_tiles(device) == 0


def test_a_list_that_looks_beside_the_region_is_seen(device, plant):
    plant("common/extent.glsl", "#define END uvec2(region_right, region_top)", "#define END uvec2(width, height)")
    assert stray_tiles(device) > 0


def test_only_listed_tiles_are_resolved(device):
    """The pixels that the resolve's draw passes are those of the tiles with fragments, within the region."""
    on = stage(device, SCENES["block 0.05"])
    frame = Frame(device, Fitted(in_few(catalog()["ab-array"], touched="tiles"), on.stats), on.scene_buffer, on.canvas)
    try:
        frame.draw_fitting()
        *_, columns, rows = frame.region
        work = work_of(frame)
        assert 0 < work["resolve"]["passed"] <= min(columns * rows, 256 * len(listed(frame))) < on.stats.P / 2
        assert work["clear"]["passed"] == columns * rows
    finally:
        frame.release()


@pytest.mark.parametrize("touched", ["bounds", "tiles"])
def test_what_is_cleared_of_the_image_is_counted(device, touched):
    """It is what the resolve leaves out, or with tiles all of it."""
    on = stage(device, SCENES["block 0.05"])
    frame = Frame(device, Fitted(in_few(catalog()["ab-array"], touched=touched), on.stats), on.scene_buffer, on.canvas)
    try:
        frame.draw_fitting()
        *_, columns, rows = frame.region
        cleared = on.stats.P - (columns * rows if touched == "bounds" else 0)
        assert work_of(frame)["resolve"]["cleared"] == cleared
    finally:
        frame.release()


def test_the_image_is_cleared_before_or_beside_every_resolve():
    """In a variant that leaves pixels out, some pass clears the image: the whole, or what is beside the region."""
    for method in TOUCHING:
        for touched in method.param("touched").choices[1:]:
            steps = method.variant({"touched": touched}).passes
            assert any(IMAGE in step.clears for step in steps), (method.id, touched)
