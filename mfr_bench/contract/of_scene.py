"""The contract of a scene that a package from outside makes: what its function gives, and what is drawn of it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import fields, replace

import numpy as np

from ..errors import UsageError
from ..gpu.capture import count
from ..methods.spec import Promise
from ..methods.spec.maker import Maker, Number
from ..scene import Scene as SceneConfig
from ..scene import made
from ..scene.recording import Recording
from . import images
from .cases import stage
from .suite import Check

SIZE = (48, 40)
SIZES = (SIZE, (97, 71), (1, 1), (3, 128), (128, 2))
SEEDS = (1, 2, 4_000_000_000)
ORDERS = ("file", "random", "front_to_back", "back_to_front")


def checks(device, name: str, maker: Maker) -> Sequence[Check]:
    """Every check of a scene by its name, in order."""
    scene = SceneConfig(kind="outside", maker=name, size=SIZE, depth_complexity=0, order="file")
    orders = {f"order {order}": replace(scene, order=order) for order in ORDERS}
    return (
        ("the entry says what a reader needs", lambda: what_a_reader_needs(maker)),
        ("it makes fragments in every size of viewport", lambda: every_size(scene)),
        ("it makes fragments with the least and the most of every key", lambda: every_bound(maker, scene)),
        ("the same seed gives the same fragments", lambda: same_each_time(scene)),
        ("the device draws the fragments that were made", lambda: drawn_by_device(device, scene)),
        ("images can be compared", lambda: can_be_compared(device, scene)),
        ("exact methods draw it right, in every order", lambda: images.of_every_family(device, orders)),
    )


def what_a_reader_needs(maker: Maker) -> Iterator[str]:
    """Check that the entry says on one line what the scene is."""
    if not isinstance(maker.what, str) or not maker.what.strip() or "\n" in maker.what:
        yield f"the entry says {maker.what!r}; allowed: one line that says what the scene is"


def every_size(scene: SceneConfig) -> Iterator[str]:
    """Odd, long and tiny viewports: depths from 0 to 1, pixels within, and some fragments in the first."""
    found = [fault for size in SIZES for fault in _faults(replace(scene, size=size), f"size {size[0]}x{size[1]}")]
    if not found and not len(made.made_anew(scene)):
        found = [f"no fragment in {SIZE[0]}x{SIZE[1]} pixels with every key at its default"]
    yield from found


def every_bound(maker: Maker, scene: SceneConfig) -> Iterator[str]:
    """Each key at its bounds, the others at their defaults."""
    for key, number in maker.keys.items():
        for value in bounds_of(number):
            yield from _faults(replace(scene, options=f"{key}={value}"), f"{key}={value}")


def bounds_of(number: Number) -> list[float]:
    """The least and the greatest value of a key, those that are finite."""
    ends = [end for end in (number.least, number.most) if math.isfinite(end)]
    return [math.ceil(ends[0]), math.floor(ends[-1])] if isinstance(number.default, int) and ends else ends


def _faults(scene: SceneConfig, where: str) -> Iterator[str]:
    try:
        made.made_anew(scene)
    except UsageError as error:
        yield f"{where}: {error}"


def same_each_time(scene: SceneConfig) -> Iterator[str]:
    """Two processes make the same of a seed, bit for bit."""
    for seed in SEEDS:
        first, second = (made.made_anew(replace(scene, seed=seed)) for _ in range(2))
        yield from (f"seed {seed}: {name} differs from one time to the next" for name in unlike(first, second))


def unlike(first: Recording, second: Recording) -> list[str]:
    """The arrays in which two recordings differ."""
    return [array.name for array in fields(Recording)
            if not np.array_equal(getattr(first, array.name), getattr(second, array.name))]


def drawn_by_device(device, scene: SceneConfig) -> Iterator[str]:
    """The device's own count of fragments in each pixel is that of what was made."""
    on = stage(device, scene)
    wrong = count(device, on.scene_buffer, on.canvas) != on.truth.counts
    if wrong.any():
        y, x = np.argwhere(wrong)[0]
        yield f"{np.count_nonzero(wrong)} pixels have another number of fragments, the first of them {x} {y}"


def can_be_compared(device, scene: SceneConfig) -> Iterator[str]:
    """Some pixel has no two fragments of one depth and different colours: others are left out of the errors."""
    on = stage(device, scene)
    covered = on.truth.counts > 0
    tied = on.answer(Promise()).tied[covered]
    if len(tied) and tied.all():
        yield f"every one of {len(tied)} covered pixels has fragments of one depth and different colours"
