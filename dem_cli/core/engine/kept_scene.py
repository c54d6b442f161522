"""Validation of a scene that was read from a checkpoint, before compiled loops work on it.

They follow numbers of blocks, joints, points and corners without a look at how many there are. So no number from a file
gets there that leads out of its array: rows are counted, numbers are held to what they count, and what stays the same
through a run is compared with what this run has built itself.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from dem_cli.core.kernels.fixed_joints import FixedJoints
from dem_cli.core.kernels.tiles.joint_tiles import NO_TILES, tiled
from dem_cli.core.records.likeness import alike

Simulation = Any  # that of simulation.py, which imports this file
_ROWS: dict[str, dict[str, str]] = {  # fields of records by how many rows they have; of those with "?" maybe none
    "MovingJoints": {
        "joints": "blocks law", "points": "frames levers points kn ks", "joints?": "held torsion integrated",
        "points?": "after fans faint back",
    },
    "FixedJoints": {
        "joints": "blocks law axes anchors arms", "points": "places kn ks", "joints?": "torsion integrated",
        "points?": "after fans faint back",
    },
    "PlanarGeometry": {"joints": "keys edges scales", "points": "features", "points?": "profile", "joints?": "sunk"},
    "SpatialGeometry": {
        "joints": "keys kinds corners areas", "points": "features", "joints?": "axes", "points?": "places gaps",
    },
    "SpatialMotion": {
        "joints": "keys kinds faces normals tangents markers apart scales edges rises slopes",
        "points": "features opened types corners shares spans arms", "ends": "cap_starts", "caps": "cap_arms cap_areas",
        "room": "found labels numbers taken heirs",
    },
    "Contacts": {"points": "gaps shear normal slip memory closure", "ends": "stale", "points?": "lumped"},
    "Dampers": {
        "joints": "viscosity lasts rooms awake met", "ends": "packed active",
        "points?": "rates gains holders slips states motions lifts",
    },
}  # fmt: skip
_NUMBERS: dict[str, dict[str, str]] = {  # fields by what their numbers are of; with "!" the number of all is one, too
    "MovingJoints": {"blocks": "blocks", "points": "after"},
    "FixedJoints": {"blocks": "blocks", "points": "after"},
    "PlanarGeometry": {"faces": "keys", "corners": "edges"},
    "SpatialGeometry": {"faces": "keys", "kinds": "kinds", "points!": "corners"},
    "SpatialMotion": {
        "parts": "keys", "kinds": "kinds types", "faces": "faces", "corners": "edges corners found",
        "points": "taken heirs",
    },
    "Dampers": {"points!": "packed lasts rooms holders", "joints!": "active awake", "kinds": "states"},
}  # fmt: skip
_NONE_IS_ONE = frozenset(("edges", "corners", "found", "taken", "heirs"))  # −1: none
_CONSTANT = ("face_starts", "face_corners", "part_starts", "part_edges", "part_sides")  # of SpatialMotion
_N_KINDS, _MOST_THREADS = 4, 4096


def guard_of(sim: Simulation) -> Callable[[Any], None]:
    """Return the check of a saved state: of `sim` itself, once a saved state is in it (None), or of one beside it.
    Raises ValueError: it is unfit."""
    before, bodies, links, chains = sim.tracking.arrays(), sim.bodies, sim.links, sim.tracking.chains
    dampers, in_tiles = getattr(sim, "dampers", None), sim.tiled
    shortest, longest = sim.settings.detection.shortest_call, sim.settings.detection.longest_call

    def check(saved: Any | None) -> None:
        one = saved or sim.tracking
        _check_rows(sim, before, one)
        _require(alike(bodies, getattr(one, "bodies", bodies)), "Bodies")
        if saved is not None:
            return
        _require(sim.tiled is in_tiles, "tiled")
        _require(shortest <= sim.longest <= max(shortest, longest) and sim.steps >= 0, "a call of the loop")
        _same(links, sim.links)
        _same(chains, sim.tracking.chains)
        if dampers is not None:
            kept = sim.dampers
            _check_record(dampers, kept, _counts(sim, sim.joints))
            _require(0 <= kept.first <= sim.contacts.memory.shape[1], "Dampers.first")

    return check


def _counts(sim: Simulation, joints: Any) -> dict[str, int]:
    """Count the joints, points, blocks, parts, faces and corners."""
    topology, n_points = sim.model.topology, int(joints.starts[-1])
    return {
        "joints": len(joints.blocks), "ends": len(joints.blocks) + 1, "points": n_points, "blocks": sim.model.n_blocks,
        "parts": sim.model.n_parts, "faces": topology.n_faces, "corners": len(sim.model.vertices), "kinds": _N_KINDS,
    }  # fmt: skip


def _check_rows(sim: Simulation, before: Any, one: Any) -> None:
    """Check joints, geometry and contacts of a state. before: those that this run has."""
    for name in before._fields:
        _require(alike(getattr(before, name), getattr(one, name), rows=True), name)
    joints, geometry = one.joints, one.geometry
    _check_starts(joints.starts, len(joints.blocks), len(joints.kn))
    counts = _counts(sim, joints)
    if isinstance(joints, FixedJoints):
        _same(before.joints._replace(tiles=joints.tiles), joints)
        _check_tiles(sim, joints)
    elif len(joints.held):
        touching, most = np.where(joints.held < 0, -1 - joints.held, joints.held), np.diff(joints.starts)
        _require(bool((touching <= most).all()), "MovingJoints.held")
    if type(geometry).__name__ == "SpatialMotion":
        counts["caps"] = int(geometry.cap_starts[-1])
        _check_starts(geometry.cap_starts, counts["joints"], counts["caps"])
        _same([getattr(before.geometry, name) for name in _CONSTANT], [getattr(geometry, name) for name in _CONSTANT])
        counts["room"], least = len(geometry.found), 2 * int(np.diff(joints.starts).max(initial=0)) + 2
        fits = geometry.work.shape[1] == counts["room"] >= least and len(geometry.work) == len(before.geometry.work)
        _require(fits, "room")
    for here, kept in zip(before, (joints, geometry, one.contacts), strict=True):
        _check_record(here, kept, counts)


def _check_record(here: Any, kept: Any, counts: Mapping[str, int]) -> None:
    name, rows = type(kept).__name__, set[str]()
    for count, fields in _ROWS[name].items():
        for field in fields.split():
            rows.add(field)
            n = len(getattr(kept, field))
            _require(n == counts[count.rstrip("?")] or (count.endswith("?") and n == 0), f"{name}.{field}")
    for field, array in here._asdict().items():
        if field not in rows | {"tiles", "work"}:
            _require(alike(array, getattr(kept, field)), f"{name}.{field}")
    for count, fields in _NUMBERS.get(name, {}).items():
        most = counts[count.rstrip("!")] + count.endswith("!")
        for field in fields.split():
            numbers, least = getattr(kept, field), -1 if field in _NONE_IS_ONE else 0
            _require(numbers.min(initial=0) >= least and numbers.max(initial=-1) < most, f"{name}.{field}")


def _check_starts(starts: np.ndarray, n: int, last: int) -> None:
    whole = starts.shape == (n + 1,) and starts[0] == 0 and starts[-1] == last
    _require(whole and bool((starts[1:] >= starts[:-1]).all()), "starts")


def _check_tiles(sim: Simulation, joints: FixedJoints) -> None:
    """Check that tiles belong to these joints, for as many threads as they are for."""
    threads, model, tiles = len(joints.tiles.controls), sim.model, joints.tiles
    _require(0 < threads <= _MOST_THREADS, "tiles")
    made = NO_TILES
    if sim.tiled:
        made = tiled(joints.blocks, joints.starts, model.n_blocks, model.dimension, sim.n_in_lanes, threads)
    layout = made._fields.index("ends")  # behind it is room, of which nothing is read before it is written
    _same(made[:layout], tiles[:layout])
    for name, room in made._asdict().items():
        _require(alike(room, getattr(tiles, name)), f"JointTiles.{name}")


def _same(here: Any, kept: Any) -> None:
    """Raises ValueError where records of arrays have not the whole numbers of the run, and as many others."""
    if isinstance(here, np.ndarray):
        whole = here.dtype.kind in "iu"
        _require(alike(here, kept) and not (whole and (here != kept).any()), "what stays the same")
    elif here is not None:
        _require(type(here) is type(kept) and len(here) == len(kept), "what stays the same")
        for a, b in zip(here, kept, strict=True):
            if isinstance(a, (np.ndarray, tuple)):
                _same(a, b)


def _require(fits: bool, what: str) -> None:
    if not fits:
        raise ValueError(f"{what} is not of this structure")
