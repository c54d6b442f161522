"""Late modules and rare collections: what a process of this program saves of its start, a fifth of a short run.

Libraries name parts of others that they never use here, and what is named is loaded: scipy all of numpy, with its
Fortran wrapper generator and its tests. And Python would look for garbage among all that is loaded again and again.
"""

from __future__ import annotations

import gc
import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import LazyLoader
from types import ModuleType

LATE = frozenset((
    "importlib.metadata._adapters",  # of what packages say of themselves; with it comes e-mail
    "numpy._core._add_newdocs",  # docstrings that nobody reads here
    "numpy._core._add_newdocs_scalars",
    "numpy.f2py",
    "numpy.polynomial",
    "numpy.testing",
))  # fmt: skip
SELDOM = (200_000, 10, 10)  # objects between two collections, and collections between two of older ones


class LateModules:
    """Finder of modules that are loaded when something in them is first asked for."""

    def find_spec(self, name: str, path: Sequence[str] | None, target: ModuleType | None = None) -> ModuleSpec | None:
        """Of a module that may wait."""
        spec = PathFinder.find_spec(name, path, target) if name in LATE else None
        if spec is not None and spec.loader is not None:
            spec.loader = LazyLoader(spec.loader)
        return spec


def start_lightly() -> None:
    """For a process that is this program's own; once, before it imports much."""
    if not any(isinstance(finder, LateModules) for finder in sys.meta_path):
        sys.meta_path.insert(0, LateModules())
        gc.set_threshold(*SELDOM)
