"""Switch between the package's own way through numba and unmodified numba: thrown once, for all kernels.

The own way (callees.py, entries.py, kept_code.py, machine_code.py, references.py, shortcuts.py, views.py, ...) reaches
into private names of numba and LLVM, which a next version may rename. Whatever surprises it throws the switch: from
there on kernels are compiled by public means alone (plain_numba.py), to the same answers. Loads nothing of either.
"""

from __future__ import annotations

import os

__all__ = ["SWITCH", "Surprise", "Switch"]

PLAIN = "DEM_PLAIN_NUMBA"  # environment variable: anything but "" and 0 throws the switch by hand
STRICT = "DEM_STRICT_KERNELS"  # the same: what surprises is an error, for tests and for who changes kernels


def _set(name: str) -> bool:
    return os.environ.get(name, "") not in ("", "0")


class Surprise(Exception):
    """Error: a version or a private name differs from those where the package's own way was tried."""


class Switch:
    """Reason why kernels of this process are compiled by unmodified numba, if they are, and remarks for users.

    reason    what surprised; None while the own way is gone
    remarks   kernels that numba has to be loaded for in each process, and the like; `dem run -v` prints them
    """

    def __init__(self) -> None:
        self.reason: str | None = None
        self.remarks: list[str] = []

    def own_way(self) -> bool:
        """True where kernels are compiled the package's own way."""
        if self.reason is None and _set(PLAIN):
            self.reason = f"{PLAIN} is set"
        return self.reason is None

    def throw(self, surprise: Exception) -> None:
        """Switch to unmodified numba for all later kernels. Raises Surprise where that is an error."""
        if _set(STRICT):
            raise Surprise(_words(surprise)) from surprise
        if self.own_way():
            self.reason = _words(surprise)

    def remark(self, text: str, fault: bool = False) -> None:
        """Record what costs time in each process but changes no result; fault: Surprise is raised where it is an
        error.
        """
        if fault and _set(STRICT):
            raise Surprise(text)
        if text not in self.remarks:
            self.remarks.append(text)

    def said(self) -> list[str]:
        """List the remarks for users, a line each."""
        by_numba = "kernels are compiled by numba as it comes, which takes longer"
        return ([] if self.reason is None else [f"{by_numba}: {self.reason}"]) + self.remarks


def _words(surprise: Exception) -> str:
    """Shorten a fault to one line, not the page that numba may write."""
    first = next(iter(str(surprise).strip().splitlines()), "")
    return first if isinstance(surprise, Surprise) else f"{type(surprise).__name__}: {first}".rstrip(": ")


SWITCH = Switch()
