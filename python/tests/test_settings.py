"""Settings are those of the command line, and the package is whole."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import get_type_hints

import osculate
from osculate import settings
from osculate._given import facts

HERE = Path(__file__).parent


def test_the_types_of_settings_are_current() -> None:
    subprocess.run([sys.executable, str(HERE.parent / "make_settings.py"), "--check"], check=True)


def test_every_option_of_the_command_is_a_setting() -> None:
    page = subprocess.run([sys.executable, "-m", "osculate", "annotate", "--help"], capture_output=True, text=True).stdout
    words = (word.strip("[],.") for line in page.splitlines() if line.lstrip().startswith("-") for word in line.split()[:2])
    options = {word[2:].replace("-", "_") for word in words if word.startswith("--")}
    assert {"radius_factor", "color_by", "threads"} <= options
    assert options - {"output", "verbose", "quiet", "log", "help"} == set(facts("convert"))


def test_settings_are_one_family() -> None:
    """A setting means the same in every call that has it."""
    seen: dict[str, object] = {}
    for call in ("Mesh", "read", "annotate", "estimate", "convert", "disk", "trace"):
        for name, fact in facts(call).items():
            assert seen.setdefault(name, (fact["default"], fact["help"])) == (fact["default"], fact["help"]), name
    assert set(facts("annotate")) == set(facts("Mesh")) | set(facts("estimate"))
    assert set(get_type_hints(settings.AnnotateSettings, include_extras=False)) == set(facts("annotate"))


def test_all_that_is_public_is_documented() -> None:
    for name in osculate.__all__:
        value = getattr(osculate, name)
        if callable(value):
            assert value.__doc__, name
    fields = [name for name in dir(osculate.FaceCurvature) if not name.startswith("_")]
    for name in fields:
        assert getattr(osculate.FaceCurvature, name).__doc__, name
    assert (Path(osculate.__file__).parent / "py.typed").exists()
