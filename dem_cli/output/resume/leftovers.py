"""Leftovers of an interrupted run: whether the run that finds them may go on from there, and the words where not."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dem_cli.errors import UsageError


def fits(
    header: Mapping[str, Any], form: int, what: Mapping[str, str], resume: bool, left: str | None, path: Path
) -> bool:
    """Whether they are of the same case and program, and wanted; False: begin anew.

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
    """That another run is about to write there."""
    return UsageError(
        f"{final}: another run is writing its results there; wait for its end, or choose another folder with -o"
    )
