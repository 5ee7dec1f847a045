"""Help that teaches by example, completion, and the lists that need no device."""

import subprocess

import click
import pytest

from mfr_bench import __version__
from mfr_bench.cli.main import cli
from mfr_bench.cli.output import note
from mfr_bench.config import shipped

from .conftest import command, environment

COMMANDS = sorted(cli.commands)


def test_the_help_lists_every_command_and_exit_status(mfr):
    ended = mfr("--help")
    assert ended.status == 0
    assert {"run", "plot", "table", "methods", "doctor", "scene", "render", "shader", "configs"} <= set(COMMANDS)
    for name in COMMANDS:
        assert f"\n  {name} " in ended.out
    assert list(cli.commands) == cli.list_commands(None)
    assert "..." not in ended.out.partition("Options:")[2]  # no line is cut
    assert "Examples:" in ended.out
    assert "Exit status: 0 done; 1 " in ended.out
    assert "_MFR_BENCH_COMPLETE" in ended.out


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_explains_itself(mfr, name):
    ended = mfr(name, "-h")
    assert ended.status == 0
    assert ended.out.startswith(f"Usage: mfr-bench {name}")
    assert "Example" in ended.out
    assert "Show this message and exit." in ended.out


@pytest.mark.parametrize("arguments", [[], *([name] for name in COMMANDS)], ids=" ".join)
def test_help_fits_80_columns(mfr, monkeypatch, arguments):
    monkeypatch.setenv("COLUMNS", "80")
    assert max(map(len, mfr(*arguments, "--help").out.splitlines())) <= 80


@pytest.mark.parametrize("arguments", [[], *([name] for name in COMMANDS)], ids=" ".join)
@pytest.mark.parametrize("columns", [60, 71])
def test_help_breaks_no_word_on_a_narrow_terminal(arguments, columns):
    """Every word and option of the wide help is whole in the narrow one, and no line is left to the terminal."""
    shown = cli.commands[arguments[0]] if arguments else cli
    wide, narrow = (shown.get_help(click.Context(shown, info_name="mfr-bench", terminal_width=width, color=False))
                    for width in (400, columns))
    assert narrow.split() == wide.split()
    assert all(len(line) <= columns or len(line.split()) <= 2 for line in narrow.splitlines())


@pytest.mark.parametrize("name", COMMANDS)
def test_help_speaks_of_a_config_only_where_one_is_given(name):
    """The options of a scene of one's own are shared by `run`, which takes a CONFIG, and `decide`, which does not."""
    command = cli.commands[name]
    takes = any("CONFIG" in (p.metavar or "") for p in command.params if isinstance(p, click.Argument))
    assert takes or not [p.opts[0] for p in command.params if "a CONFIG" in (getattr(p, "help", None) or "")]


@pytest.mark.parametrize("name", COMMANDS)
def test_an_option_says_in_words_what_it_takes(name):
    """'FLOAT RANGE' and '0<x<=1' are click's own words, for an option that names no unit and no range."""
    shown = cli.commands[name].get_help(click.Context(cli.commands[name], info_name=name, color=False))
    assert not [word for word in ("RANGE", "INTEGER", "FLOAT", "DIRECTORY", "PATH", "<=") if word in shown]


def test_a_complaint_breaks_no_word_on_a_narrow_terminal(monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "60")
    said = "mfr-bench run: No such option '--forc'. Did you mean '--force', '--time-budget'?; see mfr-bench run --help"
    note(said)
    assert capsys.readouterr().err == said + "\n"  # for programs a line stays a line
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    note(said)
    shown = capsys.readouterr().err
    assert shown.split() == said.split()
    assert max(map(len, shown.splitlines())) <= 60


def test_the_version_is_the_packages(mfr):
    assert mfr("--version").out == f"mfr-bench, version {__version__}\n"


def test_shipped_configs_are_listed_by_the_names_that_run_takes(mfr):
    lines = mfr("configs").out.splitlines()
    assert [line.split()[0] for line in lines] == list(shipped())
    assert any(line.startswith("smoke ") and line.endswith("Time of every method on one small scene") for line in lines)
    assert any(line.endswith("(kplus2015 Fig. 6)") for line in lines)
    assert any(line.endswith("(kplus2015 Table 1)") for line in lines)


def completed(words):
    done = subprocess.run(command(), capture_output=True, text=True, check=False, env=environment(
        COMP_WORDS=words, COMP_CWORD=str(len(words.split(" ")) - 1), _MFR_BENCH_COMPLETE="bash_complete"))
    return [line.partition(",")[2] for line in done.stdout.splitlines()]


@pytest.mark.parametrize(("words", "found"), [
    ("mfr-bench ta", ["table"]), ("mfr-bench run smo", ["smoke"]), ("mfr-bench run smoke --dev", ["--device"]),
    ("mfr-bench run smoke --device c", ["cpu"]), ("mfr-bench shader kplus-h", ["kplus-heap"]),
    ("mfr-bench run smoke --only zbuffer,kplus-h", ["zbuffer,kplus-heap"]),
    ("mfr-bench run smoke --profile sm", ["smoke"]), ("mfr-bench render smoke --profile sm", ["smoke"]),
    ("mfr-bench run smoke --profile zz", []), ("mfr-bench run no-such-config --profile sm", []),
    ("mfr-bench run smoke --set scene.fragment_p", ["scene.fragment_probability="]),
    ("mfr-bench run smoke --set stop_op", ["stop_opacity="]), ("mfr-bench shader kplus-array --pass res", ["resolve"]),
])
def test_shells_complete_names(words, found):
    assert completed(words)[:len(found)] == found


def test_the_script_for_the_shell_is_printed():
    done = subprocess.run(command(), capture_output=True, text=True, check=True,
                          env=environment(_MFR_BENCH_COMPLETE="bash_source"))
    assert "complete " in done.stdout
    assert "mfr-bench" in done.stdout
