"""The suite must see a wrong shader: each fault planted here makes an exact method miss its promise."""

import pytest

from mfr_bench.errors import ShaderError
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Buffer, Method, Pass
from mfr_bench.store.status import EXACT_ERROR

from .cases import DEEP, SCENES, Drawn, with_k

FAULTS = [
    ("zbuffer", "scene/quad.vert", "? in_depth : 2.0 * in_depth - 1.0", "? 1.0 - in_depth : 1.0 - 2.0 * in_depth"),
    ("peel-f2b", "methods/peel/f2b.frag", "gl_FragCoord.z <= ", "gl_FragCoord.z < "),
    ("peel-dual", "methods/peel/dual.frag", "z > nearest && z < furthest", "z >= nearest && z < furthest"),
    ("peel-bucket", "methods/peel/bucket.frag", "z > -edge.x && z < edge.y", "z < edge.y"),
    ("peel-srab", "methods/routing/collect.frag", ".x + 1u : EMPTY", ".x : EMPTY"),
    ("ab-array", "methods/array/store.frag", "slot * pixels + p", "slot + p"),
    ("ab-coherent", "methods/coherent/window.glsl", "held.x <= carried.x", "held.x >= carried.x"),
    ("ab-coherent", "methods/coherent/order.comp", "fragments[slot].y = slot", "fragments[slot].y = 0u"),
    ("ab-ll", "methods/list/store.frag", "incoming()", "incoming().yx"),
    ("ab-sb", "methods/sbuffer/sums.glsl", "group + 1u", "group"),
    ("ab-lbuffer", "methods/sbuffer/address.frag", "[pixel_group(p)], count", "[pixel_group(p)], 1u"),
    ("ab-precalc", "methods/precalc/scan_pixels.comp", "block_sum[b] + ", ""),
    ("ab-precalc-fixed", "methods/precalc/address_fixed.frag", "p * uint(N)", "p"),
    ("ab-dfb", "methods/dfb/sum_down.frag", "before += counter[child]", "before += 1u"),
    ("ab-ll-paged", "methods/list/store_paged.frag", "= page_before", "= 0u"),
    ("ab-ll-bucket", "methods/list/choose.glsl", "share * float", "(1.0 - share) * float"),
    ("lin-pre", "methods/list/insert_cas32.frag", "<= fragment.x", ">= fragment.x"),
    ("kb-mdt32", "methods/mdt/store_depth.frag", "max(depth, ", "min(depth, "),
    ("kb-mdt32", "methods/mdt/store_depth.frag", "depth > depths[", "depth < depths["),
    ("kb-ab-ll", "common/nearest.glsl", "changed = fragment.x <", "changed = fragment.x >"),
    ("kplus-array", "methods/kplus/array.glsl", "worse(node, worst)", "worse(worst, node)"),
    ("kplus-array-r", "methods/kplus/store_revised.frag", "NODE(p, slot) = fragment", "NODE(p, 1u) = fragment"),
    ("kplus-heap", "methods/kplus/heap.glsl", "worse(right, node)", "worse(node, right)"),
    ("kplus-heap", "methods/kplus/structure.glsl", "!worse(NODE", "worse(NODE"),
    ("kplus-array", "methods/kplus/structure.glsl", "surely_worse(fragment, NODE(p, 0u))",
     "surely_worse(NODE(p, 0u), fragment)"),
    ("kplus-sb", "methods/sbuffer/address.frag", "count = min(count, uint(K))", "count = max(count, uint(K))"),
    ("kplus-sb-dynamic", "methods/kplus/histogram.frag", "histogram[count - 1u]", "histogram[count / 4u]"),
    ("peel-kplus", "methods/kplus/store_beyond.frag", "worse(fragment, last[p])", "worse(last[p], fragment)"),
    ("kb-ps", "common/insert_sorted.glsl", "fragment.x < held.x", "fragment.x > held.x"),
    ("adaptive", "methods/adaptive/rank.comp", "other > depth", "other < depth"),
    ("adaptive", "methods/adaptive/classify.glsl", "draws[command + 1] = 1u", "draws[command + 1] = 0u"),
    ("adaptive", "methods/adaptive/registers.glsl", "in_use = cell < end_cell", "in_use = cell + 2u < end_cell"),
    ("kb-ll", "methods/ll/store.frag", "<= fragment.x", ">= fragment.x"),
    ("kb", "methods/kb/store.frag", "incoming()", "incoming().yx"),
    ("kb-multi", "methods/kb/tidy.frag", "held.x != EMPTY", "held.x == EMPTY"),
    ("kb-mha", "methods/kb/coded.glsl", "code == coded", "code != coded"),
]
OPTION_FAULTS = [
    ("ab-array", {"sort": "hybrid"}, "common/sort.glsl", "nearer.x <= moving.x", "nearer.x >= moving.x"),
    ("open-post", {"atomic64": "emulated"}, "methods/open/insert.frag", "atomicMax(ages[p], age)",
     "atomicMax(ages[p], 1u)"),
    ("open-pre", {"atomic64": "emulated"}, "methods/open/table.glsl", "less64(met, cell)", "less64(cell, met)"),
    ("lin-post", {"packed": "on", "atomic64": "emulated"}, "methods/list/store_packed.frag", "~fragment.x",
     "fragment.x"),
    ("lin-pre", {"insert": "max64", "atomic64": "emulated"}, "methods/list/insert_max64.frag", "less64(old, record)",
     "less64(record, old)"),
    ("kb-mdt64", {"atomic64": "emulated"}, "methods/mdt/store64.frag", "less64(moving, held)", "less64(held, moving)"),
    ("ab-array", {"sort": "shell"}, "common/sort.glsl", "hole >= gap", "hole > gap"),
    ("ab-array", {"sort": "bubble"}, "common/resolve_bubble.glsl", "COMPARE(1, 2)", ""),
    ("ab-array", {"sort": "bubble", "local_array": 64}, "common/sort.glsl", "met.x >= carried.x", "met.x <= carried.x"),
    ("ab-array", {"sort": "register"}, "common/network.glsl", "block##b.x < block##a.x", "block##b.x > block##a.x"),
    ("ab-array", {"bma": "on"}, "common/classify.frag", "findMSB(count - 1u) - 2", "findMSB(count - 1u) - 3"),
    ("ab-array", {"payload": "rgba16f"}, "common/payload.glsl", "rgba8 >> 16 & 255u", "rgba8 >> 24 & 255u"),
    ("ab-array", {"resolve": "compute"}, "common/resolve.comp", "xy.y * width + xy.x", "xy.y * width"),
    ("ab-coherent", {"resolve": "compute"}, "methods/coherent/order.glsl", "uint(LANES + ORDERED)", "uint(LANES)"),
    ("ab-sb", {"touched": "tiles"}, "common/list_tiles.comp", "y < end.y", "y + 15u < end.y"),
    ("ab-ll", {"touched": "tiles"}, "common/list_tiles.comp", "columns + tile.x;", "columns + tile.x + 1u;"),
    ("ab-array", {"touched": "tiles"}, "screen/tile.vert", "in_tile / tiles.x", "in_tile % tiles.x"),
    ("ab-array", {"touched": "tiles", "resolve": "compute"}, "common/resolve.comp", "at < tile_command",
     "at + 1u < tile_command"),
    ("ab-precalc", {"scan": "fullscreen"}, "methods/precalc/scan.frag", "+", "-"),
    ("ab-sb", {"mapping": "forward"}, "methods/sbuffer/sums.glsl", "group < to", "group <= to"),
    ("adaptive", {"spare_memory": 0.0}, "methods/adaptive/allocate.frag", "atomicAdd(taken[0], count)", "taken[0]"),
    ("adaptive", {"spare_memory": 0.0}, "methods/adaptive/count.frag", "1.0 / float(DEEPEST)", "2.0 / float(DEEPEST)"),
    ("adaptive", {"flat": "stored"}, "methods/adaptive/store.frag", "* PLACES + p", "+ p"),
    ("adaptive", {"flat": "stored"}, "methods/adaptive/store.frag", "slot = quad", "slot = quad + 1u"),
    ("adaptive", {"memory_mb": 0.15}, "methods/adaptive/sums.frag", "count);", "1u);"),
    ("kb-ab-array", {"occupancy": 32}, "common/occupancy/cull.frag", "wanted > 1u", "wanted > 2u"),
    ("kb-multi", {"occupancy": 32}, "common/occupancy/cull.frag", "wanted > 1u", "wanted > 2u"),
    ("kb-ab-sb", {"occupancy": 64}, "common/occupancy/mark.frag", "1u << (interval % 32u)", "3u << (interval % 32u)"),
]
SEEN_IN = ("sorted", "reverse-sorted", "tiles", "scattered", "random random")  # no more are drawn than it takes
IN_ORDER_OF_ARRIVAL = [("kb-sr", {}, "methods/routing/start.frag", "-1 << instance", "1 << instance")]


