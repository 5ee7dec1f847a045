"""`mfr-bench`: the group of commands, and how any of them ends."""

from __future__ import annotations

import os
import sys

import click

from .. import __version__
from ..errors import MfrError, UsageError, nearest
from . import device_commands, report_commands, run_command

INTERRUPTED = 130

EPILOG = """
\b
Examples:
  mfr-bench run smoke                      every method on a small scene, in a minute
  mfr-bench run kplus2015-fig6 --dry-run   what would be measured, and what would be skipped
  mfr-bench plot results                   draw all figures again
  mfr-bench doctor                         the OpenGL device, and what it does right

\b
Exit status: 0 done, 1 a cell crashed or ran out of time or memory, 2 the command or a config is wrong,
3 an image is wrong, 130 interrupted.

\b
Shell completion: eval "$(_MFR_BENCH_COMPLETE=bash_source mfr-bench)"   (or zsh_source, fish_source)
"""


class Commands(click.Group):
    """Names the nearest command for one that does not exist."""

    def resolve_command(self, context, args):
        if args and self.get_command(context, args[0]) is None:
            names = self.list_commands(context)
            raise click.UsageError(f"no command {args[0]!r}; allowed: {', '.join(names)}{nearest(args[0], names)}")
        return super().resolve_command(context, args)


@click.group(cls=Commands, epilog=EPILOG, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="mfr-bench")
def cli() -> None:
    """Benchmark of multi-fragment rendering: A-buffers, k-buffers, depth peeling, on your own GPU.

    Every image that is timed is first checked against a float64 oracle.
    """


for module in (run_command, report_commands, device_commands):
    for command in module.COMMANDS:
        cli.add_command(command)


def _one_line(error: click.ClickException) -> str:
    """click's complaint with the command in front and its help at the end."""
    context = getattr(error, "ctx", None)
    command = context.command_path if context else "mfr-bench"
    return f"{command}: {' '.join(error.format_message().split())}; see {command} --help"


def main() -> None:
    """Entry point: every ending is a line and an exit status, never a traceback for a user's mistake."""
    try:
        status = cli.main(prog_name="mfr-bench", standalone_mode=False)
        sys.stdout.flush()
        sys.exit(status if isinstance(status, int) else 0)
    except UsageError as error:
        _complain(*error.lines)
        sys.exit(error.exit_status)
    except MfrError as error:
        _complain(str(error))
        sys.exit(error.exit_status)
    except click.ClickException as error:
        _complain(_one_line(error))
        sys.exit(2)
    except (KeyboardInterrupt, click.Abort):
        _complain("interrupted; what was measured is kept")
        sys.exit(INTERRUPTED)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # nothing reads what is still buffered
        sys.exit(0)


def _complain(*lines: str) -> None:
    for line in lines:
        print(line, file=sys.stderr)
