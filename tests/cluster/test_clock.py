"""A node whose clock is an hour off: what it measured counts like any other's, and nothing is measured again."""

from __future__ import annotations

import json
import os
import re
import time

from ..cli.conftest import TINY, mfr, on_device  # noqa: F401

HOUR_S = 3600
STAMP = re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ")


def shift(folder, by_s):
    """Make every moment in the files of a folder, and of the files themselves, another one."""
    def moved(match):
        at = time.mktime(time.strptime(match[0], "%Y-%m-%dT%H:%M:%SZ")) + by_s
        return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.localtime(at))

    for path in filter(lambda path: path.is_file(), folder.rglob("*")):
        if path.suffix == ".json":
            path.write_text(STAMP.sub(moved, path.read_text()))
        os.utime(path, (time.time() + by_s, time.time() + by_s))


def test_clocks_that_are_an_hour_off_cost_nothing(mfr, on_device, tmp_path, monkeypatch):  # noqa: F811
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tiny.yaml").write_text(TINY.replace("sweep: {", "sweep: {scene.depth_complexity: [2, 3], "))
    for number in (1, 2):
        assert mfr("run", "tiny.yaml", "--shard", f"{number}/2", "--out", f"node{number}").status == 0
    for number, by_s in ((1, HOUR_S), (2, -HOUR_S)):
        folder = tmp_path / f"node{number}"
        shift(folder, by_s)
        cells = sorted((folder / "cells").glob("*.json"))
        before = [path.read_bytes() for path in cells]
        again = mfr("run", "tiny.yaml", "--shard", f"{number}/2", "--out", folder)
        assert again.status == 0 and f"{len(cells)} kept from before" in again.out
        assert [path.read_bytes() for path in cells] == before
    for order in (("node1", "node2"), ("node2", "node1")):
        assert mfr("merge", *order, "--into", "-".join(order)).status == 0
    first, second = ({path.name: path.read_bytes() for path in (tmp_path / name).rglob("*.*") if path.is_file()}
                     for name in ("node1-node2", "node2-node1"))
    assert first == second and len(json.loads(first["manifest.json"])["cells"]) > len(cells)
