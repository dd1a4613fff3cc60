# SPDX-License-Identifier: MIT
"""The Python package `osculate`, which comes with the extension as a wheel."""

import platform
from functools import lru_cache


class Missing(Exception):
    """The package is not there, with a sentence that says what to do."""


@lru_cache(maxsize=None)
def _load():
    try:
        import osculate
        return osculate, None
    except Exception as error:  # a library of another system raises anything
        return None, error


def osculate():
    """The package.

    Raises Missing where the extension was built for another system."""
    package, error = _load()
    if package is None:
        here = f"{platform.system()} {platform.machine()}, Python {platform.python_version()}"
        raise Missing(
            f"This copy of the extension has no compiled part for {here} ({error}). Importing and exporting work; to "
            "estimate and show, install the extension made for this system or build it: docs/blender.md says how.")
    return package


def is_there():
    """Whether `osculate` succeeds."""
    return _load()[0] is not None


def setting_facts(call):
    """What is known of the settings of a call, by name: help, default, choices, group."""
    from osculate._given import facts
    return facts(call)
