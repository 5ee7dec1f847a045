"""`mfr-bench`: the group of commands, and how any of them ends."""

from __future__ import annotations

import sys

import click

from .. import __version__
from ..errors import Interrupted, MfrError, UsageError, one_of
from . import (
    advise_command,
    alive,
    bundle_commands,
    claims_command,
    cluster_commands,
    compare_command,
    decide_command,
    device_commands,
    merge_command,
    meshes_command,
    method_commands,
    pack_commands,
    page_command,
    race_command,
    report_commands,
    run_command,
    scene_command,
    stress_command,
    twochannel_command,
    versus_command,
)
from .layout import Formatter
from .output import let_go_of_stdout, note, prepare_streams, say

EPILOG = """
\b
Examples:
  mfr-bench run smoke                  every method, small, within a minute
  mfr-bench run smoke --dry-run        what is measured, what skipped, and why
  mfr-bench table results              the tables of all that was measured
  mfr-bench doctor                     the OpenGL device, and its self-tests

Exit status: 0 done; 1 a cell crashed, or ran out of time or memory;
2 the command or a config is wrong; 3 an image is wrong, or race broke a
promise; 4 compare or versus found a regression; 5 they could tell nothing, or
miss cells; 6 advise or decide: nothing keeps the bounds; 130 interrupted.

\b
Shell completion:
  eval "$(_MFR_BENCH_COMPLETE=bash_source mfr-bench)"
  (or zsh_source, fish_source)
"""


SECTIONS = {
    "Measure": (run_command.run, decide_command.decide, stress_command.stress, versus_command.versus),
    "Read what was measured": (report_commands.table, report_commands.plot, advise_command.advise,
                               compare_command.compare, claims_command.claims, report_commands.conformance,
                               page_command.report, pack_commands.pack, pack_commands.unpack),
    "Many machines": (cluster_commands.submit, cluster_commands.status, cluster_commands.collect, merge_command.merge,
                      bundle_commands.submit_results, bundle_commands.verify),
    "Look around": (device_commands.doctor, device_commands.methods, report_commands.configs, meshes_command.meshes,
                    scene_command.scene, device_commands.render, device_commands.shader, race_command.race,
                    twochannel_command.twochannel),
    "Write configs and methods": (report_commands.schema, method_commands.new_method, method_commands.new_scene,
                                  method_commands.new_effect, method_commands.check),
}
WHOLE = 200  # characters of a command's line in the list, which is never cut


class Commands(click.Group):
    """Lists commands by section; names the nearest for one that does not exist."""

    def list_commands(self, context):
        return [command.name for commands in SECTIONS.values() for command in commands]

    def format_commands(self, context, formatter):
        longest = max(map(len, self.commands))
        for title, commands in SECTIONS.items():
            with formatter.section(title):
                formatter.write_dl([(f"{c.name:{longest}}", c.get_short_help_str(WHOLE)) for c in commands])

    def resolve_command(self, context, args):
        if args and self.get_command(context, args[0]) is None:
            names = self.list_commands(context)
            raise click.UsageError(f"no command {args[0]!r}; {one_of(args[0], names)}")
        alive.begin(args[0])
        return super().resolve_command(context, args)

    def invoke(self, context):
        """Run the command; a mistake in its options that names no command becomes one of this command."""
        try:
            return super().invoke(context)
        except click.UsageError as error:
            if error.ctx is None and context.invoked_subcommand:
                name = context.invoked_subcommand
                error.ctx = click.Context(self.commands[name], context, name)
            raise


click.Context.formatter_class = Formatter


def _print_man(context: click.Context, parameter: click.Parameter, asked: bool) -> None:
    if asked:
        from .man import page

        say(page(context.command).rstrip("\n"))
        context.exit()


@click.group(cls=Commands, epilog=EPILOG, invoke_without_command=True,
             context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="mfr-bench")
@click.option("--man", is_flag=True, is_eager=True, expose_value=False, callback=_print_man,
              help="Print the manual page: man -l <(mfr-bench --man).")
@click.pass_context
def cli(context: click.Context) -> None:
    """Benchmark of multi-fragment rendering: A-buffers, k-buffers, depth peeling, on your own GPU.

    Every image that is timed is first checked against a float64 oracle.
    """
    if context.invoked_subcommand is None:
        say(context.get_help())
        context.exit(2)


for commands in SECTIONS.values():
    for command in commands:
        cli.add_command(command)


def main() -> None:
    """Entry point: every ending is a line and an exit status, never a traceback for a user's mistake."""
    prepare_streams()
    status, lines = _outcome()
    alive.end()
    lines = [*_broken_declarations(), *lines]
    let_go_of_stdout()
    for line in lines:
        note(line)
    sys.exit(status)


def _broken_declarations() -> list[str]:
    """A line for each declaration that the catalog left out, if the command has loaded it."""
    methods = sys.modules.get("mfr_bench.methods")
    return [f"{line}; the catalog is without it" for line in methods.MISTAKES] if methods else []


def _outcome() -> tuple[int, list[str]]:
    """Run the command: its exit status, and what is to be said of it on stderr."""
    try:
        status = cli.main(prog_name="mfr-bench", standalone_mode=False)
        sys.stdout.flush()
    except UsageError as error:
        return error.exit_status, error.lines
    except MfrError as error:
        return error.exit_status, [str(error)]
    except click.ClickException as error:
        return 2, [_one_line(error)]
    except (KeyboardInterrupt, click.Abort):
        return Interrupted.exit_status, ["interrupted"]
    except MemoryError as error:
        return 1, [f"out of memory: {error}"]
    except OSError as error:
        return 1, [f"{error.filename or 'the output'}: {error.strerror or error}"]
    return (status if isinstance(status, int) else 0), []


def _one_line(error: click.ClickException) -> str:
    """click's complaint with the command in front and its help at the end."""
    context = getattr(error, "ctx", None)
    command = context.command_path if context else "mfr-bench"
    said = " ".join(error.format_message().split()).rstrip(".")
    example = _example(context) if isinstance(error, click.MissingParameter) else ""
    return f"{command}: {said}{example}; see {command} --help"


def _example(context: click.Context) -> str:
    """The first example of the command's help, as a part of a line; nothing where it has none."""
    lines = (line.removeprefix("Example:").removeprefix("Examples:").strip()
             for line in map(str.strip, (context.command.help or "").splitlines()))
    first = next((line for line in lines if line.startswith(f"{context.command_path} ")), None)
    return f"; for example: {first}" if first else ""
