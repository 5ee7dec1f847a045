"""docs/fairness.md: methods compared with independent implementations, and what differences from sources are worth.

The numbers are in results/peers: `measured.csv` has a row per comparison, `reasons.csv` says of a method and an
implementation why their times differ, `differences.csv` in what each method differs from its source, and `rankings.csv`
which of two methods a paper has as the faster. scripts/differences.py measures the last two into `worth.csv` and
`ranked.csv`.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from statistics import geometric_mean

from ..errors import StoreError
from ..markdown import filled, markdown_table
from ..resources import peers_dir

USUAL = "llvmpipe-amd-epyc-2-cores"  # the device of a ratio that names none
ALIKE = (0.85, 1.15)  # ratios between which no reason is asked for
MOST = 1.10  # the ratio that no row is to exceed
# Of two ways: the first over the second.
MEASURED = ("n", "k", "first_ms", "second_ms", "ratio", "ratio_low", "ratio_high", "device", "date")
RANKED = ("source", "faster", "faster_with", "slower", "slower_with")
COLUMNS: Mapping[str, tuple[str, ...]] = {
    "measured.csv": ("method", "parameters", "implementation", "commit", "measured", "device", "date", "width",
                     "height", "density", "n", "k", "ours_ms", "theirs_ms", "ratio", "ratio_low", "ratio_high"),
    "reasons.csv": ("method", "parameters", "implementation", "reason"),
    "reads.csv": ("method", "parameters", "n", "k", "ratio", "ratio_low", "ratio_high"),
    "differences.csv": ("method", "source", "here", "choice", "note"),
    "worth.csv": ("method", "choice", *MEASURED),
    "rankings.csv": (*RANKED, "n", "k", "reason"),
    "ranked.csv": (*RANKED, *MEASURED),
}
HEAD = """# Fair to every method

`mfr-bench methods --fairness` prints this page from the tables in `results/peers`; a test compares the two.

Times of the methods here over those of independent implementations, of which each has a table below. Rows of the two
hosts, which "Compared with independent implementations" tells of, are kept apart:
"""
COMPARED = """## Compared with independent implementations

The public code of others and the methods here drew the same quads in one process, frame by frame in turns, in random
order. Times are CPU times of a frame in all threads of the process, medians of 9 rounds; a ratio is ours over theirs,
paired within rounds, with the 95 % interval of its median by the bootstrap. A row whose interval was wider than 0.2 was
measured once more, and the second stands. None of that code is part of this project. The device is llvmpipe, where the
fragments of a pixel come one by one: what contention costs on a GPU is not in these numbers, and nothing was measured
on a GPU.

The images were compared first, and differ by at most 0.0034, the rounding of premultiplied 8-bit colours. The weights
of weighted blending differ, so that its images were compared with theirs in the place of ours (0 and 0.0006). MLAB
and HT of PixelSyncOIT divide by zero where nothing covers a pixel, and backwards memory allocation of pknowles/oit
draws nothing there: these were compared elsewhere.

The others' shaders were used unchanged but for these:

- rectangle textures became plain ones, colours and depths come from the quads, and what the driver's compiler refuses
  was written in another way;
- of the authors' renderer the tiles of the S-buffer follow the viewport, and counters are elements of a buffer where
  they were pointers; KB-AB_Array and KB-AB_LL store colours where they stored white; LL-Paged counts no further than
  its local array of 32; KB-AB_LL resets its furthest depth once for a pixel, not at each cell, and shows k fragments,
  not k - 1; and of what it peels the shaders of the geometry are public, while the passes between are ours;
- of nvpro-samples colours are not converted to sRGB and back, and fragments beyond the last slot are dropped;
- of pknowles/oit backwards memory allocation leaves out its map of heat;
- moments have the paper's overestimation of 0.25.

Rows of `amd-epyc-2-cores-b` were measured later, on another host of the same name, on which other work ran. Those of
A-buffers, and of the k-buffers that resolve in a local array, are of methods whose selection of batches, sorts or
filling of that array had changed here in between, or were missing before, as those of all other methods were; rows with
backwards memory allocation are older than that change. Local arrays in memory take 1.5 to 2.5 times as long on that
host, registers and stores 1.1 to 1.6 times, which moves ratios: compare rows of one device. Its rows of front-to-back
peeling are medians of 7 rounds, those without the resolve of 31, some of frames of 15. What a sort of 64 fragments in a
local array takes there changes from process to process, and where the array is longer by a few elements that nothing
uses: of AB_SB (Shell sort) 206 to 261 ms in eight processes, with the same shaders; of PixelSyncOIT's insertion sort at
n = 64, all pixels covered, 396 ms at 256×256 in one and 717 in another (ours 336 and 335), at 512×512 1452 and 3332
(ours 1157 and 1655), of which the table has the first, of 7 rounds. Intervals are of one process.

