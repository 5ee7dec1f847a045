"""`new-method` and `check`: a method of one's own, from its first file to its contract."""

from __future__ import annotations

from pathlib import Path

import click

from .endings import WRONG
from .interruption import Interruption
from .options import DEVICE, OUTSIDE, MethodName, OutPath, method
from .output import note, say

FRAGMENTS = "3,2"  # of each pixel, on the race machine
SCHEDULES = 5_000  # on each of its machines
SCENES = 4


@click.command("new-method")
@click.argument("name")
@click.option("--out", metavar="DIR", type=OutPath(file_okay=False), help="The folder to make. [default: NAME]")
def new_method(name: str, out: str | None) -> None:
    """Write a package with a method of your own: its declaration, its GLSL, a config.

    It works as it is: an A-buffer to copy and change. docs/adding-a-method.md explains each part.

    \b
    Example:
      mfr-bench new-method my-array
      mfr-bench check my-array --methods my-array
      mfr-bench run my-array/my-array.yaml --methods my-array
    """
    from ..errors import UsageError
    from ..methods import catalog
    from ..outside.template import write

    if name in catalog():
        raise UsageError(f"new-method: {name!r} is a method already; allowed: an id of its own")
    folder = Path(out or name)
    for path in write(name, folder):
        say(path)
    say(f"next: mfr-bench check {name} --methods {folder}")


@click.command()
@click.argument("method_id", metavar="METHOD", type=MethodName())
@click.option("--no-race", is_flag=True, help="Leave out the adversarial scheduler, which needs a C++ compiler.")
@DEVICE
@OUTSIDE
def check(method_id: str, no_race: bool, device: str) -> int:
    """Check METHOD against the contract that every method keeps.

    Its declaration and shaders are looked at; every variant is drawn on flat, empty, sparse, sorted, scattered, opaque
    and slanted scenes and compared with the float64 oracle; memory, losses and writes outside buffers are checked; and
    where a C++ compiler is there, its GLSL runs under the adversarial scheduler of `race`. A line for each check; exit
    status 3 where one fails, 1 where the device lacks what METHOD needs.

    \b
    Examples: mfr-bench check my-array --methods my-array
              mfr-bench check kplus-array
    """
    declared = method(method_id, "METHOD")
    _hold_own(method_id)
    failed, lacking = _contract(declared, device)
    if no_race:
        say("left out  the race machine (--no-race)")
    else:
        failed += _raced(declared)
    say(f"{method_id}: {failed} checks failed" if failed else f"{method_id}: every check passed")
    return WRONG if failed else int(lacking)


def _hold_own(method_id: str) -> None:
    """Raise UsageError where a declaration from outside has the id too: the method of that id is another one."""
    from ..errors import UsageError
    from ..methods import MISTAKES
    from ..methods.outside import loaded

    if any(method.id == method_id for each in loaded() for method in each.methods) and (
            wrong := [line for line in MISTAKES if f"the id {method_id!r} is declared twice" in line]):
        raise UsageError(f"METHOD: {method_id!r} would be another method than the one from outside; allowed: "
                         f"an id of its own, in {wrong[0].partition(':')[0]}")


def _contract(declared, device: str) -> tuple[int, bool]:
    """The number of checks that failed, and whether the device could draw no image at all."""
    from ..contract import suite
    from ..gpu.device import open_device

    with Interruption(device_here=True):
        opened = open_device(device)
        failed = 0
        for outcome in suite.run(opened, declared):
            _tell(outcome.name, outcome.faults)
            failed += bool(outcome.faults)
        missing = suite.missing_features(opened, declared)
        if missing:
            note(f"{declared.id}: this device lacks {', '.join(missing)}: no image of its defaults was drawn")
        elif skipped := suite.skipped_variants(opened, declared):
            say(f"left out  {skipped} variants, for which the device lacks features")
    return failed, bool(missing)


def _tell(name: str, faults) -> None:
    say(f"{'FAILED' if faults else 'ok':8}  {name}")
    for fault in faults:
        say(f"          {fault}")


def _raced(declared) -> int:
    """The number of machines on which a promise broke; without a compiler none is tried."""
    from ..errors import MfrError
    from ..race.build import NoCompilerError, compiler
    from ..race.campaign import run, small_variant
    from ..race.check import How
    from ..race.report import headline
    from ..race.scenes import parse_counts
    from ..race.sweep import machines

    try:
        compiler()
    except NoCompilerError as error:
        say(f"left out  the race machine: {error}")
        return 0
    failed = 0
    for name, how in machines(How(SCHEDULES, 1)).items():
        try:
            found = run(small_variant(declared, ()), parse_counts(FRAGMENTS), how, SCENES)
        except MfrError as error:
            say(f"left out  the race machine, {name}: {error}")
            continue
        broken = found.broken and not found.checker.promises_nothing
        _tell(f"the race machine, {name}", (headline(found),) if broken else ())
        failed += broken
    return failed
