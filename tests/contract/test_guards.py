"""No method writes outside its buffers: words behind each of them keep their pattern, whatever the count."""

import pytest

from mfr_bench import glsl
from mfr_bench.contract.guards import SCENES, broken, keeps_to_its_buffers, variant_of
from mfr_bench.methods import catalog

from .cases import every_method, runs_here


@pytest.mark.parametrize("method", every_method(), ids=lambda m: m.id)
def test_nothing_is_written_behind_a_buffer(device, method):
    variant = variant_of(method)
    if not runs_here(device, variant):
        pytest.skip(f"this device lacks {', '.join(f for f in variant.needs if f not in device.features)}")
    assert list(keeps_to_its_buffers(device, method)) == []


@pytest.mark.parametrize("method", ["ab-array", "ab-sb", "ab-ll"])
def test_nothing_is_written_behind_the_list_of_tiles(device, method):
    variant = catalog()[method].variant({"touched": "tiles"})
    for name, config in SCENES.items():
        assert broken(device, variant, config) == [], name


def test_a_tile_behind_the_list_is_seen(device, plant):
    plant("common/list_tiles.comp", "tile_list[at]", "tile_list[at + 1u]")
    variant = catalog()["ab-array"].variant({"touched": "tiles"})
    assert broken(device, variant, SCENES["exactly full"]) == ["tile_list"]


@pytest.mark.parametrize(("method", "right", "wrong", "buffer"), [
    ("ab-array", "slot < uint(SLOTS)", "slot <= uint(SLOTS)", "nodes"),
    ("ab-array", "nodes[slot * pixels + p]", "nodes[(slot + 1u) * pixels + p]", "nodes"),
    ("kplus-array", "slot < room", "slot <= room", "nodes"),
    ("ab-ll", "cells[cell] = fragment", "cells[cell + 1u] = fragment", "cells"),
])
def test_a_write_behind_a_buffer_is_seen(device, monkeypatch, method, right, wrong, buffer):
    whole = glsl.read
    monkeypatch.setattr(glsl.includes, "read", lambda path: whole(path).replace(right, wrong))
    variant = variant_of(next(m for m in every_method() if m.id == method))
    found = {name for config in SCENES.values() for name in broken(device, variant, config)}
    found |= set(broken(device, variant, SCENES["one over"], untold=1))
    assert buffer in found
