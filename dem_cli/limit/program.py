"""Limit analysis as a linear program: posed in well-scaled numbers, solved by Clarabel, answered in newtons.

    max λ   so that   Gᵀ g + dead + λ live = 0,   g ≥ 0        G: motion of the cone generators (limit.cone)

What makes it quick and exact is its scaling: rows by the weight and radius of their own block, forces by √n
mean weights, the objective by n, so that the velocities of the mechanism are of the order of one; only then do
the absolute tolerances of a solver mean something.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csc_matrix, csr_matrix, diags, hstack, identity, vstack

from dem_cli.limit.cone import Cone
from dem_cli.limit.matrices import Structure

ANSWERED, IMPOSSIBLE, UNBOUNDED, UNKNOWN = "answered", "impossible", "unbounded", "unknown"
FEASIBLE = 5e-7  # unbalanced force in own weights at which the solver may stop
KINDS = {
    "Solved": ANSWERED,
    "AlmostSolved": ANSWERED,
    "PrimalInfeasible": IMPOSSIBLE,
    "AlmostPrimalInfeasible": IMPOSSIBLE,
    "DualInfeasible": UNBOUNDED,
    "AlmostDualInfeasible": UNBOUNDED,
}


class Program(NamedTuple):
    """The linear program in newtons and metres, and the units in which it is solved."""

    structure: Structure
    cone: Cone
    motion: csr_matrix  # G, (n_generators, n_free)
    n_blocks: int  # that can move
    weight: float  # mean weight [N]
    load: float  # multiplier that makes the live loads as large as the dead ones


class Found(NamedTuple):
    """What the solver came up with; where it says that something is impossible, its proof."""

    kind: str  # ANSWERED; IMPOSSIBLE: `velocities` are the proof; UNBOUNDED: `amounts` and `multiplier`; UNKNOWN
    amounts: np.ndarray  # of the generators [N], (n_generators,)
    multiplier: float  # of the live loads
    velocities: np.ndarray  # of the free degrees of freedom, in any unit, (n_free,)
    iterations: int
    said: str  # by the solver


def program_of(structure: Structure, cone: Cone) -> Program:
    """The linear program of a structure with live loads."""
    d, n_dof = structure.model.dimension, structure.n_dof
    forces = (loads.reshape(-1, n_dof)[:, :d] for loads in (structure.dead, structure.live))
    dead, live = (float(np.linalg.norm(loads, axis=1).sum()) for loads in forces)
    live = live or float(np.abs(structure.live).sum())  # moments alone
    n_blocks = len(structure.free) // n_dof
    weight = (dead or live) / n_blocks
    return Program(structure, cone, cone.motion(structure.compatibility), n_blocks, weight, (dead or live) / live)


def largest_load(program: Program, settings: dict[str, Any]) -> Found:
    """Forces under the largest multiplier, and the mechanism that ends it."""
    return _solve(program, settings, program.structure.live[:, None] * program.load, [-float(program.n_blocks)])


def standing(program: Program, settings: dict[str, Any]) -> Found:
    """Some forces that carry the dead loads alone."""
    return _solve(program, settings, np.zeros((len(program.structure.free), 0)), [])


def _solve(program: Program, settings: dict[str, Any], live: np.ndarray, objective: list[float]) -> Found:
    """Clarabel's form: min q·x, A x + s = b, s = 0 in the rows of equilibrium and s = g ≥ 0 below; x = (g, λ)."""
    import clarabel

    s, spread = program.structure, np.sqrt(program.n_blocks)
    n_rows, n = len(s.free), program.motion.shape[0]
    rows = diags(1.0 / s.scales)
    a = vstack(
        [
            hstack([rows @ program.motion.T * program.weight, rows @ csc_matrix(live)]),
            hstack([-identity(n), csc_matrix((n, live.shape[1]))]),
        ]
    )
    b = np.concatenate([-s.dead / s.scales / spread, np.zeros(n)])
    q = np.concatenate([np.zeros(n), objective])
    cones = [clarabel.ZeroConeT(n_rows), clarabel.NonnegativeConeT(n)]
    chosen = clarabel.DefaultSettings()
    chosen.verbose, chosen.max_threads = False, 1
    for name, value in ({"tol_feas": FEASIBLE / spread} | settings).items():
        setattr(chosen, name, value)
    answer = clarabel.DefaultSolver(csc_matrix((len(q), len(q))), q, a.tocsc(), b, cones, chosen).solve()
    x, z = np.array(answer.x), np.array(answer.z)
    said = str(answer.status)
    return Found(
        KINDS.get(said, UNKNOWN),
        x[:n] * program.weight * spread,
        float(x[n]) * spread * program.load if objective else 0.0,
        z[:n_rows] / s.scales,
        int(answer.iterations),
        said,
    )
