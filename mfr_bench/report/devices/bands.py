"""A figure of very many devices: along an axis, how far each method is from each device's fastest, as quantiles.

Lines of a hundred devices hide each other. A panel for each method has the median over devices, the band of most of
them and that of all, and names the devices at both ends.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from .. import data, style
from ..figures.scales import log_axis, y_label
from ..figures.series import axis_label
from ..figures.sheet import EDGE, LEFT, FigureSheet, fitted, styled, text_width
from .reading import Experiment
from .standing import MIDDLE, Standing

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMNS, PANEL_IN, GAP_IN, FOOT_IN = 4, 0.95, 0.12, 0.42
PANEL_WIDTH_IN = (style.WIDTH_IN - LEFT - EDGE - GAP_IN * (COLUMNS - 1)) / COLUMNS
HEADING_IN, ENDS_IN, LABEL_IN = 0.42, 0.03, 0.23  # above a panel: all of it, and where its lines begin
LABEL_PT = 7.5
QUANTILES = (0.0, 0.1, 0.5, 0.9, 1.0)
LOG_FROM = 8.0  # largest value of x over the least from which x is logarithmic
ABOUT = ("Time over that of the device's fastest method at each place. Line: median over devices; dark: 10 to 90 % of "
         "them; light: all. Above each panel the least and the largest ratio, and on which devices.")


@dataclass(frozen=True)
class Bands:
    """The ratios of every method along one axis. x: the axis; at: its values in ascending order.

    ratios: float64 (devices, values, entries), of several places at one value the geometric mean; NaN where a device
    has no time of a method.
    """

    experiment: Experiment
    x: str
    at: Sequence[float]
    ratios: np.ndarray

    @cached_property
    def quantiles(self) -> np.ndarray:
        """float64 (QUANTILES, values, entries), over the devices that have each."""
        import numpy as np

        found = np.full((len(QUANTILES), *self.ratios.shape[1:]), np.nan)
        known = np.isfinite(self.ratios).any(axis=0)
        found[:, known] = np.nanquantile(self.ratios[:, known], QUANTILES, axis=0)
        return found

    def ends(self, entry: int) -> list[str]:
        """The least and the largest ratio of a method anywhere, each with its device."""
        import numpy as np

        own = self.ratios[:, :, entry]
        least, most = (np.unravel_index(find(own), own.shape) for find in (np.nanargmin, np.nanargmax))
        return [f"{data.number(float(own[place]))} on {self.experiment.devices[place[0]].name}"
                for place in (least, most)]


def bands_of(experiment: Experiment) -> Bands | None:
    """The bands along the first axis of the config's figures that has several numbers; None where none has."""
    places = [_coordinates(experiment, place) for place in experiment.places]
    for x in dict.fromkeys(axis for device in experiment.devices for axis in device.axes):
        values = [place.get(data.bare(x)) for place in places]
        numbers = sorted({value for value in values if type(value) in (int, float)})
        if len(numbers) > 1:
            return Bands(experiment, x, numbers, _ratios(experiment, values, numbers))
    return None


def _coordinates(experiment: Experiment, place: str) -> Mapping[str, Any]:
    """The values that make a place, by bare name: of its scene, and of the parameters that stand behind it."""
    scene, end = json.JSONDecoder().raw_decode(place)
    params = place[end:].removeprefix("; ")
    swept = next((device.sweeps[params] for device in experiment.devices if params in device.sweeps), {})
    return {data.bare(name): value for name, value in {**scene, **swept}.items()}


def _ratios(experiment: Experiment, values: Sequence[Any], numbers: Sequence[float]) -> np.ndarray:
    import numpy as np

    times = experiment.numbers[..., MIDDLE]  # (devices, places, entries)
    logs = np.log(np.where(times > 0, times, np.nan))
    best = np.min(np.where(np.isnan(logs), np.inf, logs), axis=2, keepdims=True)
    apart = logs - np.where(np.isfinite(best), best, np.nan)
    found = []
    for number in numbers:
        here = apart[:, [value == number for value in values]]
        count = np.isfinite(here).sum(axis=1)
        found.append(np.where(count, np.nansum(here, axis=1) / np.maximum(count, 1), np.nan))
    return np.exp(np.stack(found, axis=1))


