"""The end of a cell: its status with the reason, and the values of its row that are not sampled."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..errors import CapacityError, MfrError
from ..gpu.frame import Frame
from ..methods.spec import Fitted, SceneStats, Variant
from ..oracle.ties import TIED_BY_CHANCE
from ..store.status import EXACT_ERROR


def verdict(fitted: Fitted, found: Mapping[str, Any], lost: int, distinct_images: int = 1) -> tuple[str, str | None]:
    """Status and reason of a measured cell. `found`: its conformance and, where they are known, its shares.

    An exact method is wrong above 1e-4, where it lost a fragment, or where its frames differ. Where colours are open in
    many pixels (docs/scenes.md, "Equal depths"), it must also have stored as many fragments as it promises.
    """
    if not fitted.variant.guarantee.startswith("exact"):
        return "ok", None
    if lost:
        return "wrong", f"{lost} fragments lost"
    tied = f", {found['tied_pixels']} pixels tied" if found["tied_pixels"] else ""
    if found["max_abs_error"] > EXACT_ERROR:
        return "wrong", (f"max_abs_error {found['max_abs_error']:.3g} above {EXACT_ERROR:g}, "
                         f"{found['wrong_pixels']} wrong pixels{tied}")
    stored, promised = found.get("hit_ratio"), found.get("promised_ratio")
    open_colours = found["tied_pixels"] > TIED_BY_CHANCE * sum(fitted.stats.histogram[1:])
    if open_colours and stored is not None and stored < promised:
        return "wrong", f"stores {stored:.4g} of the fragments instead of {promised:.4g}{tied}"
    if distinct_images > 1:
        return "wrong", f"{distinct_images} different images of one scene"
    return "ok", None


def failure(error: Exception) -> tuple[str, str]:
    """Status and reason of a cell that raised: whatever a method or a driver does costs its own cell only."""
    if isinstance(error, CapacityError):
        return "overflow", str(error)
    if isinstance(error, MemoryError):
        return "out_of_memory", str(error) or "out of memory"
    return "crashed", " ".join((str(error) if isinstance(error, MfrError) else repr(error)).split())


def scene_values(fitted: Fitted) -> dict[str, Any]:
    """The values of a cell that are known without running it."""
    return _counts(fitted) | {"memory_model_bytes": fitted.model_bytes()}


def frame_values(frames: list[Fitted]) -> list[dict[str, Any]]:
    """The fragments and the chosen k of each frame; empty if frames do not differ and the method chooses none."""
    if len(frames) == 1 and frames[0].decision() is None:
        return []
    return [{"frame": i, **_counts(fitted), "kept": fitted.kept(), "histogram": list(fitted.stats.histogram)}
            for i, fitted in enumerate(frames)]


def _counts(fitted: Fitted) -> dict[str, Any]:
    """The fragments of a scene, and the k that the method chooses for it."""
    decision, stats = fitted.decision(), fitted.stats
    return {"fragments": stats.F, "covered_pixels": sum(stats.histogram[1:]),
            "max_fragments": len(stats.histogram) - 1, "chosen_k": decision.k if decision else None}


def fragment_shares(frame: Frame, variant: Variant, stats: SceneStats) -> dict[str, float | None]:
    """The shares of the fragments that are kept, that the promise keeps, and that are discarded before the store.

    All are shares of the fragments that the scene on the device generates. A count that the method's memory does not
    show is taken to be as promised. None for each in a scene without fragments, and of a method that promises no image.
    """
    if variant.guarantee == "none" or not stats.F:
        return {"hit_ratio": None, "promised_ratio": None, "discarded_share": None}
    counted, promised = frame.probe(), Fitted(variant, stats).kept()
    shaded = counted.get("shaded_fragments")
    return {"hit_ratio": counted.get("stored_fragments", promised) / stats.F, "promised_ratio": promised / stats.F,
            "discarded_share": None if shaded is None else 1 - shaded / stats.F}
