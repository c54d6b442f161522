"""Chapter 6 or 7 of the thesis: what dem says, what the thesis found, and what exact answers demand.

`scripts/chapter6` (blocks, a column and an arch that are shaken) and `scripts/chapter7` (joints that are not plane)
call it with the number. Each section (thesis6/page.py, thesis7/page.py) runs its cases of `cases/validation/` and
prints its part of docs/chapter6.md or docs/chapter7.md.
"""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
for folder in (ROOT, ROOT / "scripts"):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))

ABOUT = {"6": "Thesis chapter 6, shaken blocks, column and arch", "7": "Thesis chapter 7, joints that are not plane"}


def main(number: str, *words: str) -> int:
    """0 where every run came to an answer, 1 otherwise."""
    return import_module(f"thesis{number}.page").PAGE.main(ABOUT[number], words)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
