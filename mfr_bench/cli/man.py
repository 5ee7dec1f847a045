"""The manual page, made of the commands' own help.

click-man, which was looked at, writes a file for each command, and fills the lines of examples.
"""

from __future__ import annotations

import inspect
import textwrap
from collections.abc import Iterator

import click

from .. import __version__

KEPT = "\b"  # alone on a line: the paragraph that follows keeps its lines


def page(group: click.Group) -> str:
    """The page in roff: the program, then each command with its arguments and options."""
    whole = click.Context(group, info_name="mfr-bench", **group.context_settings)
    lines = [f'.TH MFR-BENCH 1 "" "mfr-bench {__version__}" "User Commands"', ".SH NAME",
             f"mfr-bench \\- {_inline(group.get_short_help_str(200))}", ".SH SYNOPSIS",
             r".B mfr-bench", r"\fICOMMAND\fR [\fIOPTIONS\fR] [\fIARGUMENTS\fR]", ".SH DESCRIPTION",
             *_paragraphs(group.help or ""), ".SH OPTIONS", *_options(group, whole), ".SH COMMANDS"]
    for name, command in group.commands.items():
        context = click.Context(command, info_name=name, parent=whole)
        usage = " ".join(command.collect_usage_pieces(context))
        lines += [f".SS mfr-bench {_inline(name)} {_inline(usage)}", *_paragraphs(command.help or ""),
                  *_options(command, context)]
    return "\n".join([*lines, *_sections(group.epilog or "")]) + "\n"


def _options(command: click.Command, context: click.Context) -> Iterator[str]:
    """The options, and the arguments of which the help says more than the usage."""
    for param in command.get_params(context):
        record = param.get_help_record(context)
        if record and record[1]:
            yield from (".TP", rf"\fB{_inline(record[0])}\fR", _inline(record[1]))


def _sections(epilog: str) -> Iterator[str]:
    """Sections of the page: each paragraph at the end of the help begins with its heading and a colon."""
    for paragraph in inspect.cleandoc(epilog).split("\n\n"):
        heading, _, text = paragraph.replace(KEPT, "").strip().partition(":")
        kept = [KEPT] if KEPT in paragraph else []
        yield from (f".SH {_inline(heading.upper())}", *_paragraphs("\n".join([*kept, textwrap.dedent(text).strip()])))


def _paragraphs(text: str) -> Iterator[str]:
    """Paragraphs of a help text; those that keep their lines are not filled."""
    for paragraph in inspect.cleandoc(text).split("\n\n"):
        lines = [line for line in textwrap.dedent(paragraph).splitlines() if line.strip() != KEPT]
        kept = KEPT in paragraph
        yield from (".PP", *([".nf"] if kept else []), *map(_line, lines), *([".fi"] if kept else []))


def _line(text: str) -> str:
    """A line of its own: what begins with a point or an apostrophe would be a request."""
    return (r"\&" if text.startswith((".", "'")) else "") + _inline(text)


def _inline(text: str) -> str:
    return text.replace("\\", r"\e").replace("-", r"\-")
