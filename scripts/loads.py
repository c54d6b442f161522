"""Failure loads of the case files by limit analysis and by DEM; exit code 1 where they disagree.

Demanded: DEM raised from gravity, and as `dem run` goes about it, within 1 % of the zero-dilation path, and no load
above the associated one by more than 0.5 % (loadtable/judge.py).
"""

from __future__ import annotations

import argparse
import sys
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
for folder in (ROOT, ROOT / "scripts"):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))

CASES = (ROOT / "cases" / "verification", ROOT / "cases" / "gallery")
DOCS = ROOT / "docs"


def pushovers() -> list[Path]:
    """Case files that look for a failure load with joints that limit analysis knows."""
    files = [file for folder in CASES for file in sorted(folder.glob("*.toml"))]
    tables = {file: tomllib.loads(file.read_text(encoding="utf-8")) for file in files}
    kinds = {file: tables[file]["analysis"].get("kind", "pushover") for file in files}
    return [file for file in files if kinds[file] == "pushover" and known(tables[file])]


def known(tables: dict[str, Any]) -> bool:
    """Whether all joints are Coulomb's: limit analysis has no other law."""
    return all(joint.get("law", "coulomb") == "coulomb" for joint in tables["joints"].values())


def name_of(file: Path) -> str:
    """As in the table: folder and stem."""
    return f"{file.parent.name}/{file.stem}"


def main(words: Sequence[str] | None = None) -> int:
    """0 where all agree, 1 otherwise."""
    parser = argparse.ArgumentParser(prog="scripts/loads", description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", type=Path, metavar="CASE", help="case files; default: all pushovers")
    parser.add_argument("--write", action="store_true", help="write docs/loads.json and docs/loads.md")
    options = parser.parse_args(words)

    from dem_cli.bench.machine import describe, one_thread

    one_thread()
    from loadtable import judge, page
    from loadtable.measure import measure

    from dem_cli.bench.cases import compiled

    machine = describe()
    compiled()
    found, disagree = [], False
    for file in options.cases or pushovers():
        row = measure(file.resolve())
        found.append(row)
        wrong = judge.problems(row)
        disagree |= bool(wrong)
        print(" | ".join((*page.loads_of(row), *wrong)), flush=True)
        if options.write:
            page.write(DOCS, [row], machine, [name_of(file) for file in pushovers()])
    return int(disagree)


if __name__ == "__main__":
    sys.exit(main())
