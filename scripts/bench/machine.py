"""Description of the machine, as far as it explains the figures; nothing that says whose it is."""

from __future__ import annotations

import os
import platform
from importlib import metadata
from pathlib import Path
from typing import Any

THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS", "NUMBA_NUM_THREADS")
PACKAGES = ("numpy", "numba", "scipy", "clarabel", "pymunk", "Box2D", "mujoco-core", "compas_cra")


def one_thread() -> None:
    """Keep numerical libraries to one core; to be called before any of them is imported."""
    for name in THREADS:
        os.environ[name] = "1"


def describe() -> dict[str, Any]:
    """Cores, processor, versions, load."""
    from dem_cli.version import __version__

    found: dict[str, Any] = {"cores": os.cpu_count(), "processor": processor(), "system": platform.system()}
    found["load"] = round(os.getloadavg()[0], 2) if hasattr(os, "getloadavg") else None
    found |= {"dem": __version__, "python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            found[name] = None
    return found


def processor() -> str:
    """Model of the processor where the system tells, else its architecture."""
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return f"{line.split(':', 1)[1].strip()} ({platform.machine()})"
    except OSError:
        pass
    return platform.processor() or platform.machine()


def sentence(machine: dict[str, Any]) -> str:
    """The machine in one line."""
    load = machine.get("load")
    words = [f"{machine['cores']} cores", str(machine["processor"]), str(machine["system"])]
    words += [f"{name} {machine[name]}" for name in ("dem", "python", *PACKAGES) if machine.get(name)]
    return ", ".join(words) + (f"; load {load:g} when it began" if load is not None else "")
