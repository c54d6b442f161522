"""Verification records of solved cases, stored in verification.json."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from dem_cli.app.verify.blind import blind_answers
from dem_cli.app.verify.case_selection import APART, SHELVES
from dem_cli.case.reader import parse_toml, read_text
from dem_cli.errors import DemError, UsageError
from dem_cli.results.output.reference import as_declared, error_of, unexpected_fall, verdicts
from dem_cli.results.output.scalars import plain

Record = dict[str, Any]  # of a case: see `record`
ORIGINS = ("inferred_from", "chosen_by")  # keys of a case that change nothing that is computed
VERDICT_STATES = ("passed", "missed", "failed", "met")  # of a reference; missed: as declared; met: declared as missed
BLIND_STATES = ("predicted", "outside")  # of blind ones: not measured yet; measured outside the band, no failure


def record(path: Path, title: str, summary: Mapping[str, Any], case: Any, seconds: float) -> Record:
    """Create the record of a solved case: file, title, kind, status, seconds, and one dict for each reference.

    Those are the verdicts of results/output/reference.py with `source`, `error`, what was found less what was expected,
    and, where the tolerance is the case's own, the `reason` for it; then those of blind references (verify/blind.py).
    """
    status, references = str(summary["status"]), case.compared
    answers = [
        {**answer, **_told(reference), "error": error_of(answer)}
        for answer, reference in zip(verdicts(summary, references), references, strict=True)
    ]
    answers = [*(dict(answer, state=state(answer)) for answer in answers), *blind_answers(summary, case)]
    kept = {"case": path.as_posix(), "sha256": digest(path), "title": title, "kind": summary["kind"], "status": status}
    kept |= {"seconds": rounded(seconds), "references": answers}
    if status.startswith("not converged"):
        kept["error"] = "; ".join([status, *summary.get("warnings", ())])
    elif unexpected_fall(summary, answers):
        kept["error"] = f"{status}, which no [reference] expects"
    return plain(kept)


def _told(reference: Any) -> dict[str, Any]:
    """Return the source, the reason and the scatter of a [reference] for the page."""
    own = reference.tolerance is not None or reference.relative is not None
    repeated = {name: getattr(reference, name) for name in ("scatter", "specimens") if getattr(reference, name)}
    return {"source": reference.source} | ({"reason": reference.reason or "not said"} if own else {}) | repeated


def failed(path: Path, reason: str, bad: bool) -> Record:
    """Create the record of a case that could not be solved; bad: the case file is wrong."""
    kept = {"case": path.as_posix(), "title": path.stem, "error": reason, "bad": bad, "references": [], "seconds": 0.0}
    return kept | {"sha256": digest(path)}


def state(answer: Mapping[str, Any]) -> str:
    """Return the state of a verdict, one of STATES."""
    if as_declared(answer):
        return "passed" if answer["passed"] else "missed"
    return "met" if answer["passed"] and "missed" in answer else "failed"


def digest(path: Path) -> str:
    """Hash the content of a case file (SHA-256) without comments, spaces, and where its inputs came from."""
    try:
        case = parse_toml(path, read_text(path))
        said = json.dumps({key: case[key] for key in case if key not in ORIGINS}, sort_keys=True, default=str)
    except DemError:
        said = path.read_text(encoding="utf-8", errors="replace") if path.is_file() else ""
    return hashlib.sha256(said.encode()).hexdigest()


def rounded(seconds: float) -> float:
    """Round to two digits: more would change from run to run."""
    return float(f"{seconds:.2g}")


def on_shelves(records: Iterable[Record], shelves: Sequence[str]) -> list[Record]:
    """Return records with only the references of some shelves; none: all."""
    if not shelves:
        return list(records)
    wanted = [dict(r, references=[a for a in r["references"] if SHELVES[a["kind"]] in shelves]) for r in records]
    return [r for r in wanted if r["references"] or "error" in r]


def apart(records: Iterable[Record]) -> tuple[list[Record], list[Record]]:
    """Separate records with counted references from those on the shelf of inference."""
    records = list(records)
    of_inference = [record for record in on_shelves(records, [APART]) if record["references"]]
    others = on_shelves(records, [shelf for shelf in SHELVES.values() if shelf != APART])
    return others, of_inference


def counts(records: Iterable[Record]) -> dict[str, int]:
    """Count cases, references, references in each state (of blind ones where there are any), and unsolved cases."""
    records = list(records)
    states = [answer["state"] for record in records for answer in record["references"]]
    found = {"cases": len(records), "references": len(states)} | {name: states.count(name) for name in VERDICT_STATES}
    found |= {name: states.count(name) for name in BLIND_STATES if name in states}
    return found | {"not solved": sum("error" in record for record in records)}


def all_well(records: Iterable[Record]) -> bool:
    """Test whether all references and cases are as declared."""
    found = counts(records)
    return not (found["failed"] or found["met"] or found["not solved"])


def data_file(page: Path) -> Path:
    """Return the JSON file of a page."""
    return page.parent / "data" / f"{page.stem}.json"


def load(file: Path) -> list[Record]:
    """Read the records of an earlier `dem verify --write`, with relative case paths; empty without a file."""
    if not file.is_file():
        return []
    try:
        kept = json.loads(file.read_text(encoding="utf-8"))["cases"]
        return [{**one, "case": moved(one["case"], file.parent.parent, Path())} for one in kept]
    except (ValueError, KeyError, TypeError, OSError) as error:
        raise UsageError(f"{file}: is not what `dem verify --write` left ({error}); remove it") from None


def dump(records: Iterable[Record], page: Path, version: str) -> str:
    """Format records as JSON, one per line, with case paths relative to the page."""
    cases = sorted(({**r, "case": moved(r["case"], Path(), page.parent)} for r in records), key=lambda r: r["case"])
    lines = ",\n".join(json.dumps(case, ensure_ascii=False) for case in cases)
    return f'{{"version": {json.dumps(version)}, "cases": [\n{lines}\n]}}\n'


def moved(path: str, before: Path, after: Path) -> str:
    """Convert a path relative to one folder to one relative to another."""
    return Path(os.path.relpath(before / path, after)).as_posix()


def merged(old: Iterable[Record], new: Iterable[Record]) -> list[Record]:
    """Merge new records with the old ones of other cases that still exist."""
    found = {r["case"]: r for r in old if Path(r["case"]).is_file()}
    return list((found | {r["case"]: r for r in new}).values())
