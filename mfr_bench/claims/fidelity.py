"""docs/fidelity.md: every experiment, method and claim, what the paper says of it and what is done here."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from ..config.model import Experiment
from ..markdown import filled, markdown_table
from ..report.data import figure_of
from ..report.settings import Setting, settings
from .verdict import Claim

HEAD = """# How the papers' experiments are run

For every figure, table and text that is run: what the paper says, where, what is done here, and for each difference
why, what it favours, and by how much where that was measured. `mfr-bench configs --fidelity` prints this page from
`results/reference/settings.csv`, the configs and the claims; a test compares the configs with that table, at full size
and in their profile `smoke`, which has fewer pixels and fewer values along an axis.

Places are lines of the papers' plain texts, by the paper's short name. Effects were measured in the profile `smoke` on
llvmpipe with two cores unless they say otherwise; there fragments of a pixel come one by one, so that a GPU's
contention is not in them.

| short name | paper |
| --- | --- |
| gpupro5_ch1 | Lefebvre, Hornus and Lasram, Per-Pixel Lists for Single Pass A-Buffer, GPU Pro 5, 2014 |
| gpupro5_ch2 | Kluczek, Reducing Texture Memory Usage by 2-Channel Color Encoding, GPU Pro 5, 2014 |
| kplus_2014_slides | Vasilakis and Fudos, k+-buffer: Fragment Synchronized k-buffer, I3D 2014, slides |
| kplus_2015 | Vasilakis, Papaioannou and Fudos, k+-buffer, IEEE TVCG 2015 |
| occupancy_2015 | Vasilakis and Papaioannou, Accelerating k+-buffer using Efficient Fragment Culling, poster, 2015 |
| sbuffer_2012 | Vasilakis and Fudos, S-buffer, Eurographics 2012 short papers |
"""
ALL = """## For all of them

- The devices of the papers are not to be had: times are compared with times of the same device only.
- Fragments are quads of one colour or strips, and cost as little to shade as can be; none is textured.
- Where a paper renders a model that is not free, a synthetic scene of the same depth complexity and density stands in.
- A time is a whole frame with all passes, the median of samples in turns, where gpupro5_ch1 takes the mean of six
  seconds; passes are timed in frames of their own.
- Fragments, counters and semaphores are words of storage buffers, where the papers have images (RG_32F, R_32UI) or
  pointers (NV_shader_buffer_store).
- MB are MiB, by which alone the printed formulas follow.
"""
COLUMNS = ("setting", "the paper", "where", "here", "why", "favours")
CLAIM_COLUMNS = ("claim", "where", "the paper", "rules", "readings and remarks")


def as_markdown(experiments: Iterable[Experiment], claims: Iterable[Claim]) -> str:
    """The page: a section per experiment in the order of their names, one for methods, one for claims."""
    of = _by_owner(settings())
    known = {e.name: e for e in experiments}
    parts = [HEAD, ALL, "## Experiments\n"]
    parts += [_experiment(known[name], of[name]) for name in sorted(known) if name in of]
    parts += ["## Methods\n", _table(("method", *COLUMNS), [(f"`{owner}`", *_cells(row)) for owner, rows in of.items()
                                                            if owner not in known for row in rows])]
    parts += ["## Claims\n", _table(CLAIM_COLUMNS, map(_claim, claims))]
    return "\n".join(parts)


def _by_owner(rows: Sequence[Setting]) -> Mapping[str, list[Setting]]:
    found: dict[str, list[Setting]] = {}
    for row in rows:
        found.setdefault(row.of, []).append(row)
    return found


def _experiment(experiment: Experiment, rows: Sequence[Setting]) -> str:
    source = f"{experiment.source['paper']} {figure_of(experiment.source)}".strip()
    readings = filled(" ".join(experiment.source.get("readings", ())))
    head = [f"### {experiment.name}: {experiment.title} ({source})", "", *([readings, ""] if readings else [])]
    return "\n".join([*head, _table(COLUMNS, map(_cells, rows))])


def _cells(row: Setting) -> tuple[str, ...]:
    same = row.reason is None and row.key is not None and row.printed == row.here
    return (row.setting, row.printed or "not printed", row.place, "the same" if same else row.here or "",
            row.reason or "", row.effect or "")


def _claim(claim: Claim) -> tuple[str, ...]:
    parts = [f"read as: {claim.reading}" if claim.reading else "", *(f"or: {r.words}" for r in claim.otherwise),
            claim.remark, f"not on a software driver: {claim.hardware}" if claim.hardware else ""]
    return (f"`{claim.id}`: {claim.sentence}", claim.source, claim.paper, "; ".join(rule.text for rule in claim.rules),
            ". ".join(part for part in parts if part))


def _table(columns: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    return "\n".join(markdown_table(columns, rows)) + "\n"
