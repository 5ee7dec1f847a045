"""A method against the oracle, on llvmpipe or any other device. Each check gives a line for a broken promise."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from ..config.settings import Measure
from ..methods import catalog
from ..methods.spec import Fitted, Method, Variant
from ..plan import Cell, judge
from ..scene import Scene as SceneConfig
from ..store.status import EXACT_ERROR
from .cases import ALIKE, DEEP, KS, SCENES, SLANTED, Drawn, alike, runs_here, stats_in
from .variants import label, with_k

SOME_EXACT = ("flat", "opaque", "rejecting")  # scenes in which a condition of exactness may hold


def refused(variant: Variant, config: SceneConfig, stats) -> bool:
    """Whether a pixel has more fragments than the method has room for, which a run says before it draws anything."""
    deepest = variant.method.deepest
    if not deepest or stats.n <= deepest:
        return False
    cell = Cell("contract", variant.method.id, variant.method.id, variant.params, config, Measure(), {})
    said = judge(cell, {variant.method.id: variant.method}, stats, None)
    return said == ("over_budget", f"a pixel has {stats.n} fragments, the method has room for {deepest}")


class Held:
    """Images of a variant, checked against its promise. `promised`: the scenes where it makes one; `faults`: lines."""

    def __init__(self, device, variant: Variant, scenes: Mapping[str, SceneConfig]):
        self.device, self.variant = device, variant
        self.promised: list[str] = []
        self.faults: list[str] = []
        for name, config in scenes.items():
            stats = stats_in(device, config)
            if all(getattr(stats, fact) for fact in variant.asks) and not refused(variant, config, stats):
                self.faults += [f"{label(variant)}, {name}: {fault}" for fault in self._draw(name, config)]

    def _draw(self, name: str, config: SceneConfig) -> Iterator[str]:
        drawn = Drawn(self.device, self.variant, config)
        if drawn.allocated != drawn.declared and not (self.variant.stores_fewer and drawn.fits):
            yield f"allocates {drawn.allocated}, declares {drawn.declared}"
        if not np.isfinite(drawn.image).all():
            yield "the image has a value that is not finite"
        if Fitted(self.variant, stats_in(self.device, config)).exact():
            self.promised.append(name)
            if drawn.lost:
                yield f"{drawn.lost} fragments lost"
            if not drawn.error <= EXACT_ERROR:
                yield f"the image is off by {drawn.error:.3g}, allowed: {EXACT_ERROR:g}"


def of_every_family(device, scenes: Mapping[str, SceneConfig]) -> Iterator[str]:
    """Images of the first exact method of each family that draws the scene; a line for a scene that none draws."""
    for name, config in scenes.items():
        drawn: set[str] = set()
        for method in catalog().values():
            variant = with_k(method.variant({}), 4)
            if method.family not in drawn and method.guarantee.startswith("exact") and draws(device, variant, config):
                drawn.add(method.family)
                yield from Held(device, variant, {name: config}).faults
        if not drawn:
            yield f"{name}: no method draws it on this device"


def draws(device, variant: Variant, config: SceneConfig) -> bool:
    """Whether neither the device nor the method itself refuses the scene."""
    cell = Cell("contract", variant.method.id, variant.method.id, variant.params, config, Measure(), {})
    methods = {variant.method.id: variant.method}
    return runs_here(device, variant) and judge(cell, methods, stats_in(device, config), device.limits) is None


def running(device, variants: Iterable[Variant]) -> Variant | None:
    """The first of the variants that the device has the features for."""
    return next((variant for variant in variants if runs_here(device, variant)), None)


def every_scene(device, method: Method) -> Iterator[str]:
    """All layouts and orders, odd sizes, sparse, empty, one layer, rejected fragments."""
    variant = with_k(method.variant({}), 4)
    if runs_here(device, variant):
        yield from Held(device, variant, SCENES).faults


def slanted(device, variants: Iterable[Variant]) -> Iterator[str]:
    """Depths that no grid of the scene's holds, and primitives that cross: the device's own fragments, sorted."""
    if variant := running(device, (with_k(v, 4) for v in variants)):
        yield from Held(device, variant, SLANTED).faults


def option(device, variant: Variant) -> Iterator[str]:
    """One choice of one parameter."""
    if runs_here(device, variant):
        yield from Held(device, with_k(variant, 4), alike(variant)).faults


def deep_variants(method: Method) -> list[Variant]:
    """The default with k = 16, and with emulated 64-bit atomics where it has them."""
    choices = [{}, {"atomic64": "emulated"}] if method.param("atomic64") else [{}]
    return [with_k(method.variant(chosen), 16) for chosen in choices]


def deep(device, method: Method) -> Iterator[str]:
    """128 layers, where the method promises an exact image."""
    variant = running(device, deep_variants(method))
    if variant and method.guarantee.startswith("exact"):
        held = Held(device, variant, DEEP)
        yield from held.faults or (() if held.promised else ["promises nothing of any scene of 128 layers"])


def every_k(device, method: Method, k: int) -> Iterator[str]:
    """k = 1 gives the Z-buffer's image, k >= n the A-buffer's."""
    variant = method.variant({"k": k})
    if runs_here(device, variant):
        yield from Held(device, variant, {"rejecting": SCENES["rejecting"]}).faults


def all_ks(device, method: Method) -> Iterator[str]:
    """Every k of KS, of an exact method that has one."""
    if method.param("k") and method.guarantee.startswith("exact"):
        for k in KS:
            yield from every_k(device, method, k)


def exact_where_it_says(device, method: Method, variants: Iterable[Variant]) -> Iterator[str]:
    """Few and many slots, and every option: each condition holds in some scene, and the image there."""
    if not method.exact_where:
        return
    chosen = [with_k(variant, k) for variant in variants for k in (4, 16)]
    held = [Held(device, v, {name: SCENES[name] for name in SOME_EXACT}) for v in chosen if runs_here(device, v)]
    yield from (fault for each in held for fault in each.faults)
    if not any(each.promised for each in held):
        yield f"its condition {method.exact_where!r} holds in none of the scenes"


def fifty_frames(device, method: Method) -> Drawn | None:
    """Fifty frames of one scene; None where the device lacks a feature."""
    variant = with_k(method.variant({}), 4)
    return Drawn(device, variant, SCENES["scattered"], frames=50) if runs_here(device, variant) else None


def frames_are_alike(drawn: Drawn | None, method: Method) -> Iterator[str]:
    """Nothing of a frame may survive into the next."""
    if drawn is not None and method.guarantee.startswith("exact"):
        if drawn.distinct_images > 1:
            yield f"{drawn.distinct_images} different images in fifty frames of one scene"
        if drawn.lost:
            yield f"{drawn.lost} fragments lost in fifty frames"


def counts_what_it_holds(device, method: Method) -> Iterator[str]:
    """A probing frame finds as many fragments as are promised, and leaves the image and the passes as they are."""
    variant = with_k(method.variant({}), 4)
    for name in ALIKE if runs_here(device, variant) else ():
        drawn = Drawn(device, variant, SCENES[name], probing=True)
        if (found := drawn.probed.get("stored_fragments", drawn.kept)) != drawn.kept:
            yield f"{name}: holds {found} fragments, promises {drawn.kept}"
        if drawn.passes_probing != drawn.passes or not np.array_equal(drawn.image_probing, drawn.image):
            yield f"{name}: another image or number of geometry passes in a frame that counts"
