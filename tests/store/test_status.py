"""The table of statuses: what each decides, and that the program decides nothing besides it."""

import ast
from pathlib import Path

import mfr_bench
from mfr_bench.cli.run_command import exit_status
from mfr_bench.environment import draws_in_software
from mfr_bench.store.status import STATUSES

PACKAGE = Path(mfr_bench.__file__).parent


def those(**fields):
    return {name for name, status in STATUSES.items() if all(getattr(status, f) == v for f, v in fields.items())}


def test_what_each_status_decides():
    assert those(timed=True) == {"ok", "wrong"}
    assert those(retried=True) == {"crashed", "timeout", "out_of_memory"}
    assert those(failed=True) == {"wrong", "crashed", "timeout", "out_of_memory", "overflow"}
    assert those(refused=True) == {"unsupported", "over_budget"}
    assert those(over_memory=True) == {"over_budget", "out_of_memory", "overflow"}
    assert those(exit_status=1) == {"crashed", "timeout", "out_of_memory"} and those(exit_status=3) == {"wrong"}
    assert STATUSES["wrong"].sign == "wrong image" and STATUSES["out_of_memory"].sign == "out of memory"


def test_a_run_ends_with_the_gravest_status():
    assert exit_status({"ok", "unsupported", "over_budget", "overflow"}) == 0
    assert exit_status({"ok", "timeout"}) == 1
    assert exit_status({"crashed", "wrong"}) == 3
    assert exit_status({"wrong"}, wrong_images=False) == 0
    assert exit_status({"crashed", "wrong"}, wrong_images=False) == 1


def test_no_other_module_lists_statuses():
    """A tuple, list, set or mapping of several statuses would be a second table."""
    found = []
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            members = node.elts if isinstance(node, (ast.Tuple, ast.List, ast.Set)) else (
                node.keys if isinstance(node, ast.Dict) else [])
            named = {m.value for m in members if isinstance(m, ast.Constant)} & set(STATUSES) - {"ok", "wrong"}
            if len(named) > 1:
                found.append((str(path.relative_to(PACKAGE)), sorted(named)))
    decisions = {"plan/__init__.py", "plan/limits.py"}  # the type of what a plan decides names both of its statuses
    assert [entry for entry in found if entry[0] not in decisions] == []


def test_the_renderers_that_draw_on_the_cpu():
    for name in ("llvmpipe (LLVM 15.0.6, 256 bits)", "softpipe", "Google SwiftShader", "Software Rasterizer",
                 "ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device (Subzero)), SwiftShader driver)", "swrast"):
        assert draws_in_software(name), name
    for name in ("NVIDIA H100 PCIe/PCIe/SSE2", "AMD Radeon RX 7900 XTX (radeonsi, navi31)", "Mesa Intel(R) Arc(tm)"):
        assert not draws_in_software(name), name
