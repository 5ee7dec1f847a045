"""Faults of concurrency that somebody might well write: every one is found, by its name."""

from dataclasses import dataclass

import pytest

from mfr_bench.errors import MfrError
from mfr_bench.methods import catalog
from mfr_bench.race.campaign import run, small_variant
from mfr_bench.race.check import How
from mfr_bench.race.report import owners

LOCK, LOCK64 = "common/lock.glsl", "common/lock64.glsl"
SCHEDULES, SCENES = 40_000, 4
TAKEN = "        if (atomicExchange(semaphore[p], 1u) == 0u) { \\\n            memoryBarrierBuffer();"
TAKEN64 = "        if (atomicExchange(lock64[p], 1u) == 0u) {\n            memoryBarrierBuffer();"
LEFT = "            memoryBarrierBuffer(); \\\n            semaphore[p] = 0u; \\"
FILL = ("        NODE(p, slot) = fragment;\n        memoryBarrierBuffer();\n"
        "        atomicAdd(counter[p], ONE_TAKEN);\n")
LEFT64 = "            memoryBarrierBuffer();\n            lock64[p] = 0u;"


@dataclass(frozen=True)
class Fault:
    """One piece of a shader replaced, and the method that is run with it."""

    name: str
    method: str
    path: str
    right: str
    wrong: str
    settings: tuple[str, ...] = ()
    weak: bool = False
    fragments: tuple[int, ...] = (3, 2)
    ties: bool = False

    def __str__(self) -> str:
        return f"{self.method}: {self.name}"


def faults(method: str, path: str, settings: tuple[str, ...], replaced: list[tuple]) -> list[Fault]:
    """A fault for each name, right piece and wrong piece; True behind them stands for weak memory."""
    return [Fault(name, method, path, right, wrong, settings, *weak) for name, right, wrong, *weak in replaced]


def of_the_lock(method: str, *settings: str) -> list[Fault]:
    """The faults of a spin lock."""
    return faults(method, LOCK, settings, [
        ("no barrier behind the lock", TAKEN, TAKEN.replace("\n            memoryBarrierBuffer();", "\n"), True),
        ("no barrier before the release", LEFT, LEFT.replace("memoryBarrierBuffer(); ", ""), True),
        ("released before the work", TAKEN, f"{TAKEN} semaphore[p] = 0u;"),
        ("never released", "            semaphore[p] = 0u; \\", "            \\"),
        ("taken by a load and a store", "atomicExchange(semaphore[p], 1u) == 0u",
         "semaphore[p] == 0u && (semaphore[p] = 1u) == 1u"),
        ("one try", "waiting && tries < uint(LOCK_TRIES)", "waiting && tries < 1u"),
    ])


def of_the_wide_lock(method: str, *settings: str) -> list[Fault]:
    """The faults of the lock that emulates 64-bit atomics."""
    return faults(method, LOCK64, ("atomic64=emulated", *settings), [
        ("no barrier behind the lock of 64 bits", TAKEN64, TAKEN64.replace("memoryBarrierBuffer();", ""), True),
        ("no barrier before its release", LEFT64, LEFT64.replace("memoryBarrierBuffer();", ""), True),
        ("released before the work of 64 bits", TAKEN64, f"{TAKEN64} lock64[p] = 0u;"),
        ("the lock of 64 bits never released", "            lock64[p] = 0u;\n", ""),
        ("one try for 64 bits", "waiting && tries < uint(LOCK_TRIES)", "waiting && tries < 1u"),
    ])


def counted(method: str, path: str, right: str, wrong: str, *settings: str, **more) -> Fault:
    return Fault("a counter by a load and a store", method, path, right, wrong, settings, **more)


