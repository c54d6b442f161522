"""Generator of random structures: from a seed to the tables of a case with 4 to 150 blocks, materials, joints, loads.

What it draws is realistic in size and may stand or fall; a structure that carries nothing at all, or whatever is asked
of it, is drawn again, but for a few. The same seed gives the same tables.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from studies.stress.random_structures import frames, walls
from studies.stress.random_structures.admissible import LoadedBodies, associated_load
from studies.stress.random_structures.walls import Blocks, Rng

Tables = dict[str, Any]

KINDS: dict[str, tuple[float, Callable[[Rng], Any]]] = {  # how often, how
    "coursed wall": (0.15, walls.coursed),
    "bonded wall": (0.08, walls.bonded),
    "stepped wall": (0.09, walls.stepped),
    "propped wall": (0.06, walls.propped),
    "wall and buttress": (0.12, walls.side_by_side),
    "rubble wall": (0.12, walls.rubble),
    "arch": (0.14, frames.arch),
    "arcade": (0.10, frames.arcade),
    "columns": (0.06, frames.drums),
    "colonnade": (0.08, frames.colonnade),
}
GENERATED = ("arch", "bonded wall")  # as a [[structure]]
SIZES = (4, 150)  # free blocks
LOADS = (0.01, 20.0)  # associated loads outside of it are drawn again, but for a share
AS_IT_COMES = 0.03  # of structures: kept even if they fall or are held fast
MOST_TRIES = 60


def structure(seed: int) -> Tables:
    """The case of a seed; its title says what it is."""
    for trial in range(MOST_TRIES):
        rng = np.random.default_rng([seed, trial])
        tables = drawn(rng)
        bodies = LoadedBodies.of(tables)
        if not SIZES[0] <= int((~bodies.fixed).sum()) <= SIZES[1]:
            continue
        load = associated_load(bodies)
        if LOADS[0] < load < LOADS[1] or rng.random() < AS_IT_COMES:
            return tables | {"title": f"{seed}: {tables['title']}"}
    raise RuntimeError(f"seed {seed}: nothing that stands in {MOST_TRIES} tries")


def drawn(rng: Rng) -> Tables:
    """Any structure, whether it stands or not."""
    names = list(KINDS)
    kind = str(rng.choice(names, p=[KINDS[name][0] for name in names]))
    tables: Tables = {
        "title": kind,
        "materials": {"stone": {"density": round(rng.uniform(1600.0, 2800.0))}},
        "joints": {"dry": {"friction": round(rng.uniform(0.2, 1.2), 3)}},
    }
    add(tables, KINDS[kind][1](rng), 0.0, "")
    if rng.random() < 0.2:
        bystander = str(rng.choice([name for name in names if name not in GENERATED]))
        right = max(x for block in LoadedBodies.of(tables).polygons for x in block[:, 0])
        blocks = KINDS[bystander][1](rng)
        left = min(x for block in blocks for x, _ in block["vertices"])
        add(tables, blocks, right - left + rng.uniform(0.5, 10.0), "other-")
        tables["title"] += f" beside {bystander}"
    second_material(rng, tables)
    loaded(rng, tables)
    return tables


def add(tables: Tables, made: Blocks | Tables, shift: float, prefix: str) -> None:
    """Blocks, or a [[structure]], to the tables of a case."""
    if isinstance(made, dict):
        tables.setdefault("structure", []).append(made)
        return
    moved = [
        block | {"id": prefix + block["id"], "vertices": [[x + shift, y] for x, y in block["vertices"]]}
        for block in made
    ]
    tables.setdefault("block", []).extend({"material": "stone", **block} for block in moved)


def second_material(rng: Rng, tables: Tables) -> None:
    """Some blocks drawn by hand of another density and, for some, with another friction against stone."""
    if rng.random() < 0.65 or "block" not in tables:
        return
    tables["materials"]["other"] = {"density": round(rng.uniform(500.0, 3000.0))}
    share = rng.uniform(0.1, 0.5)
    for block in tables["block"]:
        if rng.random() < share:
            block["material"] = "other"
    if rng.random() < 0.6:
        tables["joints"]["second"] = {"friction": round(rng.uniform(0.2, 1.2), 3)}
        tables["interface"] = [{"between": ["stone", "other"], "joint": "second"}]


def loaded(rng: Rng, tables: Tables) -> None:
    """Direction and pattern of the live loads, dead point loads on tops and faces of blocks."""
    pattern = str(rng.choice(["mass", "tilt", "live"], p=[0.65, 0.15, 0.2]))
    sign = float(rng.choice([-1.0, 1.0]))
    tables["analysis"] = {"kind": "pushover", "pattern": pattern, "direction": [sign, 0.0]}
    bodies = LoadedBodies.of(tables)
    tops = candidates(bodies)
    weight = float(bodies.weights[~bodies.fixed].mean())
    loads = []
    if pattern != "tilt" and rng.random() < 0.35:
        for i in rng.choice(tops, size=min(len(tops), int(rng.integers(1, 4))), replace=False):
            force = [0.0, -weight * rng.uniform(0.5, 10.0)]
            loads.append({"block": bodies.names[i], "force": force, "at": bodies.inside(i, rng)})
    if pattern == "live":
        every = np.flatnonzero(~bodies.fixed)
        chosen = rng.choice(every, size=min(len(every), int(rng.integers(1, 4))), replace=False)
        total = 0.3 * weight * np.sqrt(len(every)) / len(chosen)
        for i in chosen:
            turn = np.radians(rng.uniform(-20.0, 20.0))
            force = [sign * total * np.cos(turn), total * np.sin(turn)]
            loads.append({"block": bodies.names[i], "force": force, "at": bodies.inside(i, rng), "kind": "live"})
    if loads:
        tables["load"] = [{**load, "force": [float(value) for value in load["force"]]} for load in loads]


def candidates(bodies: LoadedBodies) -> np.ndarray:
    """Free blocks in the upper half of the structure."""
    low, high = bodies.centroids[:, 1].min(), bodies.centroids[:, 1].max()
    return np.flatnonzero(~bodies.fixed & (bodies.centroids[:, 1] >= 0.5 * (low + high)))
