"""A column, an arch on buttresses and an arch of voussoirs under pulses of the base, beside published results."""

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
    parser = argparse.ArgumentParser(prog="scripts/pulses", description=__doc__)
    parser.add_argument("--write", action="store_true", help="write docs/pulses.json, .md and .png")
    parser.add_argument(
        "--draw", action="store_true", help="write .md and .png from the docs/pulses.json that is there"
    )
    parser.add_argument("--only", nargs="+", metavar="PART", help="run these parts, keep the rest of docs/pulses.json")
    options = parser.parse_args(words)

    from dem_cli.bench.machine import describe, one_thread

    one_thread()
    from pulsetable import study

    path = DOCS / "pulses.json"
    table: dict[str, Any] = {}
    if (options.draw or options.only) and path.is_file():
        table = json.loads(path.read_text(encoding="utf-8"))
    if not options.draw:
        table["machine"] = describe()
        for name in options.only or study.PARTS:
            table[name] = study.PARTS[name](lambda line: print(line, flush=True))
            if options.write:
                path.write_text(json.dumps(table) + "\n", encoding="utf-8")
    if options.write or options.draw:
        from pulsetable import page

        page.write(DOCS, table)
    return 0


if __name__ == "__main__":
    sys.exit(main())
