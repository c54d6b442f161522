"""Structures of the study, by seed: every generator, in 2D and 3D, as drawn and with stones that are off."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from fuzzing.draw import Draw, Tables
from fuzzing.structures import IN_SPACE, STRUCTURES

from dem_cli.app import api
from dem_cli.core.model.model import Model
from dem_cli.errors import CaseError, UsageError
from studies import solution

ERROR = 3e-4  # of a stone, either way [m]
SIZES = (5, 60)  # free blocks
LOADS = (0.02, 5.0)  # bounds outside of this are drawn again: what falls at once, what nothing moves
MOST_TRIES = 200
LAID = ("wall", "column")  # generators whose blocks dem itself lays with [[imperfection]]
FIRST = 40_000  # no seed of another study or of the fuzzer
KINDS = [(kind, space) for space in (False, True) for kind in STRUCTURES if space or kind not in IN_SPACE]


def seeds(each: int = 2) -> range:
    """Return the seeds of `each` structures of every generator, in each dimension that it has."""
    return range(FIRST, FIRST + each * len(KINDS))


def structure(seed: int) -> tuple[Tables, int, float]:
    """Return the case of a seed, its number of free blocks and its bound; drawn again where dem refuses it, or where it
    does not stand.
    """
    for trial in range(MOST_TRIES):
        tables = drawn(seed, trial)
        try:
            loaded = solution.from_tables(tables)
            model = api.build_model(loaded)
            blocks = int((~model.fixed).sum())
            bound = bound_of(loaded, model) if SIZES[0] <= blocks <= SIZES[1] else None
            if bound is not None and LOADS[0] < bound < LOADS[1]:
                api.build_model(solution.from_tables(off(tables)))
                return tables, blocks, bound
        except (CaseError, UsageError):
            continue
    raise RuntimeError(f"seed {seed}: nothing that stands in {MOST_TRIES} tries")


def drawn(seed: int, trial: int) -> Tables:
    """Draw a structure of the generator of a seed, whether it can be built or not."""
    kind, space = KINDS[(seed - FIRST) % len(KINDS)]
    d = Draw(f"geometries {seed} {trial}")
    d.space = space
    table: Tables = {"kind": kind, "id": "s", "material": "stone", **STRUCTURES[kind](d)}
    table.pop("floors", None)  # their weights are no stones
    ways = [[sign, 0.0] for sign in (1.0, -1.0)]
    if space:
        ways = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.6, 0.8, 0.0]]
    return {
        "title": f"{seed}: {kind}",
        "seed": seed,
        **({"dimension": 3} if space else {}),
        "materials": {"stone": {"density": d.size(1600.0, 2800.0)}},
        "joints": {"dry": {"friction": d.size(0.35, 0.9)}},
        "structure": [table],
        "analysis": {"kind": "pushover", "pattern": d.choice(["mass"] * 4 + ["tilt"]), "direction": d.choice(ways)},
        "output": {"frames": 0},
    }


def bound_of(loaded: Any, model: Model) -> float | None:
    """Return the associated load of the initial geometry; None: there is none."""
    from dem_cli.core.engine.properties import joint_properties, law_of
    from dem_cli.core.limit.analysis import limit_loads
    from dem_cli.masonry.assembly.solver_request import solver_request

    request = solver_request(loaded.case)
    found = limit_loads(model, joint_properties(request, model), law_of(request), associated_only=True)
    return found.associated.upper


def off(tables: Tables, error: float = ERROR) -> Tables:
    """Return a structure with stones off by up to `error` [m]: laid again by dem, or each one too small."""
    if tables["structure"][0]["kind"] in LAID:
        return tables | {"imperfection": [{"structure": "s", "height": [-error, error]}]}
    model = api.build_model(solution.from_tables(tables))
    rng = np.random.default_rng(tables["seed"])
    blocks = list(smaller(model, error * rng.random(model.n_blocks)))
    return {key: value for key, value in tables.items() if key != "structure"} | {"block": blocks}


def smaller(model: Model, set_back: np.ndarray) -> Iterator[Tables]:
    """Return the blocks of a model as [[block]] tables; of free convex ones the farthest corner lies so far back [m],
    (n_blocks,).
    """
    for i, name in enumerate(model.block_ids):
        parts = np.flatnonzero(model.part_blocks == i)
        corners = [model.vertices[model.part_starts[p] : model.part_starts[p + 1]] for p in parts]
        whole = model.fixed[i] or len(parts) > 1  # a concave one would not stay within itself
        scale = 1.0 if whole else 1.0 - set_back[i] / float(np.linalg.norm(corners[0], axis=1).max())
        placed = [(model.centroids[i] + scale * part).tolist() for part in corners]
        more: Tables = {"fixed": True} if model.fixed[i] else {}
        if model.dimension == 2:
            more["thickness"] = float(model.thickness[i])
        shape: Tables = {"vertices": placed[0]} if len(placed) == 1 else {"parts": placed}
        yield {"id": name, "material": "stone", **shape, **more}
