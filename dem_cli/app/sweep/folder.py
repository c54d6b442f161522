"""Folder of a sweep: its facts in sweep.json, its case, its tables, and a folder of runs."""

from __future__ import annotations

import json
import os
import shutil
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from dem_cli.errors import UsageError
from dem_cli.results.output.atomic_file import PART, write_text
from dem_cli.results.output.folder import locked, write_error
from dem_cli.results.output.store import CASE
from dem_cli.results.output.sweep_files import CSV, FACTS, RUNS, SQLITE

LOCK, TABLES_LOCK = ".sweep{}.lock", ".tables.lock"
STALE = 3600.0  # s after which a half-written table is one that a killed sweep left
OURS = frozenset((FACTS, CASE, CSV, SQLITE, RUNS, "sweep.png", "report.html"))


@contextmanager
def opened(folder: Path, fresh: bool, force: bool, shard: str = "") -> Iterator[Path]:
    """Create the folder of a sweep, or reopen it, locked against other processes.

    fresh: throw away the runs of before. shard: several share the folder, each under its own name; a whole sweep
    shares it with none. Raises UsageError where it holds other things, or another sweep goes on there.
    """
    if folder.exists() and not folder.is_dir():
        raise UsageError(f"output folder {folder}: a file of that name exists")
    if folder.is_dir() and not force:
        foreign = sorted(p.name for p in folder.iterdir() if p.name not in OURS and not p.name.startswith("."))
        if foreign:
            raise UsageError(
                f"output folder {folder}: holds files that a sweep did not write ({', '.join(foreign[:3])}); "
                "choose another with -o, or keep them with --force"
            )
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise write_error(error, folder) from None
    locks: list[int] = []
    try:
        for name in dict.fromkeys((LOCK.format(""), LOCK.format(shard))):
            locks.append(_open_lock(folder / name))
            if not locked(locks[-1], shared=bool(shard) and name == LOCK.format("")):
                raise UsageError(f"{folder}: another sweep is writing its results there")
        if fresh:
            shutil.rmtree(folder / RUNS, ignore_errors=True)
            for name in (CSV, SQLITE):
                (folder / name).unlink(missing_ok=True)
        _remove_parts(folder)
        yield folder
    finally:
        for lock in locks:
            os.close(lock)  # the file stays: who opened it a moment ago may not lock another one


@contextmanager
def tables_alone(folder: Path) -> Iterator[None]:
    """Lock the tables: of shards that end at one time, the last one knows the runs of all."""
    lock = _open_lock(folder / TABLES_LOCK)
    try:
        while not locked(lock):
            time.sleep(0.05)
        yield
    finally:
        os.close(lock)


def _open_lock(path: Path) -> int:
    try:
        return os.open(path, os.O_CREAT | os.O_RDWR, 0o644)
    except OSError as error:
        raise write_error(error, path.parent) from None


def _remove_parts(folder: Path) -> None:
    """Remove half-written tables of killed sweeps."""
    for part in folder.glob(f"{PART}*"):
        with suppress(OSError):
            if time.time() - part.stat().st_mtime > STALE:
                part.unlink()


def write_facts(folder: Path, found: Mapping[str, Any]) -> None:
    """Write sweep.json: swept keys, program versions and progress."""
    write_text(folder / FACTS, json.dumps(found, indent=2, ensure_ascii=False) + "\n")
