"""Mistakes in a command: one line that says what is allowed, with the nearest name, and exit status 2."""

import click
import pytest

from mfr_bench.cli.main import cli

from .conftest import TINY

MISTAKES = [
    (["rnu", "smoke"], "mfr-bench: no command 'rnu'; nearest: 'run'; allowed: run, ", "; see mfr-bench --help"),
    (["run"], "mfr-bench run: Missing argument 'CONFIG...', --mesh FILE or --fragments FILE; ",
     "for example: mfr-bench run smoke; see mfr-bench run --help"),
    (["run", "--mesh", "a.obj"], "--mesh: there is no file 'a.obj'; allowed: an OBJ, PLY, STL, GLB or glTF file; ",
     "'mfr-bench meshes' lists some to fetch"),
    (["decide", "--mesh", "tiny.yam"], "--mesh: there is no file 'tiny.yam'; allowed: ",
     "; nearest: 'tiny.yaml'; 'mfr-bench meshes' lists some to fetch"),
    (["run", "--fragments", "no/a.npz"], "--fragments: there is no file 'no/a.npz'; allowed: an .npz of recorded",
     "'mfr-bench scene CONFIG --fragments F.npz' writes one"),
    (["decide", "--mesh", "."], "mfr-bench decide: Invalid value for '--mesh': '.' is a folder; allowed: an OBJ, PLY, ",
     "STL, GLB or glTF file; see mfr-bench decide --help"),
    (["run", "--fragments", ""], "mfr-bench run: Invalid value for '--fragments': '' is no file; allowed: an .npz of ",
     "see mfr-bench run --help"),
    (["decide", "--memory-mb", "lots"], "mfr-bench decide: Invalid value for '--memory-mb': 'lots' is not allowed; ",
     "allowed: a number above 0, up to 16777216; see mfr-bench decide --help"),
    (["decide", "--layers", "2.5"], "mfr-bench decide: Invalid value for '--layers': '2.5' is not allowed; ",
     "allowed: a whole number from 1 to 4096; see mfr-bench decide --help"),
    (["decide", "--size", "1280"], "--size: '1280' is no size; allowed: WIDTHxHEIGHT in pixels, ", "such as 1280x720"),
    (["decide", "--config", ""], "mfr-bench decide: Invalid value for '--config': '' is no config; allowed: ", ""),
    (["race", "kb", "--schedules", "0"], "mfr-bench race: Invalid value for '--schedules': '0' is not allowed; ",
     "allowed: a whole number of at least 1; see mfr-bench race --help"),
    (["race", "kb", "--replay", ""], "--replay: '' is no schedule; allowed: the word that race prints", ""),
    (["meshes", "fetsh"], "mfr-bench meshes: Invalid value for '[list|fetch]': 'fetsh' is not allowed; ",
     "allowed: list, fetch; nearest: 'fetch'; see mfr-bench meshes --help"),
    (["methods", "--methods", "nowhere"], "mfr-bench methods: Invalid value for '--methods': 'nowhere' is no folder; ",
     "'mfr-bench new-method' makes it; see mfr-bench methods --help"),
    (["run", "--mesh", "a.obj", "--fragments", "a.npz"], "--mesh with --fragments; allowed: one way to give the ", ""),
    (["scene", "tiny.yaml"], "scene: nothing to write; allowed: --out FILE.npz, --fragments FILE.npz, or both", ""),
    (["scene", "tiny.yaml", "--fragments", "a.npy"], "--fragments: 'a.npy' has another ending; allowed: ", ""),
    (["run", ""], "mfr-bench run: Invalid value for 'CONFIG...': '' is no config; allowed: a file, ", "run --help"),
    (["run", "smok"], "smok: no such file, folder or shipped config; nearest: 'smoke', ",
     ", which 'mfr-bench configs' lists"),
    (["run", "nothing-like-it"], "nothing-like-it: no such file, folder or shipped config; allowed: any of ",
     ", which 'mfr-bench configs' lists"),
    (["run", "smoke.yaml"], "smoke.yaml: no such file or folder; nearest: 'smoke'", ""),
    (["run", "tiny.yaml", "--only", "kplus-aray"],
     "--only: unknown method 'kplus-aray'; nearest: 'kplus-array', 'kplus-array-r', 'kplus-heap'; allowed: any of ",
     ", which 'mfr-bench methods' lists"),
    (["run", "tiny.yaml", "--only", ""], "--only: unknown method ''; allowed: ", ""),
    (["run", "tiny.yaml", "--only", "kplus-array,"], "--only: unknown method ''; allowed: ", ""),
    (["run", "tiny.yaml", "--only", "zbuffer"], "tiny: --only zbuffer leaves no cell; allowed: ab-array, ", ""),
    (["run", "tiny.yaml", "--set", "k"], "--set k: not a setting; allowed: KEY=VALUE, such as k=8", ""),
    (["run", "tiny.yaml", "--set", "k=0"], "--set k: 0 is not allowed; allowed: a whole number from 1 to ", ""),
    (["run", "tiny.yaml", "--set", "scene.sede=1"], "--set scene.sede: unknown key; nearest: 'seed'; allowed: ", ""),
    (["run", "tiny.yaml", "--profile", "smok"], "tiny.yaml:", "no profile 'smok'; allowed: none; leave out --profile"),
    (["run", "tiny.yaml", "--device", ""], "mfr-bench run: Invalid value for '--device': '' is no device; allowed: ",
     "or an index, UUID, PCI address or part of a name that 'mfr-bench doctor' lists; see mfr-bench run --help"),
    (["run", "tiny.yaml", "--time-budget", "5"], "--time-budget: '5' is no duration; ", ""),
    (["run", "tiny.yaml", "--split", "5", "--shard", "1/2"], "--split: '5' is no duration; ", ""),
    (["run", "tiny.yaml", "--ot", "x"], "mfr-bench run: No such option '--ot'", "see mfr-bench run --help"),
    (["run", "tiny.yaml", "--out", ""], "mfr-bench run: Invalid value for '--out': '' is no place to write to",
     "; allowed: the name of a folder; see mfr-bench run --help"),
    (["table", ""], "mfr-bench table: Invalid value for 'DIR...': '' is no place to read; allowed: the name of ", ""),
    (["submit", "tiny.yaml", "--cluster", ""], "mfr-bench submit: Invalid value for '--cluster': '' is no place to ",
     "allowed: the name of a file; see mfr-bench submit --help"),
    (["scene", "tiny.yaml", "--out", ""], "mfr-bench scene: Invalid value for '--out': '' is no place to ", ""),
    (["run", "--out"], "mfr-bench run: Option '--out' requires an argument; see mfr-bench run --help", ""),
    (["run", "tiny.yaml", "--quiet=5"], "mfr-bench run: Option '--quiet' does not take a value; see ", ""),
    (["--man=5"], "mfr-bench: Option '--man' does not take a value; see mfr-bench --help", ""),
    (["verify", "two"], "two: a folder; allowed: a bundle, one .zip; ",
     'mfr-bench submit-results two --sign-off "YOUR NAME" --out bundle.zip'),
    (["configs", "--kinds", "--fidelity"], "configs: more than one of --papers, --markdown, --kinds and --fidelity",
     "allowed: one, or none for text"),
    (["methods", "--json", "--markdown"], "methods: more than one of --json, --markdown, --rounding and --fairness",
     "allowed: one, or none for text"),
    (["plot"], "mfr-bench plot: Missing argument 'DIR...'; for example: mfr-bench plot results/nvidia-h200/smoke; see ",
     "mfr-bench plot --help"),
    (["plot", "nowhere"], "nowhere: no such folder; allowed: a folder that 'mfr-bench run' wrote", ""),
    (["table", "."], ".: no results in or below it; allowed: a folder that 'mfr-bench run' wrote", ""),
    (["shader", "kplus-aray"], "METHOD: unknown method 'kplus-aray'; nearest: 'kplus-array', ",
     ", which 'mfr-bench methods' lists"),
    (["shader", "kplus-array", "--pass", "stor"], "--pass: kplus-array has no pass 'stor'; allowed: clear, ",
     "; nearest: 'store'"),
    (["scene", "tiny.yaml", "--out", "."], "mfr-bench scene: Invalid value for '--out': File '.' is a directory", ""),
    (["render", "tiny.yaml", "--out", "a.png"], "mfr-bench render: Missing option '--method'; for example: ",
     "mfr-bench render smoke --method kplus-array --set k=8 --out image.png; see mfr-bench render --help"),
    (["render", "tiny.yaml", "--method", "ab-array", "--out", "a.jpg"],
     "--out: 'a.jpg' has another ending; allowed: a file that ends in .npy or .png", ""),
    (["scene", "tiny.yaml", "--out", "s.npy"],
     "--out: 's.npy' has another ending; allowed: a file that ends in .npz", ""),
    (["render", "two", "--method", "ab-array", "--out", "a.npy"], "two: 2 configs; allowed: one file, or the name", ""),
]


