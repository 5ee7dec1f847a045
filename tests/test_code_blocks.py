"""Every block of code in README and docs is what it says: commands that there are, and text that parses."""

import ast
import json
import re
import shlex
from pathlib import Path

import pytest
import yaml

from mfr_bench.cli.main import cli

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
SHELL = ("sh", "bash", "console")
PARSERS = {"python": ast.parse, "json": json.loads, "yaml": lambda text: list(yaml.safe_load_all(text))}
KNOWN = {*SHELL, *PARSERS, "glsl", "c", "cpp", "c++", "text", "toml", "diff", ""}
ALONE = ("configs", "schema", "scene", "shader", "new-method", "stress --list")  # no device, no results, no time


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


@pytest.mark.parametrize("call", [c for c in dict.fromkeys(c for _, c in CALLS) if " ".join(c).startswith(ALONE)],
                         ids=" ".join)
def test_commands_that_need_nothing_run(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert cli.main([*call], standalone_mode=False) in (None, 0)
