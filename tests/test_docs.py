"""The documentation says what the declarations say."""

from pathlib import Path

import pytest

from mfr_bench.methods import catalog
from mfr_bench.methods.catalog_text import as_markdown

DOCS = Path(__file__).parents[1] / "docs"


def test_methods_page_is_what_the_declarations_give():
    assert (DOCS / "methods.md").read_text() == as_markdown(catalog().values()), (
        "docs/methods.md is out of date: mfr-bench methods --markdown >docs/methods.md")


@pytest.mark.parametrize("method", catalog())
def test_every_method_is_on_the_page(method):
    assert (DOCS / "methods.md").read_text().count(f"| `{method}` |") >= 3
