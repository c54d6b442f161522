"""Cells of CSV files that never become a formula of a spreadsheet, nor break a row.

Names stay allowed as they are ("+20 %" is a fair label of a run, and a valid case stays valid): only the table is
careful. Line breaks and other control characters become blanks. Text that begins with =, +, − or @ and is no number
gets an apostrophe in front, as spreadsheets mark text; `text_of` takes it away again.
"""

from __future__ import annotations

import re
from typing import Any

FORMULA = ("=", "+", "-", "@")
_CONTROL = re.compile(r"[\x00-\x1f\x7f\x85\u2028\u2029]+")


def cell(value: Any) -> Any:
    """Convert a value to a safe CSV cell; all but text stays as it is."""
    if not isinstance(value, str):
        return value
    line = _CONTROL.sub(" ", value).strip(" ") if _CONTROL.search(value) else value
    return f"'{line}" if line.startswith(FORMULA) and not _is_number(line) else line


def text_of(written: str) -> str:
    """Recover the text of a cell written by `cell`, except for line breaks."""
    return written[1:] if written.startswith(tuple(f"'{sign}" for sign in FORMULA)) else written


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
