"""The manual page: every command with its options, and nothing that roff complains of."""

import re
import shutil
import subprocess

import pytest

from mfr_bench.cli.main import cli
from mfr_bench.cli.man import page


@pytest.fixture(scope="module")
def text():
    return page(cli)


def test_it_has_the_sections_that_readers_of_manual_pages_look_for(text):
    assert re.findall(r"^\.SH (.*)$", text, re.MULTILINE) == [
        "NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "COMMANDS", "EXAMPLES", "EXIT STATUS", "SHELL COMPLETION"]
    names = [name.replace("-", r"\-") for name in cli.commands]
    assert re.findall(r"^\.SS mfr-bench (\S+)", text, re.MULTILINE) == names


def test_everything_that_has_a_tag_is_explained(text):
    """An argument stands in the usage, and needs no entry without a text of its own; a blank line would be a gap."""
    tags = re.findall(r"^\.TP\n(.+)\n(.*)$", text, re.MULTILINE)
    assert len(tags) > 100 and all(explained.strip() for _, explained in tags)
    assert "\n\n" not in text


@pytest.mark.skipif(not shutil.which("groff"), reason="needs the Debian package groff")
def test_groff_formats_it_without_a_warning(text):
    done = subprocess.run(["groff", "-man", "-Tutf8", "-ww"], input=text, capture_output=True, text=True, check=True)
    assert done.stderr == ""
