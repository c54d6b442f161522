"""Appendix A of the thesis: a slice of a church, S. Maria Maggiore in Tuscania, pushed out of the plane of its walls.

`scripts/church --write` runs everything and writes docs/church.md; `scripts/church --cases` writes the case files.
"""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
for folder in (ROOT, ROOT / "scripts"):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))


def main(*words: str) -> int:
    """0 where every run came to an answer, 1 otherwise."""
    if words == ("--cases",):
        from churches.cases import write

        write()
        return 0
    from churches.page import PAGE

    return PAGE.main("Thesis Appendix A, the slice of a church", words)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
