"""Failure load of joints that do not dilate: a path of elastic, frictional joints from gravity to collapse.

The displacement of the live load grows until its multiplier grows no more. Every point of the path is a
state in equilibrium under the real, non-associated law (limit.elastic), so that the plateau is a true
collapse state of the structure loaded from gravity, whatever the stiffness of its joints. The state is
that of the explicit solver (gaps, shear springs), which can go on from it.

The load of irregular structures grows in stairs: it rests while a few blocks come to lie elsewhere, over some elastic
displacements, which are nothing for blocks that are rigid, and rises again. So a plateau is looked at from far ahead,
by a few long increments, and where the load is higher there, the path is followed on.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from copy import copy
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.limit.elastic import Elastic, State
from dem_cli.core.limit.interior import Increment
from dem_cli.core.limit.matrices import LimitStructure
from dem_cli.core.limit.settings import DEFAULT_LIMIT, LimitSettings, PathSettings

OK = "ok"
FALLS = "not converged: no state under dead loads was found"  # no proof that there is none
UNFINISHED = "not converged: the load still grows with displacement"


@dataclass
class Path:
    """Path of the load to collapse, and the state at its highest load."""

    status: str  # OK, FALLS, UNFINISHED
    load: float | None = None  # multiplier of the live loads, as users know it
    residual: float = np.inf  # largest unbalanced force under the joint law, in own weights
    normal: np.ndarray | None = None  # [N], (n_points,)
    shear: np.ndarray | None = None  # on b along the tangents [N], (n_points, d − 1)
    gaps: np.ndarray | None = None  # opening of the points [m], (n_points,)
    displacements: np.ndarray | None = None  # since before gravity, (n_blocks, n_dof)
    mechanism: np.ndarray | None = None  # motion of its increment; its live power is one, (n_blocks, n_dof)
    loads: list[float] = field(default_factory=list)  # multiplier after each increment
    reached: list[float] = field(default_factory=list)  # displacement, in elastic ones at the multiplier of one
    live_displacements: list[float] = field(default_factory=list)  # live loads × displacements since before gravity [J]
    highest: int = 0  # increment at which the load was highest: the state is that
    factorisations: int = 0
    rest: float | None = None  # multiplier at its first plateau, where the load was seen to be higher beyond
    smoothing: float = 0.0  # products that were left on the way, over the square of the largest normal force

    @property
    def state(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray] | None:
        """Normal and shear forces, gaps and displacements at the highest load, where there is one."""
        if self.normal is None or self.shear is None or self.gaps is None or self.displacements is None:
            return None
        return self.normal, self.shear, self.gaps, self.displacements

    def reach(self, load: float) -> float:
        """Displacement, in elastic ones, at which the path first came to a load; to one beyond, that at its highest."""
        first = next((i for i, reached in enumerate(self.loads) if reached >= load), self.highest)
        return self.reached[first] if self.reached else 0.0

    @property
    def fall(self) -> float:
        """Largest fall of the load on the way to its highest, over that: a load that is raised fails at this peak."""
        if not self.load:
            return 0.0
        loads = np.array(self.loads[: self.highest + 1])
        return float((np.maximum.accumulate(loads) - loads).max() / abs(self.load))

    @property
    def finished(self) -> bool:
        """Test whether the load stopped growing."""
        return self.status == OK

    def flat(self, share: float) -> bool:
        """Test whether the highest load is a plateau, reached beyond that share of the displacement, rather than a
        peak."""
        return self.finished and self.reached[self.highest] > share * self.reached[-1]

    def summary(self) -> dict[str, Any]:
        """Return the entries of summary.json about the path."""
        return {
            "load": self.load,
            "status": self.status,
            "residual": self.residual if np.isfinite(self.residual) else None,
            "displacement": self.reached[self.highest] if self.reached else None,
            "final_load": self.loads[-1] if self.loads else None,
            "highest_increment": self.highest if self.loads else None,
            "first_plateau": self.rest,
            "factorisations": self.factorisations,
            **({"smoothing": self.smoothing} if self.smoothing else {}),
        }


def trace(
    structure: LimitStructure,
    friction: np.ndarray,
    plateau: float | None = None,
    effort: float | None = None,
    progress: Callable[[float, float], None] = lambda load, reached: None,
    settings: LimitSettings = DEFAULT_LIMIT,
) -> Path:
    """Trace the load path from gravity to the plateau of the load.

    friction  coefficient of every point [-], (n_points,)
    plateau   relative growth of the load, over that of the displacement, that counts as none (None: as the settings)
    effort    factorisations × points after which what was reached is returned (None: as the settings)
    progress  called with the load and the displacement of every increment
    """
    problem = Elastic(structure, friction, settings)
    growth_of_plateau = settings.path.plateau if plateau is None else plateau
    points = max(problem.n_points, 1)
    longest = settings.longest_path(structure.model.dimension) * points
    affordable = settings.path.smoothed_effort / points**0.5 if settings.path.smoothing else settings.path.effort
    most = min(affordable, longest) if effort is None else effort
    path = Path(FALLS, smoothing=settings.path.smoothing)

    def spent() -> bool:
        return problem.factorisations * problem.n_points > most

    rest = at_rest(problem)
    for easier, folds in settings.path.easier:
        standing = _advance(problem, rest, None, spent, folds, easier)
        if standing is not None:
            break
    path.factorisations = problem.factorisations
    if standing is None:
        return path
    _keep(path, structure, problem, standing, rest, 0.0)
    path.status = UNFINISHED
    _follow(path, structure, problem, standing, growth_of_plateau, spent, progress)
    path.factorisations = problem.factorisations
    return path


class Stride(NamedTuple):
    """Increment that led to a state, and the state before it."""

    increment: Increment
    before: State
    state: State
    length: float  # displacement [elastic ones]
    share: float  # of the longest increment, over that tried first
    earlier: Increment | None  # the one that led to the state before; None: gravity


class Walk:
    """Incremental path from gravity: longer increments where they succeed, shorter ones where they fail."""

    def __init__(self, problem: Elastic, standing: State, stop: Callable[[], bool]) -> None:
        self.problem, self.settings, self.stop = problem, problem.settings.path, stop
        self.state = standing
        self.origin, self.elastic = float(product(problem.live, standing.displacements)), compliance(problem, standing)
        self.reached = 0.0
        self.share = 1.0  # of the longest increment, that the next one is tried with
        self.last: Stride | None = None

    def go_on(self) -> bool:
        """Try increments of several sizes; True where one led to another state, exact or rough (State.left)."""
        settings = self.settings
        longest = (settings.growth - 1.0) * self.reached if self.reached else settings.first
        found, resort = None, None  # a rough state is the last resort, where shorter increments lead nowhere either
        for share, easier, folds in settings.attempts:
            found = self._advanced(longest, share, easier, folds)
            if found is not None and not found.state.left:
                break
            found, resort = None, resort or found
            if self.stop() or (resort is not None and share == settings.last_exact):
                break
        if (stride := found or resort) is not None:
            self._moved(stride)
        return stride is not None

    def _advanced(self, longest: float, share: float, easier: float, folds: int) -> Stride | None:
        settings, problem, state = self.settings, self.problem, self.state
        length = share * self.share * longest
        target = self.origin + self.elastic * (self.reached + length)
        ahead = min(length / self.last.length, settings.ahead) if self.last is not None and easier == 1.0 else 0.0
        largest = float(state.normal.max(initial=1.0)) ** 2
        end = settings.smoothing * largest / problem.lightest if settings.smoothing else settings.end
        increment = Increment(problem, state, target, end=end)
        rough = settings.rough * largest
        tau = easier * first_products(problem, state, target)
        found = increment.solve(tau, ahead, folds, self.stop, rough)
        if found is None:
            return None
        if not (found.left or settings.smoothing) and problem.residual(found, state) >= settings.accepted:
            return None
        return Stride(increment, state, found, length, share, self.last.increment if self.last is not None else None)

    def far_ahead(self) -> Iterator[tuple[float, float]]:
        """Look ahead by long increments, as far as these lead: displacements and loads there; the walk stays here."""
        ahead, leaping = copy(self), True
        ahead.share = 1.0
        most = int((1.0 + self.settings.effort_ahead) * self.problem.factorisations)
        ahead.stop = lambda: self.stop() or self.problem.factorisations > most
        while ahead.reached < self.settings.far_ahead * self.reached and not ahead.stop():
            leap = ahead._advanced((self.settings.leap - 1.0) * ahead.reached, 1.0, 1.0, 0) if leaping else None
            if leap is not None and not leap.state.left:
                ahead._moved(leap)
            else:
                leaping = False
                if not ahead.go_on():
                    return
            if not ahead.state.left:
                yield ahead.reached, ahead.state.load

    def _moved(self, stride: Stride) -> None:
        self.last, self.state = stride, stride.state
        self.reached += stride.length
        if stride.share == 1.0:
            self.share = min(1.0, self.settings.regrowth * self.share)
        elif stride.share < 1.0:
            self.share = max(self.settings.smallest, stride.share * self.share)


def _follow(
    path: Path,
    structure: LimitStructure,
    problem: Elastic,
    state: State,
    plateau: float,
    stop: Callable[[], bool],
    progress: Callable[[float, float], None],
) -> None:
    """Follow increments from gravity until the load grows no more (status OK), or one fails in every size."""
    settings, walk = problem.settings.path, Walk(problem, state, stop)
    calm_since, slope = np.inf, np.inf  # displacement from which on the load grows no more
    best: tuple[Stride, float] | None = None  # that of the highest load, and where it led
    higher = 0.0  # displacement at which the load is known to be higher than on a plateau before it
    while walk.reached < settings.furthest:
        if walk.reached >= higher and is_plateau(settings, walk.reached, calm_since, slope / plateau):
            higher = _higher_ahead(path, walk, problem.live_scale, plateau)
            if walk.reached >= higher:
                break
            path.rest = path.load if path.rest is None else path.rest
        if not walk.go_on():
            break
        assert walk.last is not None
        if walk.state.left:
            continue
        slope, since = _slope(path, settings, walk.state.load * problem.live_scale, walk.reached)
        calm_since = min(calm_since, since) if slope < plateau else np.inf
        if _keep(path, structure, problem, walk.state, walk.last.before, walk.reached):
            best = (walk.last, walk.reached)
        progress(path.loads[-1], walk.reached)
    if best is not None and not settings.smoothing:
        _polish(path, structure, problem, *best)
    if walk.reached >= higher and is_plateau(settings, walk.reached, calm_since, slope / plateau):
        path.status = OK


def _higher_ahead(path: Path, walk: Walk, scale: float, plateau: float) -> float:
    """Displacement ahead at which the load of a plateau has risen again; 0: not as far as long increments lead."""
    if walk.settings.smoothing or path.load is None:
        return 0.0
    higher = path.load + plateau * abs(path.load)
    return next((reached for reached, load in walk.far_ahead() if load * scale > higher), 0.0)


def _slope(path: Path, settings: PathSettings, load: float, reached: float) -> tuple[float, float]:
    """Compute the relative growth of the load over that of the displacement, and since where: over a full
    increment."""
    behind = [k for k, before in enumerate(path.reached) if 0.0 < settings.span * before <= reached]
    if not behind:
        return np.inf, np.inf
    last = path.reached[behind[-1]]
    growth = (load - path.loads[behind[-1]]) / max(abs(load), 1e-12)
    return abs(growth) * last / (reached - last), last


def is_plateau(settings: PathSettings, reached: float, since: float, slope: float) -> bool:
    """Test whether a load that grows no more since a displacement has come to its plateau.

    slope: of the last increment, in those that count as none. Early on, while joints still open and close one after
    the other, a load may rest and rise again: there it has to last. Later the first plateau counts.
    """
    if reached >= settings.lasting * since:
        return True
    return since >= settings.early and (slope < settings.calm or reached > settings.growth**1.5 * since)


def at_rest(problem: Elastic) -> State:
    """Return the state before gravity: blocks where they are drawn, all joints pressed by half a weight.

    From there dead loads come at once.
    """
    n, shear = problem.n_points, np.zeros(len(problem.ks_t))
    still, slip = np.zeros(len(problem.columns)), np.zeros(n + len(shear))
    return State(still, 0.0, np.full(n, 0.5), shear, slip, plastic=np.zeros(problem.n_links))


def _advance(
    problem: Elastic,
    state: State,
    target: float | None,
    stop: Callable[[], bool],
    folds: int = 0,
    easier: float = 1.0,
) -> State | None:
    """Solve for the state at a displacement of the live load; without one, under dead loads alone."""
    tau = easier * first_products(problem, state, target)
    return Increment(problem, state, target).solve(tau, 0.0, folds, stop)


def first_products(problem: Elastic, state: State, target: float | None) -> float:
    """Products N p and c ∘ a to begin an increment with."""
    largest = float(state.normal.max(initial=1.0)) if target is not None else float(np.abs(problem.dead).max())
    return problem.settings.path.tau * max(largest, 1.0) ** 2


def compliance(problem: Elastic, state: State) -> float:
    """Displacement of the live load per unit of multiplier while all loaded joints are closed."""
    path = problem.settings.path
    closed = state.normal > path.loaded * state.normal.max(initial=1.0)
    share = np.where(closed, 1.0, path.opened)
    return float(product(problem.live, problem.elastic(share).solve(problem.live)))


def _polish(path: Path, structure: LimitStructure, problem: Elastic, stride: Stride, reached: float) -> None:
    """Solve the increment of the highest load to the end, and the one before, for the mechanism between them."""
    found = stride.increment.polished()
    if found is None or problem.residual(found, stride.before) > path.residual:
        return
    before = (stride.earlier.polished() if stride.earlier is not None else None) or stride.before
    later = [part[path.highest + 1 :] for part in (path.loads, path.reached, path.live_displacements)]
    for part in (path.loads, path.reached, path.live_displacements):
        del part[path.highest :]
    path.load = None
    _keep(path, structure, problem, found, stride.before, reached, before)
    for part, after in zip((path.loads, path.reached, path.live_displacements), later, strict=True):
        part += after


def _keep(
    path: Path,
    structure: LimitStructure,
    problem: Elastic,
    state: State,
    before: State,
    reached: float,
    since: State | None = None,
) -> bool:
    """Append an increment to the path, and store its state in SI units where the load is the highest; returns
    whether it is.

    since: the state before, closer to the law, that the mechanism is taken from (None: before)
    """
    moved = problem.displacements(state.displacements)
    load = state.load * problem.live_scale
    path.loads.append(load)
    path.reached.append(reached)
    path.live_displacements.append(float(product(structure.live, moved)))
    if path.load is not None and load < path.load:
        return False  # softer than before: the structure fails where the load was highest
    path.load, path.highest = load, len(path.loads) - 1
    path.residual = problem.residual(state, before)
    path.normal, path.shear, path.gaps = problem.forces_and_gaps(state)
    path.displacements = structure.on_blocks(moved)
    motion = moved - problem.displacements((since or before).displacements)
    power = float(product(structure.live, motion))
    path.mechanism = structure.on_blocks(motion / power) if power > 0.0 else structure.on_blocks(0.0 * motion)
    return True
