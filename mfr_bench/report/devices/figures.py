"""Figures of methods by device: ratios to the fastest, and ranks, each with its interval."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ...store import write_file
from .. import data, style
from ..figures.files import file_name, render
from ..figures.scales import log_axis
from ..figures.sheet import EDGE, LEGEND_LINE_IN, FigureSheet, fitted, legend_columns, styled, widest
from .bands import bands_figure, bands_of
from .differs import differences
from .reading import Experiment
from .standing import MOST_DEVICES, Standing

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ROW_IN, FOOT_IN, LEAST_IN = 0.26, 0.42, 0.9
COLOURS = (style.BLUE, style.ORANGE, style.GREEN, style.VERMILION, style.SKY, style.PURPLE, "#5f6368", "#993f00",
           "#1a1a1a", "#aaaf34", "#882255", "#44aa99")
RATIOS = ("ratio to the fastest method of the device",
          "Time over that of the device's fastest method, geometric mean over the scenes that both were measured in.")
RANKS = ("rank on the device, 1 the fastest",
         "Bars: the ranks that the intervals of the ratios and the noise floor of the device leave open.")
ONE_BY_ONE = "Bars: 95 % intervals."
SPREAD = "Dot: median over devices; thick line: 10 to 90 % of them; thin line: all."


def write_device_figures(experiments: Sequence[Experiment], target: Path) -> list[Path]:
    """Write <experiment>-ratios and -ranks, .png and .svg, of each that several devices have. Raises StoreError.

    Of more than MOST_DEVICES, also <experiment>-bands, where a figure of the config has numbers as x.
    """
    written = []
    for experiment in experiments:
        if len(experiment.devices) < 2:
            continue
        standing = Standing(experiment)
        drawn = {name: device_figure(standing, name) for name in ("ratios", "ranks")}
        if len(experiment.devices) > MOST_DEVICES and (bands := bands_of(experiment)):
            drawn["bands"] = bands_figure(standing, bands)
        for name, figure in drawn.items():
            for suffix, content in render(figure).items():
                written.append(target / f"{file_name(experiment.name)}-{name}.{suffix}")
                write_file(written[-1], content)
    return written


def device_figure(standing: Standing, name: str) -> Figure:
    """A row for each method, the one with the least median first; `name`: ratios or ranks."""
    with styled():
        chart = Chart(standing, name)
        return chart.draw()


@dataclass(frozen=True)
class Chart:
    """One figure of an experiment; `name`: ratios or ranks."""

    standing: Standing
    name: str

    @property
    def experiment(self) -> Experiment:
        """The experiment whose methods stand in the rows."""
        return self.standing.experiment

    @property
    def values(self) -> np.ndarray:
        """(devices, entries, 3): low, middle, high."""
        return self.standing.ratio if self.name == "ratios" else self.standing.rank

    @property
    def one_by_one(self) -> bool:
        """Whether each device has marks of its own; else the spread over devices is drawn."""
        return len(self.experiment.devices) <= MOST_DEVICES

    @property
    def rows(self) -> list[str]:
        """Labels of the methods, the one with the least median ratio first."""
        return [entry for entry, _ in self.standing.by_entry()]

    def notes(self) -> list[str]:
        """The lines below the title: what is drawn, of how much, and in what the devices differ."""
        about = (RATIOS if self.name == "ratios" else RANKS)[1]
        bars = ("" if self.name == "ranks" else ONE_BY_ONE) if self.one_by_one else SPREAD
        if not self.one_by_one and self.name == "ranks":
            about = ""
        apart = "; ".join(f"{title}: {', '.join(value for value, _ in values[:4])}{' …' if len(values) > 4 else ''}"
                          for title, values in differences(self.experiment))
        simulated = any(device.facts.get("simulated") for device in self.experiment.devices)
        return [line for line in (
            "Simulated: no device drew these frames." if simulated else "", f"{about} {bars}".strip(),
            f"{self._counts}; images that are not right are left out.",
            f"The devices differ in {apart}." if apart else "") if line]

    @property
    def _counts(self) -> str:
        return f"{len(self.experiment.devices)} devices, {len(self.experiment.places)} scenes and parameters"

    def draw(self) -> Figure:
        """The figure with its title, notes, legend and rows."""
        names = [device.name for device in self.experiment.devices] if self.one_by_one else []
        width, rows = style.WIDTH_IN, self.rows
        columns = legend_columns(names, width - 2 * EDGE) if names else 1
        legend_in = LEGEND_LINE_IN * -(-len(names) // columns) + 0.1 if names else 0.0
        plot_in = max(LEAST_IN, ROW_IN * len(rows))
        title = f"{self.experiment.name}: {'ratio to the fastest' if self.name == 'ratios' else 'rank'} by device"
        sheet = FigureSheet(width, tuple(fitted(title, style.TITLE_PT, width, "bold")), tuple(
            part for line in self.notes() for part in fitted(line, style.SMALL_PT, width)),
            legend_in + plot_in + FOOT_IN)
        figure = sheet.figure()
        left = min(2.6, EDGE + 0.12 + widest(rows, 7.5))
        axes = sheet.axes(figure, left, legend_in, width - left - 0.15, plot_in)
        self._rows(axes, rows)
        if names:
            figure.legend(*axes.get_legend_handles_labels(), loc="upper left", ncols=columns, handlelength=1.0,
                          handletextpad=0.4, columnspacing=1.2, borderpad=0, borderaxespad=0,
                          bbox_to_anchor=(EDGE / width, sheet.y(0.0)))
        return figure

    def _rows(self, axes: Axes, rows: Sequence[str]) -> None:
        places = [self.experiment.entries.index(entry) for entry in rows]
        if self.one_by_one:
            for number, device in enumerate(self.experiment.devices):
                self._device(axes, number, device.name, places)
        else:
            for row, at in enumerate(places):
                self._spread(axes, row, at)
        axes.set_ylim(max(1, len(rows)) - 0.5, -0.5)
        axes.set_yticks(range(len(rows)), rows)
        axes.tick_params(axis="y", length=0)
        for row in range(0, len(rows), 2):
            axes.axhspan(row - 0.5, row + 0.5, color=style.BAND, linewidth=0, zorder=0)
        axes.set_xlabel((RATIOS if self.name == "ratios" else RANKS)[0])
        axes.grid(axis="x", which="major")
        if self.name == "ratios":
            low, high = axes.get_xlim()
            axes.set_xlim(low, high if self.one_by_one else 1.2 * high)
            log_axis(axes, "x", 10)
        else:
            axes.set_xlim(0.5, len(rows) + (0.5 if self.one_by_one else 1.0))
            axes.set_xticks(range(1, len(rows) + 1) if len(rows) < 10 else [1, *range(5, len(rows) + 1, 5)])

    def _device(self, axes: Axes, number: int, name: str, places: Sequence[int]) -> None:
        """The methods on one device, a little below those on the one before."""
        import numpy as np

        low, middle, high = self.values[number, list(places)].T
        shift = (number + 0.5) / len(self.experiment.devices) - 0.5
        y = np.arange(len(places)) + 0.76 * shift
        colour, marker = COLOURS[number % len(COLOURS)], style.MARKERS[number % len(style.MARKERS)]
        known = np.isfinite(low) & np.isfinite(high) & (high < 1e6)
        axes.hlines(y[known], low[known], high[known], color=colour, linewidth=1.0, zorder=3)
        axes.plot(middle, y, linestyle="", marker=marker, markersize=3.4, color=colour, label=name, zorder=4)

    def _spread(self, axes: Axes, row: int, at: int) -> None:
        import numpy as np

        found = self.values[:, at, 1]
        found = found[np.isfinite(found)]
        colour = style.method_colour(self.experiment.method(self.experiment.entries[at]))
        least, low, middle, high, most = np.percentile(found, (0, 10, 50, 90, 100))
        axes.hlines(row, least, most, color=colour, linewidth=0.8, zorder=3)
        axes.hlines(row, low, high, color=colour, linewidth=3.2, zorder=3)
        axes.plot([middle], [row], marker="o", markersize=4.2, color="white", markeredgecolor=colour, zorder=4)
        text = f"{middle:g}" if self.name == "ranks" else data.number(float(middle))
        axes.annotate(text, (most, row), (4, 0), textcoords="offset points", va="center",
                      fontsize=style.NUMBER_PT, color=style.QUIET)
