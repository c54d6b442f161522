"""Appendix B of the thesis: walls with loads on top, pushed in their plane. `scripts/appendix_b` calls it."""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
for folder in (ROOT, ROOT / "scripts"):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))


def main(*words: str) -> int:
    """0 where every run came to an answer, 1 otherwise."""
    from appendixb.page import PAGE

    return PAGE.main("Thesis Appendix B, walls with top load", words)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