FAULTS = [
    *of_the_lock("kplus-array"), *of_the_lock("kplus-heap", "k=3"), *of_the_lock("kb-ps"), *of_the_lock("kplus-sb"),
    *of_the_wide_lock("kb-mdt64"),
    Fault("no barrier inside the interlock", "kplus-array", LOCK,
          "        memoryBarrierBuffer(); \\\n    } \\", "    } \\",
          ("sync=interlock",), True),
    Fault("no interlock", "kplus-array", LOCK, "    INTERLOCK_BEGIN; \\\n", "", ("sync=interlock",)),
    Fault("a head exchanged by a load and a store", "ab-ll", "methods/list/store.frag",
          "atomicExchange(next[chosen_list(p, fragment.x)], cell);",
          "next[chosen_list(p, fragment.x)]; next[chosen_list(p, fragment.x)] = cell;"),
    counted("ab-ll", "methods/list/alloc.glsl", "atomicAdd(cell_counter[0], 1u)", "cell_counter[0]++"),
    counted("ab-array", "methods/array/store.frag", "atomicAdd(counter[p], 1u)", "counter[p]++"),
    counted("ab-sb", "methods/sbuffer/store.frag", "atomicAdd(address[pixel_index()], 1u)", "address[pixel_index()]++"),
    counted("ab-lbuffer", "common/count.frag", "atomicAdd(counter[pixel_index()], 1u);",
          "counter[pixel_index()] += 1u;"),
    counted("ab-precalc-fixed", "methods/precalc/store_fixed.frag", "atomicAdd(counter[p], 1u)", "counter[p]++"),
    counted("ab-lbuffer", "methods/sbuffer/address.frag", "atomicAdd(group_total[pixel_group(p)], count)",
            "((group_total[pixel_group(p)] += count) - count)"),
    counted("kplus-sb", "methods/kplus/count.frag", "atomicAdd(counter[p], 1u) >= uint(K)", "counter[p]++ >= uint(K)"),
    counted("kplus-array-r", "methods/kplus/store_revised.frag", "atomicAdd(counter[p], ONE_TAKEN)",
            "counter[p] += ONE_TAKEN", "k=3", fragments=(4,)),
    Fault("a page taken without a swap", "ab-ll-paged", "methods/list/pages.glsl",
          "seen = atomicCompSwap(place[p], at, full ? at | TAKING : at + 1u);",
          "seen = place[p]; if (seen == at) place[p] = full ? at | TAKING : at + 1u;"),
    Fault("one try for a page", "ab-ll-paged", "methods/list/pages.glsl", "waiting && tries < uint(LOCK_TRIES)",
          "waiting && tries < 1u"),
    Fault("a page is never released", "ab-ll-paged", "methods/list/pages.glsl",
          "atomicExchange(place[p], fits ? page + 1u : at);", ""),
    Fault("a node linked before it is published", "lin-pre", "methods/list/insert_cas32.frag",
          "            memoryBarrierBuffer();\n", "", (), True),
    Fault("a node linked without a swap", "lin-pre", "methods/list/insert_cas32.frag",
          "linked = atomicCompSwap(next[at], following, cell) == following;", "next[at] = cell; linked = true;"),
    Fault("a lost retry", "lin-pre", "methods/list/insert_cas32.frag", "going = !linked;", "going = false;"),
    Fault("a record linked before it is published", "lin-pre", "methods/list/insert_max64.frag",
          "    memoryBarrierBuffer();\n", "", ("insert=max64",), True),
    Fault("a maximum by a load and a store", "lin-pre", "common/atomic64.glsl",
          "old = unpackUint2x32(atomicMax(BUFFER64[at], packUint2x32(value)));",
          "old = load64(at); if (less64(old, value)) BUFFER64[at] = packUint2x32(value);", ("insert=max64",)),
    Fault("a minimum by a load and a store", "kb-mdt64", "common/atomic64.glsl",
          "old = unpackUint2x32(atomicMin(BUFFER64[at], packUint2x32(value)));",
          "old = load64(at); if (less64(value, old)) BUFFER64[at] = packUint2x32(value);"),
    Fault("an exchange of 64 bits by a load and a store", "lin-post", "common/exchange64.glsl",
          "old = uvec2(unpackInt2x32(atomicExchange(BUFFER64[at], packInt2x32(ivec2(value)))));",
          "old = uvec2(unpackInt2x32(BUFFER64[at])); BUFFER64[at] = packInt2x32(ivec2(value));", ("packed=on",)),
    Fault("a node linked before it is published", "kb-ll", "methods/ll/store.frag",
          "            memoryBarrierBuffer();\n",
          "", (), True),
    Fault("a node linked without a swap", "kb-ll", "methods/ll/store.frag",
          "linked = atomicCompSwap(next[at], following, node) == following;", "next[at] = node; linked = true;"),
    Fault("a minimum of depths by a load and a store", "kb-mdt32", "methods/mdt/store_depth.frag",
          "depth = max(depth, atomicMin(depths[slot * pixels + p], depth));",
          "{ uint old = depths[slot * pixels + p]; depths[slot * pixels + p] = min(old, depth); "
          "depth = max(depth, old); }"),
    Fault("a slot counts before it is published", "kplus-array-r", "methods/kplus/store_revised.frag",
          FILL, FILL.replace("        memoryBarrierBuffer();\n", ""), ("k=3",),
          True, (4,)),
    Fault("a slot counts before it is written", "kplus-array-r", "methods/kplus/store_revised.frag",
          FILL, "        atomicAdd(counter[p], ONE_TAKEN);\n        NODE(p, slot) = fragment;\n", ("k=3",),
          False, (4,)),
    Fault("fills are not waited for", "kplus-array-r", "methods/kplus/store_revised.frag",
          "if ((atomicAdd(counter[p], 0u) >> COUNTED_BITS) + 1u >= BOUND) return true;", "return true;", ("k=3",),
          False, (4,)),
    Fault("no barrier behind the fills", "kplus-array-r", "methods/kplus/store_revised.frag",
          "        memoryBarrierBuffer();\n        insert(p, fragment);", "        insert(p, fragment);", ("k=3",),
          True, (4,)),
    # One of the two barriers alone publishes the record before the swap.
    Fault("a record named before it is published", "open-pre", "methods/open/table.glsl", "memoryBarrierBuffer();", "",
          ("atomic64=emulated",), True),
    Fault("a cell set without a swap", "open-pre", "methods/open/table.glsl",
          "named = atomicCompSwap(cells[at], before, larger ? carried + 1u : before);",
          "if (larger) cells[at] = carried + 1u;", ("atomic64=emulated",)),
    Fault("an age by a load and a store", "open-pre", "methods/open/insert.frag", "atomicMax(ages[p], age);",
          "ages[p] = max(ages[p], age);"),
    Fault("bounds by a load and a store", "ab-ll-bucket", "methods/list/bounds.frag", "atomicMin(bound, depth);",
          "bound = min(bound, depth);", (), False, (4,)),
    Fault("an order that is read before it is there", "ab-coherent", "methods/coherent/order.glsl",
          "= slot;\n    barrier();", "= slot;", ("resolve=compute",)),
    Fault("a rank by depths that are not there yet", "ab-coherent", "methods/coherent/order.glsl",
          "(slot * pixels + leader).x;\n    barrier();", "(slot * pixels + leader).x;", ("resolve=compute",)),
    counted("adaptive", "methods/adaptive/store.frag", "atomicAdd(counter[p], 1u)", "counter[p]++", "shallow=memory"),
    *faults("adaptive", "methods/adaptive/keep.frag", (), [
        ("a fragment in the framebuffer put behind those that are further away", "fragment.x < held.x",
         "fragment.x > held.x"),
        ("the fragment that was in a place of the framebuffer lost", "fragment = before ? held : fragment;",
         "if (before) fragment.x = EMPTY;"),
        ("places of the framebuffer in order of arrival", "bool before = fragment.x < held.x;",
         "bool before = held.x == EMPTY && fragment.x != EMPTY;")]),
    counted("adaptive", "methods/adaptive/allocate.frag", "atomicAdd(taken[0], count)",
          "((taken[0] += count) - count)", "spare_memory=0"),
    counted("ab-array", "common/list_tiles.comp", "atomicAdd(tile_command[0], 1u)", "tile_command[0]++",
            "touched=tiles", fragments=(2, *(0,) * 30, 2, *(0,) * 20, 2)),
    # A method that loses equal depths keeps one of each all the same; and nothing else is in its place.
    Fault("no fragment of a depth kept", "kb-mdt32", "methods/mdt/fetch.glsl",
          "at >= pixels && depths_at(at - pixels) == depth", "at < pixels", ("k=3",), fragments=(4,), ties=True),
    Fault("a layer skipped behind equal depths", "peel-f2b", "methods/peel/f2b.frag", "gl_FragCoord.z <= texel",
          "gl_FragCoord.z <= 0.02 + texel", fragments=(3,), ties=True),
]


