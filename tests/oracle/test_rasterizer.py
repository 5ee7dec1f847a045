"""The independent rasterizer: its bounds hold for corners that move, its rules share edges out, faults are seen."""

import numpy as np
import pytest

from mfr_bench.oracle.composite import Fragments
from mfr_bench.oracle.rasterizer.bounds import bounds
from mfr_bench.oracle.rasterizer.cases import CASES, SIZE, before_the_eye, of_clip, of_corners
from mfr_bench.oracle.rasterizer.clipping import polygons
from mfr_bench.oracle.rasterizer.deviation import deviation
from mfr_bench.oracle.rasterizer.rules import RULES, OffGridError, covered

PIXELS = SIZE[0] * SIZE[1]
BITS = 8


def fragments(scene, primitive, pixel, depth) -> Fragments:
    """Fragments as a device would give them."""
    order = np.argsort(pixel, kind="stable")
    counts = np.bincount(pixel, minlength=PIXELS).reshape(SIZE[1], SIZE[0])
    return Fragments.of(scene, counts, np.float32(depth)[order].view(np.uint32), primitive[order].astype(np.uint32))


def drawn(scene, moves=0.0):
    """Triangle, pixel and depth of all fragments, without clipping: by the edge functions of Olano and Greer (1997).

    `moves`: pixels by which each corner is moved, at random.
    """
    clip = scene.position.astype(np.float64)
    chance = np.random.default_rng(1).uniform(-moves, moves, (*clip.shape[:2], 2))
    clip[..., :2] += chance * 2.0 / np.array(SIZE) * clip[..., 3:]
    x, y = np.meshgrid((np.arange(SIZE[0]) + 0.5) / SIZE[0] * 2 - 1, (np.arange(SIZE[1]) + 0.5) / SIZE[1] * 2 - 1)
    points = np.stack([x.ravel(), y.ravel(), np.ones(PIXELS)])
    found = []
    for i, corners in enumerate(clip):
        matrix = corners[:, (0, 1, 3)]
        if abs(np.linalg.det(matrix)) < 1e-12:
            continue
        shares = np.linalg.inv(matrix).T @ points  # λ / w of each corner
        z = corners[:, 2] @ shares
        at = np.flatnonzero((shares >= 0).all(axis=0) & (z >= -1) & (z <= 1))
        found.append((np.full(len(at), i), at, (z[at] + 1) / 2))
    return [np.concatenate(parts) for parts in zip(*found, strict=True)]


@pytest.mark.parametrize("moves", [0.0, 1 / 256])
@pytest.mark.parametrize("case", CASES)
def test_every_rasterizer_that_moves_corners_by_a_step_of_the_grid_is_within_bounds(case, moves):
    """The clipped polygons and planes of depth agree with a rasterizer that clips nothing."""
    scene = CASES[case]()
    primitive, pixel, depth = drawn(scene, moves)
    off = deviation(fragments(scene, primitive, pixel, depth), BITS)
    assert not (off.missing or off.impossible or off.repeated), off
    assert off.deep == 0 and off.fragments == len(primitive)


def test_the_bounds_leave_little_open():
    for case in ("huge triangles", "triangles around the eye"):
        assert (~bounds(CASES[case](), BITS).certain).mean() < 0.01
    assert 0 < polygons(before_the_eye()).cut.sum() < 60


def test_certain_possible_and_impossible_by_hand():
    """A right triangle with its long edge through the middles of a diagonal: these are possible, no more."""
    scene = of_corners(np.array([[[10.0, 10.0], [18.0, 10.0], [10.0, 18.0]]]), np.zeros((1, 3)))
    found = bounds(scene, BITS)
    x, y = found.pixel % SIZE[0] - 10, found.pixel // SIZE[0] - 10
    assert sorted(zip(x[found.certain], y[found.certain], strict=True)) == [
        (i, j) for i in range(8) for j in range(8) if i + j < 7]
    assert sorted(zip(x[~found.certain], y[~found.certain], strict=True)) == [(i, 7 - i) for i in range(8)]
    assert np.abs(found.depth - 0.5).max() == 0 and (found.high - found.low).max() < 2e-6


