"""Primal–dual interior point of one increment (limit.elastic): predictor–corrector, and a way round folds.

All products N p and c ∘ a (limit.slips) equal τ on the central path, which ends in a solution as τ goes to zero.
Each iteration factorises once: a predictor towards zero says how far τ may fall (Mehrotra, SIAM J. Optim. 2, 1992, 575)
and how the products curve, correctors make the step longer (Gondzio, Comput. Optim. Appl. 6, 1996, 137).
Where friction is not associated the problem is not monotone: the central path may turn back in τ. There a state on it
may be taken as it is, in equilibrium but with products that are left, and the next increment goes on from there; or the
path is followed by its arc length (predictor along the tangent, corrector across it) until it comes down.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from dem_cli.core.arithmetic import functions
from dem_cli.core.arithmetic.products import product
from dem_cli.core.limit.elastic import Direction, Elastic, State
from dem_cli.core.limit.settings import InteriorPointSettings
from dem_cli.core.limit.slips import apart
from dem_cli.interrupts import look


@dataclass
class Iterate:
    """Iterate of the interior point: displacements, load, shear forces and positive variables."""

    u: np.ndarray
    load: float
    shear: np.ndarray
    x: np.ndarray  # N, c, p, a as limit.slips keeps them, positive or inside their cones, (2·(1 + d)·n_points,)

    def copy(self) -> Iterate:
        """Copy the iterate, so that later steps leave it unchanged."""
        return Iterate(self.u.copy(), self.load, self.shear.copy(), self.x.copy())


@dataclass
class Course:
    """Progress of an iteration: whether it is stuck, and its best iterate in equilibrium on the central path."""

    settings: InteriorPointSettings
    means: list[float] = field(default_factory=list)  # products, iteration by iteration
    short: int = 0  # steps in turn that led nowhere
    kept: tuple[float, Iterate] | None = None  # mean product, and where it was

    def keep(self, mean: float, at: Iterate) -> None:
        """Store the iterate of the smallest products so far."""
        if self.kept is None or mean < self.settings.reversal * self.kept[0]:
            self.kept = (mean, at.copy())

    def goes_on(self, feasible: bool) -> bool:
        """Test whether steps still make progress: products fall, or equations are not yet satisfied."""
        settings, means = self.settings, self.means
        if len(means) >= settings.slow or self.short >= settings.short_steps:
            return False
        return not (feasible and len(means) > settings.patience
                    and means[-1] > settings.stalled * means[-1 - settings.patience])  # fmt: skip


class Increment:
    """Load increment from a state to a displacement of the live load, or to a load.

    end        mean product at which it ends, over the square of the lightest block (None: as set)
    viscosity  force of the free degrees of freedom per displacement of this increment, against it, (n_free,)
    """

    def __init__(
        self,
        problem: Elastic,
        before: State,
        displacement: float | None,
        load: float = 0.0,
        end: float | None = None,
        viscosity: np.ndarray | None = None,
    ):
        self.problem, self.before, self.displacement, self.target = problem, before, displacement, load
        self.viscosity = viscosity
        self.settings = problem.settings.of_increment(problem.dimension)
        self.end = (self.settings.end if end is None else end) * problem.lightest
        ties = problem.ties
        self.yielding = None if ties is None else ties.elastic_force(before.displacements, before.plastic) >= (
            (1.0 - self.settings.near_yield) * ties.most
        )  # fmt: skip
        self.last: Iterate | None = None  # of what was solved

    def start(self, tau: float, ahead: float) -> Iterate:
        """Build the first iterate: the last state moved off the boundary to products of τ; slips go on `ahead`
        times as far."""
        problem, before, slips = self.problem, self.before, self.problem.slips
        mu = problem.friction
        opening = self.gaps + before.normal / problem.kn
        normal, opening = apart(before.normal - np.maximum(opening, 0.0), tau)
        limit, shear, slip = slips.started(mu * before.normal, before.shear, ahead * before.slip, tau)
        normal = np.maximum(normal, limit / mu)
        shear = slips.limited(shear, self.settings.friction_used * mu * normal)
        x = slips.joined(normal, opening, mu * normal, shear, slip)
        return Iterate(before.displacements.copy(), before.load, shear, x)

    def solve(
        self,
        tau: float,
        ahead: float = 0.0,
        folds: int = 0,
        stop: Callable[[], bool] = lambda: False,
        rough: float = 0.0,
    ) -> State | None:
        """Solve for the state after the increment; None where the iteration got stuck.

        tau    of the first products
        ahead  how far slips go on from the last increment, as a share of that
        folds  how many folds of the central path to go round; where there are any, it is followed closely
        rough  mean product up to which a state on the central path is taken where the iteration got stuck (State.left)
        """
        self.settings = self.problem.settings.of_increment(self.problem.dimension, folds)
        for _ in range(1 if self.yielding is None else self.settings.yieldings):
            self._pose()
            with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # what runs away is given up
                found = self._solved(self.start(tau, ahead), tau, folds, stop, rough)
            if found is None or self._yields_so(found):
                return found
        return None

    def _pose(self) -> None:
        """Set up the problem at the begin of this increment: friction by its forces, ties that yield, gaps."""
        problem, before = self.problem, self.before
        problem.draw_in(before.normal)
        if self.yielding is not None:
            problem.put_ties(self.yielding, before.plastic)
        self.gaps = problem.opened(before.displacements) + problem.gaps  # where joints have no stiffness

    def _yields_so(self, found: State) -> bool:
        """Test whether exactly those ties yield that were assumed to; otherwise the others are assumed next."""
        ties, before = self.problem.ties, self.before
        if ties is None:
            return True
        yielding = ties.yielding(found.displacements, before.plastic)
        taken, self.yielding = self.yielding, yielding
        return bool((yielding == taken).all())

    def polished(self) -> State | None:
        """Solve the increment again to smaller products, down to the end that is set; None where that fails."""
        if self.last is None:
            return None
        self.end = self.settings.end * self.problem.lightest
        self._pose()
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            return self._solved(self.last.copy(), None, 0, lambda: False, 0.0)

    def _solved(
        self, at: Iterate, tau: float | None, folds: int, stop: Callable[[], bool], rough: float
    ) -> State | None:
        """Iterate to the solution; tau: of the first step, which goes straight to the equations; None: they are
        satisfied."""
        settings, course, length = self.settings, Course(self.settings), 1.0
        while not stop():
            mean, infeasible = float(self.problem.slips.products(at.x).mean()), self._residuals(at)
            if infeasible < settings.tolerance and mean <= settings.at_end * self.end:
                self.last = at
                return self._state(at)
            if not np.isfinite(infeasible):
                break
            course.means.append(mean)
            if self.straight < settings.balanced and self._spread(at, mean) < settings.centred:
                course.keep(mean, at)
            if not course.goes_on(self.straight < settings.feasible):
                turned = self._arc(*course.kept, mean, stop) if course.kept is not None and folds > 0 else None
                if turned is None:
                    break
                at, folds, course, length = turned, folds - 1, Course(settings), 1.0
                continue
            if not self._factorise(at):
                break
            step = self._direction(tau) if tau is not None else self._towards_end(at, mean, length)
            tau, length = None, self._to_boundary(at, step)
            course.short = course.short + 1 if length < settings.short else 0
            self._move(at, step, length)
        if course.kept is None or not course.kept[0] < rough:
            return None
        mean, at = course.kept
        return self._state(at)._replace(left=mean)

    def _towards_end(self, at: Iterate, mean: float, length: float) -> Direction:
        """Compute the next step with the centring that the length of the last one asks for."""
        for least, share in self.settings.centring:
            if length > least or least == 0.0:
                return self._direction(max(share * mean, self.end))
        return self._predicted(at, mean)

    def _predicted(self, at: Iterate, mean: float) -> Direction:
        """Compute the next step by Mehrotra's predictor and corrector, and Gondzio's correctors towards the
        central path."""
        settings, slips = self.settings, self.problem.slips
        straight = self._direction(0.0)
        length = self._to_boundary(at, straight, 1.0)
        left = float(slips.products(slips.moved(at.x, straight.positive, length)).mean()) / mean
        tau = max(float(np.clip(left**3, settings.least, 1.0)) * mean, self.end)
        most = settings.widest * mean
        products = tau - np.clip(slips.products(slips.moved(at.x, straight.positive)), -most, most)
        step = self._direction(products)
        length = self._to_boundary(at, step, 1.0)
        for share in settings.back:
            if (
                length > settings.blind
            ):  # else curvature misled it, or products fell before the equations were satisfied
                break
            wanted = np.full_like(products, max(tau, share * mean))
            other = self._direction(wanted)
            if (longer := self._to_boundary(at, other, 1.0)) > length:
                step, length, products = other, longer, wanted
        for _ in range(settings.correctors):
            if length > settings.far:
                break
            beyond = slips.products(slips.moved(at.x, step.positive, min(1.0, length + settings.beyond)))
            wanted = np.clip(beyond, tau / settings.widest, tau * settings.widest)
            products = products + np.maximum(wanted - beyond, -settings.widest * tau)
            other = self._direction(products)
            longer = self._to_boundary(at, other, 1.0)
            if not longer > length + settings.gain:
                break
            step, length = other, longer
        return step

    # -- the central path by its arc length -----------------------------------------------------------

    def _arc(self, tau: float, at: Iterate, fold: float, stop: Callable[[], bool]) -> Iterate | None:
        """Follow the central path round its fold from a kept iterate until τ is well below it; None where that
        fails."""
        settings, slips, last, on_path, at = self.settings, self.problem.slips, None, False, at.copy()
        for _ in range(settings.on_arc):
            if tau < settings.passed * fold:
                return at
            if stop():
                return None
            self._residuals(at)
            if not self._factorise(at):
                return None
            spread = self._spread(at, tau)
            onto, along = self._direction(tau), self._tangent()
            relative = slips.relative(at.x, tau * along.positive)
            if not np.abs(relative).max() < settings.endless:
                return None
            tangent = np.append(relative, 1.0) / np.sqrt(product(relative, relative) + 1.0)
            tangent *= -1.0 if last is None else np.sign(product(tangent, last))
            on_path = on_path or (self.straight < settings.feasible and spread < settings.wide)
            change = 0.0
            if on_path:  # the corrector stays in the plane across the tangent
                offset = slips.relative(at.x, onto.positive)
                change = -product(offset, tangent[:-1]) / (product(relative, tangent[:-1]) + tangent[-1])
                if spread < settings.wide:
                    fall, growth = slips.extremes(tangent[:-1])
                    fastest = max(-fall, settings.growing * growth)
                    change += tangent[-1] * settings.stride / max(fastest, abs(tangent[-1]) / settings.by_tau)
                    last = tangent
                change = float(np.clip(change, max(functions.log(self.end / tau), -settings.down), settings.up))
            step = onto.and_on(along, tau * change)
            length = self._to_boundary(at, step)
            self._move(at, step, length)
            tau *= functions.exp(length * change)
        return None

    # -- Newton ---------------------------------------------------------------------------------------

    def _residuals(self, at: Iterate) -> float:
        """Compute the residuals of the linear equations into self; returns the largest."""
        problem, before, slips = self.problem, self.before, self.problem.slips
        normal, opening = slips.normals(at.x)
        self.unbalanced = problem.imbalance(normal, at.shear, at.load)
        if self.viscosity is not None:
            self.unbalanced -= self.viscosity * (at.u - before.displacements)
        moved = problem.motion @ (at.u - before.displacements)
        self.off_gap = self.gaps + moved[: problem.n_points] + normal / problem.kn - opening
        self.off_slide = slips.slides(at.x) - (at.shear - before.shear) / problem.ks_t - moved[problem.n_points :]
        self.off_reserve = slips.lacks(problem.friction * normal, at.shear, at.x)
        if self.displacement is None:
            self.off_target = self.target - at.load
        else:
            self.off_target = self.displacement - product(problem.live, at.u)
        linear, turning = (
            max(float(np.abs(off).max(initial=0.0)) for off in parts)
            for parts in ((self.unbalanced, self.off_gap), (self.off_slide, self.off_reserve))
        )
        self.straight = slips.straight(linear, turning)
        return max(linear, turning)

    def _factorise(self, at: Iterate) -> bool:
        look()
        problem = self.problem
        self.normal, self.opening = problem.slips.normals(at.x)
        self.soft_n = self.opening + self.normal / problem.kn
        self.stiff_n = self.normal / self.soft_n
        self.joints = problem.slips.linear(at.x, problem.friction, problem.ks, self.stiff_n)
        try:
            self.lu = problem.factorised(self.stiff_n, self.joints.stiffness, self.viscosity)
        except RuntimeError:
            return False
        self.by_live = self.lu.solve(problem.live)
        return bool(np.isfinite(self.by_live).all())

    def _direction(self, tau: float | np.ndarray) -> Direction:
        """Compute Newton's direction to the equations and products of τ, one for all or as Slips.products has them."""
        n = self.problem.n_points
        products = np.broadcast_to(tau, 3 * n)
        push = (products[:n] - self.normal * self.opening - self.normal * self.off_gap) / self.soft_n
        forced = self.joints.towards(products[n:], self.off_reserve)
        return self._solve(push, forced, self.unbalanced, self.off_gap, self.off_slide, self.off_reserve,
                           self.off_target)  # fmt: skip

    def _tangent(self) -> Direction:
        """Compute the change of the central path by τ."""
        none = np.zeros_like
        return self._solve(1.0 / self.soft_n, self.joints.along(), none(self.unbalanced), none(self.off_gap),
                           none(self.off_slide), none(self.off_reserve), 0.0)  # fmt: skip

    def _solve(self, push, forced, unbalanced, off_gap, off_slide, off_reserve, off_target) -> Direction:
        """Solve Newton's equations, condensed on the free degrees of freedom and bordered by the live load.

        push, forced: changes of the normal forces and of the slips while nothing else changes.
        """
        problem, joints = self.problem, self.joints
        rub = joints.rubbed(forced, off_slide, push)
        u = self.lu.solve(unbalanced + problem.pull @ np.concatenate([push, rub]))
        if self.displacement is None:
            load = off_target
        else:
            load = (off_target - product(problem.live, u)) / product(problem.live, self.by_live)
        u = u + load * self.by_live
        moved = problem.motion @ u
        closing, slide = moved[: problem.n_points], moved[problem.n_points :]
        d_normal = push - self.stiff_n * closing
        d_shear = joints.sheared(rub, slide, closing)
        d_reserve = problem.slips.changes(problem.friction * d_normal, d_shear) + off_reserve
        d_opening = off_gap + closing + d_normal / problem.kn
        d_slip = joints.slipped(forced, d_reserve - off_reserve)
        return Direction(u, float(load), d_shear, np.concatenate([d_normal, d_reserve, d_opening, d_slip]))

    def _to_boundary(self, at: Iterate, step: Direction, share: float | None = None) -> float:
        """Compute the step, at most 1, that goes a share (None: as set) of the way to where a variable becomes
        zero.
        """
        slips = self.problem.slips
        steepest = slips.fastest(at.x, step.positive)[0]
        share = self.settings.boundary if share is None else share
        return min(1.0, -share / steepest) if steepest < 0.0 else 1.0

    def _move(self, at: Iterate, step: Direction, length: float) -> None:
        at.u = at.u + length * step.displacements
        at.load += length * step.load
        at.shear = at.shear + length * step.shear
        at.x = self.problem.slips.moved(at.x, step.positive, length)

    def _spread(self, at: Iterate, mean: float) -> float:
        """Largest ratio of a product to the mean, or of the mean to a product."""
        products = self.problem.slips.products(at.x)
        return max(float(products.max()) / mean, mean / max(float(products.min()), 1e-300))

    def _state(self, at: Iterate) -> State:
        slips, ties, plastic = self.problem.slips, self.problem.ties, self.before.plastic
        if ties is not None:
            plastic = ties.stretched(at.u, plastic)
        return State(at.u, at.load, slips.normals(at.x)[0], at.shear, slips.slip(at.x), plastic=plastic)