@pytest.mark.parametrize(("arguments", "begins", "ends"), MISTAKES, ids=[" ".join(m[0]) or "none" for m in MISTAKES])
def test_a_mistake_is_one_line_and_exit_2(mfr, tiny, here, arguments, begins, ends):
    (here / "two").mkdir()
    for name in ("a", "b"):
        (here / "two" / f"{name}.yaml").write_text(TINY.replace("name: tiny", f"name: {name}"))
    ended = mfr(*arguments)
    assert ended.status == 2
    assert ended.complaint.startswith(begins)
    assert ended.complaint.endswith(ends)


def test_all_mistakes_of_all_configs_are_told_at_once(mfr, here):
    (here / "a.yaml").write_text(TINY.replace("size: [32, 24]", "size: [0, 24]").replace("ab-array", "ab-aray"))
    (here / "b.yaml").write_text(TINY.replace("title", "titel"))
    ended = mfr("run", "a.yaml", "b.yaml", "absent.yaml", "--out", "out")
    assert ended.status == 2
    assert ended.out == ""
    lines = ended.err.splitlines()
    assert [line.split(": ")[0] for line in lines] == ["a.yaml:3", "a.yaml:4", "b.yaml:2", "absent.yaml"]
    assert "nearest: 'ab-array'" in lines[1]
    assert "nearest: 'title'" in lines[2]
    assert not (here / "out").exists()


