"""The columns of results.csv and passes.csv, what figures derive from them, and the arrays that a cell may keep.

A new column is one entry of `COLUMNS` and the module that produces its value: configs, figures, tables, the CSV files
and docs/results.md read the entry.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from .status import STATUSES

Type = Literal["str", "int", "float", "bool", "json"]
Origin = Literal["cell", "scene", "values", "joined", "derived"]
Drawn = Literal["", "place", "measure", "error", "cost"]


@dataclass(frozen=True)
class Column:
    """A column of a CSV file, or a measure that is derived when it is drawn.

    origin: the part of the cell file that holds the value; `joined` values come from several parts or several cells,
        `derived` ones stand in no file of a run.
    drawn: what a figure may do with it. A `place` says where a cell stands (x, panels, rows); a `measure` can also be
        the height of a line or bar; an `error` and a `cost` are measures that a frontier may have as y and as x.
    producer: the module of mfr_bench that gives the value.
    label: text of a figure's axis, unless the name with its unit serves.
    """

    name: str
    type: Type
    unit: str
    meaning: str
    origin: Origin = "values"
    drawn: Drawn = ""
    producer: str = "run.cell"
    label: str = ""

    @property
    def axis(self) -> str:
        """Text of the axis that shows the column."""
        return self.label or (f"{self.name} ({self.unit})" if self.unit else self.name)


COLUMNS = (
    Column("experiment", "str", "", "name of the config", "cell", "place", "run.ledger"),
    Column("method", "str", "", "id of the method", "cell", "place", "run.ledger"),
    Column("status", "str", "", " | ".join(STATUSES), "cell", "place", "run.ledger"),
    Column("reason", "str", "", "why the status is not ok", "cell", producer="run.ledger"),
    Column("width", "int", "pixels", "viewport width", "joined", "place", "store.rows"),
    Column("height", "int", "pixels", "viewport height", "joined", "place", "store.rows"),
    Column("pixel_density", "float", "", "covered pixels / all pixels, as configured", "scene", "place",
           "config.model"),
    Column("depth_complexity", "int", "fragments", "fragments per covered pixel, as configured", "scene", "place",
           "config.model"),
    Column("k", "int", "fragments", "fragments kept per pixel", "joined", "place", "store.rows"),
    Column("fragment_probability", "float", "", "chance that a generated fragment is not discarded", "scene", "place",
           "config.model"),
    Column("order", "str", "", "submission order", "scene", "place", "config.model"),
    Column("seed", "int", "", "seed of the scene", "scene", "place", "config.model"),
    Column("params", "json", "", "every parameter of the method", "cell", producer="run.ledger"),
    Column("fragments", "int", "fragments", "fragments of the frame", drawn="measure", producer="run.outcome"),
    Column("samples", "int", "", "timed frames, warm-up apart", drawn="measure"),
    Column("timer", "str", "", "gpu (timer queries) or wall (between two finishes)"),
    Column("time_ms", "float", "ms", "whole frame, median", drawn="cost", label="time (ms)"),
    Column("time_ms_low", "float", "ms", "lower end of the median's 95 % interval", drawn="measure"),
    Column("time_ms_high", "float", "ms", "upper end of the median's 95 % interval", drawn="measure"),
    Column("floor_ms", "float", "ms", "time_ms of the floor for the same scene, device and timer", "joined", "measure",
           "store.rows"),
    Column("memory_bytes", "int", "bytes", "objects that the method allocated", drawn="cost"),
    Column("memory_model_bytes", "int", "bytes", "the same by the paper's formula", drawn="measure",
           producer="run.outcome"),
    Column("max_abs_error", "float", "", "largest channel error against the promised image, channels in [0,1]",
           drawn="measure", producer="oracle.quality", label="largest channel error"),
    Column("rmse", "float", "", "root mean square error against the full list's image, in the "
           "nearest order of equal depths", drawn="error",
           producer="oracle.quality", label="root mean square error"),
    Column("psnr_db", "float", "dB", "peak signal-to-noise ratio against the full list's image, in the "
           "nearest order of equal depths", drawn="measure",
           producer="oracle.quality"),
    Column("flip", "float", "", "mean FLIP of the displayed image against the full list's, in the nearest order of "
           "equal depths, over black or white, the worse", drawn="error", producer="oracle.quality", label="mean FLIP"),
    Column("hit_ratio", "float", "", "fragments kept / generated, counted in what the method holds after an untimed "
           "frame (as promised, by a method that holds no fragments)", drawn="measure", producer="run.outcome",
           label="share of the fragments that is kept"),
    Column("wrong_pixels", "int", "pixels", "pixels with a channel error above 1/512", drawn="measure",
           producer="oracle.quality", label="wrong pixels"),
    Column("tied_pixels", "int", "pixels", "pixels that fragments of equal depth and different colours leave open",
           drawn="measure", producer="oracle.quality"),
    Column("tied_error", "float", "", "largest channel error of a tied pixel: how far it is from every order of equal "
           "depths", drawn="measure", producer="oracle.quality"),
    Column("order_error", "float", "", "largest channel error of a tied pixel against the order of submission",
           drawn="measure", producer="oracle.quality"),
    Column("max_error_all", "float", "", "largest channel error against the full list's image, in the nearest order of "
           "equal depths", drawn="error", producer="oracle.quality"),
    Column("wrong_pixels_all", "int", "pixels", "pixels with a channel error above 1/512 against the full list's "
           "image, in the nearest order of equal depths", drawn="error", producer="oracle.quality"),
    Column("label", "str", "", "name of the method in tables and figures", "cell", "place", "run.ledger"),
    Column("layout", "str", "", "how quads are placed", "scene", producer="config.model"),
    Column("scene", "json", "", "every key of the scene: as configured, at the point of the sweep", "cell",
           producer="run.ledger"),
    Column("point", "json", "", "values of the swept keys", "cell", producer="run.ledger"),
    Column("covered_pixels", "int", "pixels", "pixels with at least one fragment", drawn="measure",
           producer="run.outcome"),
    Column("max_fragments", "int", "fragments", "most fragments in any pixel", drawn="measure",
           producer="run.outcome"),
    Column("noisy", "bool", "", "the interval was still wider than asked for when time or samples ran out"),
    Column("stop_reason", "str", "", "why sampling stopped"),
    Column("repeats", "int", "frames", "frames within one sample, which is their mean: short frames need several"),
    Column("sessions", "int", "", "processes that took the samples: more than 1 where a run was resumed",
           producer="run.ledger"),
    Column("lost_fragments", "int", "fragments", "fragments that the method counted as dropped in a frame: the "
           "first, or the mean of those after it where that is more", drawn="measure"),
    Column("discarded_share", "float", "", "share of the fragments discarded before the store (occupancy)",
           drawn="measure", producer="run.outcome"),
    Column("culled_share", "float", "", "share of the fragments that never ask for the lock: discarded by early z, or "
           "refused by the test before it; counted where the map of `discarded` is kept", drawn="measure",
           label="share of the fragments that is discarded"),
    Column("luminance_error", "float", "", "largest error of a primitive's luminance in [0,1], where payloads have two "
           "channels", drawn="measure", producer="oracle.twochannel", label="largest error of luminance"),
    Column("hue_error", "float", "degrees", "mean angle between a primitive's light and that of its payload, where "
           "payloads have two channels", drawn="measure", producer="oracle.twochannel",
           label="mean error of hue (degrees)"),
    Column("distinct_images", "int", "", "different images among those of measure.repeat_images untimed frames",
           drawn="measure"),
    Column("promised_ratio", "float", "", "fragments that the method promises to keep / generated", drawn="measure",
           producer="run.outcome"),
    Column("geometry_passes", "int", "", "times the geometry was drawn in a frame", drawn="measure"),
    Column("chosen_k", "int", "fragments", "k, where the method chooses it from the scene", producer="run.outcome"),
    Column("error_bound", "float", "", "largest max_abs_error that rounding explains, where the method is exact",
           drawn="measure"),
    Column("glsl_hash", "str", "", "hash of the shaders that ran", "cell", producer="run.ledger"),
    Column("key", "str", "", "name of the cell file", "cell", producer="run.ledger"),
    Column("device", "str", "", "short name of the device", "joined", producer="store.rows"),
    Column("package", "str", "", "name, version and hash of the code from outside for method, effect or scene; "
           "empty for mfr-bench's own", "joined", producer="store.rows"),
    Column("msaa", "int", "samples", "samples of a pixel, as configured", "joined", "place", "store.rows"),
    Column("edge_pixels", "int", "pixels", "pixels with a fragment that covers only some of their samples, where they "
           "have several", drawn="measure", label="pixels with an edge"),
)

PASS_COLUMNS = (
    Column("experiment", "str", "", "name of the config", "cell", producer="run.ledger"),
    Column("method", "str", "", "id of the method", "cell", producer="run.ledger"),
    Column("label", "str", "", "name of the method in tables and figures", "cell", producer="run.ledger"),
    Column("key", "str", "", "name of the cell file", "cell", producer="run.ledger"),
    Column("pass", "str", "", "name of the pass", "joined", producer="store.rows"),
    Column("order", "int", "", "position in the frame, from 0", "joined", producer="store.rows"),
    Column("samples", "int", "", "frames in which the pass was timed", "joined", producer="store.rows"),
    Column("time_ms", "float", "ms", "median", "joined", "measure", "store.rows"),
    Column("time_ms_low", "float", "ms", "lower end of the median's 95 % interval", "joined", producer="store.rows"),
    Column("time_ms_high", "float", "ms", "upper end of the median's 95 % interval", "joined", producer="store.rows"),
    Column("share", "float", "", "median / sum of the medians of the cell's passes", "joined", "measure", "store.rows",
           "share of the passes' time"),
    Column("work", "json", "", "work of the pass in a frame by counter, where measure.counters asks for it", "joined",
           producer="store.rows"),
)


def _derived(name: str, unit: str, meaning: str, label: str, drawn: Drawn = "measure") -> Column:
    return Column(name, "float", unit, meaning, "derived", drawn, "report.data.point", label)


DERIVED = (
    _derived("fps", "1/s", "1000 / time_ms", "frames per second"),
    _derived("floor_ratio", "", "time_ms / time_ms of the floor, with the interval of the ratio", "time / floor"),
    _derived("memory_mib", "MiB", "memory_bytes / 2^20", "memory (MiB)", "cost"),
    _derived("memory_model_mib", "MiB", "memory_model_bytes / 2^20", "memory by the paper's formula (MiB)"),
    _derived("ms_per_mib", "ms/MiB", "time_ms / memory_mib", "time per memory (ms / MiB)"),
    _derived("ms_times_mib", "ms·MiB", "time_ms · memory_mib", "time × memory (ms · MiB)"),
    _derived("fps_per_mib", "1/(s·MiB)", "fps / memory_mib", "frames per second per MiB"),
    _derived("words_per_pixel", "", "memory_bytes / 4 / (width · height)", "32-bit words per pixel"),
    _derived("tied_share", "", "tied_pixels / covered_pixels", "share of the covered pixels that is tied"),
    _derived("culled_of_unkept", "", "culled_share / (1 - hit_ratio)",
             "share of the fragments not kept that is discarded"),
)


@dataclass(frozen=True)
class Array:
    """An array that a cell may store with its numbers, one value or one pixel for each pixel of the viewport."""

    name: str
    type: str  # of numpy
    dimensions: int
    meaning: str


ARRAYS = {array.name: array for array in (
    Array("image", "uint8", 3, "premultiplied RGBA, row 0 at the bottom"),
    Array("error", "float16", 2, "largest channel error against the promised image, channels in [0, 1]"),
    Array("loss", "float16", 2, "the same against the image of all fragments"),
    Array("fragments", "uint16", 2, "fragments generated"),
    Array("discarded", "uint16", 2, "fragments refused before they were stored"),
)}

VALUES = {c.name: c for c in COLUMNS if c.origin == "values"}


def names(columns: Sequence[Column], *drawn: Drawn) -> tuple[str, ...]:
    """The columns that a figure may use in one of these ways, in the order of the table."""
    return tuple(c.name for c in columns if c.drawn in drawn)
