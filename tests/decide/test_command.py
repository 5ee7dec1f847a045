"""`mfr-bench decide` on the software driver, small: an answer, with all that was excluded and why."""

import json
import re
import time

import pytest

from mfr_bench.store import ResultFolder

from ..cli.conftest import here, mfr, on_device  # noqa: F401  fixtures

QUESTION = ("decide", "--size", "24x20", "--layers", "5", "--time-budget", "40s")


@pytest.fixture(autouse=True)
def young(monkeypatch):
    """A process that starts with the command: that of the tests is older than any budget."""
    monkeypatch.setattr("mfr_bench.decide.budget.started", time.monotonic)


@pytest.fixture
def few(monkeypatch):
    """A catalog of a few methods, so that the race is short."""
    from mfr_bench import methods
    from mfr_bench.report import style

    whole = methods.catalog()
    chosen = {name: whole[name] for name in ("floor", "ab-array", "peel-f2b", "kplus-array", "wboit", "zbuffer")}
    monkeypatch.setattr(methods, "catalog", lambda: chosen)
    style.method_colours.cache_clear()
    yield
    style.method_colours.cache_clear()


def test_an_answer_names_the_fastest_and_why_the_others_are_out(mfr, on_device, few, here):  # noqa: F811
    ended = mfr(*QUESTION, "--json")
    assert ended.status == 0
    answer = json.loads(ended.out)
    assert {"method", "params", "time_ms", "memory_bytes", "max_error", "confidence"} <= set(answer)
    assert answer["method"] in ("ab-array", "kplus-array", "peel-f2b")
    assert answer["max_error"] <= 1e-4 and 0 <= answer["confidence"] <= 1 and answer["time_ms"] > 0
    reasons = {entry["method"]: entry["reason"] for entry in answer["excluded"]}
    assert {"wboit", "zbuffer"} <= set(reasons)
    folder, = (here / "results").glob("*/decide-*")
    assert (folder / "decide.yaml").exists()
    marked = ResultFolder(folder).manifest()["answer"]  # for the figure, which frames it
    assert ResultFolder(folder).cell(marked["key"])["method"] == answer["method"]
    assert abs(marked["confidence"] - answer["confidence"]) <= 0.01  # in whole percents, as the text has it


def test_a_second_time_nothing_is_measured_again(mfr, on_device, few, here):  # noqa: F811
    first, second = (json.loads(mfr(*QUESTION, "--out", "d", "--json").out) for _ in range(2))
    assert first["time_ms"] == second["time_ms"] and first["method"] == second["method"]


def test_a_scene_of_quads_need_not_say_so(mfr, on_device, few, here):  # noqa: F811
    """`kind` is left out: with an error allowed, the layers that keep it were looked for by that key."""
    (here / "own.yaml").write_text("name: own\nscene: {size: [8, 8], depth_complexity: 6}\nmethods: [ab-array]\n")
    ended = mfr("decide", "--config", "own.yaml", "--max-error", "0.5", "--time-budget", "6s")
    assert ended.status in (0, 1), ended.err
    assert "layers keep the error" in ended.err


def test_nothing_keeps_a_memory_of_nothing(mfr, on_device, few):  # noqa: F811
    ended = mfr(*QUESTION, "--memory-mb", "0.0001", "--json")
    assert ended.status == 6 and json.loads(ended.out)["method"] is None


def test_the_text_form_fits_a_narrow_terminal(mfr, on_device, few, monkeypatch):  # noqa: F811
    monkeypatch.setenv("COLUMNS", "60")
    ended = mfr(*QUESTION, "--max-error", "1/255")
    assert ended.status == 0 and "Answer: " in ended.out and "Not chosen, the nearest " in ended.out
    told = r"^\d+ candidates; the answer comes within 40 s of the start$"
    assert re.search(told, ended.err, re.MULTILINE)
    assert re.search(r"^decide 1/\d+, \d+ s left to measure  \S", ended.err, re.MULTILINE)  # a line for each that ends
    assert max(len(line) for line in ended.out.splitlines() if not line.startswith("  in full: ")) <= 60


@pytest.mark.parametrize(("arguments", "said"), [
    ((), "no scene; allowed: --size with --layers, --mesh, --fragments, or --config"),
    (("--config", "smoke", "--size", "8x8", "--layers", "2"), "allowed: one way to give the scene"),
    (("--size", "8", "--layers", "2"), "--size: '8' is no size; allowed: WIDTHxHEIGHT"),
    (("--size", "8x8", "--layers", "2", "--time-budget", "soon"), "--time-budget: 'soon' is no duration"),
])
def test_a_bad_question_is_one_line(mfr, here, arguments, said):  # noqa: F811
    ended = mfr("decide", *arguments)
    assert ended.status == 2 and said in ended.complaint


def stacked(path, layers):
    """A mesh of `layers` pairs of faces of one depth, front and back, over the middle of the view."""
    corners = [(x, y, z) for z in range(layers) for x, y in ((0, 0), (1, 0), (0, 1))]
    faces = [face for z in range(layers) for face in ((3 * z, 3 * z + 1, 3 * z + 2), (3 * z, 3 * z + 2, 3 * z + 1))]
    head = (f"ply\nformat ascii 1.0\nelement vertex {len(corners)}\nproperty float x\nproperty float y\n"
            f"property float z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
    path.write_text(head + "".join(f"{x} {y} {z}\n" for x, y, z in corners) + "".join(f"3 {a} {b} {c}\n"
                                                                                     for a, b, c in faces))


def test_the_layers_of_a_mesh_are_counted(mfr, on_device, few, here, monkeypatch):  # noqa: F811
    """What a grid of boxes guesses of it had k-buffers race with too small a k, and leave for their error."""
    monkeypatch.setattr("mfr_bench.cli.decide_command.MESH_DEEPER", 0.3)  # a guess that is too low
    stacked(here / "leaves.ply", 5)
    ended = mfr("decide", "--mesh", "leaves.ply", "--size", "32x24", "--time-budget", "40s")
    assert ended.status == 0 and "up to 10 layers" in ended.out
    assert re.search(r"\b3\d\.\d % of the pixels covered", ended.out)
    assert "error above" not in ended.out
    assert "--set scene.alpha" not in ended.err  # which decide does not take
    assert "Blending floor" not in ended.out


def test_a_mesh_beside_a_config_is_found_from_a_config_elsewhere(here):  # noqa: F811
    """The scene of a question is written into a folder of its own."""
    from mfr_bench.cli.decide_command import _of_config

    stacked(here / "leaves.ply", 2)
    (here / "own.yaml").write_text(
        "name: own\nscene: {kind: mesh, file: leaves.ply, size: [16, 12]}\nmethods: [ab-array]\n")
    _, scene = _of_config("own.yaml", None, 1e-4)
    assert scene["file"] == str(here.resolve() / "leaves.ply")
