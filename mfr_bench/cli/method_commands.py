"""`new-method`, `new-scene`, `new-effect` and `check`: what is one's own, from its first file to its contract."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import click

from .endings import WRONG, note_blame
from .interruption import Interruption
from .options import DEVICE, OUTSIDE, MethodName, OutPath
from .output import note, say

FRAGMENTS = "3,2"  # of each pixel, on the race machine
SCHEDULES = 5_000  # on each of its machines
SCENES = 4


OUT = click.option("--out", metavar="DIR", type=OutPath(file_okay=False), help="The folder to make. [default: NAME]")


@click.command("new-method")
@click.argument("name")
@OUT
def new_method(name: str, out: str | None) -> None:
    """Write a package with a method of your own: its declaration, its GLSL, a config.

    It works as it is: an A-buffer to copy and change. docs/adding-a-method.md explains each part.

    \b
    Example:
      mfr-bench new-method my-array
      mfr-bench check my-array --methods my-array
      mfr-bench run my-array/my-array.yaml --methods my-array
    """
    from ..outside.template import METHOD

    _write(METHOD, name, out)


@click.command("new-scene")
@click.argument("name")
@OUT
def new_scene(name: str, out: str | None) -> None:
    """Write a package with a scene of your own: the function that makes its fragments, a config.

    It works as it is: the arms of a spiral, to copy and change. docs/own-scenes.md explains each part.

    \b
    Example:
      mfr-bench new-scene my-rings
      mfr-bench check my_rings --methods my-rings
      mfr-bench run my-rings/my-rings.yaml --methods my-rings
    """
    from ..outside.template import SCENE

    _write(SCENE, name, out)


@click.command("new-effect")
@click.argument("name")
@OUT
def new_effect(name: str, out: str | None) -> None:
    """Write a package with an effect of your own: its entry, its model in float64, its GLSL, a config.

    It works as it is: the middle fragment of a pixel, to copy and change. docs/effects.md explains each part.

    \b
    Example:
      mfr-bench new-effect my-glow
      mfr-bench check my_glow --methods my-glow
      mfr-bench run my-glow/my-glow.yaml --methods my-glow
    """
    from ..outside.template import EFFECT

    _write(EFFECT, name, out)


def _write(template, name: str, out: str | None) -> None:
    """Write the package, each of its files a line, and say what to do next. Raises UsageError for a name that is taken.
    """
    from ..errors import UsageError
    from ..outside.template import write

    declared = template.declares(name)
    if declared in _known(template.kind):
        raise UsageError(f"new-{template.kind}: {declared!r} is {template.article} {template.kind} already; allowed: "
                         f"{template.own} of its own")
    folder = Path(out or name)
    for path in write(template, name, folder):
        say(path)
    if declared != name:
        say(f"the {template.kind} is named {declared}, since the name of a Python module has no hyphen")
    say(f"next: mfr-bench check {declared} --methods {folder}")


def _known(kind: str):
    """The methods, scenes or effects that can be checked, by name. Scenes are those from outside."""
    from ..effects import EFFECTS
    from ..methods import catalog
    from ..methods.outside import scene_makers

    methods = catalog()  # which brings effects from outside
    return {"method": methods, "scene": scene_makers(), "effect": EFFECTS}[kind]


@click.command()
@click.argument("name", metavar="NAME", type=MethodName())
@click.option("--no-race", is_flag=True, help="Leave out the adversarial scheduler, which needs a C++ compiler.")
@DEVICE
@OUTSIDE
def check(name: str, no_race: bool, device: str) -> int:
    """Check a method, a scene from outside or an effect against the contract that every one of its kind keeps.

    A method: its declaration and shaders are looked at; every variant is drawn on flat, empty, sparse, sorted,
    scattered, opaque and slanted scenes and compared with the float64 oracle; memory, losses and writes outside buffers
    are checked; and where a C++ compiler is there, its GLSL runs under the adversarial scheduler of `race`.

    A scene: its function is called for odd and tiny viewports and the bounds of its keys; the same seed has to give the
    same fragments; an exact method of every family has to draw it right.

    An effect: its model is compared with the cases of its entry, with each pixel by itself and with what the entry says
    that it reads; an exact method of every family that draws it has to show what the model computes.

    A line for each check; exit status 3 where one fails, 1 where the device lacks what a method needs.

    \b
    Examples: mfr-bench check my-array --methods my-array
              mfr-bench check kplus-array
              mfr-bench check thickness
    """
    from ..errors import UsageError, one_of

    kinds = {kind: found[name] for kind in ("method", "scene", "effect") if name in (found := _known(kind))}
    if not kinds:
        known = [each for kind in ("method", "scene", "effect") for each in _known(kind)]
        raise UsageError(f"NAME: unknown method, scene or effect {name!r}; {one_of(name, known)}")
    _hold_own(name)
    failed = lacking = 0
    with Interruption(device_here=True) as interruption:
        for kind, declared in kinds.items():
            found, missing = CHECKS[kind](name, declared, device, interruption.asked)
            failed, lacking = failed + found, lacking or missing
    if failed:
        note_blame(device, "a check failed")
    if "method" in kinds and no_race:
        say("left out  the race machine (--no-race)")
    elif "method" in kinds:
        failed += _raced(kinds["method"])
    say(f"{name}: {failed} checks failed" if failed else f"{name}: every check passed")
    return WRONG if failed else int(lacking)


def _hold_own(name: str) -> None:
    """Raise UsageError where a declaration from outside has the name of another one, which would be checked."""
    from ..errors import UsageError
    from ..methods import MISTAKES

    if wrong := [line for line in MISTAKES if f" {name!r} is declared twice" in line]:
        kind = wrong[0].partition(f" {name!r} ")[0].rpartition(" the ")[2].replace("id", "method")
        raise UsageError(f"NAME: {name!r} would be another {kind} than the one from outside; allowed: "
                         f"a name of its own, in {wrong[0].partition(':')[0]}")


def _of_method(_: str, declared, device: str, stop: Callable[[], bool]) -> tuple[int, bool]:
    """The number of checks of a method that failed, and whether the device could draw no image at all."""
    from ..contract import suite
    from ..gpu.device import open_device

    opened = open_device(device)
    failed = _carried_out(suite.of_method(opened, declared), stop)
    missing = suite.missing_features(opened, declared)
    if missing:
        note(f"{declared.id}: this device lacks {', '.join(missing)}: no image of its defaults was drawn")
    elif skipped := suite.skipped_variants(opened, declared):
        say(f"left out  {skipped} variants, for which the device lacks features")
    return failed, bool(missing)


def _of_scene(name: str, maker, device: str, stop: Callable[[], bool]) -> tuple[int, bool]:
    """The number of checks of a scene that failed."""
    from ..contract import of_scene
    from ..gpu.device import open_device

    return _carried_out(of_scene.checks(open_device(device), name, maker), stop), False


def _of_effect(name: str, effect, device: str, stop: Callable[[], bool]) -> tuple[int, bool]:
    """The number of checks of an effect that failed."""
    from tempfile import TemporaryDirectory

    from ..contract import of_effect
    from ..gpu.device import open_device

    with TemporaryDirectory() as folder:
        failed = _carried_out(of_effect.checks(open_device(device), name, effect, Path(folder)), stop)
    if not effect.cases:
        say("left out  the model against cases that are known: the entry has none")
    return failed, False


CHECKS = {"method": _of_method, "scene": _of_scene, "effect": _of_effect}


def _carried_out(checks, stop: Callable[[], bool]) -> int:
    """The number of checks that failed, each of them told. Raises KeyboardInterrupt behind one, where it is to stop."""
    from ..contract import suite

    failed = 0
    for outcome in suite.run(checks):
        _tell(outcome.name, outcome.faults)
        failed += bool(outcome.faults)
        if stop():
            raise KeyboardInterrupt
    return failed


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
