"""Settings of limit analysis: path to collapse and its interior point, associated load, lower bound, least load."""

from __future__ import annotations

import math
from dataclasses import replace

from dem_cli.frozen_records import dataclass


@dataclass(frozen=True)
class PathSettings:
    """Settings of the path of elastic, frictional joints from gravity to collapse: increments, plateau, effort."""

    first: float = 0.25  # displacement of the first increment, in elastic ones at the multiplier 1
    growth: float = 1.3  # of the displacement; where it doubles, walls step over the plateau that load control ends at
    # Where an increment fails: shares of it, first products in those that are set, and folds of the central path to go
    # round. Longer ones last: they may leap over a failure, onto a branch that carries more.
    attempts: tuple[tuple[float, float, int], ...] = (
        (1.0, 1.0, 0), (0.4, 1.0, 0), (0.16, 1.0, 0), (0.064, 1.0, 0), (1.0, 100.0, 0), (0.4, 1.0, 4), (1.0, 1.0, 4),
        (2.2, 1.0, 0), (5.0, 1.0, 0),
    )  # fmt: skip
    regrowth: float = 2.0  # of increments that had to be shorter, one after the other
    smallest: float = 0.15  # of the longest increment: the next one begins no shorter
    ahead: float = 1.5  # of the last slips, that the next increment expects at most
    last_exact: float = 0.16  # share of an increment: where none down to it is found, one in a rough state is taken
    smoothing: float = 0.0  # products that increments end at, over the square of the largest normal force; 0: `end`
    rough: float = 5e-4  # products that may be left on the way, over the square of the largest normal force
    span: float = 1.2  # growth of the displacement over which that of the load is looked at
    # Under dead loads alone: first products in those that are set, and folds.
    easier: tuple[tuple[float, int], ...] = ((1.0, 0), (1e2, 0), (1.0, 4), (1e2, 4), (1e4, 4))
    effort: float = 2e7  # factorisations × points before giving up: about half a minute
    smoothed_effort: float = 6.5e9  # the same of a path that is smoothed, × points to the power of 1.5: some 90 s
    large: int = 1600  # blocks of one structure, beyond which the path is smoothed, and where it ends is the answer
    large_in_space: int = 1000  # the same in 3D, where it is not smoothed
    most: int = 2500  # factorisations before giving up
    most_in_space: int = 1200  # the same in 3D: what ends at all ends by then
    furthest: float = 1e5  # displacement at which a structure counts as self-locking
    plateau: float = 2e-3  # relative growth of the load over that of the displacement that counts as zero, ...
    lasting: float = 2.0  # ... where it lasts until the displacement is so many times as large, ...
    early: float = 2.0  # ... or, from this displacement on, in two increments,
    calm: float = 0.5  # or in one of less than this share
    far_ahead: float = 8.9  # times the displacement at the end of a plateau: what still counts as a rest on the way
    leap: float = 3.0  # growth of the displacement in the increments that look so far
    effort_ahead: float = 0.5  # of the factorisations before it, that it takes to look so far
    finer: float = 1e-5  # the same growth, where the load is known to be higher than a first plateau
    tau: float = 0.01  # of the first products, over the square of the largest normal force
    end: float = 1e-7  # of the last ones on the way (InteriorPointSettings.end at the highest load)
    accepted: float = 1e-2  # unbalanced force under the exact law, in own weights, of a state worth keeping
    least_friction: float = 1e-6  # of points without friction: negligible, and the equations stay the same
    loaded: float = 1e-6  # of the largest normal force: a point with less counts as open, ...
    opened: float = 1e-6  # ... and has this share of its stiffness, for the compliance of the start
    points_summed: float = 3.0  # of a joint in space, from which on they are summed before they go into the fronts
    cones_compiled: int = 1000  # points in space from which on their friction is worked out in compiled code
    singular: float = 1e-13  # added to the diagonal, over its mean


