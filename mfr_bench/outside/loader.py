"""The process that imports one package or folder of methods, and answers with what it declares, as data.

Such code runs here, in the process that makes the fragments of a scene (`making`), and in the one that measures, which
imports the models of effects; apart from what an installed package does by itself. The answer is a pickle of plain
values and declarations: `methods`, `effects`, `scenes`, `shaders`, `hash`, `mistakes`.
"""

from __future__ import annotations

import ast
import hashlib
import importlib
import os
import pickle
import pkgutil
import sys
from collections.abc import Iterable, Iterator
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Any

from ..contract.variants import variants
from ..errors import ShaderError
from ..glsl import includes, stages
from ..glsl.code import code_of
from ..glsl.digest import fitted_nominally
from ..methods.loading import DeclarationError, family, import_folder, line_of, order_of
from ..methods.spec import Method
from ..resources import shaders_dir
from .effects import EFFECTS
from .scenes import SCENES

PACKAGE = "methods_of_a_folder"  # the name under which the files of a folder are imported
HASH_DIGITS = 12


def main() -> None:
    """Arguments: the descriptor that receives the answer, `module` or `folder`, and its name."""
    descriptor, kind, name = sys.argv[1:]
    told = told_by_folder(Path(name)) if kind == "folder" else told_by_module(name)
    with open(int(descriptor), "wb") as answer:
        pickle.dump(told, answer)
        answer.flush()
        os._exit(0)  # without the exit handlers of foreign code


def told_by_folder(folder: Path) -> dict[str, Any]:
    """The declarations of a folder's files; of a project's folder, those of the one folder in it with such files."""
    if not folder.is_dir():
        return _nothing(f"{folder}: is no folder; allowed: a folder with declarations of methods")
    inside = [below for below in sorted(folder.iterdir()) if below.is_dir() and list(below.glob("*.py"))]
    at = folder if list(folder.glob("*.py")) else inside[0] if len(inside) == 1 else None
    if at is None:
        return _nothing(f"{folder}: has no declaration; allowed: a folder with *.py files, and shaders/ beside them")
    try:
        import_folder(at, PACKAGE)
    except Exception as error:  # noqa: BLE001 - whatever foreign code raises is one line
        return _nothing(_said(at / "__init__.py", error))
    return _told(PACKAGE, at, str(at.resolve()))


def told_by_module(name: str) -> dict[str, Any]:
    """The declarations of the module or package of an entry point."""
    try:
        module = importlib.import_module(name)
    except Exception as error:  # noqa: BLE001 - as above
        spec = None if isinstance(error, ModuleNotFoundError) else find_spec(name)
        return _nothing(_said(Path(spec.origin) if spec and spec.origin else Path(name), error))
    return _told(name, Path(module.__file__).parent, name)


def _told(package: str, folder: Path, place: str) -> dict[str, Any]:
    """The declarations; place: the folder or the module that the process that measures imports."""
    shaders = folder / "shaders"
    includes.folders_outside = lambda: [shaders]
    mistakes = list(_hidden_shaders(shaders))
    names = _modules_of(package)
    families = [f for f in _families(package, names, mistakes) if f]
    methods = []
    for each in sorted(families, key=order_of):
        for method in each.METHODS:
            if trouble := next(_troubles(method), None):
                mistakes.append(f"{_where(each, method, trouble)}: {method.id}: {trouble}")
            else:
                methods.append(method)
    effects = dict(EFFECTS.of(_having(EFFECTS.constant, names), place, mistakes))
    scenes = dict(SCENES.of(_having(SCENES.constant, names), place, mistakes))
    if not (methods or effects or scenes or mistakes):
        mistakes.append(f"{folder}: declares no method, scene or effect; allowed: a file with METHODS, "
                        f"{SCENES.constant} or {EFFECTS.constant}, as mfr-bench new-method, new-scene or new-effect "
                        "writes it")
    return {"methods": methods, "effects": effects, "scenes": scenes,
            "shaders": str(shaders) if shaders.is_dir() else None, "hash": code_hash(folder), "mistakes": mistakes}


