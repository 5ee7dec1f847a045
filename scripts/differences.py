#!/usr/bin/env python3
"""Measures what differences from sources are worth, and methods that papers rank: frames of two ways, in turns.

scripts/differences.py [METHOD...] [--only differences|rankings] [--layers 16 64] [--rounds 9]

For each row of results/peers/differences.csv that names a choice, a method is compared with itself with the choice; for
each of rankings.csv, the method that a paper has as the slower with the faster. They draw quads that cover all of
256x256 pixels. Each row comes into worth.csv or ranked.csv at once, in place of that of the same frames. Each way draws
in every round; times are the processor time of all threads, and a ratio is that of the two in a round, with the
interval of its median.
"""

from __future__ import annotations

import argparse
import csv
import datetime as dt
import sys
from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from statistics import median

from ending import Misuse, at_least, run_script
from in_turns import FEWEST_ROUNDS, in_turns, ratio

from mfr_bench.config.model import Scene
from mfr_bench.errors import one_of
from mfr_bench.gpu.context import Device
from mfr_bench.gpu.device import open_device
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.single import Shown, shown
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted, Method, Variant
from mfr_bench.report.peers import COLUMNS, RANKED, chosen, table
from mfr_bench.resources import peers_dir
from mfr_bench.scene import generate

SIDE = 256  # pixels
LAYERS, SLOTS = (16, 64), (8,)  # fragments of a pixel, and k of the methods that have one
EMULATED = {"atomic64": "emulated"}  # where the device has no 64-bit atomics


@dataclass(frozen=True)
class Pair:
    """Two variants that are compared on so many layers, and the columns that tell in what the second differs."""

    told: Mapping[str, str]
    layers: int
    k: int | None
    ways: tuple[Variant, Variant]

    @property
    def key(self) -> tuple[str, ...]:
        return tuple(self.told.values())


def fitted_to(device: Device, method: Method, params: Mapping[str, object]) -> Variant:
    """The variant, with 64-bit atomics emulated where the device has none."""
    variant = method.variant(params)
    lacks = "shader_atomic_int64" in variant.needs and "shader_atomic_int64" not in device.features
    return method.variant({**params, **EMULATED}) if lacks else variant


def with_k(method: Method, k: int | None) -> dict[str, int]:
    return {"k": k} if k and any(param.name == "k" for param in method.params) else {}


def differences(device: Device, only: Container[str]) -> Iterator[Pair]:
    """Each method as it is, beside itself with the choice of a row of differences.csv."""
    known = catalog()
    for row in table("differences.csv"):
        method = known[row["method"]]
        if not row["choice"] or row["method"] not in only:
            continue
        told = {name: row[name] for name in ("method", "choice")}
        for layers, k in product(LAYERS, SLOTS if with_k(method, 1) else (None,)):
            base = with_k(method, k)
            yield Pair(told, layers, k, (fitted_to(device, method, base),
                                         fitted_to(device, method, {**base, **chosen(row["choice"])})))


def rankings(device: Device, only: Container[str]) -> Iterator[Pair]:
    """The slower of two methods by a paper beside the faster, as rankings.csv has them."""
    known = catalog()
    for row in table("rankings.csv"):
        if row["faster"] not in only:
            continue
        told = {name: row[name] for name in RANKED}
        for layers, slots in product(map(int, row["n"].split()), row["k"].split() or [None]):
            k = layers if slots == "n" else slots and int(slots)
            ways = [fitted_to(device, known[row[each]],
                              {**with_k(known[row[each]], k), **chosen(row[f"{each}_with"])})
                    for each in ("slower", "faster")]
            yield Pair(told, layers, k, (ways[0], ways[1]))


def drawn(on: Shown, variant: Variant) -> Frame:
    """A frame of the variant that has room for what it draws."""
    frame = Frame(on.device, Fitted(variant, on.stats), on.scene_buffer, on.canvas)
    frame.draw_fitting()
    return frame


def compared(on: Shown, ways: tuple[Variant, Variant], rounds: int) -> dict[str, str]:
    """The columns of a comparison: the medians of both ways in ms, and the ratio of the first over the second."""
    frames = [drawn(on, way) for way in ways]
    first, second = in_turns(on.device, dict(enumerate(frames)), rounds).values()
    for frame in frames:
        frame.release()
    low, middle, high = ratio(first, second)
    return {"first_ms": f"{median(first):.2f}", "second_ms": f"{median(second):.2f}", "ratio": f"{middle:.3f}",
            "ratio_low": f"{low:.3f}", "ratio_high": f"{high:.3f}"}


def lacking(device: Device, pair: Pair) -> list[str]:
    """The features that a way needs and the device lacks."""
    return sorted({need for way in pair.ways for need in way.needs} - set(device.features))


def measured(device: Device, pairs: list[Pair], rounds: int) -> Iterator[dict[str, str]]:
    """A row for each pair that the device can draw."""
    for layers in sorted({pair.layers for pair in pairs}):
        with shown(device, generate(Scene(size=(SIDE, SIDE), depth_complexity=layers))) as on:
            for pair in (pair for pair in pairs if pair.layers == layers):
                if lacks := lacking(device, pair):
                    print(f"{', '.join(pair.key)}: needs {', '.join(lacks)}", file=sys.stderr)
                    continue
                row = {**pair.told, "n": str(layers), "k": str(pair.k or ""),
                       **compared(on, pair.ways, rounds)}
                print(" ".join(row.values()), flush=True)
                yield row


def written(name: str, rows: list[dict[str, str]], wanted: list[tuple[str, ...]]) -> None:
    """Put the rows in place of those of the same frames in a table, which keeps to the order of what is wanted."""
    def of(row: Mapping[str, str]) -> tuple[int, int, int]:
        return wanted.index(tuple(row.values())[:len(wanted[0])]), int(row["n"]), int(row["k"] or 0)

    old = [row for row in table(name) if tuple(row.values())[:len(wanted[0])] in wanted]
    found = {of(row): row for row in (*old, *rows)}
    with (peers_dir() / name).open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS[name], lineterminator="\n")
        writer.writeheader()
        writer.writerows(found[place] for place in sorted(found))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("methods", nargs="*", metavar="METHOD", help="only these; of rankings, where it is the faster")
    parser.add_argument("--device", default="auto")
    parser.add_argument("--name", default="llvmpipe-amd-epyc-2-cores", help="of the device, for the table")
    parser.add_argument("--rounds", type=at_least(FEWEST_ROUNDS), default=9, help="samples of each way")
    parser.add_argument("--layers", type=int, choices=LAYERS, nargs="+", default=LAYERS,
                        help="only so many fragments of a pixel")
    parser.add_argument("--only", choices=("differences", "rankings"), help="measure one of the two tables")
    given = parser.parse_args()
    for method in given.methods:
        if method not in catalog():
            raise Misuse(f"{method}: no such method; {one_of(method, catalog())}")
    device, only = open_device(given.device), set(given.methods or catalog())
    same = {"device": given.name, "date": dt.datetime.now(dt.UTC).date().isoformat()}
    for name, result, pairs_of in (("differences", "worth.csv", differences), ("rankings", "ranked.csv", rankings)):
        if given.only in (None, name):
            pairs = [pair for pair in pairs_of(device, only) if pair.layers in given.layers]
            wanted = list(dict.fromkeys(pair.key for pair in pairs_of(device, catalog())))
            for row in measured(device, pairs, given.rounds):
                written(result, [{**row, **same}], wanted)


if __name__ == "__main__":
    run_script(main)
