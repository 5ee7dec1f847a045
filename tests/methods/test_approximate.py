"""Methods that mix fragments: each gives the image that its paper's arithmetic gives, computed here in float64.

A model takes the fragments of a pixel in order of arrival, (depth, straight RGBA in [0, 1]), and gives premultiplied
RGBA. Where the arrival matters, fragments have to come one by one, as on a CPU.
"""

from functools import partial
from itertools import pairwise

import numpy as np
import pytest

from mfr_bench.oracle.composite import composite
from mfr_bench.store.status import EXACT_ERROR

from .drawing import drawn, stack

N = 12
BY_ARRIVAL = ("mlab", "aoit")
ROUNDING = 1e-5  # of float32 sums of so few fragments
HALVES, BYTES = 2e-3, 6e-3  # of 11 and of 8 bits


def premultiplied(rgba):
    return np.append(rgba[:3] * rgba[3], rgba[3])


def under(front, behind):
    return front + (1 - front[3]) * behind


# --- the papers' arithmetic ------------------------------------------------------------------------


def weighted(fragments, weight):
    total, revealage = np.zeros(4), 1.0
    for depth, rgba in fragments:
        total += premultiplied(rgba) * rgba[3] * weight(depth)
        revealage *= 1 - rgba[3]
    return np.append(total[:3] / total[3], 1.0) * (1 - revealage)


def distance(depth):
    return 0.1 + (500 - 0.1) * depth


WEIGHTS = {
    "eq7": lambda d: max(1e-2, min(3e3, 10 / (1e-5 + (distance(d) / 5) ** 2 + (distance(d) / 200) ** 6))),
    "eq8": lambda d: max(1e-2, min(3e3, 10 / (1e-5 + (distance(d) / 10) ** 3 + (distance(d) / 200) ** 6))),
    "eq9": lambda d: max(1e-2, min(3e3, 0.03 / (1e-5 + (distance(d) / 200) ** 4))),
    "eq10": lambda d: max(1e-2, 3e3 * (1 - d) ** 3),
}


def multi_layer(fragments, k, steps):
    """`steps`: whole numbers in which a merged layer's straight colour is kept."""
    layers = []
    for depth, rgba in fragments:
        layers = sorted([*layers, (depth, rgba)], key=lambda layer: layer[0])
        if len(layers) > k:
            merged = under(premultiplied(layers[-2][1]), premultiplied(layers[-1][1]))
            straight = np.append(merged[:3] / merged[3], merged[3])
            layers[-2:] = [(layers[-2][0], np.round(straight * steps) / steps)]
    return blended(rgba for _, rgba in layers)


def blended(colours):
    image = np.zeros(4)
    for rgba in colours:
        image = under(image, premultiplied(rgba))
    return image


def hybrid(fragments, k):
    by_depth = [rgba for _, rgba in sorted(fragments, key=lambda f: f[0])]
    core, tail = blended(by_depth[:k]), by_depth[k:]
    if not tail:
        return core
    total = sum(map(premultiplied, tail))
    return under(core, premultiplied(np.append(total[:3] / total[3], 1 - (1 - total[3] / len(tail)) ** len(tail))))


def adaptive(fragments, k):
    """The visibility as (depth, transmittance behind it), the cumulative form of the paper."""
    nodes = []
    for depth, rgba in fragments:
        at = sum(z < depth for z, _ in nodes)
        before = nodes[at - 1][1] if at else 1.0
        nodes = [*nodes[:at], (depth, before * (1 - rgba[3])), *((z, t * (1 - rgba[3])) for z, t in nodes[at:])]
        if len(nodes) > k:
            areas = [(z - z0) * (t0 - t) for (z0, t0), (z, t) in pairwise(nodes)]
            gone = 1 + int(np.argmin(areas))
            nodes[gone - 1:gone + 1] = [(nodes[gone - 1][0], nodes[gone][1])]
    image = np.zeros(4)
    for depth, rgba in fragments:
        seen = next((t for z, t in reversed(nodes) if z < depth), 1.0)
        image += premultiplied(rgba) * seen
    return np.append(image[:3], 1 - nodes[-1][1])


SPREAD = {4: [1, 0, 0.375, 0, 0.375], 6: [1, 0, 0.48, 0, 0.451, 0, 0.45]}


