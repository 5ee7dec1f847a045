"""`python -m tests.run.planted_run FOLDER`: a run with the fake worker, without a config and reports."""

from __future__ import annotations

import sys

from mfr_bench.config.model import Measure, Scene
from mfr_bench.methods import catalog
from mfr_bench.plan import Cell
from mfr_bench.run import process
from mfr_bench.run.jobs import jobs
from mfr_bench.run.ledger import Ledger
from mfr_bench.run.sheet import Sheet
from mfr_bench.run.supervisor import Supervisor
from mfr_bench.store import ResultFolder

SCENES, METHODS = range(1, 25), ("floor", "ab-array", "kplus-array", "kplus-heap")
CELLS = len(SCENES) * len(METHODS)


def planned() -> list[Cell]:
    return [Cell("planted", m, m, catalog()[m].complete({}), Scene(size=(8, 8), depth_complexity=n), Measure(), {})
            for n in SCENES for m in METHODS]


class Telling(Ledger):
    """Prints a dot for every batch that is kept."""

    def sampled(self, batch) -> None:
        super().sampled(batch)
        print(".", end="", flush=True)


def main() -> None:
    process.PROGRAM = ("import sys; sys.path[:] = sys.argv.pop().split(':'); "
                       "from tests.run.fake_worker import main; main()")
    folder = ResultFolder(sys.argv[1])
    with Supervisor("auto") as supervisor, folder.lock():
        ready = supervisor.ready()
        ledger = Telling([Sheet(folder, jobs(planned(), catalog(), ready.device, ready.timer))], ready.device)
        ledger.settle()
        supervisor.measure(ledger.groups(), ledger)
        ledger.close()


if __name__ == "__main__":
    main()
