"""Resolve files that a case names relative to the case file, and report missing ones."""

from __future__ import annotations

import difflib
import hashlib
from pathlib import Path

from pydantic import ValidationInfo

from dem_cli.case.wording import show
from dem_cli.input_limits import DRAWING_BYTES, UnreadableInput, read_bounded, what_else


def absolute_path(file: str, info: ValidationInfo) -> str:
    """Return the absolute path of a file that a case names relative to itself."""
    folder = (info.context or {}).get("folder")
    path = Path(file).expanduser()
    if folder is None or path.is_absolute():
        return str(path)
    return str((Path(folder).absolute() / path).resolve())


def digest(file: str | Path) -> str:
    """Hash the content of a file (SHA-256); "" where it cannot be read, which its reader reports."""
    try:
        return hashlib.sha256(read_bounded(Path(file), DRAWING_BYTES)).hexdigest()
    except (OSError, UnreadableInput):
        return ""


def is_file(path: Path) -> bool:
    """Test whether a file exists; False also where its name is too long or access is denied."""
    try:
        return path.is_file()
    except OSError:
        return False


def missing_file(path: Path, what: str) -> str:
    """Return the message for a missing file with the nearest name; what: what it should be, such as "a record"."""
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
