"""Mesa's software drivers are kept from AVX-512 where their compiler is the one that makes wrong programs for it."""

from __future__ import annotations

import os

import pytest

from mfr_bench.gpu import vectors
from mfr_bench.gpu.vectors import VARIABLE, avoid_high_registers

WIDE, NARROW = "flags\t\t: fpu avx2 avx512f avx512vl\n", "flags\t\t: fpu avx avx2\n"


@pytest.fixture
def system(tmp_path, monkeypatch):
    """Makes a system of a processor and a driver, which starts out without the variable."""
    def made(flags: str, driver: str, linked: bytes) -> None:
        file = tmp_path / driver
        file.parent.mkdir(parents=True)
        file.write_bytes(b"\x7fELF\0libc.so.6\0" + linked + b"\0")
        (tmp_path / "cpuinfo").write_text(flags)

    monkeypatch.setattr(vectors, "CPUINFO", tmp_path / "cpuinfo")
    monkeypatch.setattr(vectors, "LIBRARIES", tmp_path)
    monkeypatch.setenv(VARIABLE, "")  # so that the test's own change is undone
    monkeypatch.delenv(VARIABLE)
    vectors._is_hit.cache_clear()
    yield made
    vectors._is_hit.cache_clear()


@pytest.mark.parametrize(("flags", "driver", "linked", "chosen"), [
    (WIDE, "lib/x86_64-linux-gnu/libgallium-26.0.3-1ubuntu1.so", b"libLLVM.so.21.1", "avx"),
    (WIDE, "lib/x86_64-linux-gnu/dri/swrast_dri.so", b"libLLVM-21.so.1", "avx"),
    (WIDE, "lib64/libvulkan_lvp.so", b"libLLVM.so.21.1", "avx"),
    (WIDE, "lib64/libgallium-26.2.6.so", b"libLLVM.so.22.1", None),
    (WIDE, "lib64/libgallium-25.0.7.so", b"libLLVM.so.19.1", None),
    (WIDE, "lib64/libgallium-26.0.3.so", b"libLLVM.so.210", None),
    (WIDE, "lib64/libother.so", b"libLLVM.so.21.1", None),
    (NARROW, "lib64/libgallium-26.0.3.so", b"libLLVM.so.21.1", None),
])
def test_the_variable_is_set_where_compiler_and_processor_meet(system, flags, driver, linked, chosen):
    system(flags, driver, linked)
    avoid_high_registers()
    assert os.environ.get(VARIABLE) == chosen


def test_a_value_that_the_user_has_given_stays(system, monkeypatch):
    system(WIDE, "lib64/libgallium-26.0.3.so", b"libLLVM.so.21.1")
    monkeypatch.setenv(VARIABLE, "sse4.1")
    avoid_high_registers()
    assert os.environ[VARIABLE] == "sse4.1"


@pytest.mark.parametrize("missing", ["cpuinfo", "libgallium-26.0.3.so"])
def test_what_cannot_be_read_is_no_error(system, monkeypatch, tmp_path, missing):
    system(WIDE, "lib64/libgallium-26.0.3.so", b"libLLVM.so.21.1")
    next(tmp_path.rglob(missing)).unlink()
    avoid_high_registers()
    assert VARIABLE not in os.environ


def test_an_empty_file_is_no_driver(system, tmp_path):
    system(WIDE, "lib64/libgallium-26.0.3.so", b"libLLVM.so.21.1")
    (tmp_path / "lib64/libgallium-26.0.3.so").write_bytes(b"")
    avoid_high_registers()
    assert VARIABLE not in os.environ


def test_a_software_device_tells_what_it_may_use(device):
    assert device.instructions == (os.environ.get(VARIABLE) if device.kind == "cpu" else None)
