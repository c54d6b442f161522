"""Associated load of large plane structures: primal–dual interior point of the linear program with frontal
factors.

    max λ       so that   Gᵀ g + dead + λ live = 0,   g ≥ 0              (limit/program.py)
    min −dead·u so that   live·u = 1,   s = G u ≥ 0,   and gᵢ sᵢ = τ → 0

Newton's equations, condensed on the degrees of freedom, are Gᵀ (g/s) G, bordered by the live load: the pattern is that
of blocks that touch, and the factors are those of the path (limit/newton_matrix.py). Steps are those of Mehrotra
(SIAM J. Optim. 2, 1992, 575) with correctors towards the central path (Gondzio, Comput. Optim. Appl. 6, 1996, 137);
each is refined once, with the border, as factors g/s lie many orders of magnitude apart at the end. What comes out is
judged like the answer of any solver (limit/associated.py).
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.sparse import diags

from dem_cli.core.arithmetic.products import product
from dem_cli.core.contact.compatibility import free_columns, relative_motion
from dem_cli.core.limit.newton_matrix import NewtonMatrix, PointRows
from dem_cli.core.limit.program import ANSWERED, UNKNOWN, Program, ProgramSolution
from dem_cli.core.limit.settings import DEFAULT_LIMIT
from dem_cli.interrupts import look

PRODUCTS = ((0, 0), (1, 1), (0, 1), (1, 0))  # of normal and tangent


class Feasible(NamedTuple):
    """Iterate of the interior point; all in units of mean weights and of the program's load."""

    x: np.ndarray  # velocities, (n_free,)
    load: float
    slack: np.ndarray  # G u, positive, (n_amounts,)
    amounts: np.ndarray  # g, positive, (n_amounts,)

    @property
    def mean(self) -> float:
        """Mean product of slacks and amounts."""
        return float(product(self.slack, self.amounts)) / max(len(self.slack), 1)

    @property
    def inside(self) -> bool:
        """Test whether all slacks and amounts are positive, and all numbers finite."""
        return bool((self.slack > 0.0).all() and (self.amounts > 0.0).all() and np.isfinite(self.mean + self.load))

    def moved(self, by: Feasible, primal: float, dual: float) -> Feasible:
        """Move the iterate along a step; primal: share of velocities, dual: share of forces."""
        return Feasible(
            self.x + primal * by.x, self.load + dual * by.load,
            self.slack + primal * by.slack, self.amounts + dual * by.amounts,
        )  # fmt: skip

    def lengths(self, step: Feasible) -> tuple[float, float]:
        """Compute the longest steps, at most 1, that leave all values positive: velocities, forces."""
        return _to_zero(self.slack, step.slack), _to_zero(self.amounts, step.amounts)


def _to_zero(values: np.ndarray, change: np.ndarray) -> float:
    """Share of a change, at most 1, after which the first of positive values becomes zero."""
    return min(1.0, float((-values / np.minimum(change, -1e-300)).min(initial=1.0)))


def is_linear(program: Program) -> bool:
    """Test whether the program has generators alone: plane joints without caps and tips, no links."""
    cone = program.cone
    bare = not (cone.n_round or len(cone.most) or cone.first.any() or program.structure.links)
    return bare and cone.dimension == 2 and len(cone.points) > 0


def solved_on_fronts(program: Program, loaded: bool) -> ProgramSolution:
    """Solve the program like limit.program.largest_load (loaded) or `standing`; UNKNOWN, which proves nothing, on
    failure."""
    return FrontalProgram(program, program.structure.live * program.load if loaded else None).solution()


