#!/usr/bin/env python3
"""Measures `adaptive` beside the fastest other exact method where geometry does not fill rectangles.

scripts/adaptive_scenes.py FILE [--rounds 7] [--only TEXT] [--deep | --small | --opaque] [--bound] [--table]

FILE is a CSV table with a row for each scene; a scene that has one is not measured again. All methods draw a scene in
turns in one process, by its processor time; every image is compared with the oracle's. --only: scenes whose names have
TEXT. --deep: the scenes with up to 1024 layers at 512x512 instead, --small: with 256 to 1024 layers at 96x96, which
the arrays of all methods have room for; --opaque: those with 10, 30 and 60 % of the primitives opaque. --bound: for
meshes and their stand-ins measure, in the place of `adaptive`, the least that a method which stores each fragment can
do: a counter and one store for each, and a resolve that reads them once and blends them as they come. --table: print
FILE in Markdown, measure nothing. For a driver that draws on the CPU.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from statistics import median

import numpy as np
from ending import Misuse, at_least, run_script
from in_turns import FEWEST_ROUNDS, add_row, geometric_mean, in_turns, ratio, rows_of

from mfr_bench.config.model import Measure
from mfr_bench.gpu.device import open_device
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.single import Shown
from mfr_bench.methods import catalog
from mfr_bench.methods.shared import PAYLOAD, STAGE, STOP_OPACITY, resolve_sorted
from mfr_bench.methods.shared.screen_region import TOUCHED, in_screen_region
from mfr_bench.methods.spec import Buffer, Fitted, Method, Pass, Variant
from mfr_bench.plan import Cell, judge
from mfr_bench.scene import Scene, generate
from mfr_bench.scene.geometry import Geometry
from mfr_bench.scene.kinds.mesh import View
from mfr_bench.scene.primitives import OPAQUE
from mfr_bench.store.status import EXACT_ERROR

ROOT = Path(__file__).resolve().parents[1]
OTHERS = {"ab-array": "AB_Array", "ab-ll": "AB_LL", "ab-sb": "AB_SB", "ab-precalc-fixed": "PreCalc_Fixed",
          "ab-dfb": "DFB"}
MINE, FLOOR, REUSE = "adaptive", "floor", "ab-sb reuse_count=on"
BOUND = "unsorted touched=bounds"
MESH_LIKE = ("hairball", "needles", "temple", "mesh", "hair,")  # how the names of meshes and their stand-ins begin
FEW = 16  # layers: where no pixel has more, the frames are told apart in the summary
KEPT = 2  # others that are measured in all rounds, the fastest by a first look
LOOK_ROUNDS = 3


def stand_in(kind: str, most: int, mean: float, density: float = 0.5, **more) -> Scene:
    return Scene(kind=kind, depth_complexity=most, mean_depth=mean, pixel_density=density, size=(256, 256), seed=1,
                 **more)


def quads(layers: int, **more) -> Scene:
    return Scene(depth_complexity=layers, size=(256, 256), seed=1, **more)


def mesh(name: str) -> Scene:
    return Scene(kind="mesh", file=name, folder=str(ROOT / "configs" / "meshes"), depth_complexity=1, size=(256, 256),
                 alpha="material", order="random", seed=1,
                 view=View(projection="perspective", eye=(1, 2, 3), target=(0, 0, 0)))


def hair(width: float, thin: str) -> Scene:
    return Scene(kind="strands", depth_complexity=1, size=(256, 256), strands=5000, segments=16, alpha=(0.4, 0.9),
                 order="file", seed=1, width=width, thin=thin)


def scattered(layers: int, **more) -> Scene:
    return quads(layers, layout="random", quad_size=(16, 16), **more)


def tiles(layers: int, density: float) -> Scene:
    return quads(layers, layout="tiles", pixel_density=density)


SCENES: Mapping[str, Scene] = {
    **{f"{kind}, {most} layers": stand_in(kind, most, mean)
       for kind in ("hairball", "needles", "temple") for most, mean in ((6, 2.5), (16, 8), (60, 30))},
    "temple, 200 layers": stand_in("temple", 200, 100),
    "hairball, 60 layers in 5 %": stand_in("hairball", 60, 30, 0.05),
    "temple, 60 layers in 5 %": stand_in("temple", 60, 30, 0.05),
    "hairball, 60 layers, opaque": stand_in("hairball", 60, 30, alpha=(1.0, 1.0)),
    **{f"{kind}, {most} layers, {words} opaque": stand_in(kind, most, mean)
       for kind, most, mean in (("hairball", 16, 8), ("hairball", 60, 30), ("temple", 60, 30))
       for words in ("a third", "half")},
    "mesh knot.obj": mesh("knot.obj"), "mesh solids.obj": mesh("solids.obj"),
    "hair, half a pixel, slivers": hair(0.5, "sliver"), "hair, 2 pixels wide": hair(2.0, "alpha"),
    **{f"16 × 16 quads at random places, {layers} in the mean": scattered(layers) for layers in (1, 4, 16, 64)},
    "16 × 16 quads at random places, 16 in the mean, opaque": scattered(16, alpha=(1.0, 1.0)),
    "slanted quads, 16 layers": quads(16, slant=0.7, pixel_density=0.5),
    "slanted quads, 64 layers": quads(64, slant=0.7, pixel_density=0.1),
    "tiles of quads, 4 layers in 1 %": tiles(4, 0.01),
    **{f"tiles of quads, {layers} layers": tiles(layers, 0.5) for layers in (4, 16, 64)},
}
PARTS = {"a third opaque": 1 / 3, "half opaque": 1 / 2, "10 % opaque": 0.1, "30 % opaque": 0.3,
         "60 % opaque": 0.6}  # of the primitives, by the end of a scene's name
DEEP: Mapping[str, Scene] = {
    f"{name}, {scene.depth_complexity} layers": replace(scene, size=(512, 512))
    for name, scene in {
        "quads in a block": quads(1024, pixel_density=0.02),
        "tiles of quads": tiles(1024, 0.02), "slanted quads": quads(1024, slant=0.7, pixel_density=0.02),
        "hairball": stand_in("hairball", 1000, 300, 0.05), "needles": stand_in("needles", 1024, 300, 0.05)}.items()}
SMALL: Mapping[str, Scene] = {
    f"{name}, {layers} layers at 96 × 96": replace(scene, size=(96, 96))
    for layers in (256, 512, 1024)
    for name, scene in {
        "quads in a block": quads(layers, pixel_density=0.25), "tiles of quads": tiles(layers, 0.25),
        "slanted quads": quads(layers, slant=0.7, pixel_density=0.25),
        "hairball": stand_in("hairball", layers, 0.3 * layers, 0.25),
        "needles": stand_in("needles", layers, 0.3 * layers, 0.25)}.items()}
PARTLY_OPAQUE: Mapping[str, Scene] = {
    f"{name}, {part} % opaque": scene
    for part in (10, 30, 60)
    for name, scene in {
        **{f"{kind}, {most} layers": stand_in(kind, most, most / 2)
           for kind in ("hairball", "needles", "temple") for most in (8, 16, 64)},
        "mesh knot.obj": mesh("knot.obj"), "mesh solids.obj": mesh("solids.obj"),
        "hair, 2 pixels wide": hair(2.0, "alpha")}.items()}


def made(name: str, scene: Scene) -> Geometry:
    """The geometry of a scene, with as many opaque primitives as its name says, dealt out by a seed."""
    whole = generate(scene)
    share = next((share for words, share in PARTS.items() if name.endswith(words)), 0.0)
    rgba = whole.rgba.copy()
    rgba[np.random.default_rng(scene.seed).random(len(rgba)) < share, 3] = OPAQUE
    return replace(whole, rgba=rgba)


def unsorted() -> Method:
    """AB_Array without its sort: its image is wrong unless fragments come nearest first."""
    slots = {"SLOTS": "n"}
    return Method(
        id="unsorted", name="Unsorted", family="array", source="the bound of scripts/adaptive_scenes.py",
        summary="n slots per pixel, composited as they come", guarantee="none", words="2*n + 1", ties="kept",
        params=(STAGE, STOP_OPACITY, TOUCHED, PAYLOAD),
        buffers=(Buffer("counter", "P", doc="fragments of each pixel"),
                 Buffer("nodes", "2*n*P", type="FRAGMENT", doc="fragments of each pixel, in order of arrival")),
        steps=in_screen_region(
            Pass("clear", "clear", writes=("counter",)),
            Pass("store", "geometry", "methods/array/store.frag", writes=("counter", "nodes"), defines=slots),
            resolve_sorted("counter", "nodes", fetch="methods/array/fetch.glsl", texels=("nodes",), defines=slots)))


METHODS = {**catalog(), "unsorted": unsorted()}


@contextmanager
def drawn(on: Shown, scene: Scene, names: Sequence[str]) -> Iterator[dict[str, Frame]]:
    """Frames of the methods, each drawn until it fits and its image found right; what cannot be drawn is told."""
    frames: dict[str, Frame] = {}
    try:
        for name in names:
            if reason := not_drawn(on, scene, name):
                print(f"{name} is left out: {reason}", file=sys.stderr)
            else:
                frames[name] = checked(on, name)
        yield frames
    finally:
        for frame in frames.values():
            frame.release()


def variant_of(name: str) -> Variant:
    """The variant of a method with its parameters, `id name=value …`."""
    method, *given = name.split()
    return METHODS[method].variant(dict(each.split("=") for each in given))


def not_drawn(on: Shown, scene: Scene, name: str) -> str | None:
    """The reason why a run would leave the method out, such as a buffer that no storage block holds."""
    variant = variant_of(name)
    cell = Cell(experiment="", method=variant.method.id, label=name, params=variant.params, scene=scene,
                measure=Measure(), point={})
    decision = judge(cell, METHODS, on.stats, on.device.limits)
    return decision[1] if decision else None


def checked(on: Shown, name: str) -> Frame:
    """A frame of a method. Exits where an exact image is wrong."""
    variant = variant_of(name)
    frame = Frame(on.device, Fitted(variant, on.stats), on.scene_buffer, on.canvas)
    frame.draw_fitting()
    frame.draw()
    errors = on.errors(variant, frame.image())
    if errors and (errors["max_abs_error"] > EXACT_ERROR or frame.lost_fragments()):
        raise SystemExit(f"{name}: the image is wrong by {errors['max_abs_error']:.3g}; its times would mean nothing")
    return frame


def measured(device, name: str, scene: Scene, rounds: int, mine: str = MINE) -> dict[str, object]:
    """The row of a scene: `mine` beside the others."""
    on = Shown(device, made(name, scene))
    try:
        with drawn(on, scene, [mine, FLOOR, REUSE, *OTHERS]) as frames:
            looked = in_turns(device, frames, LOOK_ROUNDS)
            kept = sorted((m for m in OTHERS if m in frames), key=lambda m: median(looked[m]))[:KEPT]
            if not kept:
                raise SystemExit(f"{name}: no other method draws it, so that there is nothing to compare with")
            times = in_turns(device, {m: frames[m] for m in (mine, FLOOR, REUSE, *kept) if m in frames}, rounds)
            return {"scene": name, **depths(on), "plan": plan_of(frames[mine]), **compared(times, mine)}
    finally:
        on.canvas.release()
        on.scene_buffer.release()


def depths(on: Shown) -> dict[str, object]:
    """Fragments of a covered pixel in the mean and at most, and the share of the pixels that are covered."""
    covered = int(sum(on.stats.histogram[1:]))
    return {"mean": round(on.stats.F / max(1, covered), 1), "most": on.stats.n,
            "covered": round(covered / on.stats.P, 4)}


def plan_of(frame: Frame) -> str:
    if frame.plan is None:
        return ""
    return f"`{frame.plan.path}`" + (", guessed" if frame.plan.guessed else "")


def compared(times: Mapping[str, Sequence[float]], mine: str = MINE) -> dict[str, object]:
    """The columns that times in ms come to: those of the fastest other, and the ratios to it and to two more."""
    fastest = min((m for m in times if m in OTHERS), key=lambda m: median(times[m]))
    low, middle, high = ratio(times[mine], times[fastest])
    beside = {column: round(ratio(times[mine], times[m])[1], 3) if m in times else ""
              for column, m in (("floor", FLOOR), ("reuse", REUSE))}
    return {"ms": round(median(times[mine]), 2), "fastest": fastest, "fastest_ms": round(median(times[fastest]), 2),
            "ratio": round(middle, 3), "low": "" if low is None else round(low, 3),
            "high": "" if high is None else round(high, 3), **beside}


COLUMNS = {
    "scene": lambda r: r["scene"],
    "fragments of a covered pixel: mean, most": lambda r: f"{float(r['mean']):g}, {r['most']}",
    "covered": lambda r: f"{100 * float(r['covered']):.0f} %",
    "plan": lambda r: r["plan"],
    "adaptive, ms": lambda r: f"{float(r['ms']):.1f}",
    "fastest other, ms": lambda r: f"{OTHERS[r['fastest']]} {float(r['fastest_ms']):.1f}",
    "over it": lambda r: f"{float(r['ratio']):.2f}" + (f" [{float(r['low']):.2f}, {float(r['high']):.2f}]"
                                                      if r["low"] else ""),
    "over the floor": lambda r: f"{float(r['floor']):.2f}" if r["floor"] else "",
    "over AB_SB that reuses its count": lambda r: f"{float(r['reuse']):.2f}" if r["reuse"] else "",
}
LEFT = 4  # columns of words; those of numbers go to the right, but for the name of the fastest


def as_table(rows: Sequence[Mapping[str, str]]) -> str:
    """The rows in Markdown, and a line on all of them."""
    rules = ["---" if i < LEFT or name.startswith("fastest") else "---:" for i, name in enumerate(COLUMNS)]
    lines = [list(COLUMNS), rules, *([told(row) for told in COLUMNS.values()] for row in rows)]
    return "\n".join(["| " + " | ".join(line) + " |" for line in lines] + ["", *summary(rows)])


def summary(rows: Sequence[Mapping[str, str]]) -> list[str]:
    """How often it is fastest, and geometric means: of all scenes, of meshes and their stand-ins, of parts of these."""
    like = [row for row in rows if row["scene"].startswith(MESH_LIKE)]
    groups = {"all scenes": rows, "meshes and their stand-ins": like,
              "of these, without opaque ones": [row for row in like if not row["scene"].endswith("opaque")],
              f"of these, more than {FEW} layers": [row for row in like if int(row["most"]) > FEW],
              f"of these, up to {FEW} layers": [row for row in like if int(row["most"]) <= FEW]}
    return [f"{name}: fastest in {sum(r < 1 for r in ratios)} of {len(ratios)}, at most {max(ratios):.2f}, geometric "
            f"mean {geometric_mean(ratios):.3f}"
            for name, some in groups.items() if (ratios := [float(row["ratio"]) for row in some])]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("file", type=Path)
    parser.add_argument("--rounds", type=at_least(FEWEST_ROUNDS), default=7)
    parser.add_argument("--only", default="")
    size = parser.add_mutually_exclusive_group()
    size.add_argument("--deep", action="store_true")
    size.add_argument("--small", action="store_true")
    size.add_argument("--opaque", action="store_true")
    parser.add_argument("--bound", action="store_true")
    parser.add_argument("--table", action="store_true")
    given = parser.parse_args()
    chosen = DEEP if given.deep else SMALL if given.small else PARTLY_OPAQUE if given.opaque else SCENES
    known = {name: scene for name, scene in chosen.items() if not given.bound or name.startswith(MESH_LIKE)}
    scenes = {name: scene for name, scene in known.items() if given.only in name}
    if not scenes:
        raise Misuse(f"--only {given.only}: no scene has this in its name; allowed: a part of {', '.join(known)}")
    if given.table and not given.file.exists():
        raise Misuse(f"{given.file}: no such file; without --table it is made")
    done = {row["scene"] for row in rows_of(given.file)}
    if not given.table and scenes.keys() - done:
        device = open_device("cpu")
        for name, scene in scenes.items():
            if name not in done:
                add_row(given.file, measured(device, name, scene, given.rounds, BOUND if given.bound else MINE))
    order = {name: place for place, name in enumerate((*SCENES, *DEEP, *SMALL, *PARTLY_OPAQUE))}
    print(as_table(sorted(rows_of(given.file), key=lambda row: order.get(row["scene"], len(order)))))


if __name__ == "__main__":
    run_script(main)
