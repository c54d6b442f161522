"""Random structures as text: a line each, and the last section of docs/stress.md."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from studies import measured, storage
from studies.stress.random_structures import verdicts
from studies.stress.random_structures.methods import DEFAULT
from studies.template import filled
from studies.template import table as markdown

Row = Mapping[str, Any]


def load_of(row: Row, name: str = DEFAULT) -> str:
    """What a method says, in short."""
    answer = row["answers"][name]
    load, status = verdicts.claimed(answer), answer["status"]
    if load is None or status.startswith(verdicts.LOCKED):
        return status.partition(":")[0]
    return f"{load:.4f}" + ("*" if status.startswith(verdicts.EXISTS) else "" if status == verdicts.SOLVED else " (?)")


def line(row: Row) -> str:
    """One structure as people read it."""
    found = verdicts.findings(row)
    methods = ", ".join(f"{name} {load_of(row, name)}" for name in row["answers"])
    known = "" if row["lowest"] is None else f"{row['lowest']:.4f} to "
    bound = verdicts.bound_of(row)
    seconds = row["seconds"] + row["limit"]["seconds"] + sum(answer["seconds"] for answer in row["answers"].values())
    what = f"{row['title']} ({row['blocks']} blocks, {row['pattern']}, {seconds:.1f} s)"
    bounds = "does not stand" if bound is None else f"{known}{bound:.4f}"
    return "\n    ".join([f"{what}: {bounds}; {methods}", *(f"{name}: {said}" for name, said in found)])


def text(rows: Sequence[Row]) -> str:
    """Counts."""
    return "\n".join(f"{name}: {value}" for name, value in counts(rows).items())


def counts(rows: Sequence[Row]) -> dict[str, str]:
    """What was found, by name."""
    every = [(row, *finding) for row in rows for finding in verdicts.findings(row)]
    known = [row for row in rows if is_known(row)]
    pairs = [pair for row in rows for pair in verdicts.disagreements(row)]
    differ = [row for row in rows if verdicts.disagreements(row)]
    found = {
        "structures": f"{len(rows):,}",
        "free blocks": f"{min(row['blocks'] for row in rows)} to {max(row['blocks'] for row in rows)}",
        "known load (lowest = associated)": f"{len(known)}",
        "structures on which methods disagree": f"{len(differ)}, in {len(pairs)} pairs",
    }
    for name in (*verdicts.FAULTS, verdicts.UNFINISHED):
        seeds = sorted({row["seed"] for row, named, _ in every if named == name})
        found[name] = f"{len(seeds)}" + (f" (seeds {', '.join(map(str, seeds))})" if seeds else "")
    return found


def is_known(row: Row) -> bool:
    """Whether its load is the only one that joints without dilation admit."""
    top, low = row["associated"], row["lowest"]
    return top is not None and low is not None and top - low <= verdicts.SAME * top


def section() -> str:
    """The section of docs/stress.md; nothing where no structures were run."""
    rows = storage.read("random_structures").get("structures", [])
    if not rows:
        return ""
    about = [*counts(rows).items()]
    differ = [row for row in rows if verdicts.disagreements(row) or verdicts.findings(row)]
    return filled(
        "stress/random_structures/section.md.j2",
        counts=markdown(["what", "how many"], [list(item) for item in about]),
        kinds=markdown(["kind", "structures", "known load", "worst error of these", "methods disagree"], kinds(rows)),
        differ=markdown(["seed", "structure", "admissible", *METHODS, "said"], [cells(row) for row in differ]),
        measured=measured.sentence("random_structures"),
        seeds=f"{rows[0]['seed']} to {rows[-1]['seed']}",
    )


METHODS = (DEFAULT, "gravity", "path", "limit")


def kinds(rows: Sequence[Row]) -> list[list[str]]:
    """Rows of the table of kinds."""
    alike: dict[str, list[Row]] = {}
    for row in rows:
        alike.setdefault(row["title"].partition(": ")[2].partition(" beside")[0], []).append(row)
    return [
        [
            kind,
            str(len(found)),
            str(sum(map(is_known, found))),
            worst(found),
            str(sum(bool(verdicts.disagreements(row)) for row in found)),
        ]
        for kind, found in sorted(alike.items())
    ]


def worst(rows: Sequence[Row]) -> str:
    """Largest distance of the default run's failure load from one that is known."""
    loads = [(row, row["answers"][DEFAULT].get("failure_load")) for row in rows if is_known(row)]
    errors = [
        verdicts.apart((load, load), (row["lowest"], row["associated"])) for row, load in loads if load is not None
    ]
    return f"{max(errors):.2%}" if errors else ""


def cells(row: Row) -> list[str]:
    """Its row in the table of those on which methods disagree, or with findings."""
    bound = verdicts.bound_of(row)
    low = "?" if row["lowest"] is None else f"{row['lowest']:.4f}"
    span = row["answers"][DEFAULT].get("load_range")
    said = f"{span['lowest']:.4f} to {span['highest']:.4f}" if span else ""
    wrong = sorted({name for name, _ in verdicts.findings(row)})
    said = "; ".join(filter(None, [said, *wrong]))
    kind = row["title"].partition(": ")[2]
    admissible = "none" if bound is None else f"{low} to {bound:.4f}"
    return [str(row["seed"]), f"{kind}, {row['blocks']}", admissible, *(load_of(row, name) for name in METHODS), said]
