"""Settings given as keyword arguments, as the texts that the command line's own parser takes.

Names, defaults, ranges and messages are those of the command line because they are its definitions.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import Any

import numpy as np

from . import _native
from .errors import UsageError, UsageTypeError

Texts = list[tuple[str, list[str]]]


@lru_cache(maxsize=None)
def facts(call: str) -> dict[str, dict[str, Any]]:
    """What is known of each setting of a call, by name."""
    return {fact["name"]: fact for fact in json.loads(_native.facts(call))}


def texts(call: str, settings: Mapping[str, object]) -> Texts:
    """The settings as names and texts; those that are None are left at their defaults."""
    known = facts(call)
    result: Texts = []
    for name, value in settings.items():
        if name not in known:
            raise UsageError(f"there is no setting {name} here; there are {', '.join(known)}")
        if value is None:
            continue
        if known[name]["separator"] == "switch":
            if not isinstance(value, (bool, np.bool_)):
                raise UsageTypeError(f"{name} must be True or False, not {value!r}")
            if value:
                result.append((name, []))
        else:
            result.append((name, _texts_of(name, value)))
    return result


def _texts_of(name: str, value: object) -> list[str]:
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, Iterable) and not isinstance(value, (str, bytes, Mapping)):
        items = list(value)
        if not items:
            raise UsageError(f"{name} is an empty list; leave it out, or give it a value")
        return [_text_of(name, item) for item in items]
    return [_text_of(name, value)]


def _text_of(name: str, value: object) -> str:
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, (bool, bytes)):
        raise UsageTypeError(f"{name} cannot be {value!r}")
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    raise UsageTypeError(f"{name} must be a number, a text, a path or a list of them, not {type(value).__name__}")
