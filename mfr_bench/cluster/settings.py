"""cluster.yaml: the engine, where results go, and one entry for each kind of device."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from ..errors import UsageError, nearest
from ..plan.shards import MOST_SHARES

MOST_MINUTES = 60 * 24 * 30
SPLIT_SHARE = 0.8  # of a task's minutes; the rest starts it and writes its results


class Settings(BaseModel):
    """Refuses keys that it does not know."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class Kind(Settings):
    """A kind of device: how many tasks measure one whole run on it, and what each asks of the engine.

    device: as --device takes it; of a list each share has the next. minutes: of a task, after which the engine ends it;
    it is queued again and goes on. speed: how many times faster than two processor cores the device draws; a scene that
    takes longer than a task's minutes by that is split by methods. gres, partition, constraint, account, qos: as Slurm
    takes them; options: further ones of sbatch.
    """

    shares: Annotated[int, Field(ge=1, le=MOST_SHARES)] = 1
    device: str | Annotated[list[str], Field(min_length=1)] = "auto"
    speed: Annotated[float, Field(gt=0, le=1e6)] = 1.0
    minutes: Annotated[int, Field(ge=1, le=MOST_MINUTES)] = 60
    cpus: Annotated[int, Field(ge=1, le=1024)] = 2
    memory_gb: Annotated[float, Field(gt=0, le=2**16)] | None = None
    partition: str | None = None
    gres: str | None = None
    constraint: str | None = None
    account: str | None = None
    qos: str | None = None
    options: dict[str, str | int] = {}

    @property
    def devices(self) -> list[str]:
        """The devices that its shares take in turn."""
        return [self.device] if isinstance(self.device, str) else list(self.device)

    @property
    def split_s(self) -> int:
        """Seconds of a forecast, which knows two processor cores, from which a scene is split."""
        return max(1, int(SPLIT_SHARE * 60 * self.minutes * self.speed))


class Cluster(Settings):
    """engine: slurm, or local, which starts the tasks as processes of this machine.

    store: a folder on a disk that every node has, relative to cluster.yaml. setup: lines of shell before each task.
    """

    engine: Literal["slurm", "local"]
    store: Annotated[str, Field(min_length=1, pattern=r"^[^\x00]+$")]
    setup: list[str] = []
    kinds: Annotated[dict[str, Kind], Field(min_length=1)]


def read_cluster(path: str) -> tuple[Cluster, Path]:
    """The settings in a file, and the folder of the store. Raises UsageError with a line for each mistake."""
    import yaml

    try:
        found = yaml.safe_load(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror}; docs/machines.md shows one") from None
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise UsageError(f"{path}: is no YAML: {' '.join(str(error).split())}") from None
    try:
        cluster = Cluster.model_validate(found)
    except ValidationError as error:
        raise UsageError(_line(path, mistake) for mistake in error.errors()) from None
    bad = [name for name in cluster.kinds if not name.replace("-", "").replace("_", "").isalnum()]
    if bad:
        raise UsageError(f"{path}: kinds: {bad[0]!r}; allowed: letters, digits, - and _")
    return cluster, (Path(path).parent / cluster.store).resolve()


def _line(path: str, mistake: Mapping[str, Any]) -> str:
    where = ".".join(map(str, mistake["loc"])) or "the file"
    if mistake["type"] != "extra_forbidden":
        return f"{path}: {where}: {mistake['msg'][0].lower()}{mistake['msg'][1:]}"
    allowed = list((Kind if mistake["loc"][0] == "kinds" else Cluster).model_fields)
    word = str(mistake["loc"][-1])
    return f"{path}: {where}: no such key; allowed: {', '.join(allowed)}{nearest(word, allowed)}"
