"""Writes package/osculate/settings.py: the settings of every call as types, from the command line's definitions.

usage: make_settings.py [--check]     with the package installed; --check only says whether the file is current
"""

from __future__ import annotations

import sys
import textwrap
from pathlib import Path
from typing import Any

from osculate._given import facts

TARGET = Path(__file__).parent / "package" / "osculate" / "settings.py"

CALLS = {
    "Mesh": "``osculate.Mesh``",
    "read": "``osculate.read``",
    "annotate": "``osculate.annotate``",
    "estimate": "``Mesh.annotate``",
    "convert": "``osculate.convert``",
    "write": "``Mesh.write``",
    "batch": "``osculate.ray.annotate_dataset``",
    "inspect": "``osculate.inspect``",
    "colors": "``FaceCurvature.color_scale`` and ``FaceCurvature.colors``",
    "disk": "``Mesh.disk``",
    "trace": "``Mesh.trace``",
}

#: The type of a value by what stands for it in the command line's help.
TYPES = {
    "LENGTH|auto": 'Union[float, Literal["auto"]]',
    "F[:face|mesh]": "Union[float, str]",
    "LOW:HIGH|auto": 'Union[tuple[float, float], str]',
    "N": "int",
    "M": "int",
    "T": "float",
    "DEGREES": "float",
    "DISTANCE": "float",
    "U,V": "tuple[float, float]",
    "X,Y,Z": "Vector",
    "LIST": "Union[str, Sequence[str]]",
    "CONDITION": "str",
    "FILE": "Path",
    "DIR": "Union[Path, Sequence[Path]]",
}

HEAD = '''"""Settings of every call: keyword arguments, each an option of the command line with underscores for hyphens.

Made from the command line's definitions by python/make_settings.py; names, defaults and help texts are theirs. A
setting that is left out, or None, has its default. Lists may be given as such, or as text separated by commas.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, Literal, TypedDict, Union

from numpy.typing import NDArray

Path = Union[str, "os.PathLike[str]"]
Vector = Union[tuple[float, float, float], "NDArray[Any]"]
'''


def type_of(fact: dict[str, Any]) -> str:
    if fact["separator"] == "switch":
        return "bool"
    if fact["choices"]:
        return f"Literal[{', '.join(repr(choice) for choice in fact['choices'])}]".replace("'", '"')
    return TYPES[fact["value"]]


def entry(fact: dict[str, Any]) -> str:
    default = "" if fact["default"] is None else f" (default: {fact['default']})"
    told = (fact["help"] if fact["help"].endswith("...") else fact["help"].removesuffix(".")) + default
    comment = textwrap.fill(told if told.endswith("...") else told + ".", 116, initial_indent="    #: ", subsequent_indent="    #: ")
    line = f"    {fact['name']}: {type_of(fact)} | None"
    if len(line) > 120:
        of = ",\n".join(f'        "{choice}"' for choice in fact["choices"])
        line = f"    {fact['name']}: Literal[\n{of},\n    ] | None"
    return f"{comment}\n{line}\n"


def text() -> str:
    parts = [HEAD]
    for call, what in CALLS.items():
        name = call[0].upper() + call[1:] + "Settings"
        group = ""
        parts.append(f'\n\nclass {name}(TypedDict, total=False):\n    """Settings of {what}."""\n')
        for fact in facts(call).values():
            if fact["group"] != group:
                group = fact["group"]
                parts.append(f"\n    # {group}\n")
            parts.append("\n" + entry(fact))
    return "".join(parts)


def main() -> int:
    if "--check" not in sys.argv:
        TARGET.write_text(text())
    elif TARGET.read_text() != text():
        print("package/osculate/settings.py is not current: run make_settings.py")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
