"""cluster.yaml: the engine, where results go, and one entry for each kind of device."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from ..config.source import Document, read
from ..errors import UsageError, nearest
from ..plan.shards import MOST_SHARES

MOST_MINUTES = 60 * 24 * 30
SPLIT_SHARE = 0.8  # of a task's minutes; the rest starts it and writes its results
WORD = re.compile(r"[^\x00-\x1f\x7f]*[^\s\x00-\x1f\x7f][^\x00-\x1f\x7f]*")  # a line that is not empty
OPTION = re.compile(r"[a-z][a-z0-9_-]*")
OPTIONS_SAID = {  # options of sbatch that keys of a kind stand for
    "partition": "partition", "gres": "gres", "constraint": "constraint", "account": "account", "qos": "qos",
    "time": "minutes", "cpus-per-task": "cpus", "mem": "memory_gb"}
OPTIONS_SET = ("job-name", "array", "output", "error", "open-mode", "signal", "requeue", "no-requeue", "wrap")
OF_SLURM = ("cpus", "memory_gb", "partition", "gres", "constraint", "account", "qos", "options")  # keys of a kind


def _word(value: Any) -> str:
    if not isinstance(value, str) or not WORD.fullmatch(value):
        raise ValueError("is no text on one line; allowed: one, in quotes where YAML reads it as something else")
    return value


def _devices(value: Any) -> list[str]:
    found = [str(each) if type(each) is int else each for each in (value if isinstance(value, list) else [value])]
    if not found or not all(isinstance(each, str) and WORD.fullmatch(each) for each in found):
        raise ValueError("is no device; allowed: what --device takes, such as gpu or a UUID, or a list of these")
    return found


def _options(value: Any) -> dict[str, str | int | bool]:
    if not isinstance(value, Mapping):
        raise ValueError("is no mapping; allowed: options of sbatch, as in {nice: 100, exclusive: true}")  # noqa: TRY004
    for name, each in value.items():
        option = str(name).replace("_", "-")
        if not OPTION.fullmatch(str(name)):
            raise ValueError(f"{name!r} is no option of sbatch; allowed: its long ones, without the dashes before them")
        if option in OPTIONS_SAID:
            raise ValueError(f"{name}: allowed: the key {OPTIONS_SAID[option]} of the kind, which says that")
        if option in OPTIONS_SET:
            raise ValueError(f"{name}: is set by mfr-bench, which relies on it; allowed: other options of sbatch")
        if not (each is True or type(each) is int or (isinstance(each, str) and WORD.fullmatch(each))):
            raise ValueError(f"{name}: allowed: a text on one line, a whole number, or true for an option without a "
                             "value")
    return dict(value)


Word = Annotated[str, BeforeValidator(_word)]


class Settings(BaseModel):
    """Refuses keys that it does not know."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class Kind(Settings):
    """A kind of device: how many tasks measure one whole run on it, and what each asks of the engine.

    device: as --device takes it, always as a list, of which each share has the next. minutes: of a task, after which
    the engine ends it; it is queued again and goes on. speed: how many times faster than two processor cores the device
    draws; a scene that takes longer than a task's minutes by that is split by methods. gres, partition, constraint,
    account, qos: as Slurm takes them; options: further ones of sbatch, with True for one without a value.
    """

    shares: Annotated[int, Field(ge=1, le=MOST_SHARES)] = 1
    device: Annotated[list[str], BeforeValidator(_devices)] = ["auto"]
    speed: Annotated[float, Field(gt=0, le=1e6)] = 1.0
    minutes: Annotated[int, Field(ge=1, le=MOST_MINUTES)] = 60
    cpus: Annotated[int, Field(ge=1, le=1024)] = 2
    memory_gb: Annotated[float, Field(gt=0, le=2**16)] | None = None
    partition: Word | None = None
    gres: Word | None = None
    constraint: Word | None = None
    account: Word | None = None
    qos: Word | None = None
    options: Annotated[dict[str, str | int | bool], BeforeValidator(_options)] = {}

    @property
    def split_s(self) -> int:
        """Seconds of a forecast, which knows two processor cores, from which a scene is split."""
        return max(1, int(SPLIT_SHARE * 60 * self.minutes * self.speed))


class Cluster(Settings):
    """engine: slurm, or local, which starts the tasks as processes of this machine that go on when the terminal closes.

    store: a folder on a disk that every node has, relative to cluster.yaml. setup: lines of shell before each task.
    """

    engine: Literal["slurm", "local"]
    store: Word
    setup: list[Annotated[str, Field(pattern=r"^[^\x00]*$")]] = []
    kinds: Annotated[dict[str, Kind], Field(min_length=1)]


def read_cluster(path: str) -> tuple[Cluster, Path]:
    """The settings in a file, and the folder of the store. Raises UsageError with a line for each mistake."""
    try:
        content = Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror}; docs/machines.md shows one") from None
    except UnicodeDecodeError:
        raise UsageError(f"{path}: is no text in UTF-8; docs/machines.md shows one") from None
    document, problems = read(content, path)
    if problems:
        raise UsageError(map(str, problems))
    try:
        cluster = Cluster.model_validate(document.data)
    except ValidationError as error:
        raise UsageError(_line(document, mistake) for mistake in error.errors()) from None
    if wrong := list(_unfit(document, cluster)):
        raise UsageError(wrong)
    return cluster, (Path(path).parent / Path(cluster.store).expanduser()).resolve()


def _unfit(document: Document, cluster: Cluster) -> Iterator[str]:
    """A line for each name of a kind that no folder has, and for each key that the engine does nothing about."""
    for name, kind in cluster.kinds.items():
        if not name.replace("-", "").replace("_", "").isalnum():
            yield f"{document.place(('kinds',))}: {name!r} is no name of a kind; allowed: letters, digits, - and _"
        for key in (key for key in OF_SLURM if cluster.engine == "local" and key in kind.model_fields_set):
            yield f"{document.place(('kinds', name, key))}: is for Slurm; allowed: engine slurm, or to leave it out"
    if cluster.engine == "local" and cluster.setup:
        yield f"{document.place(('setup',))}: is for Slurm; allowed: engine slurm, or to leave it out"


def _line(document: Document, mistake: Mapping[str, Any]) -> str:
    where, kind = document.place(mistake["loc"]), mistake["type"]
    allowed = list((Kind if mistake["loc"][:1] == ("kinds",) else Cluster).model_fields)
    if kind == "extra_forbidden":
        said = f"no such key; allowed: {', '.join(allowed)}{nearest(str(mistake['loc'][-1]), allowed)}"
    elif kind in ("model_type", "dict_type"):
        names = "that name kinds of devices" if mistake["loc"] == ("kinds",) else ", ".join(allowed)
        said = f"is no mapping; allowed: one with keys {names}"
    elif kind == "value_error":
        said = str(mistake["ctx"]["error"])
    else:
        said = mistake["msg"][0].lower() + mistake["msg"][1:]
    return f"{where}: {said}"
