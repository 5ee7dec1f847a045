"""The compute scan with work groups so small that a scene of a few pixels has several blocks, and each group two."""

import pytest

from mfr_bench.errors import MfrError
from mfr_bench.methods.precalc import precalc
from mfr_bench.race.campaign import run
from mfr_bench.race.check import How

COUNTS = (1, 0, 2, 1, 0, 1, 1, 0, 1, 1, 0, 1, 2, 0, 0, 1, 1, 0, 1, 1, 1)  # of pixels: five blocks of four, and one
BLOCK_SCAN, SUM_BLOCKS, SCAN_SUMS, SCAN_PIXELS = (
    f"methods/precalc/{name}" for name in ("block_scan.glsl", "sum_blocks.comp", "scan_sums.comp", "scan_pixels.comp"))
IN_TURN = "        barrier();\n        if (lane >= reach)"
TOTAL = "    barrier();\n    total ="
AT_THE_END = "        barrier();\n    }\n"


def small(schedules: int):
    return run(precalc(lanes=4, run=1, most_groups=2).variant({}), COUNTS, How(schedules=schedules), scenes=2)


def breaks() -> bool:
    try:
        return small(4000).broken
    except MfrError as error:
        return str(error).endswith("without any race")


def test_blocks_are_scanned_by_groups_of_any_order():
    assert not small(2000).broken


@pytest.mark.parametrize(("path", "barrier"), [
    (BLOCK_SCAN, IN_TURN), (BLOCK_SCAN, TOTAL), (SUM_BLOCKS, AT_THE_END), (SCAN_SUMS, AT_THE_END)])
def test_a_barrier_that_is_left_out_is_found(plant, path, barrier):
    plant(path, barrier, barrier.replace("barrier();", ""))
    assert breaks()


def test_the_last_barrier_of_the_last_step_guards_nothing_that_is_used(plant):
    """Without it the next block overwrites the total of this one, which this step does not use."""
    plant(SCAN_PIXELS, AT_THE_END, AT_THE_END.replace("barrier();", ""))
    assert not breaks()
