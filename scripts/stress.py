"""The stability stress test: what held and how exactly, what was refused; exit code 1 after a silent wrong answer.

Every stress is one record (stresses/records.py): a structure with a known failure load, or a figure with a
limit, at one value of an axis. WRONG is an answer of status ok, without a warning, outside its bracket and 0.5 %.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
for folder in (ROOT, ROOT / "scripts"):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))

from stresses import invariance, proportions, shaking, steady, stiffness, table  # noqa: E402
from stresses.records import WRONG, Record  # noqa: E402

DOCUMENT = ROOT / "docs" / "stress.md"
AXES: dict[str, Callable[[bool], Iterator[Record]]] = {
    "stiffness": stiffness.joint_stiffness,
    "shear": stiffness.shear_stiffness,
    "stiffness-ratio": stiffness.stiffness_ratio,
    "thesis": stiffness.thesis,
    "mass": proportions.mass_ratios,
    "size": proportions.size_ratios,
    "slender": proportions.slender,
    "sliver": proportions.slivers,
    "gaps": proportions.gaps,
    "numbering": invariance.numbering,
    "place": invariance.place,
    "symmetry": invariance.symmetry,
    "units": invariance.units,
    "far": invariance.far,
    "rest": steady.rest,
    "time-step": steady.time_step,
    "past-limit": steady.past_the_limit,
    "work": steady.work_identity,
    "state": steady.state_closure,
    "bytes": invariance.same_bytes,
    "shaking": shaking.shaken,
}


def collect(names: Sequence[str], short: bool, say: Callable[[str], None]) -> tuple[list[Record], dict[str, str]]:
    """All records of some axes, told as they come, and what each axis is."""
    records, about = [], {}
    for name in names:
        begun, found = time.process_time(), []
        for record in AXES[name](short):
            found.append(record)
            if record.verdict == WRONG:
                say(f"  {table.line(record)}")
        records += found
        about |= {record.axis: (AXES[name].__doc__ or "").strip() for record in found}
        say(f"{name}: {table.count(found)}, {time.process_time() - begun:.0f} s")
    return records, about


def main(words: Sequence[str] | None = None) -> int:
    """0 where nothing was wrong silently, 1 otherwise."""
    parser = argparse.ArgumentParser(prog="scripts/stress", description=__doc__.splitlines()[0])
    parser.add_argument("axes", nargs="*", help=f"some of: {', '.join(AXES)}; default: all")
    parser.add_argument("--short", action="store_true", help="few values on small structures, below half a minute")
    parser.add_argument("--write", action="store_true", help="write docs/stress.md (all axes)")
    parser.add_argument("--json", type=Path, help="keep every record in this file")
    parser.add_argument("--verbose", action="store_true", help="print every record")
    options = parser.parse_args(words)
    unknown = [name for name in options.axes if name not in AXES]
    if unknown:
        parser.error(f"'{unknown[0]}' is no axis; there are {', '.join(AXES)}")
    if options.write and (options.axes or options.short):
        parser.error("--write needs all axes in full")
    records, about = collect(options.axes or list(AXES), options.short, lambda text: print(text, flush=True))
    if options.verbose:
        print("\n".join(table.line(record) for record in records))
    if options.json:
        options.json.write_text(json.dumps([asdict(record) for record in records], indent=1), encoding="utf-8")
    if options.write:
        DOCUMENT.write_text(table.document(records, about), encoding="utf-8")
    print(f"in all: {table.count(records)}")
    return int(any(record.verdict == WRONG for record in records))


if __name__ == "__main__":
    sys.exit(main())
