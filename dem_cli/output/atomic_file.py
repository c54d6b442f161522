"""Atomic file writes: a file is there whole, or as it was."""

from __future__ import annotations

import secrets
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from dem_cli.output.folder import write_error

PART = ".part-"


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """A path beside `path`, of the same suffix, to write to; it takes the name once that went well.

    Raises OutputError where the disk does not take it.
    """
    part = path.with_name(f"{PART}{secrets.token_hex(4)}-{path.name}")  # several may write: shards of a sweep
    try:
        yield part
        part.replace(path)
    except (OSError, sqlite3.Error) as error:
        raise write_error(error, path) from None
    finally:
        part.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """A text file. Raises OutputError."""
    with whole(path) as part:
        part.write_text(text, encoding="utf-8", newline="\n")