def moment_based(fragments, count, bias):
    absorbed = np.array([min(10.0, -np.log(max(1e-9, 1 - rgba[3]))) for _, rgba in fragments])
    depths = 2 * np.array([depth for depth, _ in fragments]) - 1
    total = absorbed.sum()
    moments = np.array([(absorbed * depths**i).sum() for i in range(count + 1)]) / total
    moments = (1 - bias) * moments + bias * np.array(SPREAD[count])
    shaded = sum(premultiplied(rgba) * np.exp(-total * share_before(z, moments))
                 for z, (_, rgba) in zip(depths, fragments, strict=True))
    return np.append(shaded[:3] / shaded[3], 1.0) * (1 - np.exp(-total))


def share_before(z, moments):
    """The paper's form: the polynomial that is a step at the support points, integrated by the moments."""
    side = len(moments) // 2 + 1
    hankel = np.array([[moments[i + j] for j in range(side)] for i in range(side)])
    kernel = np.linalg.solve(hankel, z ** np.arange(side))
    roots = np.roots(kernel[::-1]).real
    points, values = np.append(roots, z), np.append(roots < z, 0.25)
    step = np.linalg.solve(np.vander(points, increasing=True), values)
    return float(np.clip(step @ moments[:side], 0, 1))


# --- methods against them --------------------------------------------------------------------------


def fragments_of(scene):
    return [(float(d), c / 255.0) for d, c in zip(scene.depth, scene.rgba, strict=True)]


def scenes(count=N):
    """Stacks of random depths and colours: of low opacity, of any, and one with opaque layers."""
    rng = np.random.default_rng(5)
    for alphas in ((10, 60), (10, 256), (200, 256)):
        depth = np.float32(rng.permutation(2**20)[:count] + 1) / np.float32(2**20 + 2)
        rgba = np.column_stack([rng.integers(0, 256, (count, 3)), rng.integers(*alphas, count)])
        yield stack(depth, rgba, size=(2, 1))


CASES = {
    **{f"wboit {name} {precision}": ("wboit", {"weight": name, "precision": precision}, partial(weighted, weight=w),
                                     ROUNDING if precision == "32f" else BYTES)
       for name, w in WEIGHTS.items() for precision in ("16f", "32f")},
    **{f"mlab {k} {payload}": ("mlab", {"k": k, "payload": payload}, partial(multi_layer, k=k, steps=steps), tolerance)
       for k in (1, 3, 6) for payload, steps, tolerance in (("rgba8", 255, BYTES), ("rgba16f", 2**40, HALVES))},
    **{f"hybrid {k}": ("hybrid", {"k": k}, partial(hybrid, k=k), ROUNDING) for k in (1, 4, 8)},
    **{f"aoit {k}": ("aoit", {"k": k}, partial(adaptive, k=k), ROUNDING) for k in (1, 3, 6)},
    **{f"mboit {m}": ("mboit", {"moments": m, name: 1e-4}, partial(moment_based, count=m, bias=1e-4), 2e-3)
       for m, name in ((4, "bias"), (6, "bias_6"))},
}


def worst(device, method, params, model):
    errors = []
    for scene in scenes():
        with drawn(device, method, scene, **params) as frame:
            assert frame.lost_fragments() == 0
            errors.append(np.abs(frame.image() - model(fragments_of(scene))).max())
    return max(errors)


@pytest.mark.parametrize("case", CASES)
def test_the_image_is_what_the_paper_says(device, case):
    method, params, model, tolerance = CASES[case]
    if method in BY_ARRIVAL and device.kind != "cpu":
        pytest.skip("the order in which this device shades fragments is not known")
    assert worst(device, method, params, model) <= tolerance


FAULTS = [
    ("wboit eq7 32f", "methods/weighted/weight.glsl", "squared(z / 5.0)", "cubed(z / 5.0)"),
    ("wboit eq10 32f", "methods/weighted/store.frag", "vec4(colour.a)", "vec4(1.0)"),
    ("wboit eq9 16f", "methods/weighted/resolve.frag", "sum.rgb / sum.a", "sum.rgb"),
    ("mlab 3 rgba8", "methods/mlab/merge.glsl", "under(colour_of(nearer), colour_of(further))",
     "under(colour_of(further), colour_of(nearer))"),
    ("mlab 6 rgba16f", "methods/mlab/store.frag", "write_slot(p, last, merged(", "write_slot(p, 0u, merged("),
    ("hybrid 4", "methods/hybrid/resolve.glsl", "1.0 - sum.a / count", "1.0 - sum.a"),
    ("hybrid 4", "methods/hybrid/store.frag", "tail_count[p] += 1u", "tail_count[p] = 1u"),
    ("aoit 3", "methods/visibility/compress.glsl", "area < least", "area > least - 2.0"),
    ("aoit 6", "methods/visibility/nodes.glsl", "node.x >= depth", "node.x > depth"),
    ("mboit 4", "methods/moments/reconstruct.glsl", "lessThan(support.yz,", "greaterThan(support.yz,"),
    ("mboit 6", "methods/moments/roots.glsl", "c[2] + middle * u", "c[2]"),
    ("mboit 4", "methods/moments/store.frag", "term *= z * z", "term *= z"),
]


