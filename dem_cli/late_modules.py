"""Delayed import of modules and rare garbage collection, which save a quarter of the start of a short run.

Libraries name parts of others that they never use here, and what is named is loaded: scipy all of numpy, with its
Fortran wrapper generator and its tests. And Python would look for garbage among all that is loaded again and again.
"""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable, Sequence
from importlib.machinery import ModuleSpec, PathFinder
from threading import RLock
from types import ModuleType
from typing import Any


def nothing_masked(_: Any) -> bool:
    """Answer for `numpy.ma` while it is not loaded that an array is not masked; unique and median ask."""
    return False


class AnyArray:
    """Substitute for `NDArray` of numpy's type hints that avoids importing numpy.typing."""

    def __class_getitem__(cls, scalar: Any) -> Any:
        """Return the type of arrays of these numbers."""
        from numpy._core.multiarray import dtype, ndarray

        return ndarray[tuple[Any, ...], dtype[scalar]]


HINTS = {"ArrayLike": Any, "DTypeLike": Any, "NDArray": AnyArray}  # what people write beside arguments
LATE: dict[str, dict[str, Any]] = {  # what each answers for as it is not loaded
    "difflib": {},  # the nearest name, of those that are wrong
    "hashlib": {},
    "importlib.metadata": {},
    "importlib.metadata._adapters": {},  # of what packages say of themselves; with it comes e-mail
    "numpy._core._add_newdocs": {},  # docstrings that nobody reads here
    "numpy._core._add_newdocs_scalars": {},
    "numpy._typing": HINTS,
    "numpy.ctypeslib": {},
    "numpy.f2py": {},
    "numpy.ma": {"isMaskedArray": nothing_masked, "is_masked": nothing_masked},
    "numpy.polynomial": {},
    "numpy.testing": {},
    "numpy.typing": HINTS,
    "pickle": {},
    "pydantic.plugin._loader": {"get_plugins": tuple},  # none: dem_cli/app/cli/main.py; it reads all that is installed
    "pydoc": {},
    "secrets": {},
    "tempfile": {},
    "zipfile": {},
}
SELDOM = (200_000, 10, 10)  # objects between two collections, and collections between two of older ones


class LateLoader:
    """Module loader that delays loading until an unknown name is used."""

    def __init__(self, spec: ModuleSpec, known: dict[str, Any]) -> None:
        assert spec.loader is not None
        self.loader, self.known, self.lock, self.begun = spec.loader, known, RLock(), False

    def __getattr__(self, name: str) -> Any:
        """Forward attributes of loaders, such as the source, to the module's own loader."""
        return getattr(self.loader, name)

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        """Create the module with its own loader."""
        return self.loader.create_module(spec)

    def exec_module(self, module: ModuleType) -> None:
        """Fill the module with its known names and a hook that loads the rest."""
        module.__dict__.update(self.known, __getattr__=self._rest_of(module))

    def _rest_of(self, module: ModuleType) -> Callable[[str], Any]:
        def found(name: str) -> Any:
            if name == "__path__":  # which each import asks for: who has none is no package
                raise AttributeError(name)
            self.load(module)
            if name in module.__dict__:
                return module.__dict__[name]
            own = module.__dict__["__getattr__"]
            if own is not found:
                return own(name)
            raise AttributeError(f"module {module.__name__!r} has no attribute {name!r}")

        return found

    def load(self, module: ModuleType) -> None:
        """Load the module once; other threads wait, and imports from within see what is there already."""
        with self.lock:
            if not self.begun:
                self._load(module)

    def _load(self, module: ModuleType) -> None:
        before = dict(module.__dict__)
        self.begun = True
        try:
            self.loader.exec_module(module)
        except BaseException:  # as if nobody had asked
            self.begun = False
            module.__dict__.clear()
            module.__dict__.update(before)
            raise


class LoadedModule:
    """Loader of a module that the import of its package has already loaded."""

    def __init__(self, module: ModuleType) -> None:
        self.module, self.spec = module, module.__spec__

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Return the loaded module."""
        return self.module

    def exec_module(self, module: ModuleType) -> None:
        """Leave the loaded module as it is."""
        module.__spec__ = self.spec


class LateModules:
    """Import finder of modules that are loaded on first use."""

    def find_spec(self, name: str, path: Sequence[str] | None, target: ModuleType | None = None) -> ModuleSpec | None:
        """Find a module that may be loaded late, or whose package was delayed until now."""
        package = sys.modules.get(name.rpartition(".")[0])
        late = package and package.__spec__ and package.__spec__.loader
        if package is not None and isinstance(late, LateLoader):
            late.load(package)
            if name in sys.modules:
                there: Any = LoadedModule(sys.modules[name])  # no Loader by descent: importlib.abc takes time to load
                return ModuleSpec(name, there)
        spec = PathFinder.find_spec(name, path, target) if name in LATE else None
        if spec is not None and spec.loader is not None:
            loader: Any = LateLoader(spec, LATE[name])
            spec.loader = loader
        return spec


def start_lightly() -> None:
    """Enable delayed imports in a process of this program, once, before it imports much."""
    if not any(isinstance(finder, LateModules) for finder in sys.meta_path):
        sys.meta_path.insert(0, LateModules())
        gc.set_threshold(*SELDOM)