@pytest.mark.parametrize(("method", "path", "right", "wrong"), FAULTS, ids=lambda text: text.replace("/", "."))
def test_a_wrong_line_of_glsl_is_seen(device, plant, method, path, right, wrong):
    plant(path, right, wrong)
    assert seen(device, method, {}, SEEN_IN)


@pytest.mark.parametrize(("method", "params", "path", "right", "wrong"), OPTION_FAULTS,
                         ids=[f"{m}-{'-'.join(map(str, params.values()))}" for m, params, *_ in OPTION_FAULTS])
def test_a_wrong_line_in_an_option_is_seen(device, plant, method, params, path, right, wrong):
    plant(path, right, wrong)
    assert seen(device, method, params, SEEN_IN)


@pytest.mark.parametrize(("method", "params", "path", "right", "wrong"), IN_ORDER_OF_ARRIVAL, ids=["kb-sr"])
def test_a_wrong_line_of_routing_is_seen_where_order_of_arrival_is_order(device, plant, method, params, path, right,
                                                                         wrong):
    assert not seen(device, method, params, ("sorted",))
    plant(path, right, wrong)
    assert seen(device, method, params, ("sorted",))


def seen(device, method, params, scenes) -> bool:
    """Whether an image is not the promised one, or a loss is counted, in any of the scenes."""
    drawn = (Drawn(device, with_k(catalog()[method].variant(params), 4), (SCENES | DEEP)[name]) for name in scenes)
    return any(d.error > EXACT_ERROR or d.lost for d in drawn)