@dataclass(frozen=True)
class InteriorPointSettings:
    """Settings of the interior point of one increment, and of its way round the folds of the central path."""

    tolerance: float = 1e-7  # infeasibility, in block weights and their displacements
    end: float = 1e-9  # of τ, over the square of the lightest block
    at_end: float = 3.0  # times it: the mean product of a solution
    friction_used: float = 0.999  # share of the friction that a start uses at most
    boundary: float = 0.99  # share of the way to the boundary
    # Share of the mean product aimed at, by the length of the last step; none: by a predictor.
    centring: tuple[tuple[float, float], ...] = ()
    least: float = 1e-3  # share of the mean product aimed at, at least
    widest: float = 10.0  # curvature counts up to so many times the mean product, and so far apart may products be
    blind: float = 0.1  # length of a step with curvature, below which one without it is tried ...
    back: tuple[float, ...] = (0.3, 1.0)  # ... that aims at these shares of the mean product
    correctors: int = 2  # towards the central path, of one step, ...
    far: float = 0.95  # ... while it is not as long as that; ...
    beyond: float = 0.3  # ... each looks so much further, ...
    gain: float = 0.03  # ... and has to make it so much longer
    short: float = 0.02  # length of a step that leads nowhere, ...
    short_steps: int = 3  # ... of which so many in turn end an iteration
    stalled: float = 0.5  # fold: the mean product fell by less than this
    patience: int = 6  # within so many iterations
    feasible: float = 1e-3  # infeasibility from which on that counts, and of iterates that may be predicted from
    balanced: float = 1e-5  # infeasibility of an iterate that may be kept
    centred: float = 30.0  # largest ratio of a product to the mean, of a kept iterate
    wide: float = 3.0  # the same of an iterate that may be predicted from
    reversal: float = 0.9  # mean product of one kept iterate over that of the last
    stride: float = 0.9  # relative change of any product's factor in one prediction
    growing: float = 0.3  # what the growth of a product counts, over its fall, in the length of a prediction
    by_tau: float = 3.0  # times as much as the other products, may τ change
    down: float = 3.0  # largest fall of ln τ in one prediction
    up: float = 2.0  # and rise
    passed: float = 0.3  # τ over that of the fold, below which it is passed
    on_arc: int = 500  # iterations on one arc
    slow: int = 40  # iterations without a fold
    endless: float = 1e12  # relative change by τ at which the path turns on the spot
    near_yield: float = 1e-6  # share of its largest force below which a tie is taken to yield on in an increment, ...
    yieldings: int = 8  # ... which is done so often with other ties that yield


# Where the central path may turn back it is followed closely: a predictor leaves it too far for an arc.
ROUND_FOLDS = InteriorPointSettings(
    centring=((0.9, 0.05), (0.6, 0.2), (0.3, 0.5), (0.1, 0.9), (0.0, 1.0)), boundary=0.95, stalled=0.8, patience=12,
    balanced=1e-3, centred=4.0, reversal=0.6, slow=150, short_steps=150,
)  # fmt: skip
# In space slips turn as well as grow: arcs are followed in shorter strides, from closer to the path.
ROUND_FOLDS_IN_SPACE = replace(ROUND_FOLDS, stride=0.2, wide=2.0, on_arc=200)


@dataclass(frozen=True)
class AssociatedSettings:
    """Settings of the associated limit load as a cone program: where the solver stops, which errors are accepted."""

    feasible: float = 1e-7  # unbalanced force in own weights at which the solver may stop
    residual: float = 1e-6  # largest accepted unbalanced force in own weights
    gap: float = 1e-4  # largest accepted width of the bounds over the load
    nothing: float = 1e-3  # live over dead loads, below which bounds are compared with this
    proof: float = 1e-6  # relative error accepted in a proof that something is impossible
    slides: float = 1e-3  # share of friction in the work of a mechanism, below which nothing slides in it
    carries: float = 1e-6  # of the largest normal force: a point with less carries nothing
    least_gap: float = 1e-9  # of the bounds, relative: what round-off leaves of smaller ones
    # Degrees of freedom up to which the cone program is factorised column by column, beyond in supernodes. The ratio of
    # CPU seconds in space was 0.64 to 0.94 for 500 to 1,500 blocks, 0.95 and 1.34 for 2,000, 1.31 for 3,000, of walls,
    # vaults and houses: supernodes do more at a time, but are ordered with a quarter more entries.
    by_columns: int = 9000
    # Of the interior point on fronts (limit/frontal_program.py)
    on_fronts: int = 5000  # degrees of freedom from which on the loads of plane joints with friction alone are found so
    most: int = 100  # iterations
    balanced: float = 0.3  # share of `residual`, ...
    closed: float = 0.1  # ... and of `gap`, at which it ends
    singular: float = 1e-20  # added to the diagonal, over its mean
    boundary: float = 0.99  # share of the way to the boundary
    least: float = 1e-6  # share of the mean product aimed at, at least
    correctors: int = 2  # of one step, ...
    far: float = 0.95  # ... while it is not as long as that; ...
    beyond: float = 0.3  # ... each looks so much further, ...
    gain: float = 0.03  # ... and has to make it so much longer
    widest: float = 10.0  # products over the mean, and the mean over them, that need no correction