def _having(name: str, modules: Iterable[str]) -> list[ModuleType]:
    """The modules, of those that were imported, that have something of this name."""
    return [sys.modules[module] for module in modules if hasattr(sys.modules.get(module), name)]


def _modules_of(package: str) -> list[str]:
    """The names of the module itself, and of those in it if it is a package."""
    path = getattr(sys.modules[package], "__path__", [])
    return [package, *sorted(f"{package}.{found.name}" for found in pkgutil.iter_modules(path))]


def _families(package: str, names: Iterable[str], mistakes: list[str]) -> Iterator[ModuleType | None]:
    """The families of methods in these modules of a package; each mistake costs the family that has it."""
    for name in names:
        try:
            yield family(name, Path(find_spec(name).origin or name) if name != package else None)
        except DeclarationError as error:
            mistakes.append(str(error))


def _hidden_shaders(shaders: Path) -> Iterator[str]:
    """Shaders that no method would see, since this program has files of the same names."""
    for path in sorted(shaders.rglob("*.*")):
        name = path.relative_to(shaders)
        if (shaders_dir() / name).is_file():
            yield f"{path}:1: mfr-bench has {name} itself; allowed: names of your own"


def _troubles(method: Method) -> Iterator[str]:
    """The reasons why a method cannot be measured: functions of its own, missing shaders, formulas."""
    try:
        pickle.dumps(method)
        foreign = _foreign_functions(method)
    except (AttributeError, pickle.PicklingError) as error:
        foreign = str(error)
    if foreign:
        yield f"declares a function of its own ({foreign}); allowed: those of mfr_bench.methods.shared"
    try:
        for variant in variants(method):
            for geometry in ("quad", "strip", "triangle"):
                fitted = fitted_nominally(variant, geometry)
                fitted.memory_bytes()
                for step in (s for s in variant.passes if s.kind != "clear"):
                    stages(fitted, step)
    except ShaderError as error:
        yield str(error)
    except Exception as error:  # noqa: BLE001 - a declaration may be wrong in any way
        yield " ".join(f"{type(error).__name__}: {error}".split())


def _foreign_functions(method: Method) -> str:
    """The first name outside this package that the declaration needs, or nothing."""
    from ..methods.outside import Reader

    class Asking(Reader):
        asked = ""

        def find_class(self, module: str, name: str):
            try:
                return super().find_class(module, name)
            except pickle.UnpicklingError:
                type(self).asked = type(self).asked or f"{module.removeprefix(f'{PACKAGE}.')}.{name}"
                return lambda *_, **__: None
    import io

    Asking(io.BytesIO(pickle.dumps(method))).load()
    return Asking.asked


def _where(module: ModuleType, method: Method, trouble: str) -> str:
    return line_of(module, *(f'"{word}"' for word in trouble.split() if "/" in word), f'id="{method.id}"',
                   f'"{method.id}"')


def code_hash(folder: Path) -> str:
    """Hash of the declarations and shaders of a folder; comments, blank lines and layout are no part of it."""
    digest = hashlib.sha256()
    for path in sorted(p for p in folder.rglob("*") if p.is_file() and "__pycache__" not in p.parts):
        if path.suffix == ".py" or (folder / "shaders") in path.parents:
            digest.update(str(path.relative_to(folder)).encode())
            digest.update(_code(path).encode())
    return digest.hexdigest()[:HASH_DIGITS]


def _code(path: Path) -> str:
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        return code_of(text)
    try:
        return ast.dump(ast.parse(text))
    except SyntaxError:
        return text


def _said(file: Path, error: Exception) -> str:
    """The line of an import that failed; file and line where it did, if they are known."""
    import traceback

    frames = [f for f in traceback.extract_tb(error.__traceback__) if f.filename == str(file)]
    line = error.lineno if isinstance(error, SyntaxError) else frames[-1].lineno if frames else 1
    return f"{file}:{line}: {' '.join(f'{type(error).__name__}: {error}'.split())}"


def _nothing(mistake: str) -> dict[str, Any]:
    return {"methods": [], "effects": {}, "scenes": {}, "shaders": None, "hash": "", "mistakes": [mistake]}
