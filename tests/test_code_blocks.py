"""Every block of code in README and docs is what it says: commands, what they print, and text that parses."""

import ast
import json
import re
import shlex
import shutil
import time
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import pytest
import yaml
from PIL import Image

from mfr_bench.cli.main import cli
from mfr_bench.cli.output import WIDEST
from mfr_bench.methods import catalog, outside

from .cli.conftest import mfr, on_device  # noqa: F401
from .printed import agrees, comparable, steps

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
SHELL = ("sh", "bash", "console")
PARSERS = {"python": ast.parse, "json": json.loads, "yaml": lambda text: list(yaml.safe_load_all(text))}
KNOWN = {*SHELL, *PARSERS, "glsl", "c", "cpp", "c++", "text", "toml", "diff", ""}
# What is not run here takes over a minute, or needs what a test has not; tests of their own run all but the first.
NOT_RUN = {"meshes fetch": "a network", "run --mesh": "minutes at 1280x720 without a GPU", "decide": "two minutes",
           "versus": "minutes, and a repository", "stress --profile smoke": "every stressor, minutes",
           "stress --time-budget": "as long as it says",
           "status /shared": "a folder at the root", "collect /shared": "a folder at the root",
           "race all": "minutes: every method and option",
           "advise results --max-error 1/255 --memory-mb 64 --devices": "results of two devices"}
# Files of the names of shipped configs: the same words measure a few cells, of scenes that no other name has.
SMALL = """\
name: {name}
title: Stand-in
scene: {{size: [24, 16], depth_complexity: 2}}
methods: [ab-array, kplus-array]
zip: {{scene.depth_complexity: [2, {depth}], k: [2, 8]}}
measure: {{target_rel_ci: 0.5, min_samples: 7, max_samples: 7, time_limit_s: 0.2}}
figures: [{{kind: lines, x: k, y: time_ms}}]
"""
SHIPPED = {path.stem for path in (ROOT / "configs").glob("*.yaml")}
RESULTS = {"node1": "pareto", "node2": "effects", "results/old": "smoke", "results/new": "smoke", "results": "coplanar"}
LIMIT_S = 240
ENDINGS = {"compare": (0, 4, 5)}  # what it says of two runs, which noise decides


def blocks(page):
    """The language and the text of each block, as (page, language, text)."""
    found = re.findall(r"^( *)```([\w+]*)[^\n]*\n(.*?)^\1```", page.read_text(), flags=re.DOTALL | re.MULTILINE)
    return [(page.name, language, text) for _, language, text in found]


BLOCKS = [block for page in PAGES for block in blocks(page)]


def commands(language, text):
    """The words of each call of mfr-bench in a shell's block."""
    lines = [command for command, _ in steps(text)] if language == "console" else text.replace("\\\n", " ").splitlines()
    for line in lines:
        lexer = shlex.shlex(line, posix=True, punctuation_chars="|&;<>()")
        lexer.whitespace_split, call = True, []
        for word in [*lexer, ";"]:
            if set(word) <= set("|&;<>()"):
                yield from [call[call.index("mfr-bench") + 1:]] if "mfr-bench" in call else []
                call = []
            else:
                call.append(word)


CALLS = [(page, tuple(call)) for page, language, text in BLOCKS if language in SHELL
         for call in commands(language, text)]


def test_pages_have_blocks_of_known_languages():
    assert CALLS
    assert {language for _, language, _ in BLOCKS} <= KNOWN


@pytest.mark.parametrize(("page", "language", "text"), [b for b in BLOCKS if b[1] in PARSERS],
                         ids=lambda value: str(value)[:24])
def test_text_of_a_language_parses(page, language, text):
    PARSERS[language](text)


@pytest.mark.parametrize(("page", "call"), dict.fromkeys(CALLS), ids=lambda value: str(value)[:60])
def test_commands_and_options_are_there(page, call):
    name, *words = call
    if name.startswith("-"):
        return
    assert name in cli.commands, f"{page}: mfr-bench {' '.join(call)}"
    options = {opt for p in cli.commands[name].params for opt in (*p.opts, *p.secondary_opts)} | {"-h", "--help"}
    assert [w for w in words if w.startswith("--") and w.partition("=")[0] not in options] == []


def settle(page, language, text, mfr):  # noqa: F811
    """Put what a block takes for granted into this folder: configs that take no time or are of its page, results, …"""
    for _, _, config in (block for block in BLOCKS if block[:2] == (page, "yaml")):
        if isinstance(settings := yaml.safe_load(config), dict) and "methods" in settings:
            Path(f"{settings['name']}.yaml").write_text(config)
    measured = [word for call in commands(language, text) if call[0] in ("run", "submit") for word in call[1:]]
    for name in SHIPPED.intersection([*RESULTS.values(), *measured]):
        Path(name).write_text(SMALL.format(name=name, depth=len(name)))
    Path("cluster.yaml").write_text("engine: local\nstore: store\nkinds: {cpu: {shares: 1, device: cpu}}\n")
    if "examples/" in text:
        shutil.copytree(ROOT / "examples", "examples", ignore=shutil.ignore_patterns("__pycache__"))
    Image.new("RGB", (12, 8), (90, 140, 60)).save("photo.jpg")
    for folder, name in RESULTS.items():
        if folder in text:
            assert mfr("run", name, "--out", f"{folder}/{name}", "--quiet").status == 0


