"""One word for one thing: two classes share a name only if no file uses both; percent is written in one way."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

import mfr_bench

from .test_imports import MODULES, name_of, source

ROOT = Path(mfr_bench.__file__).parents[1]
FILES = {**{path: name for name, path in MODULES.items()},
         **dict.fromkeys(sorted((ROOT / "tests").rglob("*.py")), None)}


@cache
def classes(module: str) -> set[str]:
    return {node.name for node in source(module).body if isinstance(node, ast.ClassDef)}


@cache
def owner(module: str, name: str) -> str | None:
    """The module that defines the class which `module` knows by a name; None where the name is no class of ours."""
    if module not in MODULES:
        return None
    if name in classes(module):
        return module
    known = imported(MODULES[module]).get(name)
    return owner(*known) if known and known != (module, name) else None


@cache
def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text())


@cache
def imported(path: Path) -> dict[str, tuple[str, str]]:
    """The imports of a file from the package: local name -> (module, name there)."""
    found = {}
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.ImportFrom) and (base := absolute(path, node)) is not None:
            found |= {alias.asname or alias.name: (base, alias.name) for alias in node.names}
    return found


def absolute(path: Path, node: ast.ImportFrom) -> str | None:
    """The module of the package that an import is from, without the package's name; None for any other."""
    module = node.module or ""
    if not node.level:
        return module.removeprefix("mfr_bench").lstrip(".") if module.partition(".")[0] == "mfr_bench" else None
    if not path.is_relative_to(ROOT / "mfr_bench"):
        return None
    parts = name_of(path).split(".") if path.name != "__init__.py" else [*filter(None, name_of(path).split(".")), ""]
    return ".".join(filter(None, [*parts[:len(parts) - node.level], module]))


def used(path: Path) -> set[tuple[str, str]]:
    """The classes that a file defines, imports, or names as attributes of a module: (name, module that defines it)."""
    found = {(name, own) for name in classes(own)} if (own := FILES.get(path)) is not None else set()
    known = imported(path)
    found |= {(name, owner(module, name)) for module, name in known.values()}
    modules = {local: f"{module}.{name}".lstrip(".") for local, (module, name) in known.items()}
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in modules:
            found.add((node.attr, owner(modules[node.value.id], node.attr)))
    return {(name, module) for name, module in found if module is not None}


def clashes(path: Path) -> dict[str, set[str]]:
    """The names of which a file uses several classes, with the modules that define them."""
    modules: dict[str, set[str]] = {}
    for name, module in used(path):
        modules.setdefault(name, set()).add(module)
    return {name: found for name, found in modules.items() if len(found) > 1}


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_no_file_uses_two_classes_of_one_name(path):
    assert clashes(path) == {}


@pytest.mark.parametrize("use", ["from mfr_bench.report.figures.kind import Kind as Other",
                                 "from mfr_bench.report.figures import kind\nprint(kind.Kind)"])
def test_two_classes_that_meet_are_seen(tmp_path, use):
    """Under a name of their own, or as an attribute of their module."""
    (tmp_path / "both.py").write_text(f"from mfr_bench.scene.spec.kind import Kind\n{use}\n")
    assert clashes(tmp_path / "both.py") == {"Kind": {"scene.spec.kind", "report.figures.kind"}}


def tight_percents(text: str) -> set[int]:
    """The lines of a source that print a number with its percent sign right behind it, as 5% instead of 5 %."""
    found = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.JoinedStr):
            said = "".join("0" if isinstance(part, ast.FormattedValue) else str(part.value) for part in node.values)
            forms = [ast.unparse(part.format_spec) for part in node.values
                     if isinstance(part, ast.FormattedValue) and part.format_spec]
            found |= {node.lineno} if re.search(r"\d%", said) or any("%" in form for form in forms) else set()
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and re.search(r"\d%", node.value):
            found.add(node.lineno)
    return found


PRINTING = [*MODULES.values(), *sorted((ROOT / "scripts").glob("*.py"))]


@pytest.mark.parametrize("path", PRINTING, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_space_stands_before_every_percent_sign(path):
    assert tight_percents(path.read_text()) == set()


@pytest.mark.parametrize("line", ['f"{share:.0%}"', 'f"{share}%"', '"5% of it"', 'f"at most 5% of {what}"'])
def test_a_tight_percent_sign_is_seen(line):
    assert tight_percents(line) == {1}


@pytest.mark.parametrize("line", ['f"{100 * share:.0f} %"', '"5 % of it"', '"%d" % 5'])
def test_other_percent_signs_are_none(line):
    assert tight_percents(line) == set()
