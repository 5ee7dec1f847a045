"""Resolves read what is stored through textures of the buffers' memory: one rule for all, and the same image."""

import numpy as np
import pytest

from mfr_bench.methods import catalog

from .drawing import drawn, stack

STORED = {"nodes", "cells", "records", "payload", "depths", "colours"}  # buffers that contain fragments
SCENE = stack(np.linspace(0.9, 0.1, 9))


def resolves(variant):
    return [step for step in variant.passes if step.fetch and step.resolver]


def by_fetch():
    """One method, with its default parameters or one option, for each file by which a resolve reads fragments."""
    given = [(method.id, {}) for method in catalog().values()]
    given += [("lin-post", {"packed": "on", "atomic64": "emulated"}), ("open-post", {"atomic64": "emulated"}),
              ("kb-mdt64", {"atomic64": "emulated"}), ("ab-array", {"payload": "rgba16f"}),
              ("ab-coherent", {"resolve": "compute"})]
    found = {}
    for method, params in given:
        variant = catalog()[method].variant(params)
        for step in resolves(variant) if "shader_atomic_int64" not in variant.needs else ():
            if step.texels:
                found.setdefault((step.fetch, step.kind, tuple(params.items())), (method, params))
    return list(found.values())


@pytest.mark.parametrize("method", catalog().values(), ids=lambda method: method.id)
def test_every_resolve_reads_fragments_through_textures(method):
    variant = method.variant({})
    buffers = {buffer.name for buffer in variant.buffers}
    for step in resolves(variant):
        assert STORED & buffers & set(step.reads) <= set(step.texels), step.name


@pytest.mark.parametrize(("method", "params"), by_fetch(), ids=str)
def test_the_image_is_that_of_buffers_read_as_they_lie(device, monkeypatch, method, params):
    def image():
        with drawn(device, method, SCENE, **params) as frame:
            fell_back = ["_by_storage" in runner.__dict__ for runner in frame._runners.values()]
            return frame.image(), any(fell_back)

    through, none = image()
    monkeypatch.setattr(type(device), "max_texels", 8)
    as_they_lie, some = image()
    np.testing.assert_array_equal(through, as_they_lie)
    assert some and not none
    assert (through != 0).all(axis=-1).all()
