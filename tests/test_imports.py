"""One direction only: what a module may import, found in its source; what a command loads, found by running it."""

import ast
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

import mfr_bench
from mfr_bench.methods import catalog

PACKAGE = Path(mfr_bench.__file__).parent

# From left to right; a module imports only from its own layer and those before it. Longer names bind first. What shows
# results knows nothing of configs; configs are checked against what each kind of figure declares of itself.
LAYERS = (
    "errors", "lazy", "resources", "hashing", "stats", "environment", "orphans", "parallel", "markdown", "effects",
    "store.status", "store.columns", "methods.spec", "methods.shared", "methods", "store", "report", "parquet", "api",
    "scene", "config", "report.experiments", "plan", "report.settings", "oracle", "glsl", "race", "contract.variants",
    "outside", "gpu", "measure", "contract", "claims", "compare", "merge", "bundle", "page", "decide", "run",
    "versus", "cluster", "cli", "__main__",
)
WITHOUT_GL = ("errors", "resources", "hashing", "stats", "environment", "methods", "config", "plan", "scene", "oracle",
              "glsl", "race", "outside", "store", "report", "claims", "compare", "merge", "bundle", "page")
PARENT = ("run.supervisor", "run.device_process", "run.ledger", "run.process",  # another process has the device
          "run.trust")
OF_THE_DEVICE = ("gpu", "run.bench", "run.cell", "run.images", "run.measuring", "run.outcome", "run.scene_work",
                 "run.worker")
GL_PACKAGES = {"moderngl", "glcontext", "OpenGL"}
SPEAKING = ("methods", "claims", "cli")  # what a paper claims is about its methods; for the commands see below
HEAVY = {"numpy", "pandas", "matplotlib", "moderngl", "glcontext", "pydantic", "yaml", "rich"}


def name_of(path: Path) -> str:
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {name_of(path): path for path in sorted(PACKAGE.rglob("*.py"))}


@cache
def source(name: str) -> ast.Module:
    return ast.parse(MODULES[name].read_text())


@cache
def imports(name: str) -> set[str]:
    """Everything that a module imports, wherever it does; the package's own modules without the package's name."""
    found = set()
    inside = [*name.split(".")[:-1]] if MODULES[name].name != "__init__.py" else name.split(".") if name else []
    for node in ast.walk(source(name)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and not node.level:
            found.add(node.module)
        elif isinstance(node, ast.ImportFrom):
            base = inside[:len(inside) - node.level + 1] + (node.module.split(".") if node.module else [])
            found |= {".".join([*base, alias.name]) for alias in node.names}
    return {f.removeprefix("mfr_bench.") for f in found}


def layer(name: str) -> int | None:
    """The layer of a module of the package; None for any other."""
    fitting = [known for known in LAYERS if name == known or name.startswith(f"{known}.")]
    return LAYERS.index(max(fitting, key=len)) if fitting else None


@pytest.mark.parametrize("name", [n for n in MODULES if n])
def test_every_module_has_a_layer_and_imports_only_to_its_left(name):
    assert layer(name) is not None, f"{name} stands in no layer of the design"
    right = {f for f in imports(name) if layer(f) is not None and layer(f) > layer(name)}
    assert not right, f"{name} imports {', '.join(sorted(right))}, to its right"


@pytest.mark.parametrize("name", [n for n in MODULES if n and not n.startswith("gpu")])
def test_only_gpu_imports_gl(name):
    assert not {f.partition(".")[0] for f in imports(name)} & GL_PACKAGES


MOST_LINES = 420


def modules_imported(name: str) -> set[str]:
    """The modules that a module imports something from, besides those of the packages that it stands in."""
    found = {next((m for m in (f, f.rpartition(".")[0]) if m in MODULES), None) for f in imports(name)}
    return {m for m in found if m and m != name and not name.startswith(f"{m}.")}


def test_no_circle_stands_anywhere():
    """Every module can be loaded after all that it imports: taken away in that order, none is left."""
    left = {m: modules_imported(m) for m in MODULES}
    while free := [m for m, needed in left.items() if not needed & left.keys()]:
        left = {m: needed for m, needed in left.items() if m not in free}
    assert not left


@pytest.mark.parametrize("path", [*MODULES.values(), *sorted(Path(__file__).parent.rglob("*.py"))],
                         ids=lambda path: str(path.relative_to(PACKAGE.parent)))
def test_no_file_is_longer_than_a_reader_likes(path):
    assert len(path.read_text().splitlines()) <= MOST_LINES


def reached(name: str) -> set[str]:
    """The package's modules that importing one of them loads, imports inside functions included."""
    seen, todo = set(), [name]
    while todo:
        at = todo.pop()
        module = next((m for m in (at, at.rpartition(".")[0]) if m in MODULES), None)
        if module and module not in seen:
            seen.add(module)
            todo += imports(module)
    return seen


@pytest.mark.parametrize("name", [n for n in MODULES if n.partition(".")[0] in WITHOUT_GL])
def test_what_needs_no_gl_reaches_none(name):
    assert not {m for m in reached(name) if m.partition(".")[0] in ("gpu", "measure", "run")}


@pytest.mark.parametrize("name", PARENT)
def test_the_parent_of_a_run_reaches_no_gl(name):
    assert not {m for m in reached(name) if m.startswith(OF_THE_DEVICE)}


@pytest.mark.parametrize("name", [n for n in MODULES if n and n.partition(".")[0] not in SPEAKING])
def test_the_harness_knows_no_method_but_the_floor(name):
    ids = set(catalog()) - {"floor"}
    strings = {node.value for node in ast.walk(source(name))
               if isinstance(node, ast.Constant) and isinstance(node.value, str)}
    found = {i for i in ids for s in strings if re.search(rf"(?<![\w-]){re.escape(i)}(?![\w-])", s)}
    assert not found


@pytest.mark.parametrize("name", [n for n in MODULES if n.startswith("cli")])
def test_commands_name_methods_only_in_examples(name):
    """Help texts teach by example; no line of code depends on a method."""
    tree = source(name)
    documented = {id(node.body[0].value) for node in ast.walk(tree) if isinstance(node, (ast.FunctionDef, ast.Module))
                  and node.body and isinstance(node.body[0], ast.Expr)}
    strings = {node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)
               and isinstance(node.value, str) and id(node) not in documented}
    assert not strings & (set(catalog()) - {"floor"})


def modules_loaded_by(*arguments: str) -> set[str]:
    """Modules in memory after `mfr-bench ARGUMENTS`."""
    code = (f"import sys; sys.argv[1:] = {list(arguments)!r}\nfrom mfr_bench.cli import main\n"
            "try:\n    main()\nexcept SystemExit:\n    pass\n"
            "print('LOADED', *sys.modules)")
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(said.stdout.rpartition("LOADED ")[2].split())


def loaded_by(*arguments: str) -> set[str]:
    """Top-level packages in memory after `mfr-bench ARGUMENTS`."""
    return {name.partition(".")[0] for name in modules_loaded_by(*arguments)}


@pytest.mark.parametrize("arguments", [["--help"], ["run", "--help"], ["--version"], ["rnu"]], ids=" ".join)
def test_help_loads_nothing_that_takes_time(arguments):
    assert not loaded_by(*arguments) & HEAVY


def test_help_loads_no_room_of_the_package_but_the_commands():
    found = {name for name in modules_loaded_by("--help") if name.startswith("mfr_bench.")}
    assert {name.split(".")[1] for name in found} == {"cli", "errors"}


def test_configs_load_no_gl():
    assert not loaded_by("configs") & {*GL_PACKAGES, "numpy", "pandas", "matplotlib"}