def runs_here(call):
    return not call[0].startswith("-") and not " ".join(call).startswith(tuple(NOT_RUN))


def expanded(call):
    """The words as a shell gives them: the date of today is the only thing that pages leave to it."""
    return [re.sub(r"\$\(date -u \+%F\)", "2026-11-28", word) for word in call]


RUN = [(page, language, text, calls) for page, language, text in BLOCKS if language in SHELL
       and (calls := [tuple(call) for call in commands(language, text) if runs_here(call)])]


@pytest.fixture
def no_methods_from_outside(monkeypatch):
    """What a block adds to the catalog is gone behind it."""
    monkeypatch.setenv(outside.VARIABLE, "")
    yield
    monkeypatch.undo()
    for cached in (outside.loaded, catalog):
        cached.cache_clear()


@pytest.mark.usefixtures("on_device", "no_methods_from_outside")
@pytest.mark.parametrize(("page", "language", "text", "calls"), RUN,
                         ids=[f"{page}-{calls[0][0]}" for page, _, _, calls in RUN])
def test_the_commands_of_a_block_run_in_their_order(page, language, text, calls, tmp_path, monkeypatch,
                                                    mfr):  # noqa: F811
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.setenv("COLUMNS", str(WIDEST))  # as pages are written
    settle(page, language, text, mfr)
    told = {tuple(shlex.split(command)[1:]): said for command, said in steps(text)} if language == "console" else {}
    for call in calls:
        catalog.cache_clear()
        if call[0] == "status":
            until_tasks_end(mfr)
        done = mfr(*expanded(call))
        assert done.status in ENDINGS.get(call[0], (0,)), f"{page}: {' '.join(call)}: {done.status}: {done.err[-300:]}"
        if call in told:
            assert agrees(told[call], done.out), f"{page}: {' '.join(call)} prints\n" + "\n".join(comparable(done.out))


@pytest.mark.usefixtures("on_device")
def test_python_that_loads_results_runs(tmp_path, monkeypatch, mfr):  # noqa: F811
    monkeypatch.chdir(tmp_path)
    mpl.use("agg")
    (text,) = (text for _, language, text in BLOCKS if language == "python" and "mfr_bench.load" in text)
    settle("", "sh", "mfr-bench table results", mfr)
    names = {}
    exec(text, names)  # noqa: S102 - a page of this repository
    assert len(names["results"].cells) == 6
    plt.close("all")


def until_tasks_end(mfr):  # noqa: F811
    """A page's next command may read what the tasks of `submit` write."""
    ends = time.monotonic() + LIMIT_S
    while "running" in mfr("status", "store").out and time.monotonic() < ends:
        time.sleep(0.2)


def test_what_is_not_run_is_on_a_page():
    assert all(any(" ".join(call).startswith(words) for _, call in CALLS) for words in NOT_RUN)


def test_pages_say_what_commands_print():
    assert sum(language == "console" and any(said for _, said in steps(text)) for _, language, text in BLOCKS) >= 3


PRINTED = """\
method     Time, ms   Ratio to the fastest   Memory, MiB
--------------------------------------------------------
ab-ll    1.52 ±0.7 %                fastest         0.516
mlab     1.61 ±12 % ~   ≈ 1.06 [0.99, 1.13]         0.250

2 cells: 2 ok
noise floor 1.3 %: the same method measured twice differs by that
tables  results/llvmpipe/my/tables/results.md
"""


@pytest.mark.parametrize(("right", "other", "agree"), [
    ("1.52 ±0.7 %", "0.61 ±3 % ~", True), ("1.3 %", "22 %", True), ("llvmpipe", "nvidia-h200", True),
    ("ab-ll    1.52 ±0.7 %                fastest         0.516\n", "…\n", True),
    ("0.516", "0.517", False), ("mlab ", "mboit", False), ("2 cells: 2 ok", "2 cells: 1 ok", False),
    ("2 cells: 2 ok\n", "", False), ("differs", "differed", False)])
def test_what_is_measured_may_differ_and_nothing_else(right, other, agree):
    assert right in PRINTED
    assert agrees(PRINTED.replace(right, other), PRINTED) == agree


def test_rows_may_stand_in_the_order_of_another_run():
    first, second = (next(line for line in PRINTED.splitlines() if line.startswith(m)) for m in ("ab-ll", "mlab"))
    swapped = PRINTED.replace(f"{first}\n{second}", f"{second}\n{first}")
    assert swapped != PRINTED and agrees(swapped, PRINTED)
