"""Files that a case names: paths that start at the case file, and what to say of one that is not there."""

from __future__ import annotations

import difflib
import hashlib
from pathlib import Path

from pydantic import ValidationInfo

from dem_cli.case.wording import show
from dem_cli.input_limits import DRAWING_BYTES, UnreadableInput, read_bounded, what_else


def absolute_path(file: str, info: ValidationInfo) -> str:
    """A path of a case that was loaded, which no longer depends on where the case lies."""
    folder = (info.context or {}).get("folder")
    path = Path(file).expanduser()
    if folder is None or path.is_absolute():
        return str(path)
    return str((Path(folder).absolute() / path).resolve())


def digest(file: str | Path) -> str:
    """What a file holds, in short (SHA-256); "" where it cannot be read: what is wrong is said by what reads it."""
    try:
        return hashlib.sha256(read_bounded(Path(file), DRAWING_BYTES)).hexdigest()
    except (OSError, UnreadableInput):
        return ""


def is_file(path: Path) -> bool:
    """Whether there is such a file; False where its name is longer than any file's, or nobody lets us look."""
    try:
        return path.is_file()
    except OSError:
        return False


def missing_file(path: Path, what: str) -> str:
    """`no such file: /x/east.csv, did you mean 'east.csv'?`; what: what it should be, such as "a record"."""
    try:
        if path.exists():
            return f"{path} is {what_else(path)}; {what} is a file"
    except OSError as error:
        return f"{show(str(path))} cannot be opened ({error.strerror})"
    try:
        files = sorted(file.name for file in path.parent.iterdir() if file.is_file())
    except OSError:
        return f"no such file: {path} (there is no folder '{path.parent}')"
    close = difflib.get_close_matches(path.name, files, 1)
    return f"no such file: {path}" + (f", did you mean '{close[0]}'?" if close else "")
