"""JSON Schema of a config file with the methods of a catalog: what an editor completes, explains and underlines.

Made of the declarations that `check` uses: the classes of `model`, the kinds of scenes and figures, the parameters of
methods. What depends on two keys at once is left to `check`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from ..methods.spec import ON_OFF, Method, Param
from .axes import K, R
from .check import EVERY_METHOD, SWEPT_KEYS
from .json_schema import schema

DIALECT = "https://json-schema.org/draft/2020-12/schema"
SWITCH = {"on": True, "off": False}  # what YAML 1.1 makes of the bare words


def editor_schema(catalog: Mapping[str, Method]) -> dict[str, Any]:
    """The schema of a config that may name the methods of the catalog."""
    found = {"$schema": DIALECT, "title": "mfr-bench config", **schema()}
    params = _params_of(catalog.values())
    found["$defs"] |= {f"method {method.id}": _entry(method) for method in catalog.values()}
    found["properties"] |= {
        "methods": {"type": "array", "minItems": 1, "items": {"anyOf": [
            {"enum": [*catalog, EVERY_METHOD]}, *({"$ref": f"#/$defs/method {i}"} for i in catalog)]}},
        "params": {"type": "object", "properties": params, "additionalProperties": False},
        "sweep": _axes(params), "zip": _axes(params)}
    return found


def _entry(method: Method) -> dict[str, Any]:
    """An entry of `methods:` that fixes parameters."""
    own = {"id": {"const": method.id}, "label": {"type": "string", "minLength": 1}}
    return {"type": "object", "description": method.summary, "required": ["id"], "additionalProperties": False,
            "properties": own | {param.name: _value(param) for param in method.params}}


def _params_of(methods: Iterable[Method]) -> dict[str, Any]:
    """Every parameter by name: of those that methods declare differently, each declaration."""
    found: dict[str, list[dict[str, Any]]] = {"r": [_value(R)], "k": [_value(K)]}
    for method in methods:
        for param in method.params:
            known = found.setdefault(param.name, [])
            if (value := _value(param)) not in known:
                known.append(value)
    return {name: values[0] if len(values) == 1 else {"anyOf": values} for name, values in found.items()}


def _value(param: Param) -> dict[str, Any]:
    """The values that `Param.parse` takes."""
    told = {"description": f"{param.doc}; default: {param.default}"}
    if param.choices:
        bare = [SWITCH[choice] for choice in param.choices if choice in ON_OFF]
        return told | {"enum": [*param.choices, *bare]}
    if param.of:
        return told | {"enum": list(param.of)}
    if not param.real:
        return told | {"type": "integer", "minimum": param.low, "maximum": param.high}
    upper = "maximum" if param.closed else "exclusiveMaximum"
    inside = {"type": "number", "exclusiveMinimum": param.low, upper: param.high}
    return told | (inside if param.off is None else {"anyOf": [inside, {"const": param.off}]})


def _axes(params: Mapping[str, Any]) -> dict[str, Any]:
    """The keys that may be swept, each a list of values."""
    values = dict(params)
    for key in SWEPT_KEYS:
        section, _, name = key.partition(".")
        values[key] = {"$ref": f"#/$defs/{section.capitalize()}/properties/{name}"}
    return {"type": "object", "additionalProperties": False,
            "properties": {key: {"type": "array", "minItems": 1, "items": value} for key, value in values.items()}}
