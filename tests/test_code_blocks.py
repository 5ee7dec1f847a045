"""Every block of code in README and docs is what it says: commands that there are, and text that parses."""

import ast
import json
import re
import shlex
import shutil
import time
from pathlib import Path

import pytest
import yaml
from PIL import Image

from mfr_bench.cli.main import cli
from mfr_bench.methods import catalog, outside

from .cli.conftest import mfr, on_device  # noqa: F401

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
SHELL = ("sh", "bash", "console")
PARSERS = {"python": ast.parse, "json": json.loads, "yaml": lambda text: list(yaml.safe_load_all(text))}
KNOWN = {*SHELL, *PARSERS, "glsl", "c", "cpp", "c++", "text", "toml", "diff", ""}
# What is not run here takes over a minute, or needs what a test has not; tests of their own run all but the first.
NOT_RUN = {"meshes fetch": "a network", "run --mesh": "minutes at 1280x720 without a GPU", "decide": "two minutes",
           "versus": "minutes, and a repository", "stress --profile smoke": "every stressor, minutes",
           "status /shared": "a folder at the root", "collect /shared": "a folder at the root",
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


def commands(text):
    """The words of each call of mfr-bench in a shell's block."""
    for line in text.replace("\\\n", " ").splitlines():
        lexer = shlex.shlex(line.removeprefix("$ "), posix=True, punctuation_chars="|&;<>()")
        lexer.whitespace_split, call = True, []
        for word in [*lexer, ";"]:
            if set(word) <= set("|&;<>()"):
                yield from [call[call.index("mfr-bench") + 1:]] if "mfr-bench" in call else []
                call = []
            else:
                call.append(word)


CALLS = [(page, tuple(call)) for page, language, text in BLOCKS if language in SHELL for call in commands(text)]


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


def settle(text, mfr):  # noqa: F811
    """Put what a block takes for granted into this folder: configs that take no time, results, a cluster, a photo."""
    measured = [word for call in commands(text) if call[0] in ("run", "submit") for word in call[1:]]
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


RUN = [(page, text, calls) for page, language, text in BLOCKS if language in SHELL
       and (calls := [tuple(call) for call in commands(text) if runs_here(call)])]


@pytest.fixture
def no_methods_from_outside(monkeypatch):
    """What a block adds to the catalog is gone behind it."""
    monkeypatch.setenv(outside.VARIABLE, "")
    yield
    monkeypatch.undo()
    for cached in (outside.loaded, catalog):
        cached.cache_clear()


@pytest.mark.usefixtures("on_device", "no_methods_from_outside")
@pytest.mark.parametrize(("page", "text", "calls"), RUN, ids=[f"{page}-{calls[0][0]}" for page, _, calls in RUN])
def test_the_commands_of_a_block_run_in_their_order(page, text, calls, tmp_path, monkeypatch, mfr):  # noqa: F811
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    settle(text, mfr)
    for call in calls:
        catalog.cache_clear()
        if call[0] == "status":
            until_tasks_end(mfr)
        done = mfr(*expanded(call))
        assert done.status in ENDINGS.get(call[0], (0,)), f"{page}: {' '.join(call)}: {done.status}: {done.err[-300:]}"


def until_tasks_end(mfr):  # noqa: F811
    """A page's next command may read what the tasks of `submit` write."""
    ends = time.monotonic() + LIMIT_S
    while "running" in mfr("status", "store").out and time.monotonic() < ends:
        time.sleep(0.2)


def test_what_is_not_run_is_on_a_page():
    assert all(any(" ".join(call).startswith(words) for _, call in CALLS) for words in NOT_RUN)
