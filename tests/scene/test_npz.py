"""Files of arrays that were damaged or crafted: one line, whatever numpy raises over them."""

from __future__ import annotations

import io
import zipfile

import numpy as np
import pytest

from mfr_bench.errors import UsageError
from mfr_bench.scene.polylines import read_polylines
from mfr_bench.scene.recording import recording_of

FRAGMENT = {"viewport": np.array([8, 6], np.int32), "pixel": np.zeros((1, 2), np.int32),
            "depth": np.zeros(1, np.float32), "rgba": np.zeros((1, 4), np.uint8)}
STRAND = {"points": np.zeros((2, 3)), "lengths": np.array([2])}
READERS = [(recording_of, FRAGMENT, "depth"), (recording_of, FRAGMENT, "viewport"), (read_polylines, STRAND, "points")]


def header(shape):
    made = io.BytesIO()
    np.lib.format.write_array_header_1_0(made, {"descr": "<f4", "fortran_order": False, "shape": shape})
    return made.getvalue()


@pytest.mark.parametrize(("reader", "arrays", "name"), READERS)
@pytest.mark.parametrize("content", [b"no array", b"\x93NUMPY\x01\x00\x04\x00{bad", header((2**40,)), b""])
def test_an_array_that_is_none_is_one_line(tmp_path, reader, arrays, name, content):
    path = tmp_path / "crafted.npz"
    with zipfile.ZipFile(path, "w") as file:
        for other, values in arrays.items():
            made = io.BytesIO()
            np.save(made, values)
            file.writestr(f"{other}.npy", content if other == name else made.getvalue())
    with pytest.raises(UsageError) as error:
        reader(path)
    assert len(error.value.lines) == 1 and error.value.lines[0].startswith(f"{path}: cannot be read (")
