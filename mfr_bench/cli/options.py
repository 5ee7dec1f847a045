"""Arguments that several commands share, with completion."""

from __future__ import annotations

import json
import math
from pathlib import Path

import click

from ..errors import nearest, one_of


class ConfigName(click.ParamType):
    """A file, a folder, or the name of a shipped config."""

    name = "config"

    def convert(self, value, param, context):
        if not value:
            self.fail("'' is no config; allowed: a file, a folder, or a name that 'mfr-bench configs' lists")
        return value

    def shell_complete(self, context, param, incomplete):
        from click.shell_completion import CompletionItem

        from ..config import shipped

        names = [CompletionItem(n) for n in shipped() if n.startswith(incomplete)]
        return names or [CompletionItem(incomplete, type="file")]


class Share(click.ParamType):
    """One of several shares: '2/4' is (2, 4)."""

    name = "share"

    def convert(self, value, param, context):
        from ..plan.shards import MOST_SHARES

        number, _, count = str(value).partition("/")
        if not (number.isdecimal() and count.isdecimal() and 1 <= int(number) <= int(count) <= MOST_SHARES):
            self.fail(f"{value!r} is no share; allowed: I/N with 1 <= I <= N <= {MOST_SHARES}, such as 2/4")
        return int(number), int(count)


class MethodName(click.ParamType):
    """The id of a method, or several with commas between."""

    name = "method"

    def shell_complete(self, context, param, incomplete):
        from click.shell_completion import CompletionItem

        from ..methods import catalog

        done, _, last = incomplete.rpartition(",")
        return [CompletionItem(f"{done},{i}" if done else i) for i in catalog() if i.startswith(last)]


def _arguments(context) -> list[str]:
    """The arguments before an option that is being completed: click does not assign them while it lacks its value."""
    assigned = context.params.get("configs") or [context.params[n] for n in ("config", "method_id") if
                                                 context.params.get(n)]
    return [*context.args, *assigned]


class ProfileName(click.ParamType):
    """The name of a profile, completed from the configs that the command line has so far."""

    name = "profile"

    def shell_complete(self, context, param, incomplete):
        from click.shell_completion import CompletionItem

        from ..config.loading import profile_names

        return [CompletionItem(name) for name in profile_names(_arguments(context)) if name.startswith(incomplete)]


class SettingText(click.ParamType):
    """KEY=VALUE, completed up to the equals sign."""

    name = "setting"

    def shell_complete(self, context, param, incomplete):
        from click.shell_completion import CompletionItem

        from ..config.layers import KEYS
        from ..methods import catalog

        params = (p.name for method in catalog().values() for p in method.params)
        return [CompletionItem(f"{key}=") for key in dict.fromkeys([*params, "r", *KEYS]) if key.startswith(incomplete)]


class PassName(click.ParamType):
    """The name of a pass, completed from the method that the command line has so far."""

    name = "pass"

    def shell_complete(self, context, param, incomplete):
        from click.shell_completion import CompletionItem

        from ..methods import catalog

        chosen = next((catalog()[word] for word in _arguments(context) if word in catalog()), None)
        return [CompletionItem(name) for name in (chosen.pass_names if chosen else ()) if name.startswith(incomplete)]


class InPath(click.Path):
    """A file or folder to read: an empty name, as an unset variable gives it, would be the working folder."""

    use = "read"

    def convert(self, value, param, context):
        if not value:
            kinds = " or ".join(["a file"] * self.file_okay + ["a folder"] * self.dir_okay)
            self.fail(f"'' is no place to {self.use}; allowed: the name of {kinds}")
        return super().convert(value, param, context)


class OutPath(InPath):
    """A file or folder to write to."""

    use = "write to"


class _InWords:
    """A range of click that says in words what is allowed: a mixin of its number types, `what` in the singular."""

    what: str

    def convert(self, value, param, context):
        try:
            found = super().convert(value, param, context)
        except click.BadParameter:
            found = math.nan
        if math.isnan(found):  # which no comparison with a bound tells
            self.fail(f"{value!r} is not allowed; allowed: {self.what} {self._bounds}")
        return found

    def _describe_range(self) -> str:
        """The bounds in the words of a complaint, for the help; click writes '0<x<=1'."""
        return self._bounds.removeprefix("of ")

    @property
    def _bounds(self) -> str:
        if self.max is None:
            return f"of at least {self.min}"
        return f"above {self.min}, up to {self.max}" if self.min_open else f"from {self.min} to {self.max}"


class NumberRange(_InWords, click.FloatRange):
    """A number within bounds."""

    what = "a number"


