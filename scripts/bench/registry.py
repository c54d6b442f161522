"""All groups of benchmarks.

A group is a module of this package with the same name that has

    measure(options) -> Found         times and answers
    page(records) -> list[str]        its lines of docs/benchmarks.md, from the records alone
    PICTURES: {suffix: draw}          draw(records, path) for benchmarks_SUFFIX.png
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

GROUPS = {  # name -> title, in the order of the page
    "kernels": "Cost of a step",
    "joints": "Cost of joint models",
    "precision": "Work against precision",
    "time_histories": "Time histories",
    "growth": "Growth with size",
    "threads": "Growth with threads",
    "sweeps": "Sweeps",
    "features": "Cost of features",
    "others": "Beside pymunk and Box2D",
    "spatial": "Growth with size in space",
    "peers": "Beside MuJoCo and compas_cra, in space",
    "startup": "From shell to shell",
}
PLACES = {"spatial": "spatial.sizes", "peers": "spatial.peers"}  # where a group is no module of its name


def module(name: str) -> Any:
    """The module of a group, imported when it is used."""
    return import_module(f"bench.{PLACES.get(name, name)}")
