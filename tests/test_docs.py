"""The documentation says what the declarations say."""

from pathlib import Path

import pytest

from mfr_bench.config import load
from mfr_bench.methods import catalog
from mfr_bench.methods.catalog_text import as_markdown
from mfr_bench.report.conformance import HAZARDS, HEAD, HEADER

DOCS = Path(__file__).parents[1] / "docs"


def test_methods_page_is_what_the_declarations_give():
    assert (DOCS / "methods.md").read_text() == as_markdown(catalog().values()), (
        "docs/methods.md is out of date: mfr-bench methods --markdown >docs/methods.md")


@pytest.mark.parametrize("method", catalog())
def test_every_method_is_on_the_page(method):
    assert (DOCS / "methods.md").read_text().count(f"| `{method}` |") >= 3


def test_conformance_page_has_every_method_of_its_configs_and_the_header_of_its_command():
    page = (DOCS / "conformance.md").read_text()
    head, *tables = page.split("\n## ")
    assert head.startswith(HEAD.format(frames=50).rstrip("\n"))
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