class WholeRange(_InWords, click.IntRange):
    """A whole number within bounds."""

    what = "a whole number"


class Percentage(click.ParamType):
    """A share in percent, with or without its sign: 2, 2.5 %."""

    name = "percent"

    def convert(self, value, param, context):
        if isinstance(value, float):
            return value
        try:
            share = float(str(value).removesuffix("%").strip()) / 100
        except ValueError:
            share = math.nan
        if not 0 < share <= 1:
            self.fail(f"{value!r} is not allowed; allowed: percent above 0, up to 100, such as 2")
        return share


class OneOf(click.Choice):
    """Names the nearest choice for one that does not exist."""

    def convert(self, value, param, context):
        if value not in self.choices:
            self.fail(f"{value!r} is not allowed; allowed: {', '.join(self.choices)}{nearest(value, self.choices)}")
        return value


class DeviceName(click.ParamType):
    """A kind of device, or one device: whether there is one is known when it is opened."""

    name = "device"
    kinds = ("auto", "gpu", "cpu")

    def convert(self, value, param, context):
        if not value.strip():
            self.fail("'' is no device; allowed: auto, gpu, cpu, or an index, UUID, PCI address or part of a name "
                      "that 'mfr-bench doctor' lists")
        return value.strip()

    def shell_complete(self, context, param, incomplete):
        from click.shell_completion import CompletionItem

        return [CompletionItem(kind) for kind in self.kinds if kind.startswith(incomplete)]


FOLDERS = click.argument("folders", nargs=-1, required=True, metavar="DIR...", type=InPath())
DEVICE = click.option("--device", type=DeviceName(), default="auto", show_default=True, metavar="DEVICE",
                      help="The OpenGL device. auto: a GPU where there is one, else a software driver on the CPU; "
                           "gpu; cpu; or an index, UUID, PCI address or part of one name as doctor lists them.")
SET = click.option("--set", "overrides", multiple=True, metavar="KEY=VALUE", type=SettingText(),
                   help="Change a key of the config, e.g. k=8 or scene.size=[64,64]; may be repeated.")
PROFILE = click.option("--profile", metavar="NAME", type=ProfileName(),
                       help="Lay this profile of the config over it, e.g. smoke.")
FORCE = click.option("--force", is_flag=True, help="Measure cells again that the folder already has.")
KEEP_FAILED = click.option("--keep-failed", is_flag=True, help="Keep cells that crashed, timed out or ran out of "
                           "memory; else they are measured again.")
TRY_HOPELESS = click.option("--try-hopeless", is_flag=True, help="Measure cells although a frame of a smaller one "
                            "already took longer than the time limit.")
DRY_RUN = click.option("--dry-run", is_flag=True,
                       help="Print the plan: what would be measured, its memory and time, what skipped, and why.")
QUIET = click.option("--quiet", is_flag=True, help="Print no progress on stderr, nor where the time went at the end; "
                     "errors still are.")
MARKDOWN = click.option("--markdown", "as_markdown", is_flag=True, help="Print Markdown.")
CSV = click.option("--csv", "as_csv", is_flag=True, help="Print CSV, a row per cell.")
THRESHOLD = click.option("--threshold", metavar="PERCENT", type=Percentage(), default="2", show_default=True,
                         help="Smallest difference that matters.")
WITHIN = click.option("--within", metavar="PERCENT", type=Percentage(), default="20", show_default=True,
                      help="Over devices: how much longer than a device's best counts as near it.")
WHOLE = click.option("--all", "whole", is_flag=True, help="Show every cell, those that are the same too.")
ONLY = click.option("--only", metavar="METHOD,...", type=MethodName(), multiple=True,
                    callback=lambda context, param, value: ",".join(value) if value else None,
                    help="Only these methods, by id.")
JSON = click.option("--json", "as_json", is_flag=True, help="Print JSON.")


def pixels(context, param, value: str | None) -> tuple[int, int] | None:
    """A callback of click: a size such as 1280x720 as (1280, 720). Raises UsageError where it is none."""
    from ..decide.question import parsed_size

    return None if value is None else parsed_size(value)


def seconds(context, param, value: str | None) -> float | None:
    """A callback of click: a duration such as 90s or 8m in seconds. Raises UsageError where it is none."""
    from ..decide.question import parsed_duration

    return None if value is None else parsed_duration(value, param.opts[0])


TIME_BUDGET = click.option("--time-budget", "budget_s", metavar="TIME", callback=seconds,
                           help="Stop measuring in time to end within TIME, as 90s, 8m or 1h: every method and figure "
                                "gets its coarse points before any gets finer ones.")


