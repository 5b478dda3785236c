"""What is swept: the product of parameters' values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from itertools import product
from typing import Any

from ibr_ref.scene import checks

MOST_ROWS = 10**6
"""Settings times views."""

Setting = dict[str, Any]
"""Values by the fields of `Params` that are swept."""


def settings_of(params: Any, over: Mapping[str, Sequence[Any]], views: int) -> list[tuple[Setting, Any]]:
    """Every setting, with the `Params` that it makes of those that are given: the last field varies fastest.

    over: values by fields of `Params`. Raises ValueError, naming the field, for what is no field, has no value or one twice,
    is not allowed in `Params`, and for more than a million rows.
    """
    known = [field.name for field in fields(params)]
    if not over:
        raise checks.reject("over", "nothing", f"values for one or more of {', '.join(known)}")
    for name, values in over.items():
        if name not in known:
            raise checks.reject("over", name, f"fields of Params: {', '.join(known)}")
        if isinstance(values, str) or not isinstance(values, Sequence) or not values:
            raise checks.reject(f"over[{name!r}]", values, "a sequence of values")
        if any(not isinstance(value, (bool, int, float, str)) for value in values):
            raise checks.reject(f"over[{name!r}]", values, "numbers, words, True and False")
        if len(set(values)) < len(values):
            raise checks.reject(f"over[{name!r}]", values, "each value once")
    rows = views
    for values in over.values():
        rows *= len(values)
    if rows > MOST_ROWS:
        raise checks.reject("over", f"{rows} rows of {views} views", f"at most {MOST_ROWS}")
    chosen = [dict(zip(over, values, strict=True)) for values in product(*over.values())]
    return [(setting, _made(params, setting)) for setting in chosen]


def _made(params: Any, setting: Setting) -> Any:
    try:
        return replace(params, **setting)
    except ValueError as error:
        raise ValueError(f"{words(setting)}: {error}") from None


def words(setting: Mapping[str, Any]) -> str:
    """Such as "linear_steps=5, steep_threshold=0.1"."""
    shown = {name: f"{value:.6g}" if isinstance(value, float) else str(value) for name, value in setting.items()}
    return ", ".join(f"{name}={value}" for name, value in shown.items())
