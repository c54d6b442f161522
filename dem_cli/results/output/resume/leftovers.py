"""Leftovers of an interrupted run: opening them safely, and deciding whether a run may resume from them.

Who made them is not known: they are read as data, and only as plain files where they lie.
"""

from __future__ import annotations

import errno
import json
import os
import stat
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dem_cli.errors import UsageError

_NO_FILE = (errno.ELOOP, errno.EISDIR, errno.ENXIO)
_AS_IT_IS = getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)


def opened(path: Path, flags: int) -> int:
    """Open a plain file by the flags of `os.open`; never the target of a link, nor a pipe without a writer.

    Raises UsageError where it is something else, and OSError.
    """
    try:
        file = os.open(path, flags | _AS_IT_IS, 0o644)
    except OSError as error:
        if error.errno in _NO_FILE:
            raise damaged(path, "it is no plain file") from None
        raise
    if not stat.S_ISREG(os.fstat(file).st_mode):
        os.close(file)
        raise damaged(path, "it is no plain file")
    return file


def read_at(file: int, begin: int, length: int) -> bytes:
    """Read bytes of a file from a position on; fewer where it ends before."""
    os.lseek(file, begin, os.SEEK_SET)
    parts = []
    while length > 0 and (part := os.read(file, min(length, 1 << 26))):
        parts.append(part)
        length -= len(part)
    return b"".join(parts)


def parsed(text: bytes) -> Any:
    """Parse JSON; None where the text is none."""
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return None


def damaged(path: Path, why: str) -> UsageError:
    """Create the error of damaged leftovers, from which no run can resume."""
    return UsageError(f"{path}: is damaged; delete it to start anew ({why})")


def fits(
    header: Mapping[str, Any], form: int, what: Mapping[str, str], resume: bool, left: str | None, path: Path
) -> bool:
    """Test whether leftovers fit the case and program, and are wanted; False: begin anew.

    header: {"format": number, "what": facts} of the leftovers; form, what: of the run that finds them; left: how much
    there is, None: nothing. Raises UsageError where they are wanted and do not fit, and where they fit unasked.
    """
    changed = [word for word in what if header.get("what", {}).get(word) != what[word]]
    if header.get("format") != form or changed:
        if resume:
            words = " and ".join(changed) or "the format of what it left"
            raise UsageError(
                f"cannot resume: {words} changed since the interrupted run, whose {left or 'work'} is in {path}; "
                "leave out --resume to throw that away and start anew"
            )
        return False
    if left and not resume:
        raise UsageError(
            f"an interrupted run of this case left {left} in {path}: go on with --resume, or delete that to start anew"
        )
    return True


def in_use(final: Path) -> UsageError:
    """Create the error of a folder that another run is about to write to."""
    return UsageError(
        f"{final}: another run is writing its results there; wait for its end, or choose another folder with -o"
    )
