"""Associated failure load of rigid blocks: the largest load in equilibrium with forces that the joints can carry.

Static theorem (Livesley 1978). Its dual is the mechanism of least work in which sliding joints also dilate by
μ times the slip; where friction acts the load is therefore an upper bound of that of real, non-dilating joints. Where
shear strength does not depend on the normal force (μ = 0, cohesion alone: Livesley's first case) it is the load itself.

Clarabel finds it; of large structures in the plane an interior point on fronts does (limit/frontal_program.py), where
that comes to an end. The solver's word is not taken: residuals, bounds and proofs of impossibility are computed here,
on unscaled data, from the forces and velocities that it returns; what does not pass is "not converged".
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.laws.envelope import Envelope
from dem_cli.core.limit.matrices import LimitStructure
from dem_cli.core.limit.program import (
    ANSWERED,
    IMPOSSIBLE,
    UNBOUNDED,
    Program,
    ProgramSolution,
    largest_load,
    program_of,
    standing,
)
from dem_cli.core.limit.settings import DEFAULT_LIMIT, AssociatedSettings
from dem_cli.core.records.statuses import FALLS
from dem_cli.errors import UsageError
from dem_cli.interrupts import look

OK = "ok"
LOCKED = "no load of this direction makes it fail"
GIVEN_UP = "not converged"

# Settings of the solver, tried in turn until the answer passes: quick, then careful.
TRIES: tuple[dict[str, Any], ...] = (
    {
        "equilibrate_enable": False, "tol_gap_abs": 1e-7, "tol_gap_rel": 1e-7,
        "iterative_refinement_reltol": 1e-9, "iterative_refinement_abstol": 1e-9,
    },
    {
        "equilibrate_enable": True, "equilibrate_min_scaling": 1e-9, "equilibrate_max_scaling": 1e9,
        "equilibrate_max_iter": 30, "tol_feas": 1e-11, "tol_gap_abs": 1e-9, "tol_gap_rel": 1e-9,
    },
)  # fmt: skip


NO_LINKS = np.zeros(0)


class LimitLoad(NamedTuple):
    """Associated failure load with its forces, mechanism and the errors that say whether to trust it."""

    status: str  # OK, FALLS, LOCKED, or GIVEN_UP with the reason
    multiplier: float | None  # of the live loads, as users know it; None where there is none
    lower: float | None  # the multiplier in equilibrium, less the power of the residual in the mechanism
    upper: float | None  # the work of the mechanism, plus that of its violations against the computed forces
    residual: float  # largest unbalanced force, in own weights (moments: × radius); without a load, error of the proof
    normal: np.ndarray  # normal force of each point, compression positive [N], (n_points,)
    shear: np.ndarray  # shear force on b along the tangent [N], (n_points, d − 1)
    velocities: np.ndarray  # mechanism; its live power is one, (n_blocks, n_dof)
    gap: float | None  # distance of the bounds, relative to the load
    iterations: int  # of the solver
    links: np.ndarray = NO_LINKS  # axial forces of the links, tension positive [N], (n_links,)


def slides(
    structure: LimitStructure,
    friction: np.ndarray,
    found: LimitLoad,
    settings: AssociatedSettings = DEFAULT_LIMIT.associated,
) -> bool:
    """Test whether friction dissipates work in the mechanism of a failure load; otherwise its joints only rock
    open.

    friction: coefficient of every point [-], (n_points,)
    """
    taken = float(work_of_friction(structure, friction, found).sum())
    return found.upper is None or bool(taken > settings.slides * abs(found.upper))


def sliding_share(
    friction: np.ndarray, found: LimitLoad, settings: AssociatedSettings = DEFAULT_LIMIT.associated
) -> float:
    """Bound the work of friction in any mechanism of a failure load, over the load; infinite where no bound is
    known.

    In a mechanism whose work is the load the forces r that were found do no more than their gap: Σ r·w ≤ gap. Inside
    the cone, where slip s opens by μ s at least, r·w ≥ (μN − |T|) s, so that friction takes μN s ≤ gap μN/(μN − |T|):
    where no point that carries anything is at the edge of its cone, no mechanism slides. That is more than `slides`
    says, which looks at one mechanism.

    friction: coefficient of every point [-], (n_points,)
    """
    if found.gap is None or not len(found.normal):
        return float("inf")
    carries = (friction > 0.0) & (found.normal > settings.carries * float(found.normal.max()))
    limit, shear = (friction * found.normal)[carries], np.linalg.norm(found.shear[carries], axis=1)
    left = (limit - shear) / limit
    least = float(left.min(initial=1.0))
    return max(found.gap, settings.least_gap) / least if least > 0.0 else float("inf")


def work_of_friction(structure: LimitStructure, friction: np.ndarray, found: LimitLoad) -> np.ndarray:
    """Compute the work that friction dissipates at every point in the mechanism of a failure load [N m],
    (n_points,)."""
    motion = structure.compatibility @ found.velocities.ravel()[structure.free]
    slips = np.linalg.norm(motion.reshape(-1, structure.model.dimension)[:, 1:], axis=1)
    return friction * found.normal * slips


def associated_limit(
    structure: LimitStructure, strength: Envelope, settings: AssociatedSettings = DEFAULT_LIMIT.associated
) -> LimitLoad:
    """Compute the largest multiplier of the live loads that the structure carries with associated flow.

    strength: of every point, see limit.cone.envelope_of.
    Status and forces tell apart: fails at a multiplier; does not stand without live load; never fails; not
    converged. Raises UsageError where no live load acts on a block that can move.
    """
    if not np.abs(structure.live).max(initial=0.0) > 0.0:
        raise UsageError("limit analysis needs live loads on blocks that can move, and there are none")
    program = program_of(structure, strength, settings)
    found = _first_good(program, largest_load, _judge_load)
    if found.status not in (OK, LOCKED):
        return found
    stands = _first_good(program, standing, _judge_standing)
    found = found._replace(iterations=found.iterations + stands.iterations)
    return found if stands.status == OK else stands._replace(iterations=found.iterations)


def carried(
    structure: LimitStructure, strength: Envelope, settings: AssociatedSettings = DEFAULT_LIMIT.associated
) -> tuple[bool | None, float]:
    """Test whether any forces inside the envelope carry the dead loads; returns also the error of the proof; None:
    unknown.

    strength: as in associated_limit. False is a proof that nothing of this kind stands; True does not prove that it
    does: joints that do not dilate may fail all the same.
    """
    answer = _first_good(program_of(structure, strength, settings), standing, _judge_standing)
    return {OK: True, FALLS: False}.get(answer.status), answer.residual


def _first_good(
    program: Program,
    solve: Callable[[Program, dict[str, Any]], ProgramSolution],
    judge: Callable[[Program, ProgramSolution], LimitLoad],
) -> LimitLoad:
    """Return the first solver's answer that passes its check; where none does, the last."""
    iterations = 0
    for found in _answers(program, solve):
        look()
        iterations += found.iterations
        judged = judge(program, found)._replace(iterations=iterations)
        if not judged.status.startswith(GIVEN_UP):
            break
    return judged