Rows without the resolve are the same frames without their last pass. Times of lists vary most: they depend on whether
both threads of llvmpipe ask for cells at the same time, which makes the same frame two to five times as long. On the
first host intervals were up to 0.43 wide, and three of twelve ratios were above 1.10 (1.16, 1.14 and 1.11, intervals
from 0.95 to 1.51); all twelve were measured again on the second, with both threads, and none is. By one thread on one
core (LP_NUM_THREADS=1), 256×256, building AB_LL takes 0.70 [0.69, 0.78] of pknowles' time with all pixels covered by 16
fragments, 0.65 [0.65, 0.66] by 64, and 0.69 [0.69, 0.69] with a quarter covered by 64; of PixelSyncOIT's 0.66
[0.66, 0.66], 0.64 [0.64, 0.68] and 0.67 [0.66, 0.67]. The build of PreCalc_Fixed with a quarter covered was measured in
three processes, of which the table has the middle one: by 16 fragments 1.12, 1.13 and 1.19, by 64 1.05, 1.09 and 1.13.
"""
REASONS = """Why a ratio lies outside 0.85 to 1.15:
"""
OPEN = """Not compared yet: of the authors' renderer k-buffers other than those above; of nvpro-samples loop64 and
interlock, which need what llvmpipe lacks, and its simple array and linked list from 32 fragments on, whose bubble sort
llvmpipe 22.3.6 compiles wrongly ([drivers.md](drivers.md)); Lefebvre's lists and hash tables, whose code is not
available; at 512×512 and n = 64 what is not in the tables: KB-LL with all pixels covered does not fit the 128 MiB of
llvmpipe's storage blocks; and everything on a GPU.
"""
ALIKE_FOR_ALL = """## What is one decision for all methods

- How shaders know k as the bound of their loops: `bound`, which docs/methods.md tells.
- How a resolve reads what is stored for each fragment: through textures of the buffers' memory, where the device has
  them so large (GL_MAX_TEXTURE_BUFFER_SIZE), otherwise as it lies. llvmpipe reads a storage buffer lane by lane in a
  loop, and a texture for all lanes at once.

CPU time of a frame through textures over that of buffers as they lie on llvmpipe (the second of the hosts above, beside
other work), 256×256 pixels, all of them covered, with the 95 % interval of the median of 9 rounds; no GPU was measured:
"""
DIFFERENCES = """## Where methods differ from their sources, and what that is worth

Every method has a row for each difference that is known. Worth is a ratio of CPU times of a frame on llvmpipe, 256×256
pixels, all of them covered by n fragments: the way here over that with the choice named, with the 95 % interval of the
median of the ratios within rounds. The choice is the source's way unless the row says otherwise.
`scripts/differences.py` measures them, a frame of each way in turns in one process, while the machine did other work
beside it; a ratio from the second of the hosts above names it. Other figures are from trials of which the code is not
kept. Where n = 64 is missing it was not measured.
"""
RANKINGS = """## What papers rank

Of two methods that a paper has as the faster and the slower, the ratio of their CPU times here, measured like the
differences above. Above 1 the order is the paper's. `mfr-bench claims` judges all claims of the papers, with
these among them, on the scenes of their experiments; what needs a feature that llvmpipe lacks stands there alone.
"""


def as_markdown() -> str:
    """The page. Raises StoreError for tables whose columns are others, or for a ratio without its reason."""
    rows = list(table("measured.csv"))
    reasons = {(r["method"], r["parameters"], r["implementation"]): r["reason"] for r in table("reasons.csv")}
    lines = [HEAD, *_overview(rows), "", COMPARED, *_measured(rows), REASONS, *_reasons(rows, reasons), "", OPEN,
             ALIKE_FOR_ALL, *_reads(), "", DIFFERENCES, *_differences(), "", RANKINGS, *_rankings()]
    return "\n".join(lines) + "\n"


def _measured_of(name: str, columns: tuple[str, ...]) -> dict[tuple[str, ...], list[dict[str, str]]]:
    """The rows of a table of times, by the columns that tell what they are of."""
    found: dict[tuple[str, ...], list[dict[str, str]]] = {}
    for row in table(name):
        found.setdefault(tuple(row[column] for column in columns), []).append(row)
    return found


def _differences() -> list[str]:
    """The table of differences. Raises StoreError for one that has neither a time nor a note."""
    times = _measured_of("worth.csv", ("method", "choice"))
    cells = []
    for row in table("differences.csv"):
        measured = times.get((row["method"], row["choice"]), ()) if row["choice"] else ()
        worth = "; ".join(filter(None, (*map(_ratio, measured), row["note"])))
        if not worth:
            raise StoreError(f"{peers_dir() / 'differences.csv'}: {row['method']}, {row['source']}: neither measured "
                             "nor with a note; run scripts/differences.py, or say why it is not measured")
        cells.append((f"`{row['method']}`", row["source"], row["here"], row["choice"] and f"`{row['choice']}`", worth))
    return markdown_table(("method", "the source", "here", "chosen by", "worth"), cells)


def _rankings() -> list[str]:
    """The table of rankings. Raises StoreError for one that is not measured, or is another's order for no reason."""
    times = _measured_of("ranked.csv", RANKED)
    cells = []
    for row in table("rankings.csv"):
        measured = times.get(tuple(row[name] for name in RANKED), ())
        kept = all(float(each["ratio"]) > 1 for each in measured)
        if not measured or not (kept or row["reason"]):
            pair = f"{row['faster']} before {row['slower']}, {row['source']}"
            lacks = "another order, and no reason; add it" if measured else "not measured; run scripts/differences.py"
            raise StoreError(f"{peers_dir() / 'rankings.csv'}: {pair}: {lacks}")
        cells.append((row["source"], _way(row, "faster"), _way(row, "slower"), "; ".join(map(_ratio, measured)),
                      "" if kept else row["reason"]))
    return markdown_table(("the paper", "faster there", "slower there", "time of the slower over the faster, here",
                           "why it is another order"), cells)


