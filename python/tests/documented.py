"""Runs the Python examples of Markdown files: the blocks of a file one after another, in a folder with `fixtures`.

usage: documented.py FILE...
"""

from __future__ import annotations

import os
import re
import sys
import tempfile
from pathlib import Path

FIXTURES = Path(__file__).resolve().parents[2] / "fixtures"


def main() -> int:
    for name in sys.argv[1:]:
        path = Path(name).resolve()
        blocks = re.findall(r"^```python\n(.*?)^```$", path.read_text(), re.DOTALL | re.MULTILINE)
        if not blocks:
            print(f"{path.name}: no example")
            return 1
        here = Path.cwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            Path("fixtures").symlink_to(FIXTURES)
            space: dict[str, object] = {"__name__": "documented"}
            for number, block in enumerate(blocks, 1):
                exec(compile(block, f"{path.name}, example {number}", "exec"), space)
            os.chdir(here)
        print(f"{path.name}: {len(blocks)} examples")
    return 0


if __name__ == "__main__":
    sys.exit(main())