@pytest.mark.parametrize(("case", "path", "right", "wrong"), FAULTS, ids=lambda text: text.replace("/", "."))
def test_a_wrong_line_of_glsl_is_seen(device, plant, case, path, right, wrong):
    method, params, model, tolerance = CASES[case]
    plant(path, right, wrong)
    assert worst(device, method, params, model) > tolerance


# --- where they must be exact ----------------------------------------------------------------------


def error(device, method, scene, **params):
    with drawn(device, method, scene, **params) as frame:
        return np.abs(frame.image() - composite(scene)).max(axis=(0, 1))


def alike(colour=None, alpha=None, count=N):
    """A stack whose layers share their colour, their alpha, or both."""
    scene = next(scenes(count))
    scene.rgba[:, :3] = scene.rgba[:, :3] if colour is None else colour
    scene.rgba[:, 3] = scene.rgba[:, 3] if alpha is None else alpha
    return scene


@pytest.mark.parametrize(("method", "params"), [("wboit", {"precision": "32f"}), ("mboit", {"moments": 4}),
                                                ("mboit", {"moments": 6})])
def test_what_knows_no_order_is_exact_where_all_colours_are_equal(device, method, params):
    """A mean of equal colours is that colour, and the opacity of all fragments is known."""
    assert max(error(device, method, alike(colour=(200, 30, 90)), **params)) <= EXACT_ERROR


@pytest.mark.parametrize(("method", "params"), [("wboit", {}), ("mboit", {}), ("hybrid", {"k": 2})])
def test_equal_alphas_alone_do_not_make_colours_right(device, method, params):
    assert max(error(device, method, alike(alpha=120), **params)[:3]) > 10 * EXACT_ERROR


@pytest.mark.parametrize("k", [1, 4])
def test_opacity_of_a_tail_of_equal_alphas_is_exact(device, k):
    assert error(device, "hybrid", alike(alpha=90), k=k)[3] <= EXACT_ERROR
    assert max(error(device, "hybrid", alike((10, 200, 90), 90), k=k)) <= EXACT_ERROR


@pytest.mark.parametrize("moments", [4, 6])
def test_moments_find_half_as_many_layers_of_equal_alpha(device, moments):
    """So many points are the only measure with these moments, and the share of a fragment's own weight is in all."""
    few, many = (max(error(device, "mboit", alike(alpha=90, count=count), moments=moments))
                 for count in (moments // 2, 3 * moments))
    assert few <= 5e-3 < many


@pytest.mark.parametrize("k", [N - 1, N])
def test_a_tail_of_one_fragment_is_exact(device, k):
    assert max(error(device, "hybrid", next(scenes()), k=k)) <= EXACT_ERROR


@pytest.mark.parametrize(("payload", "tolerance"), [("rgba8", BYTES), ("rgba16f", HALVES)])
def test_back_to_front_only_rounding_is_lost_by_merging(device, payload, tolerance):
    """The two furthest are merged, and nothing that comes later belongs behind them; front to back it does."""
    scene = next(scenes())
    scene.rgba[:, 3] = 60
    scene.depth[:] = np.sort(scene.depth)[::-1]
    assert max(error(device, "mlab", scene, k=3, payload=payload)) <= tolerance
    scene.depth[:] = np.random.default_rng(2).permutation(scene.depth)
    if device.kind == "cpu":
        assert max(error(device, "mlab", scene, k=3, payload=payload)) > tolerance


def test_opaque_fragments_are_clamped(device):
    """An absorbance of 10 in place of infinity lets exp(-10) through."""
    scene = stack([0.5], [(255, 255, 255, 255)], size=(1, 1))
    with drawn(device, "mboit", scene) as frame:
        np.testing.assert_allclose(frame.image()[0, 0], 1 - np.exp(-10), rtol=0, atol=1e-6)


@pytest.mark.parametrize("alpha", [0, 1, 255])
@pytest.mark.parametrize("method", ["wboit", "mlab", "aoit", "hybrid", "mboit"])
def test_every_alpha_gives_a_finite_image(device, method, alpha):
    with drawn(device, method, alike(alpha=alpha, count=60)) as frame:
        image = frame.image()
        assert np.isfinite(image).all()
        assert image.min() >= 0
        assert image.max() <= 1 + 1e-5
