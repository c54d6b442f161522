"""Study of the thesis's own joint (tests/oracle/microrotation.py): a column, a wall or a block under raised loads.

One line per load, then the bracket. With --write the run takes its place in docs/data/thesis_joint.json, found there by
its command; docs/chapter7.md shows it.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from typing import Any

from oracle.microrotation import Rule
from oracle.microrotation_walls import Load, Patience, structures, sweep

from studies import storage
from studies.study import StudyRunner

VISIBLE = 1e-4  # m: a step of the load in which the watched block moves by more is told
OF_STRUCTURE = ("aperture", "friction", "stiffness", "start", "step")
PLACES = 9  # digits kept


def measured(
    parser: argparse.ArgumentParser, options: argparse.Namespace, rows: Sequence[Load], seconds: float
) -> dict[str, Any]:
    """A run as JSON. bracket: [highest load carried, lowest that failed], null where there is none; of the former the
    state, and the horizontal displacement of the watched block [m]; visible: [[load, step of it [m]], ...].
    """
    given = vars(options)
    words = [options.structure]
    words += [f"--{name} {given[name]:g}" for name in OF_STRUCTURE if given[name] is not None]
    for name in ("reading", "pivot", "base", "share", *Patience._fields):
        if name == "pivot" or given[name] != parser.get_default(name):
            words.append(f"--{name} {given[name]}")
    carried = [row for row in rows if row.state != "failed"]
    last = carried[-1] if carried else None
    return {
        "command": " ".join(["scripts/study thesis_joint", *words]),
        **{name: given[name] for name in ("structure", "reading", "pivot", "base", "share")},
        "bracket": [last and last.load, rows[-1].load if rows[-1].state == "failed" else None],
        "state": last and last.state,
        "displacement": last and round(last.top, PLACES),
        "visible": [
            [row.load, round(row.top - before.top, PLACES)]
            for before, row in zip(carried, carried[1:]) if row.top - before.top > VISIBLE
        ],
        "steps": sum(row.steps for row in rows),
        "seconds": round(seconds, 1),
    }  # fmt: skip


def keep(run: dict[str, Any]) -> None:
    """Beside the others, by its command; "runs" as they are by default, "checks" with other numbers than those."""
    table = storage.read("thesis_joint") or {"runs": [], "checks": []}
    words = run["command"].split()[3:]
    part = "runs" if set(words[::2]) <= {"--reading", "--pivot"} else "checks"
    kept = {one["command"]: one for one in table[part]} | {run["command"]: run}
    table[part] = [kept[command] for command in sorted(kept)]
    storage.write("thesis_joint", table)


class ThesisJointStudy(StudyRunner):
    """One run of one structure."""

    def arguments(self, parser: argparse.ArgumentParser) -> None:
        parser.add_argument("structure", choices=self.sections)
        parser.add_argument("--reading", choices=("scaled", "literal"), default="scaled", help="of lengths (polygon)")
        parser.add_argument("--pivot", choices=("end", "vertex"), default="end")
        parser.add_argument("--base", choices=("course", "block"), default="course", help="below a wall")
        parser.add_argument("--share", type=float, default=1.0, help="of the excess moment that flows in one step")
        for name in OF_STRUCTURE:
            parser.add_argument(f"--{name}", type=float, help="default: that of the structure")
        for name, value in Patience()._asdict().items():
            parser.add_argument(f"--{name}", type=type(value), default=value, help="%(default)s; see Patience")
        parser.add_argument("--write", action="store_true", help="into docs/data/thesis_joint.json")

    def main(self, words: Sequence[str] | None = None) -> int:
        """0 where a load failed, 1 where none did."""
        parser = argparse.ArgumentParser(prog=f"scripts/study {self.name}", description=self.about)
        self.arguments(parser)
        options = parser.parse_args(words)
        given = vars(options)
        structure = structures(options.base == "block")[options.structure]
        structure = structure._replace(**{name: given[name] for name in OF_STRUCTURE if given[name] is not None})
        rule = Rule(structure.friction, options.pivot == "end", options.share)
        patience = Patience(**{name: given[name] for name in Patience._fields})
        begin, rows = time.perf_counter(), []
        for row in sweep(structure, rule, patience, options.reading == "scaled"):
            rows.append(row)
            print(
                f"{row.load:<7g} {row.state:<8} {1e3 * row.top:8.3f} mm, {-1e3 * row.sinks:.3f} mm down at most, "
                f"{row.turns} turns, {row.steps} steps",
                flush=True,
            )
        found = measured(parser, options, rows, time.perf_counter() - begin)
        low, high = found["bracket"]
        print(f"carried {low} ({found['state']}), failed {high}; {found['seconds']} s: {found['command']}")
        if options.write:
            keep(found)
        return int(high is None)


STUDY = ThesisJointStudy("thesis_joint", "A column, a wall or a block on the thesis's own joint", structures())
