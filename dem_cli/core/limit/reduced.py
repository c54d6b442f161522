"""Lower bound of failure loads of joints that slide without dilating: the reduced domain (Radenkovic; thesis 3.1.1).

A joint that slides at N has to take (C + (μ − tan ψ) N) · slip. Replace its strength by a reduced domain, in which the
flow is that of the real joint and associated, and which takes no more than the least of that:

    |T| ≤ C + (μ − tan ψ) N_min + tan ψ N            N_min: the least normal force at which the joint may slide

Let forces of the reduced domain balance the dead loads and the live ones times `low`, and others the live ones times
`reached`. Then virtual work of both in the mechanism of any collapse at a multiplier between them would take more than
the loads give: there is no collapse in between, whatever the history. With N_min = −ft A, all that the strength itself
says, this is the thesis's domain, |T| ≤ c A of joints without tension: zero where cohesion is zero. Statics says
more: N_min is found by one linear program for each joint, over all forces that the real joints carry at loads of the
interval, and the interval is moved on from what was reached.

It holds for the geometry of the start and joints that keep their strength while they slide and open. A point without
tension loses its cohesion as it opens (laws/mohr_coulomb.py): only what one point has of it counts, and only where the
joint presses; the thesis's domain has all of it.
"""

from __future__ import annotations

import time
from typing import Any, NamedTuple

import numpy as np

from dem_cli.core.laws.envelope import Envelope
from dem_cli.core.limit.joint_forces import SOLVED, JointForces
from dem_cli.core.limit.matrices import LimitStructure
from dem_cli.core.limit.settings import DEFAULT_LIMIT, ReducedSettings

OK, NONE = "ok", "no load proved: the reduced domain does not carry the dead loads, or carries any load"


class LowerBound(NamedTuple):
    """Lower bound of the failure load: below it nothing collapses."""

    status: str  # OK or NONE
    multiplier: float | None  # of the live loads, as users know it; None where none was proved
    reduced_domain: (
        float | None
    )  # of the thesis, for joints that keep their cohesion where they open; None: without any
    programs: int  # linear programs solved
    seconds: float

    def summary(self) -> dict[str, Any]:
        """Return the entries of summary.json about the lower bound."""
        return {
            "lower_bound": self.multiplier,
            "lower_bound_status": self.status,
            "reduced_domain": self.reduced_domain,
            "lower_bound_programs": self.programs,
            "lower_bound_seconds": self.seconds,
        }


def lower_bound(
    structure: LimitStructure,
    strength: Envelope,
    residual: Envelope,
    associated: float,
    settings: ReducedSettings = DEFAULT_LIMIT.reduced,
) -> LowerBound:
    """Compute a lower bound of the failure load, up to the associated load (infinite: by the strength alone).

    strength: what points carry at most; residual: what they keep while they slide and open.
    """
    return ReducedDomain(structure, strength, residual, settings).search(associated)


class ReducedDomain:
    """Linear programs inside the strength of the joints (`most`), and inside the reduced domain of their residual
    strength."""

    def __init__(
        self, structure: LimitStructure, strength: Envelope, residual: Envelope, settings: ReducedSettings
    ) -> None:
        self.settings = settings
        self.most = JointForces(structure, strength)
        self.kept = JointForces(structure, residual)
        tensions = np.bincount(self.most.joint, self.most.strength.tension, self.most.n_joints)
        self.untied = np.maximum(-tensions, -settings.endless)  # least normal forces that the strength alone allows

    def search(self, associated: float) -> LowerBound:
        """Intervals from zero on, each from what the last one reached."""
        begun, settings = time.perf_counter(), self.settings
        low, high = 0.0, associated
        own = self.kept.strength
        some = own.cohesion.any() or own.dilation.any()  # else it has no shear strength at all
        thesis = self.reach(self.untied, 0.0, associated, own.cohesion) if some else None
        first = self.reach(self.untied, 0.0, associated)
        if first is not None:
            low = first
        proved = first is not None
        for _ in range(settings.intervals):
            effort = (self.most.programs + self.most.n_joints) * self.most.n_joints
            if not associated - low > settings.accuracy * associated or effort > settings.effort:
                break
            reached = self.reach(self.least_normals(low, high), low, high)
            if reached is None or not reached - low >= settings.least_gain * (high - low):
                if not high - low > settings.accuracy * associated:
                    break
                high = low + settings.shorter * (high - low)
                continue
            low, high, proved = reached, associated, True
        programs, spent = self.most.programs + self.kept.programs, time.perf_counter() - begun
        return LowerBound(OK if proved else NONE, low if proved else None, thesis, programs, spent)

    def least_normals(self, low: float, high: float) -> np.ndarray:
        """Least normal force of each joint in any equilibrium at loads of the interval [mean weights], (n_joints,)."""
        most = self.most
        bounds, rows, tops = most.bounds(low, high), *most.cone_rows()
        least = self.untied.copy()
        for k in range(most.n_joints):
            cost = np.zeros(most.n)
            cost[: most.n_points][most.joint == k] = 1.0
            found = most.solve(cost, bounds, rows, tops)
            if found.status == SOLVED:
                least[k] = max(least[k], found.fun - self.settings.margin)
        return least

    def reach(self, least: np.ndarray, low: float, high: float, cohesion: np.ndarray | None = None) -> float | None:
        """Compute the largest multiplier up to `high` in the reduced domain; None where `low` is not in it.

        least: normal forces of the joints that slide; cohesion: of them, None: what no opening takes away.
        """
        kept, own = self.kept, self.kept.strength
        cohesion = kept.sure_cohesion(least) if cohesion is None else cohesion
        fixed = np.maximum(cohesion + (own.friction - own.dilation) * least, 0.0)
        bounds, rows, tops = kept.bounds(low, high), *kept.cone_rows(own.dilation, fixed)
        cost = np.zeros(kept.n)
        cost[-1] = 1.0
        first = kept.solve(cost, bounds, rows, tops)
        if first.status != SOLVED or first.fun * kept.load > low + self.settings.margin * kept.load:
            return None
        last = kept.solve(-cost, bounds, rows, tops)
        if last.status != SOLVED:
            return None  # without an upper end any load, as far as these forces tell: none to name
        return max(float(-last.fun * kept.load) * (1.0 - self.settings.margin), low) + 0.0
