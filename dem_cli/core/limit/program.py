"""Limit analysis as a linear or second-order cone program: in well-scaled numbers, solved by Clarabel, in newtons.

    max λ       so that   Gᵀ g + dead + λ live = 0,   g ∈ K     (G: motion along the amounts of the cones, limit.cone)
    min −dead·u so that   live·u = 1,   G u ∈ K                 (its dual: the mechanism)

K: g ≥ 0 in the plane, a linear program; in space round cones |(g₁, g₂)| ≤ g₀ of a frictional point, exactly.
Joints with cohesion, tension and crushing: dead has the forces of their tips (Cone.first), Σ share · g ≤ most of each
cap, and the dual pays for what yields there: min −dead·u + most·y so that G u + share y ∈ K, y ≥ 0. In space g and the
rate y are those of the leading amounts g₀.

The dual is what the solver gets: it has a third of the rows, and its multipliers are the forces. What makes it
quick and exact is its scaling: rows by the weight and radius of their own block, forces and velocities by √n;
only then do the absolute tolerances of a solver mean something (unscaled, walls of 2,275 blocks came out 0.1 %
too low with status "solved").
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import bmat, csc_matrix, csr_matrix, diags, identity, vstack

from dem_cli.core.laws.envelope import Envelope
from dem_cli.core.limit.cone import Cone, cone_of
from dem_cli.core.limit.matrices import LimitStructure
from dem_cli.core.limit.settings import DEFAULT_LIMIT, AssociatedSettings

ANSWERED, IMPOSSIBLE, UNBOUNDED, UNKNOWN = "answered", "impossible", "unbounded", "unknown"
KINDS = {
    "Solved": ANSWERED,
    "AlmostSolved": ANSWERED,
    "DualInfeasible": IMPOSSIBLE,
    "AlmostDualInfeasible": IMPOSSIBLE,
    "PrimalInfeasible": UNBOUNDED,
    "AlmostPrimalInfeasible": UNBOUNDED,
}


class Program(NamedTuple):
    """Cone program in newtons and metres, and the units in which it is solved."""

    structure: LimitStructure
    cone: Cone
    motion: csr_matrix  # G, (n_amounts, n_free)
    dead: np.ndarray  # dead loads of the free degrees of freedom, with the forces Cone.first [N, N m], (n_free,)
    n_blocks: int  # that can move
    weight: float  # mean weight [N]
    load: float  # multiplier that makes the live loads as large as the dead ones
    settings: AssociatedSettings

    def split(self, forces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """N and T of the contact points (n_points, d), and the axial forces of the links, (n_links,)."""
        n_points = len(forces) - len(self.structure.links.limits)
        return forces[:n_points], -forces[n_points:, 0]


class ProgramSolution(NamedTuple):
    """Solution of the cone program; where the solver says that something is impossible, its proof."""

    kind: str  # ANSWERED; IMPOSSIBLE: `velocities` are the proof; UNBOUNDED: `amounts` and `multiplier`; UNKNOWN
    amounts: np.ndarray  # of the members of the cone [N], (n_amounts,)
    multiplier: float  # of the live loads
    velocities: np.ndarray  # of the free degrees of freedom, in any unit, (n_free,)
    iterations: int
    said: str  # by the solver


def program_of(
    structure: LimitStructure, strength: Envelope, settings: AssociatedSettings = DEFAULT_LIMIT.associated
) -> Program:
    """Build the cone program of a structure with live loads; its links are points behind those of `strength`."""
    d, compatibility = structure.model.dimension, structure.compatibility
    if structure.links:
        more, bounds = structure.links.as_points(d)
        compatibility = vstack([compatibility, more]).tocsr()
        strength = Envelope(*(np.concatenate(both) for both in zip(strength, bounds, strict=True)))
    cone = cone_of(strength, d)
    n_blocks, (weight, load) = len(structure.free) // structure.n_dof, units(structure)
    motion, constant = cone.motion(compatibility), structure.dead
    if cone.first.any():
        constant = constant + compatibility.T @ cone.first.ravel()
    return Program(structure, cone, motion, constant, n_blocks, weight, load, settings)


def units(structure: LimitStructure) -> tuple[float, float]:
    """Mean weight of a block that can move [N], and the multiplier that makes live loads as large as the dead ones."""
    d, n_dof = structure.model.dimension, structure.n_dof
    forces = (loads.reshape(-1, n_dof)[:, :d] for loads in (structure.dead, structure.live))
    dead, live = (float(np.linalg.norm(loads, axis=1).sum()) for loads in forces)
    live = live or float(np.abs(structure.live).sum())  # moments alone
    return (dead or live) / (len(structure.free) // n_dof), (dead or live) / live


def largest_load(program: Program, options: dict[str, Any]) -> ProgramSolution:
    """Solve for the forces under the largest multiplier, and the mechanism that ends it."""
    return _solve(program, options, program.structure.live[None] * program.load)


def standing(program: Program, options: dict[str, Any]) -> ProgramSolution:
    """Find forces that carry the dead loads alone."""
    return _solve(program, options, np.zeros((0, len(program.structure.free))))


def factorised_by(program: Program) -> str:
    """Choose Clarabel's factorisation: by columns, equal on every processor, or the one for large programs.

    The other, faer, multiplies in the order that suits a processor.
    """
    return "qdldl" if len(program.structure.free) <= program.settings.by_columns else "faer"


def _solve(program: Program, options: dict[str, Any], live: np.ndarray) -> ProgramSolution:
    """Solve the dual in Clarabel's form, min q·x, A x + s = b: x velocities, s = power of live loads, then s = G x
    ∈ K.

    The multipliers of these rows are −λ and the amounts. Behind the velocities are the rates of the caps, behind these
    rows that they are not negative.
    """
    import clarabel

    s, cone, spread = program.structure, program.cone, np.sqrt(program.n_blocks)
    columns = diags(1.0 / s.scales)
    a = vstack([csr_matrix(live) @ columns, program.motion @ columns * -program.weight]).tocsc()
    q = -program.dead / s.scales / spread
    if len(cone.most):
        a = _with_caps(a, cone, len(live))
        q = np.concatenate([q, cone.most / program.weight / spread])
    b = np.zeros(a.shape[0])
    b[: len(live)] = spread
    curved = cone.n_round * cone.dimension
    cones = [clarabel.ZeroConeT(len(live)), *[clarabel.SecondOrderConeT(cone.dimension)] * cone.n_round,
             clarabel.NonnegativeConeT(a.shape[0] - len(live) - curved)]  # fmt: skip
    chosen = clarabel.DefaultSettings()
    chosen.verbose, chosen.max_threads = False, 1
    chosen.direct_solve_method = factorised_by(program)
    for name, value in ({"tol_feas": program.settings.feasible / spread} | options).items():
        setattr(chosen, name, value)
    answer = clarabel.DefaultSolver(csc_matrix((len(q), len(q))), q, a, b, cones, chosen).solve()
    x, z = np.array(answer.x)[: len(s.scales)], np.array(answer.z) * spread
    said = str(answer.status)
    return ProgramSolution(
        KINDS.get(said, UNKNOWN),
        z[len(live) : len(live) + len(cone.points)] * program.weight,
        float(-z[: len(live)].sum()) * program.load,
        x / s.scales,
        int(answer.iterations),
        said,
    )


def _with_caps(a: csc_matrix, cone: Cone, before: int) -> csc_matrix:
    """Add the rates of the caps to the rows of velocities, of which the amounts come after `before` others."""
    n_caps, capped = len(cone.most), np.flatnonzero(cone.cap >= 0)
    rows = before + cone.leading[capped]
    rates = csr_matrix((-cone.share[capped], (rows, cone.cap[capped])), (a.shape[0], n_caps))
    return bmat([[a, rates], [None, -identity(n_caps)]]).tocsc()
