"""Setup of numba, whichever way kernels are compiled: its cache folder, and observers of compilation."""

from __future__ import annotations

import gc
import os
from contextlib import suppress
from functools import cache
from typing import Any

import numba

from dem_cli.core.kernels.compilation.cache_folder import cache_folder
from dem_cli.core.kernels.compilation.compile_time import LISTENING

__all__ = ["UNDER_WAY", "set_up_numba"]

UNDER_WAY: list[Any] = []  # compilations: of a kernel, of a function that it calls, and so on


def set_up_numba() -> None:
    """Set numba up before anything is compiled; may be called again.

    Numba reads its settings again whenever a variable of its part of the environment has changed, and would from then
    on keep compiled code beside the sources, where nothing tells old code from new.
    """
    os.environ["NUMBA_CACHE_DIR"] = str(cache_folder())
    vars(numba.config)["CACHE_DIR"] = os.environ["NUMBA_CACHE_DIR"]
    with suppress(Exception):  # a numba that tells of nothing: then compilation counts as solving
        _tell_who_listens()


@cache
def _tell_who_listens() -> None:
    from numba.core import event

    class Outermost(event.Listener):
        """Hears where compilation of a kernel begins and ends, not that of what it calls, and tells who asked.

        Python collects no garbage meanwhile: it would look at a million live objects again and again, which was a
        fifth of the time of compilation.
        """

        _collecting = False

        def on_start(self, event: Any) -> None:
            """A kernel, or something inside of it."""
            if not UNDER_WAY:
                for each in LISTENING:
                    each.begins()
                self._collecting = gc.isenabled()
                gc.disable()
            UNDER_WAY.append(event)

        def on_end(self, event: Any) -> None:
            """A kernel, or something inside of it."""
            if not UNDER_WAY:  # it began before anybody listened
                return
            UNDER_WAY.pop()
            if not UNDER_WAY:
                if self._collecting:
                    gc.enable()
                for each in LISTENING:
                    each.ends()

    event.register("numba:compile", Outermost())