JUNIT = click.option("--junit", metavar="F", type=OutPath(dir_okay=False),
                     help="Write a JUnit report to F: a test case for each cell.")
SUMMARY = click.option("--summary", metavar="F", type=OutPath(dir_okay=False),
                       help="Append the tables as Markdown to F, such as $GITHUB_STEP_SUMMARY.")


class MethodFolder(click.ParamType):
    """A folder with declarations of one's own."""

    name = "folder"

    def convert(self, value, param, context):
        if not Path(value).is_dir() or not value:
            self.fail(f"{value!r} is no folder; allowed: one with declarations of methods, effects or scenes, as "
                      "'mfr-bench new-method' makes it")
        return value

    def shell_complete(self, context, param, incomplete):
        from click.shell_completion import CompletionItem

        return [CompletionItem(incomplete, type="dir")]


def _use_methods(context, param, folders: tuple[str, ...]) -> None:
    if folders:
        from ..methods.outside import use

        use(folders)
        context.meta[param.name] = folders


OUTSIDE = click.option("--methods", "method_folders", multiple=True, metavar="FOLDER", is_eager=True,
                       expose_value=False, callback=_use_methods, type=MethodFolder(),
                       help="Take the methods, effects and scenes of this folder too, with those of installed "
                            "packages; may be repeated.")


def measuring(what: str, folder: str):
    """The options of a command that measures `what`, each into a `folder` of its own."""
    out = click.option("--out", metavar="DIR", type=OutPath(file_okay=False),
                       help=f"Where results go; with several {what} DIR/{folder}/ each. "
                            f"[default: results/<device>/{folder}]")

    def decorate(command):
        for option in (OUTSIDE, QUIET, DRY_RUN, TIME_BUDGET, TRY_HOPELESS, KEEP_FAILED, FORCE, DEVICE, SET, ONLY,
                       PROFILE, out):
            command = option(command)
        return command
    return decorate


def hold_one_form(command: str, **asked: bool) -> None:
    """Raise UsageError where more than one form of the output is asked for; `asked`: by the name of the option."""
    from ..errors import UsageError

    if sum(asked.values()) > 1:
        *names, last = (f"--{name}" for name in asked)
        raise UsageError(f"{command}: more than one of {', '.join(names)} and {last}; allowed: one, or none for text")


def results_below(folders):
    """The result folders at or below these. Raises UsageError for each that has none."""
    from ..store import ResultFolder, find_results

    return [ResultFolder(path) for path in find_results(folders)]


def method(method_id: str, where: str):
    """The method of this id, given by the argument `where`. Raises UsageError with the nearest id."""
    from ..errors import UsageError
    from ..methods import catalog

    if method_id not in catalog():
        raise UsageError(f"{where}: unknown method {method_id!r}; "
                         f"{one_of(method_id, catalog(), 'mfr-bench methods')}")
    return catalog()[method_id]


def first_experiment(config: str, profile: str | None, overrides: tuple[str, ...], method_id: str | None = None):
    """The one experiment that a command for a single scene or image means, with the method added if it is not listed.

    So the parameters of any method may be set, whichever methods the config lists: those that refuse a value are left
    out.
    """
    from ..config import load
    from ..errors import UsageError
    from ..methods import catalog

    experiments = load(config, catalog(), profile, () if method_id else overrides)
    if len(experiments) != 1:
        raise UsageError(f"{config}: {len(experiments)} configs; allowed: one file, or the name of a shipped config")
    experiment, = experiments
    if method_id is None or not overrides:
        return experiment
    entries = [e for e in experiment.methods if e.id == method_id or _accepts(catalog()[e.id], overrides)]
    return load(config, catalog(), profile, ("figures=[]", _listing(entries, method_id), *overrides))[0]


def _accepts(other, overrides: tuple[str, ...]) -> bool:
    """Whether a method that is not asked for takes every value that is set for a parameter of it."""
    from ..config.layers import override_layer

    values = {s.key.removeprefix("params."): s.value.data for s in override_layer(overrides)[0]}
    for param in other.params:
        try:
            param.parse(values.get(param.name, param.default))
        except ValueError:
            return False
    return True


def _listing(entries, method_id: str) -> str:
    """The override that lists these entries, and the method if none is of it."""
    listed = [{"id": entry.id, "label": entry.label, **entry.params} for entry in entries]
    if method_id not in {entry.id for entry in entries}:
        listed.append({"id": method_id, "label": method_id})
    return f"methods={json.dumps(listed)}"
