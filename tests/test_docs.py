"""The documentation says what the declarations say."""

import re
from pathlib import Path

import pytest
import yaml

from mfr_bench.cli.main import cli
from mfr_bench.config import load, shipped
from mfr_bench.markdown import COLUMNS, filled
from mfr_bench.methods import catalog
from mfr_bench.methods.catalog_text import as_markdown
from mfr_bench.report.conformance import HAZARDS, HEAD, HEADER
from mfr_bench.scene.page import kinds_page
from mfr_bench.store.page import columns_page

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"


def test_the_readme_names_every_command_and_counts_right():
    text = (ROOT / "README.md").read_text()
    papers = [name for name in shipped() if load(name, catalog())[0].source.get("paper")]
    assert f"lists all {len(papers)}: source" in text
    assert [name for name in cli.commands if f"\nmfr-bench {name} " not in text] == []


def prose(text):
    """A page without its code, in blocks and within lines, where `a[i](b)` is no link."""
    return re.sub(r"^```.*?^```|`[^`\n]+`", "", text, flags=re.DOTALL | re.MULTILINE)


def links(text):
    """The file and the heading of each link that is not of the web; a link within the page has no file."""
    return re.findall(r"\]\((?!https?:)([^)#\s]*)#?([^)\s]*)\)", prose(text))


def anchors(page):
    """The names of its headings in links, as GitHub makes it."""
    headings = re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```", "", page.read_text(), flags=re.DOTALL | re.MULTILINE),
                          flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def test_code_is_no_link():
    text = "[a](b.md#c-d), [e](#f), [g](https://h)\n`i[j](k)`\n```sh\nl[m](n)\n```\n"
    assert links(text) == [("b.md", "c-d"), ("", "f")]


def test_links_of_the_documentation_lead_somewhere():
    pages = [ROOT / "README.md", *DOCS.glob("*.md")]
    found = [(page, page.parent / file if file else page, heading)
             for page in pages for file, heading in links(page.read_text())]
    assert found
    assert [(page.name, str(target)) for page, target, _ in found if not target.exists()] == []
    assert [(page.name, target.name, heading) for page, target, heading in found
            if heading and target.suffix == ".md" and heading not in anchors(target)] == []


@pytest.mark.parametrize("page", [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted(DOCS.glob("*.md"))],
                         ids=lambda page: page.name)
def test_prose_fits_the_columns_of_an_editor(page):
    """Rows of tables and blocks of code are as long as they have to be; no number is without its percent sign."""
    text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.DOTALL | re.MULTILINE)
    assert [line for line in text.splitlines() if len(line) > COLUMNS and not line.startswith(("|", "#"))] == []
    assert [line for line in text.splitlines() if line.lstrip().startswith("%")] == []


@pytest.mark.parametrize(("text", "lead", "lines"), [
    ("a " * 90, "- ", ["- " + "a " * 58 + "a", "  " + "a " * 30 + "a"]),
    (f"{'a' * 116} 1 - k/n of it", "", [f"{'a' * 116} 1 -", "k/n of it"]),
    (f"{'a' * 116} 15 % of it", "", ["a" * 116, "15 % of it"]),
    (f"{'a' * 110} `mfr-bench run smoke` b", "", ["a" * 110, "`mfr-bench run smoke` b"]),
    (f"{'a' * 110} [a page of its own](page.md) b", "", ["a" * 110, "[a page of its own](page.md) b"])])
def test_a_paragraph_is_filled_so_that_markdown_reads_it_as_it_was(text, lead, lines):
    """No line opens a list that was none, and none ends within code, a link or a percentage."""
    assert filled(text.strip(), lead).split("\n") == lines


def test_results_page_is_what_the_tables_give():
    assert (DOCS / "results.md").read_text() == columns_page(), (
        "docs/results.md is out of date: mfr-bench table --columns >docs/results.md")


def test_methods_page_is_what_the_declarations_give():
    assert (DOCS / "methods.md").read_text() == as_markdown(catalog().values()), (
        "docs/methods.md is out of date: mfr-bench methods --markdown >docs/methods.md")


def test_scenes_page_has_what_the_kinds_say_of_themselves():
    assert kinds_page() in (DOCS / "scenes.md").read_text(), (
        "docs/scenes.md is out of date: put what `mfr-bench configs --kinds` prints between its two comments")


def test_the_jobs_of_the_page_on_ci_are_yaml_and_use_options_that_there_are():
    blocks = re.findall(r"^```(?:yaml|sh)\n(.*?)^```$", (DOCS / "ci.md").read_text(), re.MULTILINE | re.DOTALL)
    jobs = [yaml.safe_load(text) for text in blocks if text.startswith("#")]
    assert [list(job["jobs"]) for job in jobs] == [["versus"], ["gate"]]
    uses = re.findall(r"mfr-bench (\w[\w-]*)((?:[^\n|&]|\n +--)*)", "".join(blocks))
    assert {name for name, _ in uses} >= {"run", "compare", "versus", "report", "pack"}
    for name, rest in uses:
        known = {option for p in cli.commands[name].params for option in p.opts}
        assert set(re.findall(r"--[a-z]+", rest)) <= known, name


@pytest.mark.parametrize("method", catalog())
def test_every_method_is_on_the_page(method):
    assert (DOCS / "methods.md").read_text().count(f"| `{method}` |") >= 3


def test_conformance_page_has_every_method_of_its_configs_and_the_header_of_its_command():
    page = (DOCS / "conformance.md").read_text()
    head, *tables = page.split("\n## ")
    assert head.startswith(HEAD.format(frames="50 frames").rstrip("\n"))
    for table, header in ((tables[0], HEADER), (tables[1], HAZARDS)):
        assert tuple(f.strip() for f in table.splitlines()[2].strip("|").split("|")) == header
    rows = [[f.strip(" `") for f in line.strip("|").split("|")] for line in tables[0].splitlines()[4:] if line]
    for name in ("conformance", "determinism"):
        experiment, = load(name, catalog())
        assert {(m.label, m.id) for m in experiment.methods} == {(row[0], row[1]) for row in rows}, (
            "docs/conformance.md is out of date: mfr-bench run conformance determinism --out out; "
            "mfr-bench conformance out >docs/conformance.md")
    assert {row[1] for row in rows} == set(catalog())
    assert [row[2] for row in rows] == [catalog()[row[1]].guarantee for row in rows]
    assert all(row[HEADER.index("wrong")] == "0" for row in rows)


@pytest.mark.parametrize("method", [m for m in catalog().values() if m.mixes or m.exact_where], ids=lambda m: m.id)
def test_where_approximations_are_exact_is_on_their_page(method):
    page = (DOCS / "approximate.md").read_text()
    assert f"`{method.id}`" in page
    assert not method.exact_where or f"`{method.exact_where}`" in page