@pytest.mark.parametrize("fault", FAULTS, ids=str)
def test_a_planted_fault_is_found(fault, plant):
    plant(fault.path, fault.right, fault.wrong)
    assert seen(fault), f"{fault} survives {SCHEDULES} schedules"


def seen(fault: Fault) -> bool:
    """Whether the promise breaks, under some schedule or without any race."""
    variant, how = small_variant(catalog()[fault.method], fault.settings), How(schedules=SCHEDULES, weak=fault.weak)
    try:
        return run(variant, fault.fragments, how, SCENES, fault.ties).failed > 0
    except MfrError as error:
        return str(error).endswith("without any race")


LOST_BIT = Fault("a bit by a load and a store", "kb-ab-array", "common/occupancy/mark.frag",
                 "atomicOr(occupied[(interval / 32u) * pixels + pixel_index()], 1u << (interval % 32u));",
                 "occupied[(interval / 32u) * pixels + pixel_index()] |= 1u << (interval % 32u);", ("occupancy=32",),
                 fragments=(4,))


def test_a_lost_bit_of_the_occupancy_map_breaks_no_promise(plant):
    """With fewer intervals known as occupied the k-th lies further away: less is culled, and nothing that belongs."""
    plant(LOST_BIT.path, LOST_BIT.right, LOST_BIT.wrong)
    assert not seen(LOST_BIT)


def test_fragments_of_one_depth_are_named_together():
    assert owners("depth", [5, 7, 5]) == {5: "depth of f0 and f2", 7: "depth of f1"}
