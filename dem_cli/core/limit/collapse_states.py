"""Least load of joints that slide without dilating: a mixed-integer program over all collapse states; 2D.

Lo Bianco and Mazzarella (thesis 3.1.3, equations 3-5; Baggio and Trovalusci 2000; Ferris and Tin-Loi 2001):

    min λ   so that   Bᵀ (N, T) + dead + λ live = 0                     forces in equilibrium
                      −ft A ≤ N ≤ fc A,   |T| ≤ C + μ N                 that the joints carry
                      B u = (a − q + tan ψ s, s₊ − s₋),   live·u = 1    a mechanism in which the live loads work
                      a (N + ft A) = q (fc A − N) = 0,   s± (C + μ N ± T) = 0,   λ, a, q, s± ≥ 0

C is the cohesion of the points that are shut; a point without tension loses its own as it opens (a > 0).
Every history that ends in a mechanism in which the live loads work ends in one of these states, none below the least
load. Each product is a choice between its two factors: a whole number, 0 or 1. HiGHS searches all of them (branch and
bound), which proves the least load, or those that differ in a few choices from the state in hand, which proves a local
least: no state that differs less is lower. Whole numbers need bounds: statics gives those of the forces; no joint is
faster than `fastest`. What the solver returns is solved again for its choices alone, and its products are looked at.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse import bmat, csr_matrix, diags, identity, vstack

from dem_cli.core.laws.envelope import Envelope
from dem_cli.core.limit.joint_forces import SOLVED, JointForces
from dem_cli.core.limit.matrices import LimitStructure
from dem_cli.core.limit.settings import LeastSettings
from dem_cli.interrupts import look


class CollapseState(NamedTuple):
    """Collapse state: forces, a mechanism, and the joints it opens, crushes and slides."""

    load: float  # multiplier of the live loads, as users know it
    forces: np.ndarray  # N of all points, T of all joints [mean weights], (n_points + n_joints,)
    velocities: np.ndarray  # free degrees of freedom; the live loads have unit power, (n_free,)
    choices: np.ndarray  # 0 or 1, (n_choices,)
    residual: float  # largest violation of the conditions, forces in mean weights, rates over the largest


class StateSearch(NamedTuple):
    """Outcome of one search for a state of collapse."""

    state: CollapseState | None
    proved: float  # below it there is no state among those searched, as users know it; inf: there is none at all
    whole: bool  # whether the search came to its end
    nodes: int


class CollapseStates:
    """Mixed-integer program of a structure; unknowns: N, T, λ, u, a, q, s₊, s₋, then the choices of a, q, s₊, s₋."""

    def __init__(self, structure: LimitStructure, strength: Envelope, upper: float, settings: LeastSettings) -> None:
        self.settings, self.structure = settings, structure
        self.statics = statics = JointForces(structure, strength)
        n_dof = structure.n_dof
        own = np.repeat(structure.scales[::n_dof], n_dof)
        self.columns = diags(own / structure.scales)  # rotations as motions at the radius of a block
        self.upper = upper
        forces = np.abs(statics.live.reshape(-1, n_dof) / (own / structure.scales).reshape(-1, n_dof)).max(axis=1)
        lightest = max(float(forces[forces > 0.0].min()), settings.slightest * float(forces.max()))
        self.alone = 1.0 / lightest  # its rate if it moves alone, while the live loads have unit power
        self.fastest = settings.rates[0] * self.alone  # rate of a joint
        joint, self.limits = statics.joint, statics.strength
        n_points, n_joints = statics.n_points, statics.n_joints
        self.crushed = np.flatnonzero(np.isfinite(self.limits.compression))
        sizes = (n_points, n_joints, 1, len(structure.free), n_points, len(self.crushed), n_joints, n_joints)
        ends = np.cumsum(sizes)
        parts = [slice(end - size, end) for end, size in zip(ends, sizes, strict=True)]
        self.N, self.T, self.load, self.u, self.a, self.q, self.plus, self.minus = parts
        self.n_states = int(ends[-1])
        self.rates = slice(self.a.start, self.n_states)  # one choice for each
        self.choices = slice(self.n_states, 2 * self.n_states - self.a.start)
        self.n = self.choices.stop
        self._bound_forces(joint)

    def _bound_forces(self, joint: np.ndarray) -> None:
        """Largest normal force of every point and least of every joint, at any load up to the associated one."""
        statics, settings = self.statics, self.settings
        bounds, (rows, tops) = statics.bounds(0.0, self.upper), statics.cone_rows()
        most = min(self.upper, 1e3 * statics.load)  # as users know multipliers
        loads = float(np.abs(self.structure.dead).sum() + np.abs(self.structure.live).sum() * most)
        ceiling = settings.forces * loads / statics.weight
        self.most = np.minimum(self.limits.compression, ceiling)
        for p in range(statics.n_points):
            cost = np.zeros(statics.n)
            cost[p] = -1.0
            found = statics.solve(cost, bounds, rows, tops)
            if found.status == SOLVED:
                self.most[p] = min(self.most[p], -found.fun * (1.0 + settings.gap) + settings.carries)
        self.bounded = bool((self.most < ceiling).all())  # else states with larger forces are left out
        least = np.zeros(statics.n_joints)
        for k in range(statics.n_joints):
            cost = np.zeros(statics.n)
            cost[: statics.n_points][joint == k] = 1.0
            found = statics.solve(cost, bounds, rows, tops)
            least[k] = found.fun - settings.carries if found.status == SOLVED else -np.inf
        tied = np.bincount(joint, self.limits.tension, statics.n_joints)
        self.least = np.maximum(least, -tied)

    # -- rows ------------------------------------------------------------------------------------------

    def _row(self, **parts: csr_matrix) -> csr_matrix:
        """Rows over all unknowns from those of some."""
        height = next(iter(parts.values())).shape[0]
        whole = []
        for name in ("N", "T", "load", "u", "a", "q", "plus", "minus"):
            part: slice = getattr(self, name)
            whole.append(parts.get(name, csr_matrix((height, part.stop - part.start))))
        whole.append(parts.get("choices", csr_matrix((height, self.choices.stop - self.choices.start))))
        return bmat([whole]).tocsr()

    def _equations(self) -> tuple[csr_matrix, np.ndarray]:
        """Equilibrium, compatibility, unit power of the live loads."""
        statics = self.statics
        balance, joint = statics.balance, statics.joint
        n_points, n_joints = statics.n_points, statics.n_joints
        dilation = -csr_matrix((self.limits.dilation[joint], (np.arange(n_points), joint)), (n_points, n_joints))
        crushing = csr_matrix(
            (np.ones(len(self.crushed)), (self.crushed, np.arange(len(self.crushed)))), (n_points, len(self.crushed))
        )
        forces = self._row(N=balance[:, :n_points], T=balance[:, n_points:-1], load=balance[:, -1:])
        opens = self._row(
            u=statics.opening @ self.columns, a=-identity(n_points), q=crushing, plus=dilation, minus=dilation
        )
        slides = self._row(u=statics.sliding @ self.columns, plus=-identity(n_joints), minus=identity(n_joints))
        power = self._row(u=csr_matrix(statics.live[None]) @ self.columns)
        right = np.concatenate([statics.right, np.zeros(n_points + n_joints), [1.0]])
        return vstack([forces, opens, slides, power]).tocsr(), right

    def _inequalities(self) -> tuple[csr_matrix, np.ndarray]:
        """Strength; each choice closes one of its two factors; what virtual work says of the load."""
        statics, limits, joint = self.statics, self.limits, self.statics.joint
        n_points, n_joints = statics.n_points, statics.n_joints
        (cone, tops), all_of = statics.cone_rows(), identity(n_points).tocsr()
        rubs = diags(limits.friction) @ statics.sums
        reach = 2.0 * (limits.cohesion + limits.friction * np.bincount(joint, self.most, n_joints))
        count = self.choices.stop - self.choices.start
        of_choice = identity(count).tocsr()
        ends = np.cumsum([n_points, len(self.crushed), n_joints, n_joints])
        y, crush, plus, minus = (of_choice[a:b] for a, b in zip([0, *ends[:-1]], ends, strict=True))
        lost = statics.sums @ diags(limits.lost) @ y  # cohesion of the points that open
        span = limits.tension + self.most
        full = (limits.tension + limits.compression)[self.crushed]
        rows = [
            (self._row(N=cone[:, :n_points], T=cone[:, n_points:-1]), tops),
            (self._rates(count), np.zeros(count)),
            (self._row(N=all_of, choices=diags(span) @ y), self.most),
            (self._row(N=-all_of[self.crushed], choices=diags(full) @ crush), limits.tension[self.crushed]),
            (self._row(N=rubs, T=identity(n_joints), choices=diags(reach) @ plus - lost), reach - limits.cohesion),
            (self._row(N=rubs, T=-identity(n_joints), choices=diags(reach) @ minus - lost), reach - limits.cohesion),
            (self._row(choices=plus + minus), np.ones(n_joints)),
            self._work(),
        ]
        return vstack([row for row, _ in rows]).tocsr(), np.concatenate([top for _, top in rows])

    def _rates(self, count: int) -> csr_matrix:
        """Build the rows that make a rate zero unless its choice is made."""
        rates = csr_matrix((np.ones(count), (np.arange(count), self.rates.start + np.arange(count))), (count, self.n))
        chosen = csr_matrix(
            (np.ones(count), (np.arange(count), self.choices.start + np.arange(count))), (count, self.n)
        )
        return rates - self.fastest * chosen

    def _work(self) -> tuple[csr_matrix, np.ndarray]:
        """λ = −dead·u + what the joints take, which is no less than with the least normal forces."""
        limits, statics = self.limits, self.statics
        slip = csr_matrix(statics.sure_cohesion(self.least) + (limits.friction - limits.dilation) * self.least)
        row = self._row(
            load=csr_matrix([[-1.0]]),
            u=csr_matrix(-statics.dead[None]) @ self.columns,
            a=csr_matrix(limits.tension),
            q=csr_matrix(limits.compression[self.crushed]),
            plus=slip,
            minus=slip,
        )
        return row, np.zeros(1)

    def _bounds(self) -> tuple[np.ndarray, np.ndarray]:
        low, high = np.zeros(self.n), np.full(self.n, np.inf)
        low[self.N], high[self.N] = -self.limits.tension, self.most
        low[self.T], low[self.u] = -np.inf, -np.inf
        high[self.load] = self.upper / self.statics.load
        high[self.rates], high[self.choices] = self.fastest, 1.0
        return low, high

    # -- search ----------------------------------------------------------------------------------------

    def search(self, below: float, near: CollapseState | None = None, changed: int = 0) -> StateSearch:
        """Search for the least collapse state under a load; near: a state from which it may differ in so many
        choices only.

        Choices that the state leaves open, as both factors are nothing, do not count.
        """
        from scipy.optimize import Bounds, LinearConstraint, milp

        look()
        settings, (low, high) = self.settings, self._bounds()
        high[self.load] = np.minimum(high[self.load], below / self.statics.load)
        (equal, right), (rows, tops) = self._equations(), self._inequalities()
        given = [LinearConstraint(equal, right, right), LinearConstraint(rows, -np.inf, tops)]
        if near is not None:
            counted, row = self.settled(near), np.zeros(self.n)
            row[self.choices] = np.where(counted, 1.0 - 2.0 * near.choices, 0.0)
            given.append(LinearConstraint(row[None], -np.inf, changed - near.choices[counted].sum()))
        cost, whole = np.zeros(self.n), np.zeros(self.n)
        cost[self.load], whole[self.choices] = 1.0, 1.0
        options = {
            "node_limit": settings.nodes if near is None else settings.near,
            "mip_rel_gap": settings.gap,
            "presolve": True,
        }
        answer = milp(cost, integrality=whole, bounds=Bounds(low, high), constraints=given, options=options)
        nodes = int(answer.mip_node_count or 0)
        if answer.status == 2:
            return StateSearch(None, np.inf, True, nodes)
        proved = answer.mip_dual_bound if answer.mip_dual_bound is not None else 0.0
        state = None if answer.x is None else self.solved(np.round(answer.x[self.choices]))
        complete = bool(answer.status == 0 and state is not None)  # choices that cannot be solved again prove nothing
        return StateSearch(state, float(max(proved, 0.0)) * self.statics.load, complete, nodes)

    def chosen(self, forces: np.ndarray, velocities: np.ndarray, weight: float) -> np.ndarray:
        """Infer the choices of an approximate collapse state, (n_choices,): the smaller factor counts as zero.

        forces: N of points, T of joints; weight: of rates, over the largest of each kind.
        """
        loose = CollapseState(0.0, forces, velocities, np.zeros(self.choices.stop - self.choices.start), 0.0)
        rates, reserves = self.factors(loose)
        return (weight * rates > reserves / max(float(forces.max(initial=0.0)), 1e-300)).astype(float)

    def factors(self, state: CollapseState) -> tuple[np.ndarray, np.ndarray]:
        """Compute both factors of every choice: rates over the largest, reserves of strength [W], (n_choices,)."""
        statics, limits = self.statics, self.limits
        normal, shear = state.forces[: statics.n_points], state.forces[statics.n_points :]
        opening, slide = statics.opening @ state.velocities, statics.sliding @ state.velocities
        opening = opening - (limits.dilation * np.abs(slide))[statics.joint]
        rates = np.maximum(np.concatenate([opening, -opening[self.crushed], slide, -slide]), 0.0)
        shut = 1.0 - state.choices[: statics.n_points]
        cohesion = limits.cohesion - statics.sums @ (limits.lost * (1.0 - shut))
        strength = cohesion + limits.friction * (statics.sums @ normal)
        reserves = [normal + limits.tension, (limits.compression - normal)[self.crushed], strength + shear]
        return rates / max(float(rates.max(initial=0.0)), 1e-300), np.concatenate([*reserves, strength - shear])

    def settled(self, state: CollapseState) -> np.ndarray:
        """Choices of which one factor is more than nothing, (n_choices,) bool."""
        small = self.settings.accepted
        rates, reserves = self.factors(state)
        return (rates > small) | (reserves > small)

    def solved(self, choices: np.ndarray) -> CollapseState | None:
        """Compute the least load with these choices by a linear program; None where no such state exists."""
        from scipy.optimize import linprog

        low, high = self._bounds()
        (equal, right), (rows, tops) = self._equations(), self._inequalities()
        low[self.choices] = high[self.choices] = choices
        cost = np.zeros(self.n)
        cost[self.load] = 1.0
        keep = slice(0, rows.shape[0] - 1)  # all but virtual work, which they fulfil
        found = linprog(
            cost, A_ub=rows[keep], b_ub=tops[keep], A_eq=equal, b_eq=right,
            bounds=np.column_stack([low, high]), method="highs",
        )  # fmt: skip
        if found.status != SOLVED:
            return None
        x = found.x
        state = CollapseState(
            float(x[self.load][0] * self.statics.load), x[: self.load.start], self.columns @ x[self.u], choices, 0.0
        )
        return state._replace(residual=self.residual(state))

    def residual(self, state: CollapseState) -> float:
        """Largest violation of equilibrium, strength, compatibility and of the products, from forces and velocities."""
        statics = self.statics
        whole = np.append(state.forces, state.load / statics.load)
        rows, tops = statics.cone_rows()
        rates, reserves = self.factors(state)
        violations = [
            statics.balance @ whole - statics.right,
            np.maximum(rows @ whole - tops, 0.0),
            rates * np.minimum(np.maximum(reserves, 0.0), 1.0),
        ]
        return max(float(np.abs(values).max(initial=0.0)) for values in violations)
