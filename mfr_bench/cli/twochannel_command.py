"""`twochannel`: what two-channel colour does to pictures."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import click

from .options import JSON, OutPath
from .output import say

MADE_SIZE = (256, 256)  # pixels of a picture that is made here
MOST_PIXELS = 2**25


@click.command()
@click.argument("images", nargs=-1, required=True, metavar="IMAGE...")
@click.option("--out", metavar="DIR", type=OutPath(file_okay=False),
              help="Write each picture next to its decoded form, as PNG, into this folder.")
@JSON
def twochannel(images: tuple[str, ...], out: str | None, as_json: bool) -> None:
    """Encode pictures in two channels, and report what that loses.

    IMAGE is a file, or grass, rock or sand: materials that are made here. The plane of hues is fitted to each picture,
    and two bytes of each texel are kept: luminance, and a blend of two base colours (gpupro5_ch2).

    \b
    Examples: mfr-bench twochannel photo.jpg --out two
              mfr-bench twochannel grass rock sand --json
    """
    from ..oracle.pictures import Encoded
    from ..store.record import plain

    _hold_names(images if out else ())
    records = {}
    for name in images:
        encoded = Encoded.of(_picture(name))
        records[name] = encoded.record()
        if out:
            records[name]["picture"] = str(_written(encoded, name, Path(out)))
    say(json.dumps(plain(records), indent=2, allow_nan=False) if as_json else
        "\n\n".join(map(_text, records, records.values())))


def _hold_names(images: Sequence[str]) -> None:
    """Raise UsageError where two pictures would be written to one file."""
    from ..errors import UsageError

    first: dict[str, str] = {}
    for name in dict.fromkeys(images):
        other = first.setdefault(_file_of(name), name)
        if other != name:
            raise UsageError(f"--out: {other} and {name} would both be written to {_file_of(name)}; allowed: pictures "
                             "of different names")


def _file_of(name: str) -> str:
    return f"{Path(name).stem}-twochannel.png"


def _picture(name: str):
    """uint8 (H, W, 3) of a file, or of a material that is made here. Raises UsageError for what is no picture."""
    import numpy as np
    from PIL import Image  # comes with matplotlib

    from ..errors import UsageError
    from ..scene.materials import MATERIALS, picture
    from ..scene.meshes.textures import NO_PICTURE

    if name in MATERIALS and not Path(name).exists():
        return picture(name, MADE_SIZE)
    try:
        with Image.open(name) as opened:
            if opened.width * opened.height > MOST_PIXELS:
                raise UsageError(f"{name}: {opened.width} x {opened.height} pixels; allowed: at most {MOST_PIXELS}")
            return np.asarray(opened.convert("RGB"))
    except FileNotFoundError:
        raise UsageError(f"{name}: no such file; allowed: a picture, or one of {', '.join(MATERIALS)}") from None
    except (*NO_PICTURE, Image.DecompressionBombError) as error:
        raise UsageError(f"{name}: no picture that can be read ({error}); allowed: a file that Pillow reads") from None


def _written(encoded, name: str, folder: Path) -> Path:
    import io

    from PIL import Image

    from ..store import write_file

    data = io.BytesIO()
    Image.fromarray(encoded.side_by_side()).save(data, format="png")
    path = folder / _file_of(name)
    write_file(path, data.getvalue())
    return path


def _text(name: str, record: Mapping[str, Any]) -> str:
    bases = ", ".join("#" + "".join(f"{channel:02x}" for channel in base) for base in record["base_colours"])
    mean, most = record["luminance_error_mean"], record["luminance_error_max"]
    lines = [f"base colours {bases}", f"luminance error {mean:.2g} in the mean, {most:.2g} at most",
             f"hue error {record['hue_error_degrees']:.3g} degrees in the mean",
             (f"PSNR {record['psnr_db']:.1f} dB, FLIP {record['flip']:.4f}, {100 * record['clipped']:.2f} % of pixels "
              "clipped"),
             f"{record['bytes_before']:,} bytes before, {record['bytes_after']:,} after"]
    lines += [record["picture"]] if "picture" in record else []
    return "\n".join([name, *(f"  {line}" for line in lines)])
