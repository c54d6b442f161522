"""Thesis chapter 6, blocks, a column and an arch that are shaken: what dem says and what the thesis found.

Each section (thesis6/page.py) runs its cases of `cases/validation/` and prints its part of docs/chapter6.md.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
for folder in (ROOT, ROOT / "scripts"):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))

DOCS = ROOT / "docs"


def main(words: Sequence[str] | None = None) -> int:
    """0 where every run came to an answer, 1 otherwise."""
    from thesis6 import page

    parser = argparse.ArgumentParser(prog="scripts/chapter6", description=__doc__.splitlines()[0])
    parser.add_argument("sections", nargs="*", metavar="SECTION", help=f"{', '.join(page.SECTIONS)}; default: all")
    parser.add_argument("--write", action="store_true", help="write docs/chapter6.json, .md and pictures")
    options = parser.parse_args(words)
    unknown = [name for name in options.sections if name not in page.SECTIONS]
    if unknown:
        parser.error(f"no section '{unknown[0]}' (allowed: {', '.join(page.SECTIONS)})")

    from dem_cli.bench.machine import one_thread

    one_thread()
    from dem_cli.bench.cases import compiled

    compiled()
    unanswered = []
    for name in options.sections or page.SECTIONS:
        found = page.section(name).measure()
        unanswered += page.unanswered(found)
        if options.write:
            page.write(DOCS, {name: found})
        print("\n".join(page.section(name).page(found)), flush=True)
    for command in unanswered:
        print(f"no answer: {command}", file=sys.stderr)
    return int(bool(unanswered))


if __name__ == "__main__":
    sys.exit(main())
