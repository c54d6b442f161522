"""Study of random structures: all methods on each, between rigorous bounds; the last section of docs/stress.md.

    scripts/study random_structures --seeds 2000:2300 --jobs 16 --json FILE.json --write

Every structure is a record of its own, kept in the file as soon as it is there: a run that is stopped goes on where it
was.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any

from studies import storage
from studies.places import DOCS
from studies.stress.random_structures import page, verdicts
from studies.stress.random_structures.record import record
from studies.study import StudyRunner

SEEDS = "2000:2300"  # of the page; those below 100 and from 1000 to 1299 were seen while the program was made
SECTION = "structures"
HEADING = "\n## Random structures\n"


class RandomStudy(StudyRunner):
    """One section: a record per structure; its page is the last section of the stress test's."""

    solves = False

    def arguments(self, parser: argparse.ArgumentParser) -> None:
        parser.add_argument("--seeds", default=SEEDS, metavar="FIRST:END", help=f"default: {SEEDS}")
        parser.add_argument("--jobs", type=int, default=1, metavar="N", help="processes side by side; default: 1")
        parser.add_argument("--max-steps", type=int, default=1_000_000, help="of each start; default: 1000000")
        parser.add_argument("--json", type=Path, help="keep every record in this file; what it has is not done again")

    def measure(self, section: str, options: argparse.Namespace) -> list[dict[str, Any]]:
        file = options.json
        kept = {row["seed"]: row for row in (json.loads(file.read_text("utf-8")) if file and file.exists() else [])}
        first, end = map(int, options.seeds.split(":"))
        missing = [seed for seed in range(first, end) if seed not in kept]
        with ProcessPoolExecutor(options.jobs, mp_context=multiprocessing.get_context("spawn")) as pool:
            for future in as_completed([pool.submit(record, seed, options.max_steps) for seed in missing]):
                row = future.result()
                kept[row["seed"]] = row
                print(page.line(row), flush=True)
                if file:
                    keep(file, kept)
        return [kept[seed] for seed in range(first, end)]

    def said(self, section: str, found: Any) -> str:
        return page.text(found)

    def problems(self, section: str, found: Any) -> list[str]:
        wrong = [(row, name, said) for row in found for name, said in verdicts.findings(row) if name in verdicts.FAULTS]
        return [f"{row['seed']}: {name}: {said}" for row, name, said in wrong]

    def write(self, found: Mapping[str, Any]) -> None:
        super().write({name: [shortened(row) for row in rows] for name, rows in found.items()})

    def draw(self, chosen: Mapping[str, Any]) -> None:
        """The last section of docs/stress.md, from what is kept."""
        path = DOCS / "stress.md"
        before = path.read_text(encoding="utf-8").partition(HEADING)[0] if path.exists() else ""
        path.write_text(before + page.section(), encoding="utf-8")


def shortened(row: Mapping[str, Any]) -> dict[str, Any]:
    """A record as it is kept beside the page: what its tables and findings need, with the digits that are shown."""
    answers = {
        name: {key: value for key, value in answer.items() if value is not None and key not in ("start", "warnings")}
        for name, answer in row["answers"].items()
    }
    return storage.rounded({**row, "answers": answers})


def keep(file: Path, rows: Mapping[int, Any]) -> None:
    """All records so far, whole or not at all."""
    part = file.with_name(f".{file.name}.part")
    part.write_text(storage.text_of([rows[seed] for seed in sorted(rows)]) + "\n", encoding="utf-8")
    part.replace(file)


STUDY = RandomStudy("random_structures", "All methods on random structures, between rigorous bounds", {SECTION: None})
