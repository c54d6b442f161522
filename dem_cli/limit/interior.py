"""A primal–dual interior point for one increment (limit.elastic), with a way round the folds of its central path.

All products N p, c± a± equal τ on the central path, which ends in a solution as τ goes to zero. Where
friction is not associated the problem is not monotone: the path may turn back in τ. There the path is
followed by its arc length instead (predictor along the tangent, corrector across it) until it comes down.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dem_cli.interrupts import look
from dem_cli.limit.elastic import Direction, Elastic, State


@dataclass
class Iterate:
    """Where the iteration is."""

    u: np.ndarray
    load: float
    shear: np.ndarray
    x: np.ndarray  # N, c₊, c₋, p, a₊, a₋, all positive, (6·n_points,)

    def copy(self) -> Iterate:
        """The same, to be kept."""
        return Iterate(self.u.copy(), self.load, self.shear.copy(), self.x.copy())


class Increment:
    """One increment from a state to a displacement of the live load, or to a load."""

    def __init__(self, problem: Elastic, before: State, displacement: float | None, load: float = 0.0):
        self.problem, self.before, self.displacement, self.target = problem, before, displacement, load
        self.settings = problem.settings.interior_point
        self.end = self.settings.end * min(1.0, float(problem.own.min(initial=1.0))) ** 2

    def start(self, tau: float, ahead: float) -> Iterate:
        """The last state moved off the boundary to products of τ; slips go on `ahead` times as far as before."""
        problem, before = self.problem, self.before
        mu = problem.friction
        opening = problem.bn @ before.displacements + before.normal / problem.kn
        normal, opening = _apart(before.normal - np.maximum(opening, 0.0), tau)
        one, two = (np.maximum(mu * before.normal + s * before.shear, 0.0) for s in (1.0, -1.0))
        one, slip_one = _apart(one - ahead * before.slips[0], tau)
        two, slip_two = _apart(two - ahead * before.slips[1], tau)
        normal = np.maximum(normal, 0.5 * (one + two) / mu)
        used = self.settings.friction_used * mu * normal
        shear = np.clip(0.5 * (one - two), -used, used)
        x = np.concatenate([normal, mu * normal + shear, mu * normal - shear, opening, slip_one, slip_two])
        return Iterate(before.displacements.copy(), before.load, shear, x)

    def solve(
        self, tau: float, ahead: float = 0.0, folds: int = 0, stop: Callable[[], bool] = lambda: False
    ) -> State | None:
        """The state after the increment, or None where the iteration got stuck.

        tau    of the first products
        ahead  how far slips go on from the last increment, as a share of that
        folds  how many folds of the central path to go round
        """
        settings, at, length, first = self.settings, self.start(tau, ahead), 1.0, True
        kept: tuple[float, Iterate] | None = None
        means: list[float] = []
        while len(means) < settings.slow and not stop():
            mean = float((at.x[: len(at.x) // 2] * at.x[len(at.x) // 2 :]).mean())
            infeasible = self._residuals(at)
            if infeasible < settings.tolerance and mean <= settings.at_end * self.end:
                return self._state(at)
            if not self._factorise(at):
                return None
            means.append(mean)
            if infeasible < settings.feasible:
                if self._spread(at, mean) < settings.centred and (kept is None or mean < settings.reversal * kept[0]):
                    kept = (mean, at.copy())
                if len(means) > settings.patience and mean > settings.stalled * means[-settings.patience]:
                    turned = self._arc(*kept, mean, stop) if kept is not None and folds > 0 else None
                    if turned is None:
                        return None
                    at, kept, means, length, folds = turned, None, [], 1.0, folds - 1
                    continue
            centring = next(share for least, share in settings.centring if length > least or least == 0.0)
            step = self._direction(at, tau if first else max(centring * mean, self.end))
            length, first = _to_boundary(at.x, step.positive, settings.boundary), False
            _move(at, step, length)
        return None

    # -- the central path by its arc length -----------------------------------------------------------

    def _arc(self, tau: float, at: Iterate, fold: float, stop: Callable[[], bool]) -> Iterate | None:
        """From a kept iterate round the fold until τ is well below it; None where that fails."""
        settings, last, on_path, at = self.settings, None, False, at.copy()
        for _ in range(settings.on_arc):
            if tau < settings.passed * fold:
                return at
            if stop():
                return None
            infeasible = self._residuals(at)
            if not self._factorise(at):
                return None
            spread = self._spread(at, tau)
            onto, along = self._direction(at, tau), self._tangent()
            relative = tau * along.positive / at.x
            if not np.abs(relative).max() < settings.endless:
                return None
            tangent = np.append(relative, 1.0) / np.sqrt(relative @ relative + 1.0)
            tangent *= -1.0 if last is None else np.sign(tangent @ last)
            on_path = on_path or (infeasible < settings.feasible and spread < settings.wide)
            change = 0.0
            if on_path:  # the corrector stays in the plane across the tangent
                offset = onto.positive / at.x
                change = -(offset @ tangent[:-1]) / (relative @ tangent[:-1] + tangent[-1])
                if spread < settings.wide:
                    fastest = max(-tangent[:-1].min(), settings.growing * tangent[:-1].max())
                    change += tangent[-1] * settings.stride / max(fastest, abs(tangent[-1]) / settings.by_tau)
                    last = tangent
                change = float(np.clip(change, max(np.log(self.end / tau), -settings.down), settings.up))
            step = onto.and_on(along, tau * change)
            length = _to_boundary(at.x, step.positive, settings.boundary)
            _move(at, step, length)
            tau *= np.exp(length * change)
        return None

    # -- Newton ---------------------------------------------------------------------------------------

    def _residuals(self, at: Iterate) -> float:
        """Residuals of the linear equations into self; returns the largest."""
        problem, before, mu = self.problem, self.before, self.problem.friction
        normal, one, two, opening, slip_one, slip_two = np.split(at.x, 6)
        self.unbalanced = problem.imbalance(normal, at.shear, at.load)
        self.off_gap = problem.bn @ at.u + normal / problem.kn - opening
        slide = problem.bt @ (at.u - before.displacements)
        self.off_slide = slip_one - slip_two - (at.shear - before.shear) / problem.ks - slide
        self.off_one, self.off_two = mu * normal + at.shear - one, mu * normal - at.shear - two
        if self.displacement is None:
            self.off_target = self.target - at.load
        else:
            self.off_target = self.displacement - problem.live @ at.u
        rest = (self.unbalanced, self.off_gap, self.off_slide, self.off_one, self.off_two)
        return max(float(np.abs(r).max(initial=0.0)) for r in rest)

    def _factorise(self, at: Iterate) -> bool:
        look()
        problem = self.problem
        normal, one, two, opening, slip_one, slip_two = self.parts = np.split(at.x, 6)
        self.soft_n = opening + normal / problem.kn
        self.ratios = slip_one / one, slip_two / two
        self.soft_t = 1.0 / problem.ks + self.ratios[0] + self.ratios[1]
        self.stiff_n, self.stiff_t = normal / self.soft_n, 1.0 / self.soft_t
        self.drag = problem.friction * (self.ratios[0] - self.ratios[1]) / self.soft_t
        try:
            self.lu = problem.factorised(self.stiff_n, self.stiff_t, self.drag * self.stiff_n)
        except RuntimeError:
            return False
        self.by_live = self.lu.solve(problem.live)
        return bool(np.isfinite(self.by_live).all())

    def _direction(self, at: Iterate, tau: float) -> Direction:
        """Towards the linear equations and products of τ."""
        normal, one, two, opening, slip_one, slip_two = self.parts
        products = tau - normal * opening, tau - one * slip_one, tau - two * slip_two
        return self._solve(self.unbalanced, self.off_gap, self.off_slide, self.off_one, self.off_two,
                           self.off_target, products)  # fmt: skip

    def _tangent(self) -> Direction:
        """Change of the central path by τ."""
        none, one = np.zeros(self.problem.n_points), np.ones(self.problem.n_points)
        return self._solve(np.zeros_like(self.unbalanced), none, none, none, none, 0.0, (one, one, one))

    def _solve(self, unbalanced, off_gap, off_slide, off_one, off_two, off_target, products) -> Direction:
        """Newton's equations, condensed on the free degrees of freedom and bordered by the live load."""
        problem, mu = self.problem, self.problem.friction
        normal, one, two, _, slip_one, slip_two = self.parts
        push = (products[0] - normal * off_gap) / self.soft_n
        first, second = (products[1] - slip_one * off_one) / one, (products[2] - slip_two * off_two) / two
        rub = (first - second + off_slide) / self.soft_t - self.drag * push
        u = self.lu.solve(unbalanced + problem.bnt @ push + problem.btt @ rub)
        if self.displacement is None:
            load = off_target
        else:
            load = (off_target - problem.live @ u) / (problem.live @ self.by_live)
        u = u + load * self.by_live
        closing = problem.bn @ u
        d_normal = push - self.stiff_n * closing
        d_shear = rub - self.stiff_t * (problem.bt @ u) + self.drag * self.stiff_n * closing
        d_one, d_two = mu * d_normal + d_shear + off_one, mu * d_normal - d_shear + off_two
        positive = [
            d_normal, d_one, d_two, off_gap + closing + d_normal / problem.kn,
            first - self.ratios[0] * (d_one - off_one), second - self.ratios[1] * (d_two - off_two),
        ]  # fmt: skip
        return Direction(u, float(load), d_shear, np.concatenate(positive))

    def _spread(self, at: Iterate, mean: float) -> float:
        """Largest ratio of a product to the mean, or of the mean to a product."""
        products = at.x[: len(at.x) // 2] * at.x[len(at.x) // 2 :]
        return max(float(products.max()) / mean, mean / max(float(products.min()), 1e-300))

    def _state(self, at: Iterate) -> State:
        normal, _, _, _, slip_one, slip_two = np.split(at.x, 6)
        return State(at.u, at.load, normal, at.shear, (slip_one, slip_two))


def _apart(difference: np.ndarray, tau: float) -> tuple[np.ndarray, np.ndarray]:
    """Two positive numbers with this difference and the product τ."""
    root = np.sqrt(difference**2 + 4.0 * tau)
    larger = 0.5 * (np.abs(difference) + root)
    first = np.where(difference > 0.0, larger, tau / larger)
    return first, tau / first


def _to_boundary(x: np.ndarray, step: np.ndarray, share: float) -> float:
    """Length of the step that goes a share of the way to where something is no more positive, at most one."""
    steepest = float((step / x).min(initial=0.0))
    return min(1.0, -share / steepest) if steepest < 0.0 else 1.0


def _move(at: Iterate, step: Direction, length: float) -> None:
    at.u = at.u + length * step.displacements
    at.load += length * step.load
    at.shear = at.shear + length * step.shear
    at.x = at.x + length * step.positive