def test_every_family_that_promises_an_image_has_a_planted_fault():
    planted = {catalog()[fault[0]].family for fault in (*FAULTS, *OPTION_FAULTS, *IN_ORDER_OF_ARRIVAL)}
    assert {m.family for m in catalog().values() if m.guarantee.startswith("exact")} <= planted


def test_an_undeclared_write_does_not_compile(device):
    """Barriers follow from declared reads and writes, so a pass cannot write what it only declares to read."""
    silent = Method(
        id="silent", name="silent", family="test", source="test", summary="test", guarantee="none", words="1", ties="",
        buffers=(Buffer("counter", "P"), Buffer("address", "P")),
        steps=(Pass("scan", "fullscreen", "methods/precalc/seed.frag", reads=("counter", "address")),))
    with pytest.raises(ShaderError, match=r"methods/precalc/seed\.frag:\d+: .*method silent, pass scan"):
        Drawn(device, silent.variant({}), SCENES["flat"])


def test_a_pass_that_touches_written_buffers_waits_for_them(device, monkeypatch):
    """Between two passes on one buffer there is a barrier, in every method that has such passes."""
    barriers = []
    monkeypatch.setattr(device.gl, "glMemoryBarrier", lambda bits, real=device.gl.glMemoryBarrier:
                        (barriers.append(bits), real(bits)))
    Drawn(device, catalog()["ab-array"].variant({}), SCENES["flat"])
    storage = [bits for bits in barriers if bits & 0x2000]
    assert len(storage) == 3  # the frame before, clear before store, store before resolve