class FrontalProgram:
    """Linear program of a structure in scaled numbers, and its iteration; live: loads, None: dead loads alone."""

    def __init__(self, program: Program, live: np.ndarray | None) -> None:
        structure, cone = program.structure, program.cone
        self.program, self.settings, self.loaded = program, program.settings, live is not None
        columns = free_columns(structure.model, structure.joints)
        scale = np.where(columns < 0, 0.0, np.append(program.weight / structure.scales, 0.0)[columns])
        rows = relative_motion(structure.joints, 2) * scale[:, None]
        places = structure.model.centroids[~structure.model.fixed]
        points = PointRows(rows, columns, PRODUCTS, len(structure.scales), places)
        self.matrix = NewtonMatrix(points, replace(DEFAULT_LIMIT.path, singular=self.settings.singular))
        self.order = order = self.matrix.order
        self.motion = (program.motion @ diags(program.weight / structure.scales)).tocsr()[:, order]
        self.forces = self.motion.T.tocsr()
        self.right = (-program.dead / structure.scales)[order]
        self.live = np.zeros(len(order)) if live is None else (live / structure.scales)[order]
        normal, tangent = cone.shares.T
        self.shares = (normal * normal, tangent * tangent, normal * tangent, normal * tangent)

    def solution(self) -> ProgramSolution:
        """Iterate to the solution and return it with its status."""
        kind, count = UNKNOWN, 0
        with np.errstate(all="ignore"):  # what runs away is given up
            at = self._start()
            while count < self.settings.most:
                look()
                self._residuals(at)
                if self._done(at):
                    kind = ANSWERED
                    break
                if not at.inside or not self._factorise(at):
                    break
                at, count = self._next(at), count + 1
        program, x = self.program, np.empty_like(at.x)
        x[self.order] = at.x
        velocities = x / program.structure.scales
        amounts, load = at.amounts * program.weight, at.load * program.load
        return ProgramSolution(kind, amounts, load, velocities, count, "interior point on fronts")

    def _start(self) -> Feasible:
        """Start from least forces in equilibrium and the mechanism of least motions, moved off the boundary
        (Mehrotra)."""
        ones = np.ones(len(self.program.cone.points))
        if not self._factorise(Feasible(self.right, 0.0, ones, ones)):
            return Feasible(0.0 * self.right, 0.0, ones, np.full(len(ones), np.nan))
        dead = self.factors.solve(self.right)
        compliance = float(product(self.live, self.by_live)) if self.loaded else 1.0
        load = float(product(self.live, dead)) / compliance
        amounts, x = self.motion @ (dead - load * self.by_live), self.by_live / compliance
        slack = self.motion @ x if self.loaded else ones
        amounts, slack = (values + max(-1.5 * float(values.min()), 0.0) for values in (amounts, slack))
        both = 0.5 * float(product(amounts, slack))
        amounts, slack = amounts + both / slack.sum(), slack + both / amounts.sum()
        return Feasible(x, load, slack, amounts)

    def _residuals(self, at: Feasible) -> None:
        self.unbalanced = self.right - self.forces @ at.amounts - at.load * self.live
        self.off_motion = at.slack - self.motion @ at.x
        self.off_power = float(1.0 - product(self.live, at.x)) if self.loaded else 0.0

    def _done(self, at: Feasible) -> bool:
        """Test whether forces balance and both bounds are close."""
        settings = self.settings
        if not np.abs(self.unbalanced).max() < settings.balanced * settings.residual:
            return False
        open_gap = product(at.slack, at.amounts) + product(np.abs(self.off_motion), at.amounts)
        return not self.loaded or bool(open_gap < settings.closed * settings.gap * max(abs(at.load), settings.nothing))

    def _factorise(self, at: Feasible) -> bool:
        self.stiff = at.amounts / at.slack
        cone, n_points = self.program.cone, len(self.program.cone.first)
        try:
            self.factors = self.matrix.factorised(
                [np.bincount(cone.points, self.stiff * share, n_points) for share in self.shares]
            )
        except RuntimeError:
            return False
        self.by_live = self.factors.solve(self.live)
        return bool(np.isfinite(self.by_live).all())

    def _towards(self, at: Feasible, products: np.ndarray) -> Feasible:
        """Newton's step that changes the products by so much and meets the equations."""
        pushed = products / at.slack
        right = self.forces @ (pushed + self.stiff * self.off_motion) - self.unbalanced
        x, load = self._bordered(right, self.off_power)
        left = right + load * self.live - self.forces @ (self.stiff * (self.motion @ x))
        more, on = self._bordered(left, self.off_power - float(product(self.live, x)))
        x, load = x + more, load + on
        slack = self.motion @ x - self.off_motion
        return Feasible(x, load, slack, pushed - self.stiff * slack)

    def _bordered(self, right: np.ndarray, power: float) -> tuple[np.ndarray, float]:
        x = self.factors.solve(right)
        if not self.loaded:
            return x, 0.0
        load = (power - float(product(self.live, x))) / float(product(self.live, self.by_live))
        return x + load * self.by_live, load

    def _next(self, at: Feasible) -> Feasible:
        """Compute the next iterate by a predictor and correctors."""
        settings, mean, products = self.settings, at.mean, at.slack * at.amounts
        straight = self._towards(at, -products)
        left = at.moved(straight, *at.lengths(straight)).mean
        tau = max((left / mean) ** 3, settings.least) * mean
        wanted = tau - products - straight.slack * straight.amounts
        step = self._towards(at, wanted)
        lengths = at.lengths(step)
        for _ in range(settings.correctors):
            if min(lengths) > settings.far:
                break
            beyond = at.moved(step, *(min(1.0, length + settings.beyond) for length in lengths))
            found = beyond.slack * beyond.amounts
            more = np.clip(found, tau / settings.widest, tau * settings.widest) - found
            changed = wanted + np.maximum(more, -settings.widest * tau)
            other = self._towards(at, changed)
            if not sum(longer := at.lengths(other)) > sum(lengths) + settings.gain:
                break
            step, lengths, wanted = other, longer, changed
        return at.moved(step, *(1.0 if length == 1.0 else settings.boundary * length for length in lengths))
