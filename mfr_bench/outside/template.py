"""The packages that `new-method`, `new-scene` and `new-effect` write: examples of this project, under another name."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from ..errors import StoreError, UsageError
from ..resources import template_dir

NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")


@dataclass(frozen=True)
class Template:
    """A package to copy: the example that it is, and what it declares.

    example: the example's folder and name. module: whether the declaration has the name of its module, and so no
    hyphens. renamed: what else in its files has the name of what it declares, with {} in its place.
    """

    kind: str
    example: str
    module: bool = True
    article: str = "a"
    own: str = "a name"
    renamed: Mapping[str, str] = field(default_factory=dict)

    def declares(self, name: str) -> str:
        """The name of what a package of this name declares."""
        return _identifier(name) if self.module else name

    def text(self, text: str, name: str) -> str:
        """A text or path of the example as a package of this name has it."""
        pairs = {self.example: name, _identifier(self.example): _identifier(name), _title(self.example): _title(name)}
        pairs |= {made: given.format(self.declares(name)) for made, given in self.renamed.items()}
        return re.sub("|".join(map(re.escape, pairs)), lambda found: pairs[found[0]], text)


METHOD = Template("method", "my-array", module=False, own="an id")
SCENE = Template("scene", "spiral-scene", renamed={"spiral.py": "{}.py", "maker: spiral": "maker: {}"})
EFFECT = Template("effect", "median-layer", article="an", renamed={"median": "{}"})


def files(template: Template, name: str) -> Iterator[tuple[Path, str]]:
    """The files of a package of this name: each path inside its folder, and its text. Raises UsageError."""
    if not NAME.fullmatch(name):
        raise UsageError(f"new-{template.kind}: {name!r} is no name of {template.article} {template.kind}; allowed: "
                         "small letters and digits, words joined by single hyphens, such as my-array")
    folder = template_dir(template.example)
    for path in sorted(p for p in folder.rglob("*") if p.is_file() and "__pycache__" not in p.parts):
        yield (Path(template.text(str(path.relative_to(folder)), name)),
               template.text(path.read_text(encoding="utf-8"), name))


def _identifier(name: str) -> str:
    return name.replace("-", "_")


def _title(name: str) -> str:
    return name.replace("-", " ").capitalize()


def write(template: Template, name: str, folder: Path) -> list[Path]:
    """Write the package into a folder that is not there yet. Raises UsageError and StoreError."""
    next(files(template, name))  # the name before the folder, which may be of its name
    if folder.exists():
        raise UsageError(f"new-{template.kind}: {folder} is there already; allowed: a folder that is not")
    made = []
    for inside, text in files(template, name):
        path = folder / inside
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        except OSError as error:
            raise StoreError(f"{path}: cannot be written: {error.strerror}; remove {folder}, then run the "
                             "same command again") from None
        made.append(path)
    return made
