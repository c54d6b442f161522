"""The failure load of joints that do not dilate: a path of elastic, frictional joints from gravity to collapse.

The displacement of the live load grows until its multiplier grows no more. Every point of the path is a
state in equilibrium under the real, non-associated law (limit.elastic), so that the plateau is a true
collapse state of the structure loaded from gravity, whatever the stiffness of its joints. The state is
that of the explicit solver (gaps, shear springs), which can go on from it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dem_cli.limit.elastic import Elastic, State
from dem_cli.limit.interior import Increment
from dem_cli.limit.matrices import Structure

OK = "ok"
FALLS = "does not stand under its dead loads"
UNFINISHED = "not converged: the load still grows with displacement"
FIRST = 0.25  # displacement of the first increment, in elastic ones at the multiplier 1
GROWTH = (2.0, 2.8, 4.0, 1.5, 1.2)  # of the displacement from increment to increment; the next where one fails
FURTHEST = 1e5  # displacement at which a structure counts as self-locking
PLATEAU = 1e-3  # relative growth of the load in one increment, twice in a row, that counts as none
TAU = 0.1  # of the first products, over the square of the largest normal force
ACCEPTED = 1e-2  # unbalanced force under the exact law, in own weights, of a state worth keeping


@dataclass
class Path:
    """The way to collapse, and its last state."""

    status: str  # OK, FALLS, UNFINISHED
    load: float | None = None  # multiplier of the live loads, as users know it
    residual: float = np.inf  # largest unbalanced force under the joint law, in own weights
    normal: np.ndarray | None = None  # [N], (n_points,)
    shear: np.ndarray | None = None  # on b along the tangent [N], (n_points, 1)
    gaps: np.ndarray | None = None  # opening of the points [m], (n_points,)
    displacements: np.ndarray | None = None  # since before gravity, (n_blocks, n_dof)
    mechanism: np.ndarray | None = None  # motion of the last increment; its live power is one, (n_blocks, n_dof)
    loads: list[float] = field(default_factory=list)  # multiplier after each increment
    reached: list[float] = field(default_factory=list)  # displacement, in elastic ones at the multiplier of one
    factorisations: int = 0

    def summary(self) -> dict[str, Any]:
        """What summary.json says of it."""
        return {
            "load": self.load,
            "status": self.status,
            "residual": self.residual if np.isfinite(self.residual) else None,
            "displacement": self.reached[-1] if self.reached else None,
            "factorisations": self.factorisations,
        }


def trace(
    structure: Structure,
    friction: np.ndarray,
    plateau: float = PLATEAU,
    stop: Callable[[], bool] = lambda: False,
    progress: Callable[[float, float], None] = lambda load, reached: None,
) -> Path:
    """From gravity to the plateau of the load, 2D.

    friction  coefficient of every point [-], (n_points,)
    plateau   relative growth of the load, from one increment to the next, that counts as none
    stop      asked at every factorisation; True ends the search with what there is
    progress  told the load and the displacement of every increment
    """
    problem = Elastic(structure, friction)
    path = Path(FALLS)
    state = _at_rest(problem)
    standing = _advance(problem, path, state, None, 1.0, stop)
    if standing is None:
        return path
    path.status, calm = UNFINISHED, 0
    origin = float(problem.live @ standing.displacements)
    elastic = _compliance(problem, standing)
    before, state, reached = state, standing, 0.0
    _keep(path, structure, problem, state, before, 0.0)
    while calm < 2 and reached < FURTHEST:
        for growth in GROWTH:
            further = reached * growth if reached else FIRST
            ahead = (further - reached) / reached if reached else 0.0
            found = _advance(problem, path, state, origin + elastic * further, ahead, stop)
            if stop() or (found is not None and problem.residual(found, state) < ACCEPTED):
                break
            found = None
        if found is None:
            break
        grown = abs(found.load - state.load) / max(abs(found.load), 1e-12)
        calm = calm + 1 if reached and grown < plateau else 0
        before, state, reached = state, found, further
        _keep(path, structure, problem, state, before, reached)
        progress(path.load, reached)
    if calm == 2:
        path.status = OK
    return path


def _at_rest(problem: Elastic) -> State:
    none = np.zeros(problem.n_points)
    return State(np.zeros(len(problem.columns)), 0.0, np.full(problem.n_points, 0.5), none, (none, none))


def _advance(
    problem: Elastic, path: Path, state: State, target: float | None, ahead: float, stop: Callable[[], bool]
) -> State | None:
    """The state at a displacement of the live load; without one, under dead loads alone."""
    largest = float(state.normal.max(initial=1.0)) if target is not None else float(np.abs(problem.dead).max())
    increment = Increment(problem, state, target)
    found = increment.solve(TAU * max(largest, 1.0) ** 2, ahead, stop)
    path.factorisations += increment.factorisations
    return found


def _compliance(problem: Elastic, state: State) -> float:
    """Displacement of the live load per unit of multiplier while all loaded joints are closed."""
    closed = state.normal > 1e-6 * state.normal.max(initial=1.0)
    share = np.where(closed, 1.0, 1e-6)
    lu = problem.factorised(share * problem.kn, share * problem.ks, np.zeros(problem.n_points))
    return float(problem.live @ lu.solve(problem.live))


def _keep(
    path: Path, structure: Structure, problem: Elastic, state: State, before: State, reached: float
) -> None:
    """The state into the path, in SI units."""
    path.load = state.load * problem.live_scale
    path.residual = problem.residual(state, before)
    path.normal, path.shear = state.normal * problem.weight, state.shear[:, None] * problem.weight
    gaps = problem.bn @ state.displacements
    closed = state.normal > problem.kn * (gaps + state.normal / problem.kn)
    path.gaps = np.where(closed, -state.normal / problem.kn, np.maximum(gaps, 0.0)) * problem.unit
    columns = problem.columns * problem.unit
    path.displacements = structure.on_blocks(state.displacements * columns)
    motion = (state.displacements - before.displacements) * columns
    power = float(structure.live @ motion)
    path.mechanism = structure.on_blocks(motion / power) if power > 0.0 else structure.on_blocks(0.0 * motion)
    path.loads.append(path.load)
    path.reached.append(reached)