def _way(row: Mapping[str, str], which: str) -> str:
    return f"`{row[which]}`" + (f" ({row[f'{which}_with']})" if row[f"{which}_with"] else "")


def _ratio(row: Mapping[str, str]) -> str:
    """A ratio with its interval, and what it is of, with the device unless it is the usual one."""
    device = row["device"].removeprefix("llvmpipe-") if row["device"] != USUAL else ""
    of = ", ".join(filter(None, (f"n = {row['n']}", row["k"] and f"k = {row['k']}", device)))
    return f"{row['ratio']} [{row['ratio_low']}, {row['ratio_high']}] ({of})"


def chosen(text: str) -> dict[str, str | int]:
    """The parameters that a text `name: value; name: value` chooses; of digits alone is a whole number."""
    pairs = (part.split(": ") for part in text.split("; ") if part)
    return {name: int(value) if value.isdigit() else value for name, value in pairs}


def table(name: str) -> Iterator[dict[str, str]]:
    """The rows of one of the tables. Raises StoreError where its columns are others."""
    path: Path = peers_dir() / name
    with open(path, newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file, strict=True)
        if tuple(reader.fieldnames or ()) != COLUMNS[name]:
            raise StoreError(f"{path}: columns {reader.fieldnames}; expected {list(COLUMNS[name])}")
        yield from reader


def _by_implementation(rows: Iterable[dict[str, str]]) -> dict[str, list[dict[str, str]]]:
    """The rows of each implementation, in the order of the first of each."""
    found: dict[str, list[dict[str, str]]] = {}
    for row in rows:
        found.setdefault(row["implementation"], []).append(row)
    return found


def _overview(rows: Iterable[dict[str, str]]) -> list[str]:
    """A line for each implementation and device, with a link to the rows of the implementation."""
    cells = []
    for name, of in _by_implementation(rows).items():
        anchor = re.sub(r"[^\w -]", "", name.lower()).replace(" ", "-")  # as GitHub makes it of a heading
        for device in dict.fromkeys(row["device"] for row in of):
            ratios = [float(row["ratio"]) for row in of if row["device"] == device]
            cells.append((f"[{name}](#{anchor})", device.removeprefix("llvmpipe-"), str(len(ratios)),
                          f"{geometric_mean(ratios):.3f}", f"{min(ratios):.3f}", f"{max(ratios):.3f}",
                          str(sum(ratio > MOST for ratio in ratios))))
    head = ("beside", "device", "rows", "geometric mean", "least", "greatest", f"above {MOST:.2f}")
    return markdown_table(head, cells, left=2)


def _measured(rows: Iterable[dict[str, str]]) -> Iterator[str]:
    """The rows, under a heading for each implementation."""
    head = ("method", "parameters", "commit", "what", "device", "pixels", "covered", "n", "k", "ours, ms", "theirs, ms",
            "ratio")
    for name, of in _by_implementation(rows).items():
        cells = ((f"`{r['method']}`", r["parameters"], r["commit"][:8], r["measured"],
                  r["device"].removeprefix("llvmpipe-"), f"{r['width']}×{r['height']}",
                  f"{100 * float(r['density']):.0f} %", r["n"], r["k"], r["ours_ms"], r["theirs_ms"],
                  f"{r['ratio']} [{r['ratio_low']}, {r['ratio_high']}]") for r in of)
        yield from (f"### {name}", "", *markdown_table(head, cells), "")


def _reads() -> list[str]:
    return markdown_table(("method", "parameters", "n", "k", "ratio"), (
        (f"`{r['method']}`", r["parameters"], r["n"], r["k"], f"{r['ratio']} [{r['ratio_low']}, {r['ratio_high']}]")
        for r in table("reads.csv")))


def _reasons(rows: Iterable[dict[str, str]], reasons: Mapping[tuple[str, str, str], str]) -> list[str]:
    """A line for each method and implementation of which a ratio needs one."""
    low, high = ALIKE
    asked = dict.fromkeys((r["method"], r["parameters"], r["implementation"]) for r in rows
                          if not low <= float(r["ratio"]) <= high)
    missing = [key for key in asked if key not in reasons]
    if missing:
        raise StoreError(f"{peers_dir() / 'reasons.csv'}: no reason for {', '.join(map(str, missing))}, whose ratio "
                         f"lies outside {low} to {high}; add a row")
    return [filled(f"`{method}`{f' ({chosen})' if chosen else ''} beside {theirs}: {reasons[method, chosen, theirs]}",
                   "- ") for method, chosen, theirs in asked]