def _shortened(text: str, points: float) -> str:
    """The text, cut where a panel ends."""
    cut = text
    while cut and text_width(cut if cut == text else f"{cut}…", points) > PANEL_WIDTH_IN:
        cut = cut[:-1]
    return cut if cut == text else f"{cut}…"


def bands_figure(standing: Standing, bands: Bands) -> Figure:
    """A panel for each method, the one with the least median ratio first."""
    with styled():
        return _Chart(standing, bands).draw()


@dataclass(frozen=True)
class _Chart:
    """The figure of the bands. Panels share both axes."""

    standing: Standing
    bands: Bands

    def draw(self) -> Figure:
        experiment, width = self.bands.experiment, style.WIDTH_IN
        entries = [entry for entry, _ in self.standing.by_entry()]
        columns = min(COLUMNS, len(entries))
        rows = math.ceil(len(entries) / columns)
        step = HEADING_IN + PANEL_IN + GAP_IN
        title = f"{experiment.name}: ratio to the fastest along {data.short(self.bands.x)}, by device"
        sheet = FigureSheet(width, tuple(fitted(title, style.TITLE_PT, width, "bold")),
                            tuple(part for line in self._notes() for part in fitted(line, style.SMALL_PT, width)),
                            rows * step + FOOT_IN)
        figure = sheet.figure()
        grid: list[Axes] = []
        for i, entry in enumerate(entries):
            shared = {name: grid[0] for name in ("sharex", "sharey") if grid}
            axes = sheet.axes(figure, LEFT + i % columns * (PANEL_WIDTH_IN + GAP_IN),
                              i // columns * step + HEADING_IN, PANEL_WIDTH_IN, PANEL_IN, **shared)
            grid.append(axes)
            self._panel(axes, entry)
        for i, axes in enumerate(grid):
            self._finish(axes, leftmost=i % columns == 0, lowest=i + columns >= len(grid))
        return figure

    def _notes(self) -> list[str]:
        devices = self.bands.experiment.devices
        simulated = any(device.facts.get("simulated") for device in devices)
        return [line for line in ("Simulated: no device drew these frames." if simulated else "", ABOUT,
                                  f"{len(devices)} devices; images that are not right are left out.") if line]

    def _panel(self, axes: Axes, entry: str) -> None:
        number = self.bands.experiment.entries.index(entry)
        least, low, middle, high, most = self.bands.quantiles[:, :, number]
        colour = style.method_colour(self.bands.experiment.method(entry))
        axes.fill_between(self.bands.at, least, most, color=colour, alpha=0.18, linewidth=0)
        axes.fill_between(self.bands.at, low, high, color=colour, alpha=0.4, linewidth=0)
        axes.plot(self.bands.at, middle, color=colour, linewidth=1.4)
        axes.text(0.0, 1 + LABEL_IN / PANEL_IN, _shortened(entry, LABEL_PT), transform=axes.transAxes,
                  fontsize=LABEL_PT, va="bottom")
        ends = (_shortened(line, style.NUMBER_PT) for line in self.bands.ends(number))
        axes.text(0.0, 1 + ENDS_IN / PANEL_IN, "\n".join(ends), transform=axes.transAxes, fontsize=style.NUMBER_PT,
                  color=style.QUIET, va="bottom", linespacing=1.15)

    def _finish(self, axes: Axes, leftmost: bool, lowest: bool) -> None:
        log_axis(axes, "y", 10)
        first, last = self.bands.at[0], self.bands.at[-1]
        if first > 0 and last / first >= LOG_FROM:
            log_axis(axes, "x", 10)
        axes.set_xlim(first, last)
        axes.set_ylim(bottom=1)
        axes.grid(which="major")
        axes.tick_params(labelbottom=lowest, labelleft=leftmost)
        if lowest:
            axes.set_xlabel(axis_label(self.bands.x))
        if leftmost:
            y_label(axes, "ratio to the fastest")
