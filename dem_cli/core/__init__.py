"""Solvers: blocks, joints, loads and motion as arrays; without case files, without results on disk.

The door for people who have arrays; nothing is loaded before it is used. docs/core.md shows it.
"""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.functions import failure_load, joints, limit_load, shake
    from dem_cli.core.records.requests import DampingRequest
    from dem_cli.core.structure import Structure

__all__ = ["DampingRequest", "Simulation", "Structure", "failure_load", "joints", "limit_load", "shake"]

# Modules of dem_cli.core.
_HOMES = dict.fromkeys(("failure_load", "joints", "limit_load", "shake"), "functions") | {
    "DampingRequest": "records.requests",
    "Simulation": "engine.simulation",
    "Structure": "structure",
}


def __getattr__(name: str) -> object:
    """Import a public name when it is first used."""
    if name not in _HOMES:
        raise AttributeError(f"module 'dem_cli.core' has no attribute '{name}' (public: {', '.join(__all__)})")
    from importlib import import_module

    globals()[name] = found = getattr(import_module(f"dem_cli.core.{_HOMES[name]}"), name)
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
