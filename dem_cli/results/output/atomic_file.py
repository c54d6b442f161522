"""Atomic file writes: a file, or all files of a folder, appear complete or stay as they were."""

from __future__ import annotations

import secrets
import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from dem_cli.errors import UsageError
from dem_cli.input_limits import what_else
from dem_cli.results.output.folder import write_error

PART = ".part-"


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """Write to a temporary path of the same suffix, which replaces `path` on success.

    Raises OutputError where the disk does not take it, and UsageError where the name is that of no file.
    """
    part = path.with_name(f"{PART}{secrets.token_hex(4)}-{path.name}")  # several may write: shards of a sweep
    try:
        require_file(path)
        yield part
        part.replace(path)
    except (OSError, sqlite3.Error) as error:
        raise write_error(error, path) from None
    finally:
        with suppress(OSError):  # where there never was one: its name is too long, or leads through a file
            part.unlink(missing_ok=True)


def require_file(path: Path) -> None:
    """Raise UsageError where a device, a pipe or a folder has the name of a file to write: it would be replaced."""
    if path.exists() and not path.is_file():
        raise UsageError(f"cannot write {path}: it is {what_else(path)}; give the name of a file")


@contextmanager
def whole_folder(folder: Path) -> Iterator[Path]:
    """Write files to a temporary folder; they appear in `folder` only once all went well.

    Raises OutputError where the disk does not take them.
    """
    part, made = folder / f"{PART}{secrets.token_hex(4)}", list[Path]()
    try:
        made = [path for path in (folder, *folder.parents) if not path.exists()]
        part.mkdir(parents=True)
        yield part
        for path in sorted(part.iterdir()):
            path.replace(folder / path.name)
    except OSError as error:
        raise write_error(error, folder) from None
    finally:
        shutil.rmtree(part, ignore_errors=True)
        for path in made:  # those that hold something stay
            with suppress(OSError):
                path.rmdir()


def write_text(path: Path, text: str) -> None:
    """Write a text file atomically. Raises OutputError."""
    with whole(path) as part:
        part.write_text(text, encoding="utf-8", newline="\n")
