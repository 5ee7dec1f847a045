"""`scene`: the primitives of a scene as arrays, or its fragments, as a renderer of one's own might record them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import click

from .interruption import Interruption
from .options import DEVICE, OUTSIDE, PROFILE, SET, ConfigName, OutPath, first_experiment
from .output import ending, say


@click.command()
@click.argument("config", type=ConfigName())
@click.option("--out", type=OutPath(dir_okay=False), help="The .npz file of the primitives to write.")
@click.option("--fragments", type=OutPath(dir_okay=False), help="The .npz file of the fragments to write.")
@PROFILE
@SET
@DEVICE
@OUTSIDE
def scene(config: str, out: str | None, fragments: str | None, profile: str | None, overrides: tuple[str, ...],
          device: str) -> None:
    """Write the scene of CONFIG's first cell as NumPy arrays.

    With --out: viewport (W, H); and per quad, in submission order, rect, depth and rgba; of slanted primitives the
    four corners of each in clip space, position, in the order of a triangle strip, and rgba; of meshes position in
    pixels and window depth, rgba and object.

    With --fragments: viewport; and per fragment, in submission order, pixel, depth and rgba; of meshes object and
    front as well; with scene.msaa above 1 coverage, the mask of the samples that it covers. A config of kind fragments
    draws the file. Only slanted primitives and meshes need a device.

    \b
    Examples: mfr-bench scene smoke --set scene.layout=tiles --out scene.npz
              mfr-bench scene meshes --fragments recorded.npz
              mfr-bench run --fragments recorded.npz
    """
    from ..effects import DEFAULTS
    from ..errors import UsageError
    from ..methods import catalog
    from ..plan import expand
    from ..scene import generate

    if not (out or fragments):
        raise UsageError("scene: nothing to write; allowed: --out FILE.npz, --fragments FILE.npz, or both")
    for option, name in (("--out", out), ("--fragments", fragments)):
        if name:
            ending(name, ".npz", option=option)
    if device != "auto":
        _require(device)
    scene_of_cell = expand(first_experiment(config, profile, overrides), catalog())[0].scene
    in_samples = {"msaa": scene_of_cell.msaa}
    made = generate(replace(scene_of_cell, **DEFAULTS))  # colours stand as they are, whatever an effect puts there
    if out:
        _write_primitives(made, out)
    if fragments:
        drawn = generate(replace(scene_of_cell, **DEFAULTS | in_samples)) if scene_of_cell.msaa > 1 else made
        _write_fragments(made, drawn, fragments, device)


def _require(device: str) -> None:
    """Raise UnknownDeviceError where the device is not there, whether or not the scene needs it."""
    from ..gpu.device import open_device

    with Interruption(device_here=True):
        open_device(device)


def _write_primitives(made, out: str) -> None:
    import io

    import numpy as np

    from ..store import write_file

    data = io.BytesIO()
    np.savez(data, viewport=np.array(made.viewport, dtype=np.int32), **made.arrays(),
             fragment_probability=np.float64(made.fragment_probability), seed=np.uint32(made.seed),
             **({"least": np.uint32(made.least)} if made.least else {}))
    write_file(Path(out), data.getvalue())
    say(f"{out}: {len(made)} {made.geometry}s for {made.viewport[0]} x {made.viewport[1]} pixels")


def _write_fragments(made, drawn, out: str, device: str) -> None:
    """Write the fragments of `drawn`, the scene in as many samples as it has, with the colours of `made`."""
    from ..oracle.listed import recorded_quads
    from ..scene.quads import Quads
    from ..store import write_file

    msaa = drawn.effect.msaa
    if isinstance(drawn, Quads):
        found = recorded_quads(replace(drawn, rgba=made.rgba), msaa)
    else:
        found = _captured(made, drawn, device)
    write_file(Path(out), found.packed())
    say(f"{out}: {len(found)} fragments for {made.viewport[0]} x {made.viewport[1]} pixels")


def _captured(made, drawn, device: str):
    """The fragments that a device makes of the primitives of `drawn`, with the colours of `made`.

    Raises DeviceError where the device has not so many samples a pixel.
    """
    from ..errors import DeviceError
    from ..gpu.capture import capture
    from ..gpu.device import open_device
    from ..gpu.single import shown
    from ..methods.spec import MSAA_FEATURES
    from ..oracle.listed import recorded

    with Interruption(device_here=True):
        opened, msaa = open_device(device), drawn.effect.msaa
        allowed = [1, *(samples for samples, feature in MSAA_FEATURES.items() if feature in opened.features)]
        if msaa not in allowed:
            raise DeviceError(f"scene.msaa: this device does not rasterize into {msaa} samples a pixel; "
                              f"allowed here: {', '.join(map(str, allowed))}")
        with shown(opened, drawn) as on:
            return recorded(capture(opened, on.scene_buffer, on.canvas), made)