def test_no_command_is_the_help_and_exit_2(mfr):
    ended = mfr()
    assert ended.status == 2
    assert ended.out.startswith("Usage: mfr-bench ")
    assert ended.err == ""


NUMBERS = (click.types.FloatParamType, click.types.IntParamType)


def options_of_numbers():
    return [(name, option.opts[0]) for name, command in cli.commands.items() for option in command.params
            if isinstance(option.type, NUMBERS)]


def test_every_number_is_found():
    assert {("plot", "--dpi"), ("versus", "--seconds"), ("decide", "--layers")} <= set(options_of_numbers())


@pytest.mark.parametrize("value", ["nan", "lots", "", "-5"])
@pytest.mark.parametrize(("name", "option"), options_of_numbers())
def test_what_is_outside_a_range_is_told_what_is_allowed(mfr, name, option, value):
    ended = mfr(name, "x", option, value)
    assert ended.status == 2
    assert f"Invalid value for '{option}': '{value}' is not allowed; allowed: a " in ended.complaint


@pytest.mark.parametrize("name", [name for name, command in cli.commands.items() if
                                  any(param.required for param in command.params)])
def test_what_is_missing_is_shown_by_an_example(mfr, name):
    ended = mfr(name)
    assert ended.status == 2
    assert f"; for example: mfr-bench {name} " in ended.complaint
