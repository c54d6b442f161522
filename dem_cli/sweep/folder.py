"""The folder of a sweep: its facts in sweep.json, its case, its tables, and a folder of runs."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from dem_cli.errors import UsageError
from dem_cli.output.folder import locked, write_error
from dem_cli.output.store import CASE
from dem_cli.output.whole import write_text
from dem_cli.sweep.run import RUNS
from dem_cli.sweep.table import CSV, SQLITE

FACTS = "sweep.json"
LOCK = ".sweep{}.lock"
OURS = frozenset((FACTS, CASE, CSV, SQLITE, RUNS, "sweep.png", "report.html"))


@contextmanager
def opened(folder: Path, fresh: bool, force: bool, shard: str = "") -> Iterator[Path]:
    """Make a folder for a sweep, or take up the one that is there; nobody else writes to it meanwhile.

    fresh: throw away the runs of before. shard: several share the folder, each under its own name.
    Raises UsageError where it holds other things, or another sweep goes on there.
    """
    if folder.exists() and not folder.is_dir():
        raise UsageError(f"output folder {folder}: a file of that name exists")
    if folder.is_dir() and not force:
        foreign = sorted(n for n in os.listdir(folder) if n not in OURS and not n.startswith("."))
        if foreign:
            raise UsageError(
                f"output folder {folder}: holds files that a sweep did not write ({', '.join(foreign[:3])}); "
                "choose another with -o, or keep them with --force"
            )
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = os.open(folder / LOCK.format(shard), os.O_CREAT | os.O_RDWR, 0o644)
    except OSError as error:
        raise write_error(error, folder) from None
    try:
        if not locked(lock):
            raise UsageError(f"{folder}: another sweep is writing its results there")
        if fresh:
            shutil.rmtree(folder / RUNS, ignore_errors=True)
            for name in (CSV, SQLITE):
                (folder / name).unlink(missing_ok=True)
        yield folder
    finally:
        os.close(lock)  # the file stays: who opened it a moment ago may not lock another one


def write_facts(folder: Path, found: Mapping[str, Any]) -> None:
    """sweep.json: what was swept, by which program, and how far it is."""
    write_text(folder / FACTS, json.dumps(found, indent=2, ensure_ascii=False) + "\n")