@dataclass(frozen=True)
class ReducedSettings:
    """Settings of the lower bound by the reduced domain: intervals of the load, accuracy, effort."""

    intervals: int = 12  # that are tried at most
    accuracy: float = 1e-3  # of the associated load, to which the bound is sought
    least_gain: float = 0.02  # of an interval: less counts as zero
    shorter: float = 0.25  # share of an interval that is tried where it gave nothing
    effort: float = 5e4  # linear programs × joints, at most: some seconds
    margin: float = 1e-6  # in mean weights and of a load: what the solver leaves open
    endless: float = 1e6  # least normal force of joints that cannot be pulled apart, in mean weights


@dataclass(frozen=True)
class LeastSettings:
    """Settings of the least load of joints that do not dilate, as a mixed-integer program: bounds, effort,
    accuracy."""

    forces: float = 20.0  # largest normal force of a contact point, in all dead and live loads together
    # Largest rate of a joint, over that of the least loaded block if it moves alone: to search and to prove with ...
    rates: tuple[float, ...] = (10.0, 100.0)
    slightest: float = 0.02  # ... where no block counts as less loaded than this share of the most loaded one
    whole: int = 40  # joints, up to which all mechanisms are searched
    nodes: int = 10_000  # of a search of all states
    near: int = 2_000  # nodes of a search around a state
    changed: int = 2  # states of contact points and joints that a local search may change at once
    rounds: int = 30  # of the local search
    weights: tuple[float, ...] = (1.0, 0.1, 10.0, 0.01, 100.0)  # of rates beside forces, at the end of a path
    better: float = 1e-4  # share of the load that is an improvement
    gap: float = 1e-4  # relative, of load and proved bound at which a search ends
    carries: float = 1e-7  # force in mean weights: less counts as zero
    accepted: float = 1e-5  # residual of the conditions, in mean weights, of a state that is believed


@dataclass(frozen=True)
class LimitSettings:
    """Settings of limit analysis, grouped by method."""

    path: PathSettings = PathSettings()
    interior_point: InteriorPointSettings = InteriorPointSettings()
    round_folds: InteriorPointSettings = ROUND_FOLDS
    round_folds_in_space: InteriorPointSettings = ROUND_FOLDS_IN_SPACE
    associated: AssociatedSettings = AssociatedSettings()
    reduced: ReducedSettings = ReducedSettings()
    least: LeastSettings = LeastSettings()
    touching: float | None = None  # gap or overlap of faces that touch, in smallest edges; None: as in every analysis

    def longest_path(self, dimension: int) -> int:
        """Factorisations of a path in 2D or 3D."""
        return {2: self.path.most, 3: self.path.most_in_space}[dimension]

    def of_increment(self, dimension: int, folds: int = 0) -> InteriorPointSettings:
        """Choose the settings of the interior point in 2D or 3D, which may go round so many folds."""
        return {2: self.round_folds, 3: self.round_folds_in_space}[dimension] if folds else self.interior_point

    def too_large(self, blocks: int, dimension: int) -> bool:
        """Test whether a structure of so many blocks takes too many factorisations to follow its path to the end."""
        return blocks > {2: self.path.large, 3: self.path.large_in_space}[dimension]

    def of_path(self, blocks: int, dimension: int) -> LimitSettings:
        """Choose the settings of the path for so many blocks: in the plane, a path that is too large is smoothed."""
        return self.smoothed() if dimension == 2 and self.too_large(blocks, dimension) else self

    def smoothed(self) -> LimitSettings:
        """Return settings for large structures: increments end on the central path, the corner of friction rounded
        off.

        There increments are found where no state under the exact law is; T231 ends at 0.46644 for 0.46608, 578 blocks
        at 0.43724 for 0.43725, but of two branches the other may be taken (butt02: 1.2 for 1.173).
        """
        path = replace(self.path, smoothing=1e-5, rough=1e-4, last_exact=1.0, most=4000, early=math.inf)
        patient = replace(self.interior_point, patience=25, short_steps=20, slow=150)  # products fall slowly
        return replace(self, path=path, interior_point=patient)


DEFAULT_LIMIT = LimitSettings()
