"""The variants of a method that the contract is checked on."""

from __future__ import annotations

from collections.abc import Mapping

from ..methods.spec import Above, Method, Value, Variant, When


def variants(method: Method, numbers: Mapping[str, Value] | None = None) -> list[Variant]:
    """The default, and each other choice of each parameter by itself, where it has an effect.

    The same again with emulated atomics where the default asks for 64-bit ones. `numbers`: values of numeric
    parameters that switch something on, by name.
    """
    chosen = [{}] + [{**_acting(p.acts, c), p.name: c}
                     for p in method.params for c in (*p.choices, *p.of) if c != p.default]
    chosen += [{name: value} for name, value in (numbers or {}).items()]
    atomics = method.param("atomic64")
    if atomics and atomics.acts is None:
        chosen += [{**params, "atomic64": "emulated"} for params in chosen if "atomic64" not in params and params]
    return [method.variant(params) for params in chosen]


def _acting(condition: When | Above | None, value: Value) -> dict[str, Value]:
    """Parameters for which the condition of a parameter with this value holds."""
    if isinstance(condition, Above):
        return {condition.name: 2 * int(value) + 1}
    return {condition.name: condition.values[0], **_acting(condition.also, value)} if condition else {}


def with_k(variant: Variant, k: int) -> Variant:
    return variant.method.variant(variant.params | {"k": k}) if "k" in variant.params else variant


def label(variant: Variant) -> str:
    """The method and what differs from its defaults, for the names of tests."""
    other = [f"{p.name}={variant.params[p.name]}" for p in variant.method.params
             if variant.params[p.name] != p.default]
    return "-".join([variant.method.id, *other])