@pytest.mark.parametrize("rule", RULES)
def test_a_rule_gives_a_shared_edge_to_one_triangle(rule):
    """Squares cut along both diagonals, with corners and edges through middles of pixels."""
    numbers = np.random.default_rng(7)
    lines = np.arange(0.5, 65, 8)
    points = np.stack(np.meshgrid(lines, lines), axis=-1)
    points[1:-1, 1:-1] += numbers.integers(-3, 4, (len(lines) - 2, len(lines) - 2, 2))
    a, b, c, d = (points[i:len(lines) - 1 + i, j:len(lines) - 1 + j].reshape(-1, 2)
                  for i, j in ((0, 0), (0, 1), (1, 1), (1, 0)))
    corners = np.concatenate([np.stack(t, axis=1) for t in ((a, b, c), (c, d, a))])
    counts = np.bincount(covered(of_corners(corners, np.zeros(corners.shape[:2])), rule, 1) % PIXELS, minlength=PIXELS)
    inner = counts.reshape(SIZE[1], SIZE[0])[1:-1, 1:-1]
    assert (inner == 1).all()


def test_rules_take_the_edges_that_they_name():
    square = np.array([[[2.5, 2.5], [4.5, 2.5], [4.5, 4.5]], [[2.5, 2.5], [4.5, 4.5], [2.5, 4.5]]])
    scene = of_corners(square, np.zeros((2, 3)))
    places = {rule: sorted(divmod(pixel, SIZE[0]) for pixel in (covered(scene, rule, 1) % PIXELS).tolist())
              for rule in RULES}
    for rule, found in places.items():
        rows, columns = ((3, 4) if "top" in rule else (2, 3)), ((2, 3) if "left" in rule else (3, 4))
        assert found == [(row, column) for row in rows for column in columns], rule


def test_corners_off_the_grid_are_refused():
    scene = of_corners(np.array([[[1.3, 2.0], [9.0, 2.0], [5.0, 8.0]]]), np.zeros((1, 3)))
    with pytest.raises(OffGridError, match="off the grid of 16 steps"):
        covered(scene, "top-left", 4)


def test_edge_on_triangles_and_those_beyond_the_planes_have_no_certain_fragment():
    edge_on = of_corners(np.array([[[5.0, 5.0], [20.0, 20.0], [12.5, 12.5]]]), np.zeros((1, 3)))
    beyond = of_clip(edge_on.position + np.float32([0, 0, 1.5, 0]))
    assert not bounds(edge_on, BITS).certain.any() and len(bounds(beyond, BITS).certain) == 0


@pytest.mark.parametrize(("spoil", "expected"), [
    (lambda p, x, z: (p[1:], x[1:], z[1:]), {"missing": 1}),
    (lambda p, x, z: (np.append(p, p[0]), np.append(x, x[0]), np.append(z, z[0])), {"repeated": 1}),
    (lambda p, x, z: (np.append(p, p[0]), np.append(x, PIXELS - 1), np.append(z, z[0])), {"impossible": 1}),
    (lambda p, x, z: (p, x, np.where(np.arange(len(z)) == 0, z + 0.01, z)), {"deep": 1}),
], ids=["missing", "repeated", "impossible", "deep"])
def test_a_fault_is_counted(spoil, expected):
    scene = of_corners(np.array([[[10.2, 10.1], [40.3, 12.6], [20.9, 44.7]]]), np.array([[0.0, 0.1, 0.2]]))
    primitive, pixel, depth = drawn(scene)
    inside = ~np.isin(pixel, bounds(scene, BITS).pixel[~bounds(scene, BITS).certain])
    primitive, pixel, depth = (values[inside] for values in (primitive, pixel, depth))
    off = deviation(fragments(scene, *spoil(primitive, pixel, depth)), BITS)
    assert {name: getattr(off, name) for name in ("missing", "impossible", "repeated", "deep")} == {
        "missing": 0, "impossible": 0, "repeated": 0, "deep": 0} | expected
    assert not off.within and str(next(iter(expected.values()))) in str(off)


def test_no_fragment_and_no_triangle():
    scene = of_corners(np.zeros((0, 3, 2)), np.zeros((0, 3)))
    off = deviation(fragments(scene, *(np.empty(0, np.int64) for _ in range(3))), BITS)
    assert off.within and off.fragments == 0