def _answers(
    program: Program, solve: Callable[[Program, dict[str, Any]], ProgramSolution]
) -> Iterator[ProgramSolution]:
    """Solve by one solver after the other, each only when its answer is needed."""
    if len(program.structure.free) >= program.settings.on_fronts:
        from dem_cli.core.limit.frontal_program import is_linear, solved_on_fronts

        if is_linear(program):
            yield solved_on_fronts(program, loaded=solve is largest_load)
    for options in TRIES:
        yield solve(program, options)


def _judge_load(program: Program, found: ProgramSolution) -> LimitLoad:
    """Judge a solution: the largest load, a proof that there is none, or neither."""
    if found.kind == UNBOUNDED:
        return _refusal(program, *_locked(program, found))
    if found.kind == IMPOSSIBLE:
        return _refusal(program, *_falls(program, found))
    s = program.structure
    amounts = program.cone.admissible(found.amounts)
    forces, axial = program.split(program.cone.forces(amounts))
    imbalance = s.imbalance(forces.ravel(), found.multiplier, axial)
    power = float(product(s.live, found.velocities))
    if not (np.isfinite(imbalance).all() and power > 0.0):
        return _refusal(program, f"{GIVEN_UP}: the solver says {found.said}")
    velocities = found.velocities / power
    residual = float(np.abs(imbalance).max())
    lower = found.multiplier - float(product(np.abs(imbalance) * s.scales, np.abs(velocities)))
    upper = _work(program, velocities, amounts) - float(product(program.dead, velocities))
    settings = program.settings
    gap = (upper - lower) / max(abs(found.multiplier), settings.nothing * program.load)
    normal, shear = forces[:, 0].copy(), forces[:, 1:].copy()
    made = LimitLoad(
        OK, found.multiplier, lower, upper, residual, normal, shear, s.on_blocks(velocities), gap, 0, axial
    )
    if residual <= settings.residual and -settings.residual <= gap <= settings.gap:
        return made
    reason = f"{GIVEN_UP}: residual {residual:.1e} of own weights, bounds {gap:.1e} apart ({found.said})"
    return made._replace(status=reason)


