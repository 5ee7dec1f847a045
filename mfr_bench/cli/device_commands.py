"""`methods`, `doctor`, `render`, `shader`: one look at a device, a method or an image."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import click

from .endings import WRONG, note_blame
from .interruption import Interruption
from .options import (
    DEVICE,
    JSON,
    OUTSIDE,
    PROFILE,
    SET,
    ConfigName,
    MethodName,
    OutPath,
    PassName,
    first_experiment,
    hold_one_form,
    method,
)
from .output import ending, note, say, say_lines, width

CHECKER_PIXELS, CHECKER_GREYS = 8, (0.75, 0.9)  # of a square behind a transparent image


def _device_or_reason(want: str):
    """The device, or None and why there is none. Raises UnknownDeviceError where there are others than the wanted."""
    from ..errors import DeviceError, UnknownDeviceError

    try:
        from ..gpu.device import open_device

        return open_device(want), None
    except UnknownDeviceError:
        raise
    except DeviceError as error:
        return None, str(error)


@click.command()
@JSON
@click.option("--markdown", is_flag=True, help="Print what docs/methods.md holds; needs no device.")
@click.option("--rounding", is_flag=True,
              help="Print the table of docs/accuracy.md: what compositing loses to rounding; needs no device.")
@click.option("--fairness", is_flag=True,
              help="Print docs/fairness.md: methods compared with independent implementations; needs no device.")
@DEVICE
@OUTSIDE
def methods(as_json: bool, markdown: bool, rounding: bool, fairness: bool, device: str) -> None:
    """List every method, and whether this device runs it.

    With its paper, passes, memory, guarantee, and parameters.

    \b
    Examples: mfr-bench methods
              mfr-bench methods --json | jq '.[] | select(.supported) | .id'
    """
    from ..methods import catalog
    from ..methods.catalog_text import as_markdown

    hold_one_form("methods", json=as_json, markdown=markdown, rounding=rounding, fairness=fairness)

    if markdown:
        say(as_markdown(catalog().values()).rstrip("\n"))
        return
    if fairness:
        from ..report.peers import as_markdown as fairness_page

        say(fairness_page().rstrip("\n"))
        return
    if rounding:
        from ..oracle.rounding import as_markdown as rounding_table

        say(rounding_table().rstrip("\n"))
        return
    found, reason = _device_or_reason(device)
    records = [_method_record(m, found, reason) for m in catalog().values()]
    if as_json:
        say(json.dumps(records, indent=2))
        return
    if reason:
        note(reason)
    for record in records:
        say(_method_text(record, width()))


def _method_record(declared, device, reason: str | None) -> dict:
    """The entry of a method in `methods --json`; `supported` is null where there is no device."""
    missing = [device.limits.lacks(f) for f in declared.variant({}).needs if device and f not in device.features]
    return {
        "id": declared.id, "name": declared.name, "family": declared.family, "source": declared.source,
        "summary": declared.summary, "passes": list(declared.pass_names), "guarantee": declared.guarantee,
        "words_per_pixel": declared.words, "beside_the_words": declared.beside, "cost": declared.cost,
        "ties": declared.ties, "failure": declared.failure, "exact_where": declared.exact_where,
        "params": [{"name": p.name, "default": p.default, "allowed": p.allowed, "doc": p.doc,
                    "needs": dict(p.needs), "weakens": dict(p.weakens),
                    "unsupported": [c for c, f in p.needs.items() if device and f not in device.features]}
                   for p in declared.params],
        "needs": sorted({*declared.needs, *(f for p in declared.params for f in p.needs.values())}),
        "supported": None if device is None else not missing,
        "reason": reason or (f"needs {', '.join(missing)}" if missing else None),
    }


def _method_text(record: dict, width: int) -> str:
    here = {True: "runs here", False: record["reason"], None: "no device to run it on"}[record["supported"]]
    params = [f"{p['name']}={p['default']} ({p['allowed']}"
              + (f"; {', '.join(p['unsupported'])} not on this device" if p["unsupported"] else "") + ")"
              for p in record["params"]]
    words = "word" if record["words_per_pixel"] == "1" else "words"
    lines = [record["summary"], f"{record['guarantee']}; {record['words_per_pixel']} {words} per pixel; {here}",
             f"passes: {', '.join(record['passes'])}; source: {record['source']}",
             f"equal depths: {record['ties']}", *(params or [])]
    head = f"{record['id']}  {record['name']}"
    body = [textwrap.fill(line, width, initial_indent="    ", subsequent_indent="      ") for line in lines]
    return "\n".join([head, *body])


@click.command()
@JSON
@DEVICE
def doctor(as_json: bool, device: str) -> None:
    """Show every OpenGL device, test one, and choose its timer.

    Each test has a known answer. Where one fails, it says what that costs: a feature, without which some methods are
    unsupported, or the trust in any result, which is marked FAIL and ends with exit status 1.

    \b
    Examples: mfr-bench doctor
              mfr-bench doctor --device 1

    Without a driver it says in one line what to install, and ends with exit status 1.
    """
    from ..gpu.device import list_devices, open_device
    from ..gpu.selftest import calibrate, self_tests

    with Interruption(device_here=True):
        listed = list_devices()
        found = open_device(device)
        findings, calibration = self_tests(found), calibrate(found)
    record = {
        "devices": [{"index": d.index, **d.info, "trouble": d.trouble} for d in listed],
        "device": found.info,
        "limits": asdict(found.limits) | {"features": sorted(found.features)},
        "missing_features": sorted(found.missing_features),
        "extensions": sorted(found.extensions),
        "self_tests": [asdict(f) for f in findings], "calibration": asdict(calibration),
    }
    if as_json:
        say(json.dumps(record, indent=2))
    else:
        say_lines(_doctor_text(record))
    if any(f.harmful for f in findings):
        click.get_current_context().exit(1)


def _doctor_text(record: dict) -> str:
    device, limits, calibration = record["device"], record["limits"], record["calibration"]
    lines = [*map(_device_line, record["devices"]), "",
             f"device      {device['renderer']} ({device['kind']})", f"vendor      {device['vendor']}",
             f"version     {device['version']}",
             (f"limits      {limits['max_block_bytes'] / 2**20:.0f} MiB per storage block, "
              f"textures of {limits['max_texture_size']} pixels a side"),
             f"features    {', '.join(limits['features']) or 'none of the optional ones'}",
             f"missing     {', '.join(record['missing_features']) or 'nothing'}",
             f"extensions  {len(record['extensions'])} (listed with --json)", ""]
    lines += [f"{_mark(f):4}  {f['name']}: {f['detail']}{_cost(f)}" for f in record["self_tests"]]
    lines += ["", f"timer: {calibration['timer']} ({calibration['reason']})"]
    lines += [f"  {name:4} resolves {_said_ms(tick)}" for name, tick in calibration["resolution_ms"].items()]
    lines += [f"  work {i}: wall {wall:8.3f} ms, gpu {gpu:8.3f} ms"
              for i, (wall, gpu) in enumerate(zip(calibration["wall_ms"], calibration["gpu_ms"], strict=True), start=1)]
    rates = calibration["rates"]
    lines += ["", (f"copies {rates['copy_bytes_per_s'] / 1e9:.3g} GB/s, read and written; fills "
                   f"{rates['fill_pixels_per_s'] / 1e9:.3g} Gpixel/s of 16 bytes")]
    return "\n".join(lines)


def _device_line(listed: Mapping[str, Any]) -> str:
    """An EGL device: what it is, or why it cannot be used."""
    names = [f"{name.upper()} {listed[name]}" for name in ("uuid", "pci") if listed.get(name)]
    said = (f"cannot be used: {listed['trouble']}" if listed["trouble"]
            else f"{listed['renderer']} ({listed['kind']}), {listed['version']}")
    return "; ".join([f"{listed['index']:<3} {said}", *names])


def _mark(finding: Mapping[str, Any]) -> str:
    if finding["passed"] is None:
        return "-"
    return "pass" if finding["passed"] else "no" if finding["costs"] else "FAIL"


def _cost(finding: Mapping[str, Any]) -> str:
    return f"; {finding['costs']}" if finding["passed"] is False and finding["costs"] else ""


def _said_ms(tick_ms: float | None) -> str:
    return "unknown: its clock stands still without work" if tick_ms is None else f"{1e6 * tick_ms:.3g} ns"


@click.command()
@click.argument("config", type=ConfigName())
@click.option("--method", "method_id", required=True, type=MethodName(), help="The method that renders.")
@click.option("--out", required=True, type=OutPath(dir_okay=False),
              help="F.npy: float32 (H, W, 4), premultiplied, row 0 at the bottom. F.png: upright, over a checkerboard.")
@PROFILE
@SET
@DEVICE
@OUTSIDE
def render(config: str, method_id: str, out: str, profile: str | None, overrides: tuple[str, ...],
           device: str) -> None:
    """Render CONFIG's first scene by one method, and check the image.

    \b
    Example:
      mfr-bench render smoke --method kplus-array --set k=8 --out image.png
    """
    from ..errors import DeviceError
    from ..methods import catalog
    from ..methods.spec import Fitted
    from ..plan import judge
    from ..scene import generate
    from ..store import write_file

    kind = ending(out, ".npy", ".png")
    cell, variant = _first_cell(config, method(method_id, "--method"), profile, overrides)
    made = generate(cell.scene)

    from ..gpu.device import open_device
    from ..gpu.single import shown
    from ..run.outcome import verdict

    with Interruption(device_here=True):
        opened = open_device(device)
        with shown(opened, made) as on:
            stats, decision = on.stats, judge(cell, catalog(), on.stats, opened.limits)
            if decision:
                raise DeviceError(f"{method_id}: {decision[0]}: {decision[1]}")
            image = on.render(variant)
            errors = on.errors(variant, image)
    write_file(Path(out), _npy(image) if kind == ".npy" else _png(image))
    said = (f"max_abs_error {errors['max_abs_error']:.3g}, {errors['wrong_pixels']} wrong pixels" if errors
            else "no image to compare")
    tied = (f"; {errors['tied_pixels']} tied pixels, the worst {errors['tied_error']:.3g} from every order"
            if errors and errors["tied_pixels"] else "")
    say(f"{out}: {stats.W} x {stats.H}, {stats.F} fragments, {said}{tied}")
    if errors and verdict(Fitted(variant, stats), errors, lost=0)[0] == "wrong":
        note_blame(device, "the image is wrong")
        click.get_current_context().exit(WRONG)


def _first_cell(config: str, declared, profile: str | None, overrides: tuple[str, ...]):
    """The first cell of a method in a config, --set above all else; a method that is not listed has no entry there."""
    from ..config import MethodEntry
    from ..methods import catalog
    from ..plan import expand

    experiment = first_experiment(config, profile, overrides, declared.id)
    entry = next((e for e in experiment.methods if e.id == declared.id), MethodEntry(declared.id, declared.name, {}))
    chosen = {text.partition("=")[0].strip().removeprefix("params.") for text in overrides}
    own = {name: value for name, value in entry.params.items() if name not in chosen}
    cells = expand(replace(experiment, methods=(replace(entry, params=own),)), catalog())
    cell = next(c for c in cells if c.method == declared.id)
    return cell, declared.variant(cell.params)


def _npy(image) -> bytes:
    import io

    import numpy as np

    data = io.BytesIO()
    np.save(data, image)
    return data.getvalue()


def _png(image) -> bytes:
    import io

    from matplotlib.image import imsave

    from ..report.checkerboard import over_checkerboard

    data = io.BytesIO()
    imsave(data, over_checkerboard(image, CHECKER_PIXELS, CHECKER_GREYS)[::-1], format="png")
    return data.getvalue()


@click.command()
@click.argument("method_id", metavar="METHOD", type=MethodName())
@click.option("--pass", "pass_name", metavar="NAME", type=PassName(), help="Only the pass of this name.")
@click.option("--config", default="smoke", show_default=True, type=ConfigName(),
              help="The config whose first cell gives parameters and sizes.")
@PROFILE
@SET
@click.option("--plan", "as_plan", is_flag=True,
              help="Print what a frame runs instead: passes, bindings, barriers, and why passes are left out.")
@JSON
@OUTSIDE
def shader(method_id: str, pass_name: str | None, config: str, profile: str | None,
           overrides: tuple[str, ...], as_plan: bool, as_json: bool) -> None:
    """Print the GLSL of METHOD, with its includes and defines.

    The driver gets the same without comments, branches that are not chosen and unused macros. With --json: the passes
    in order, with their stages and what they read and write, the buffers with their words, and the parameters.

    \b
    Example: mfr-bench shader kplus-array --pass store --set k=16
    """
    from ..errors import UsageError, nearest
    from ..glsl import stages
    from ..methods.spec import Fitted
    from ..plan import expected_stats

    cell, variant = _first_cell(config, method(method_id, "METHOD"), profile, overrides)
    names = variant.pass_names
    if pass_name is not None and pass_name not in names:
        raise UsageError(f"--pass: {method_id} has no pass {pass_name!r}; allowed: {', '.join(names)}"
                         f"{nearest(pass_name, names)}")
    fitted = Fitted(variant, expected_stats(cell.scene))
    if as_plan:
        from ..gpu.plan import as_text

        say(as_text(fitted))
        return
    if as_json:
        from ..race.adapter import frame_of, record

        say(json.dumps(record(frame_of(fitted), pass_name), indent=2))
        return
    for step in variant.passes:
        if step.kind == "clear" or step.probes or pass_name not in (None, step.name) or not fitted.needed(step):
            continue
        for stage in stages(fitted, step):
            say(f"// {method_id}, pass {step.name}: {stage.entry}\n{stage.text}")
