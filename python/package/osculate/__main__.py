"""``python -m osculate``: the command line."""

from __future__ import annotations

import sys

from . import _native


def main() -> int:
    """Runs the command line; gives its exit code."""
    return _native.run(["osculate", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
