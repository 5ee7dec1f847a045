"""The figures and tables of the experiments that several devices measured, as files in one folder."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ...store import ResultFolder, write_file
from ..figures.files import file_name, write_panels
from ..tables.pages import WIDTH
from .figures import write_device_figures
from .reading import Experiment, read_experiments
from .text import as_text


def write_together(folders: Sequence[ResultFolder], target: Path) -> list[Path]:
    """Write for each experiment that several folders hold: its figures by device, ratios, ranks, and a page.

    Of an experiment NAME: the figures of its config with a panel or a series for each device, NAME-ratios and
    NAME-ranks, and NAME-devices.md, which says how the devices differ. Raises StoreError.
    """
    written = []
    for experiment in read_experiments(folders):
        if len(experiment.devices) > 1:
            written += write_panels([ResultFolder(path) for path in by_speed(experiment)], target)
            written += write_device_figures([experiment], target)
            written.append(target / f"{file_name(experiment.name)}-devices.md")
            write_file(written[-1], as_text(experiment, WIDTH, markdown=True).encode())
    return written


def by_speed(experiment: Experiment) -> list[str]:
    """The paths of the devices' folders, from that of the fastest to that of the slowest by all their times."""
    import numpy as np

    from .standing import MIDDLE

    times = np.log(experiment.numbers[..., MIDDLE])
    usual = np.nanmedian(times, axis=0)  # of each place and entry
    slower = [np.nanmean(own - usual) if np.isfinite(own).any() else np.inf for own in times]
    return [experiment.devices[i].path for i in np.argsort(slower, kind="stable")]
