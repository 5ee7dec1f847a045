"""A source tree to measure: a folder, or a git revision put into a folder of its own."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from ..errors import UsageError


@dataclass(frozen=True)
class Tree:
    """A folder with this program's source, or with methods that are measured by the program at hand.

    `name` is what the user called it.
    """

    name: str
    folder: Path

    @property
    def program(self) -> Path | None:
        """The folder that holds the package mfr_bench, if the tree is one of this program."""
        return self.folder if (self.folder / "mfr_bench" / "__init__.py").is_file() else None

    @property
    def environment(self) -> Mapping[str, str]:
        """The variables that the process of the tree gets in addition to this one's environment."""
        from ..methods.outside import VARIABLE

        if self.program:
            return {}
        others = os.environ.get(VARIABLE)
        return {VARIABLE: os.pathsep.join(filter(None, [others, str(self.folder)]))}


@contextmanager
def tree(name: str, repository: Path) -> Iterator[Tree]:
    """The folder of this name, or the revision of the repository, checked out while the context lasts.

    Raises UsageError where it is neither, or holds neither this program nor a method.
    """
    if not name:
        raise UsageError("versus: '' is no folder and no revision; allowed: a source tree, or a commit, such as HEAD")
    if Path(name).is_dir():
        yield _checked(Tree(name, Path(name).resolve()))
        return
    root, inside = _root(name, repository)
    with TemporaryDirectory(prefix="mfr-bench-") as folder:
        at = Path(folder, "tree")
        done = _git(root, "worktree", "add", "--detach", "--quiet", str(at), f"{name}^{{commit}}")
        if done.returncode:
            raise UsageError(f"versus: {name!r} is no folder and no revision of {root}; allowed: a source tree, or a "
                             "commit, such as HEAD, a tag or a hash")
        try:
            yield _checked(Tree(name, at / inside))
        finally:
            with suppress(OSError):
                _git(root, "worktree", "remove", "--force", str(at))


def _root(name: str, repository: Path) -> tuple[Path, Path]:
    """The top of the repository, and the place of the folder in it. Raises UsageError where there is none."""
    done = _git(repository, "rev-parse", "--show-toplevel")
    if done.returncode:
        raise UsageError(f"versus: {name!r} is no folder, and {repository.resolve()} is in no git repository whose "
                         "revision it could be; allowed: a source tree, or a revision inside a repository")
    root = Path(done.stdout.strip())
    return root, repository.resolve().relative_to(root.resolve())


def _git(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    try:
        return subprocess.run(["git", "-C", str(folder), *arguments], capture_output=True, text=True, check=False)
    except FileNotFoundError:
        raise UsageError("versus: git is not installed; allowed: two folders, or install git") from None


def _checked(found: Tree) -> Tree:
    if found.program or any(found.folder.glob("*.py")) or any(found.folder.glob("*/*.py")):
        return found
    raise UsageError(f"versus: {found.name} holds neither mfr_bench/ nor a method; allowed: a source tree of this "
                     "program, or a folder of methods")
