"""`scripts/certify A:B`: random structures of every generator, whose certificates an independent program checks.

Structures are those of the study of geometries (scripts/studies/geometries), small and of joints with friction, in 2D
and 3D. Each is pushed to failure; tests/oracle/check_certificate.py reads the results. Exit code 1: it refuses one.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from oracle.check_certificate import NONE, REFUSED, check
from studies.geometries.measure import STEPS
from studies.geometries.structures import structure

import dem_cli
from fuzzing.__main__ import seeds_of


def certified(seed: int, kinematics: str) -> tuple[str, dict[str, tuple[str, str]]]:
    """Run the structure of a seed; returns what it is and what the checker says of its claims."""
    tables, blocks, _ = structure(seed)
    asked = tables | {"analysis": tables["analysis"] | {"kinematics": kinematics, "max_steps": STEPS}}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "results"
        with dem_cli.run(asked, out=folder) as result:
            status = result.status
        what = f"{asked['structure'][0]['kind']} {asked.get('dimension', 2)}D, {blocks} blocks, {status}"
        return what, check(str(folder / "results.h5"))


def main(words: Sequence[str] | None = None) -> int:
    """Returns 1 where any certificate was refused, else 0."""
    parser = argparse.ArgumentParser(prog="scripts/certify", description="Check certificates of random structures.")
    parser.add_argument("seeds", type=seeds_of, metavar="A:B", help="seeds from A to before B")
    parser.add_argument("--kinematics", choices=("auto", "fixed", "large"), default="auto")
    asked = parser.parse_args(words)
    counts = Counter[str]()
    for seed in asked.seeds:
        what, found = certified(seed, asked.kinematics)
        counts.update(f"{claim} {verdict}" for claim, (verdict, _) in found.items())
        counts["structures"] += 1
        print(f"{seed}: {what}: {', '.join(f'{claim} {verdict}' for claim, (verdict, _) in found.items())}", flush=True)
        for claim, (verdict, why) in found.items():
            if verdict == REFUSED or (verdict == NONE and claim == "stands"):
                print(f"  {claim} {verdict}: {why}", flush=True)
    print("; ".join(f"{name}: {count}" for name, count in sorted(counts.items())))
    return int(any(name.endswith(REFUSED) for name in counts))


if __name__ == "__main__":
    sys.exit(main())
