"""dem: how much earthquake can a dry-stone wall, arch or column take?

In Python: `run` solves a case, `load` reads one, `open` reads results; docs/python.md says more. Nothing is loaded
before it is used.
"""

from dem_cli.version import __version__

__all__ = ["Result", "__version__", "load", "open", "run"]

TYPE_CHECKING = False  # type checkers take it as true; typing itself costs milliseconds
if TYPE_CHECKING:
    from dem_cli.app.public.functions import load, open, run
    from dem_cli.app.public.result import Result

# Modules of dem_cli.app.public.
_HOMES = {"run": "functions", "load": "functions", "open": "functions", "Result": "result"}


def __getattr__(name: str) -> object:
    """Import a public name of the package when it is first used."""
    if name not in _HOMES:
        raise AttributeError(f"module 'dem_cli' has no attribute '{name}' (public: {', '.join(__all__)})")
    from importlib import import_module

    globals()[name] = found = getattr(import_module(f"dem_cli.app.public.{_HOMES[name]}"), name)
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
