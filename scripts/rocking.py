"""Blocks that rock, slide and bounce, compared with exact motions (tests/oracle)."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
for folder in (ROOT, ROOT / "scripts", ROOT / "tests"):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))

DOCS = ROOT / "docs"


def main(words: Sequence[str] | None = None) -> int:
    """0 always: how far dem is off is what it prints."""
    parser = argparse.ArgumentParser(prog="scripts/rocking", description=__doc__)
    parser.add_argument("--write", action="store_true", help="write docs/rocking.json, .md and .png")
    parser.add_argument(
        "--draw", action="store_true", help="write .md and .png from the docs/rocking.json that is there"
    )
    parser.add_argument("--pairs", type=int, default=240, help="pairs of a block and a record (240)")
    options = parser.parse_args(words)

    from dem_cli.bench.machine import describe, one_thread

    one_thread()
    from rockingtable import page, study

    path = DOCS / "rocking.json"
    if options.draw:
        table: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    else:
        table = {"machine": describe(), **study.everything(options.pairs, lambda line: print(line, flush=True))}
    if options.write:
        path.write_text(json.dumps(table, indent=1) + "\n", encoding="utf-8")
    if options.write or options.draw:
        page.write(DOCS, table)
    return 0


if __name__ == "__main__":
    sys.exit(main())
