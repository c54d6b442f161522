"""Records as text: one line each, counts, and docs/stress.md."""

from __future__ import annotations

from collections.abc import Sequence

from stresses.records import Record


def line(record: Record) -> str:
    """One record as people read it."""
    error = "" if record.error is None else f" ({record.error:+.1e})"
    said = f": {record.message}" if record.message else ""
    return f"{record.verdict:<8} {record.axis} {record.value}, {record.structure}: {record.found}{error} {record.how}{said}"


def count(records: Sequence[Record]) -> str:
    """How many of each verdict."""
    verdicts = ("held", "warned", "refused", "WRONG")
    found = [(v, sum(r.verdict == v for r in records)) for v in verdicts]
    return ", ".join(f"{n} {v}" for v, n in found if n) or "nothing"
