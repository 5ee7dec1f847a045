"""The work of a method is counted by programs that show the same image, and that the timed ones know nothing of."""

import re

import pytest

from mfr_bench import glsl
from mfr_bench.glsl import counters as instrument
from mfr_bench.glsl.counters import Stored, counting
from mfr_bench.gpu.work import work_of
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted, SceneStats
from mfr_bench.resources import shaders_dir

from ..methods.drawing import SIZE, drawn, stack

PIXELS = SIZE[0] * SIZE[1]
DEPTHS = (0.5, 0.25, 0.75, 0.125)
SIZES = SceneStats(W=4, H=4, n=3, F=9, primitives=3)


def counted(body: str, **storage: Stored) -> str:
    return counting("", body, storage).split(instrument.FUNCTIONS)[1].strip()


@pytest.mark.parametrize(("line", "expected"), [
    ("x = nodes[i];", "x = nodes[reads(i, 2u, 1u)];"),
    ("x = nodes[i].x;", "x = nodes[reads(i, 1u, 1u)].x;"),
    ("nodes[i] = x;", "nodes[writes(i, 2u, 1u)] = x;"),
    ("if (nodes[i] == x)", "if (nodes[reads(i, 2u, 1u)] == x)"),
    ("nodes[place[p] + 1u] = x;", "nodes[writes(place[reads(p, 1u, 0u)] + 1u, 2u, 1u)] = x;"),
    ("place[p] += 1u;", "place[changes(p, 1u, 0u)] += 1u;"),
    ("uint s = atomicAdd(place[p], 1u);", "uint s = atomicAdd(place[swaps(p, 1u, 0u)], 1u);"),
    ("FRAGMENT fragments[LOCAL];", "FRAGMENT fragments[LOCAL];"),
    ("fragments[i] = fragments[j];", "fragments[moves(i)] = fragments[j];"),
    ("x = nodes.length();", "x = nodes.length();"),
])
def test_an_access_is_counted_by_its_index(line, expected):
    assert counted(line, nodes=Stored(2, True), place=Stored(1)) == expected


def test_a_macro_that_names_an_element_is_counted_where_it_is_used():
    """Only the use tells a read from a write; what the macro itself reads on the way is counted in it."""
    text = counted("#define NODE(p, i) nodes[place[p] + (i)]  // remark\nNODE(p, 1u) = NODE(p, 2u);",
                   nodes=Stored(2, True), place=Stored(1))
    assert text == ("#define NODE(p, i) nodes[place[reads(p, 1u, 0u)] + (i)]  // remark\n"
                    "NODE(writes(p, 2u, 1u), 1u) = NODE(reads(p, 2u, 1u), 2u);")


def test_a_line_that_counts_becomes_a_call_and_an_unknown_counter_is_an_error():
    assert counted("    COUNT(moved, 2u) \\") == f"count_work({list(instrument.WORK).index('moved')}u, uint(2u)); \\"
    with pytest.raises(instrument.ShaderError, match="no counter 'moves'"):
        counted("COUNT(moves, 2u)")


@pytest.mark.parametrize("method", catalog())
def test_timed_programs_hold_nothing_that_counts(method):
    variant = catalog()[method].variant({})
    for step in variant.passes:
        for stage in glsl.stages(Fitted(variant, SIZES), step) if step.kind != "clear" else ():
            assert not re.search(r"\bCOUNT(_MOST)?\(|count_work|work\[", stage.text)


def test_every_line_that_counts_is_one():
    """A line that is not recognized would stay in the timed programs."""
    lines = [line for path in shaders_dir().rglob("*.*") for line in path.read_text().splitlines()
             if re.search(r"\bCOUNT(_MOST)?\(", line)]
    assert lines and all(map(instrument.is_counter, lines))


def test_a_complaint_names_the_line_of_the_file_although_lines_that_count_are_left_out():
    variant = catalog()["kplus-array"].variant({})
    step = next(p for p in variant.passes if p.name == "store")
    source = glsl.stages(Fitted(variant, SIZES), step)[1]
    number = source.files.index("common/lock.glsl")
    lines = glsl.read("common/lock.glsl").splitlines()
    at = next(i for i, line in enumerate(lines, start=1) if line.startswith("#define CRITICAL_END"))
    shown = source.text.split(f"#line {number * glsl.includes.LINE_STRIDE + 1}\n")[1].splitlines()
    place = next(i for i, line in enumerate(shown) if line.startswith("#define CRITICAL_END"))
    include = next(i for i in range(place, -1, -1) if shown[i].startswith("#line"))
    encoded = int(shown[include].split()[1]) + place - include - 1
    assert source.located(f"0:{encoded}(1): error: x") == f"common/lock.glsl:{at}: error: x"


def test_an_array_of_fragments_does_what_it_must(device):
    """4 fragments a pixel: one atomic and one fragment stored for each, all read once, by no one else."""
    with drawn(device, "ab-array", stack(DEPTHS), sort="insertion") as frame:
        before = frame.image()
        work = work_of(frame)
        assert (frame.image() == before).all()
    fragments = len(DEPTHS) * PIXELS
    assert work["clear"]["words_written"] == PIXELS
    store, resolve = work["store"], work["resolve"]
    assert {store[name] for name in ("rasterized", "invocations", "passed", "stored", "atomics")} == {fragments}
    assert store["words_written"] == 3 * fragments and store["words_read"] == fragments
    assert resolve["invocations"] == PIXELS and resolve["loaded"] == fragments and resolve["empty"] == 0
    assert resolve["words_read"] == PIXELS + 2 * fragments
    assert resolve["words_written"] == 4 * PIXELS


@pytest.mark.parametrize("params", [{"sort": "insertion"}, {"sort": "register"}, {"resolve": "compute"}], ids=str)
def test_sums_of_an_invocation_are_what_is_counted_at_once(device, monkeypatch, params):
    with drawn(device, "ab-array", stack(DEPTHS), **params) as frame:
        summed = work_of(frame)
        monkeypatch.setattr(instrument, "_ENDS_EARLY", re.compile("main"))
        assert work_of(frame) == summed
    assert summed["resolve"]["moved"] > 0


def test_the_fragments_that_early_z_discards_never_reach_the_shader(device):
    depths = [0.1 + 0.01 * i for i in range(40)]
    with drawn(device, "kplus-array", stack(depths), k=2, occupancy=32) as frame:
        store = work_of(frame)["store"]
    assert store["rasterized"] == 40 * PIXELS
    assert 2 * PIXELS <= store["invocations"] < 10 * PIXELS


def test_what_the_lock_refuses_is_counted(device):
    """Nearest first: the second and all later fragments are known to be too far."""
    with drawn(device, "kplus-array", stack(sorted(DEPTHS)), k=1) as frame:
        store = work_of(frame)["store"]
    assert store["refused"] == (len(DEPTHS) - 1) * PIXELS
    assert store["spins"] == store["longest_wait"] == 0
