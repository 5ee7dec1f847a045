"""`submit-results`, `verify`: results to send to a public collection, and what a collection checks of them."""

from __future__ import annotations

import tempfile
from pathlib import Path

import click

from .endings import WRONG
from .merge_command import merge_into
from .options import FOLDERS, InPath, OutPath, results_below
from .output import ending, note, say


@click.command("submit-results")
@FOLDERS
@click.option("--out", required=True, metavar="F.zip", type=OutPath(dir_okay=False), help="The bundle to write.")
@click.option("--sign-off", required=True, metavar="TEXT",
              help="Who vouches that these results were measured so and may be published; part of the bundle.")
def submit_results(folders: tuple[str, ...], out: str, sign_off: str) -> None:
    """Bundle all results at or below DIR for a public collection.

    Every record is checked first. User, host, paths, UUIDs and PCI addresses are removed; the sign-off is the only name
    in it. A bundle has 64 MiB at most.

    \b
    Example: mfr-bench submit-results results/nvidia-h200 --sign-off "A. Smith" --out h200.zip
    """
    from ..bundle import make_bundle
    from ..store import write_file

    ending(out, ".zip")
    found = results_below(folders)
    content, left_out = make_bundle(found, sign_off)
    for line in left_out:
        note(line)
    write_file(Path(out), content)
    say(f"{out}: result folders: {len(found)}, {len(content) / 2**20:.1f} MiB; check it with: mfr-bench verify {out}")


@click.command()
@click.argument("bundle", type=InPath(), metavar="BUNDLE")
@click.option("--against", multiple=True, metavar="DIR", type=InPath(file_okay=False),
              help="Results of other devices, whose errors are compared; may be given several times.")
@click.option("--into", metavar="DIR", type=OutPath(file_okay=False),
              help="Merge the results into DIR if nothing is odd about them.")
def verify(bundle: str, against: tuple[str, ...], into: str | None) -> int:
    """Check a bundle of results, and take it in.

    Its hashes, every record and key, times, errors and kept images are checked, and its tables derived anew. A
    bundle is data: nothing in it is run. One that is too large, has other members than a bundle or is damaged is
    refused with exit status 2. What is odd is listed, with exit status 3: a frame faster than drawing the geometry
    alone or than the device fills its pixels, an error unlike that of other devices, an image unlike the oracle's.

    \b
    Example: mfr-bench verify h200.zip --against results --into collection
    """
    from ..bundle import read_bundle, verified
    from ..bundle.verify import unpacked

    others = results_below(against) if against else []
    sets = read_bundle(Path(bundle))
    with tempfile.TemporaryDirectory() as place:
        folders = unpacked(sets, Path(place))
        odd = verified(folders, others)
        for finding in odd:
            say(finding)
        cells = sum(len(folder.cells()) for folder in folders)
        say(f"{bundle}: result folders: {len(folders)}, cells: {cells}, odd: {len(odd) or 'nothing'}")
        if into is not None and not odd:
            merge_into(folders, Path(into))
    return WRONG if odd else 0
