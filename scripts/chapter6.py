"""Thesis chapter 6, blocks, a column and an arch that are shaken: what dem says and what the thesis found.

Each section (thesis6/page.py) runs its cases of `cases/validation/` and prints its part of docs/chapter6.md.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
for folder in (ROOT, ROOT / "scripts"):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))


def main(words: Sequence[str] | None = None) -> int:
    """0 where every run came to an answer, 1 otherwise."""
    from thesis6.page import PAGE

    return PAGE.main(__doc__.splitlines()[0], words)


if __name__ == "__main__":
    sys.exit(main())