def _judge_standing(program: Program, found: ProgramSolution) -> LimitLoad:
    """Judge whether the dead loads are in equilibrium with forces that the joints can carry."""
    if found.kind == IMPOSSIBLE:
        return _refusal(program, *_falls(program, found))
    forces, axial = program.split(program.cone.forces(program.cone.admissible(found.amounts)))
    imbalance = program.structure.imbalance(forces.ravel(), 0.0, axial)
    residual = float(np.abs(imbalance).max(initial=0.0))
    if found.kind == ANSWERED and residual <= program.settings.residual:
        return _refusal(program, OK, residual)
    return _refusal(program, f"{GIVEN_UP}: cannot tell whether it stands under its dead loads", residual)


def _falls(program: Program, found: ProgramSolution) -> tuple[str, float]:
    """Prove by a mechanism without resistance, driven by the dead loads, that nothing stands: status and error.

    Error: power of all dead loads together, as a contact force, against the largest violation; over dead power.
    """
    velocities, cone = found.velocities, program.cone
    power = float(product(program.dead, velocities)) - _work(program, velocities)
    violation = float(cone.outside(program.motion @ velocities)[cone.cap < 0].max(initial=0.0))
    error = violation * program.weight * program.n_blocks / power if power > 0.0 else np.inf
    return _proved(program, FALLS, error, found), error


def _locked(program: Program, found: ProgramSolution) -> tuple[str, float]:
    """Prove by contact forces in balance with live loads alone that no load fails: status and error."""
    s, amounts = program.structure, program.cone.endless(found.amounts)
    unbalanced = (program.motion.T @ amounts + found.multiplier * s.live) / s.scales
    load = found.multiplier * float(np.abs(s.live / s.scales).max())
    error = float(np.abs(unbalanced).max()) / load if load > 0.0 else np.inf
    return _proved(program, LOCKED, error, found), error


def _proved(program: Program, claim: str, error: float, found: ProgramSolution) -> str:
    """Accept a claimed status if the error of its proof is small enough."""
    if error <= program.settings.proof:
        return claim
    return f"{GIVEN_UP}: the solver says {found.said}, its proof errs by {error:.1e}"


def _work(program: Program, velocities: np.ndarray, amounts: np.ndarray | None = None) -> float:
    """Compute the work at the caps in a mechanism, and of the given forces on its violations elsewhere."""
    cone, motion = program.cone, program.motion @ velocities
    work = float(product(cone.most, cone.yielding(motion)))
    if amounts is not None:
        work += float(product(amounts[cone.leading], np.where(cone.cap < 0, cone.outside(motion), 0.0)))
    return work


def _refusal(program: Program, status: str, residual: float = 0.0) -> LimitLoad:
    """Build the result of a program that has no multiplier."""
    nothing, forces = (
        np.zeros((program.structure.model.n_blocks, program.structure.n_dof)),
        np.zeros_like(program.split(program.cone.first)[0]),
    )
    return LimitLoad(status, None, None, None, residual, forces[:, 0], forces[:, 1:], nothing, None, 0)
