"""Contact problem of one load increment: elastic joints without tension, Coulomb friction without dilation.

In units of a mean block weight W and of W over a median joint stiffness. For every contact point

    N ≥ 0,  p = g(u) + N/kn ≥ 0,                N p = 0        normal force, opening of the joint
    c = c(μN, T) ∈ K,  a ∈ K,                   c ∘ a = 0      reserve of friction, slip (plastic) in this increment
    Bt (u − u₀) = −(T − T₀)/ks + γ(a)                          slide: elastic and plastic part

In space friction acts nearer to the centre of pressure of its joint than its point (contact/corner_forces.py): Bt is
that of the normal forces at the begin of the increment, which are those at its end where the load grows no more.

Ties and bars are points without friction, which press as they grow longer (links/tension_points.py).

with the cones K of limit.slips, equilibrium Bᵀ(N, T) + dead + λ live = 0 and live·u = D. The bound μN moves with N
inside Newton's iteration, so that the law is the real, non-associated one; the matrix is not symmetric.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix, diags, vstack

from dem_cli.core.contact.compatibility import free_columns, relative_motion
from dem_cli.core.kernels.records import Joints
from dem_cli.core.limit.matrices import LimitStructure
from dem_cli.core.limit.newton_matrix import FrontFactors, NewtonMatrix, PointRows
from dem_cli.core.limit.settings import DEFAULT_LIMIT, LimitSettings, PathSettings
from dem_cli.core.limit.slip_cones import SlipCones
from dem_cli.core.limit.slip_pairs import SlipPairs
from dem_cli.core.limit.slips import Slips
from dem_cli.core.links.tension_points import TensionPoints

NO_TIES = np.zeros(0)
FAR = 1e6  # units that the point of a tie which yields is open: it carries nothing


def pairs_of(n_points: int, settings: PathSettings) -> SlipPairs:
    """Choose the friction model of contact points in the plane: pairs of reserves and slips."""
    return SlipPairs(n_points)


def cones_of(n_points: int, settings: PathSettings) -> SlipCones:
    """Choose the friction model of points in space; for many points the compiled one takes a third of the time."""
    if n_points < settings.cones_compiled:
        return SlipCones(n_points)
    from dem_cli.core.limit.compiled_cones import CompiledCones

    return CompiledCones(n_points)


KINDS: dict[int, Callable[[int, PathSettings], Slips]] = {2: pairs_of, 3: cones_of}  # of slips, by dimension


class State(NamedTuple):
    """Solution of one increment, in the units of `Elastic`."""

    displacements: np.ndarray  # of the free degrees of freedom, (n_free,)
    load: float  # multiplier of the scaled live loads
    normal: np.ndarray  # N, (n_points,)
    shear: np.ndarray  # T, component by component, ((d − 1)·n_points,)
    slip: np.ndarray  # a of the last increment (limit.slips), (d·n_points,)
    left: float = 0.0  # mean product N p and c ∘ a of a state on the central path, where no solution was found
    plastic: np.ndarray = NO_TIES  # elongations of ties for good, (n_links,)


class Direction(NamedTuple):
    """Newton direction; `positive` belongs to the vector (N, c, p, a)."""

    displacements: np.ndarray
    load: float
    shear: np.ndarray
    positive: np.ndarray

    def and_on(self, other: Direction, share: float) -> Direction:
        """Add a share of another direction to this one."""
        return Direction(
            self.displacements + share * other.displacements,
            self.load + share * other.load,
            self.shear + share * other.shear,
            self.positive + share * other.positive,
        )


class Elastic:
    """Scaled matrices of a structure with elastic joints; points of its ties follow those of its joints.

    gaps: of all joints where displacements are zero [m], (n_joint_points,), negative: overlaps; None: they just touch.
    """

    def __init__(
        self,
        structure: LimitStructure,
        friction: np.ndarray,
        settings: LimitSettings = DEFAULT_LIMIT,
        gaps: np.ndarray | None = None,
    ):
        self.settings, self.dimension = settings, structure.model.dimension
        joints, d, n_dof = structure.joints, structure.model.dimension, structure.n_dof
        blocks = len(structure.free) // n_dof
        self.weight = float(structure.scales.reshape(blocks, n_dof)[:, 0].mean())
        length = float((structure.scales.reshape(blocks, n_dof)[:, -1] / structure.scales[::n_dof]).mean())
        self.stiffness = float(np.median(joints.kn))
        self.unit = self.weight / self.stiffness  # of displacements [m]
        self.columns = np.tile(np.where(np.arange(n_dof) < d, 1.0, 1.0 / length), blocks)
        scaled = structure.compatibility.multiply(self.columns[None, :]).tocsr()
        self.kn, self.ks = joints.kn / self.stiffness, joints.ks / self.stiffness
        self.n_joint_points = len(self.kn)
        self.ties: TensionPoints | None = None
        first_gaps = np.zeros(self.n_joint_points) if gaps is None else gaps / self.unit
        if structure.links.points is not None:
            self.ties = structure.links.points.scaled(self.weight, self.unit, self.columns)
            self.kn = np.concatenate([self.kn, self.ties.stiffness])
            self.ks = np.concatenate([self.ks, np.ones(len(self.ties.most))])
            first_gaps = np.concatenate([first_gaps, np.zeros(len(self.ties.most))])
            friction = np.concatenate([friction, np.ones(len(self.ties.most))])  # of what never slides
        self.gaps = first_gaps
        self.ks_t = np.tile(self.ks, d - 1)  # as the shear forces are numbered
        self.slips: Slips = KINDS[d](len(self.kn), settings.path)
        self.friction = np.maximum(friction, settings.path.least_friction)
        self.dead = structure.dead * self.columns / self.weight
        live = structure.live * self.columns / self.weight
        largest = np.abs(live).max(initial=0.0)
        self.live_scale = float(np.abs(self.dead).sum() / np.abs(live).sum()) if largest > 0.0 else 1.0
        self.live = live * self.live_scale
        self.own = structure.scales * self.columns / self.weight  # own weights, for residuals
        self.lightest = min(1.0, float(self.own.min(initial=1.0))) ** 2  # square of the weight of the lightest block
        self.factorisations = 0
        self.matrix = NewtonMatrix(self._points(structure), settings.path)
        self.order = order = self.matrix.order
        rows = [scaled[k::d] for k in range(d)]  # openings, then slides as shear is numbered
        if self.ties is not None:
            rows = [vstack([each, (-1.0 if k == 0 else 0.0) * self.ties.elongation]) for k, each in enumerate(rows)]
        motion = vstack(rows).tocsr()[:, order]
        self.motion, self.pull = motion.tocsr(), motion.T.tocsr()
        self.drawn = DrawnFriction(self, joints) if d == 3 and (joints.torsion != 1.0).any() else None
        self.columns, self.dead, self.live, self.own = (
            values[order] for values in (self.columns, self.dead, self.live, self.own)
        )
        if self.ties is not None:
            self.ties = self.ties._replace(elongation=self.ties.elongation[:, order].tocsr())
        self.own_dead = self.dead  # without ties that yield
        self.put_ties(np.zeros(self.n_ties, bool), np.zeros(self.n_links))

    def displacements(self, scaled: np.ndarray) -> np.ndarray:
        """Displacements of the free degrees of freedom as the structure numbers them [m, rad], (n_free,)."""
        values = np.empty_like(scaled)
        values[self.order] = scaled * self.columns * self.unit
        return values

    def forces_and_gaps(self, state: State) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Normal forces [N], (n,), shear forces [N], (n, d − 1), and gaps [m], (n,), of joints; n = n_joint_points."""
        n = self.n_joint_points
        gaps, normal, kn = self.opened(state.displacements)[:n], state.normal[:n], self.kn[:n]
        closed = normal > kn * (gaps + normal / kn)
        gaps = np.where(closed, -normal / kn, np.maximum(gaps, 0.0)) * self.unit
        return normal * self.weight, state.shear.reshape(-1, self.n_points)[:, :n].T * self.weight, gaps

    def put_ties(self, yielding: np.ndarray, plastic: np.ndarray) -> None:
        """Set the points that yield, with their largest force, (n_ties,), and the plastic elongations, (n_links,)."""
        if self.ties is not None:
            self.gaps = self.gaps.copy()
            self.gaps[self.n_joint_points :] = self.ties.gaps(plastic) + np.where(yielding, FAR, 0.0)
            self.dead = self.own_dead + self.ties.dead(yielding)

    @property
    def n_ties(self) -> int:
        """Number of points of ties and bars; those that take compression too have two."""
        return 0 if self.ties is None else len(self.ties.most)

    @property
    def n_links(self) -> int:
        """Number of ties, and of joints that bars cross."""
        return 0 if self.ties is None else self.ties.n_links

    @property
    def n_points(self) -> int:
        """Number of points, of joints and of ties."""
        return len(self.kn)

    def draw_in(self, normal: np.ndarray) -> None:
        """Set the centres of pressure of friction by these normal forces from now on."""
        if self.drawn is not None:
            self.drawn.follow(normal)

    def opened(self, displacements: np.ndarray) -> np.ndarray:
        """Compute the opening of joints by displacements of the free degrees of freedom, (n_points,)."""
        return (self.motion @ displacements)[: self.n_points]

    def slid(self, displacements: np.ndarray) -> np.ndarray:
        """Compute the sliding of joints by displacements of the free degrees of freedom, numbered as shear forces."""
        return (self.motion @ displacements)[self.n_points :]

    def _points(self, structure: LimitStructure) -> PointRows:
        """Motions at every point by scaled degrees of freedom."""
        columns = free_columns(structure.model, structure.joints)
        scale = np.where(columns < 0, 0.0, np.append(self.columns, 0.0)[columns])
        rows = relative_motion(structure.joints, self.dimension) * scale[:, None]
        if self.ties is not None:
            pressing = np.zeros((self.n_ties, *rows.shape[1:]))
            pressing[:, 0] = -self.ties.motion
            rows, columns = np.concatenate([rows, pressing]), np.concatenate([columns, self.ties.columns])
        places = structure.model.centroids[~structure.model.fixed]
        return PointRows(rows, columns, ((0, 0), *self.slips.products_of_rows), len(self.columns), places)

    def elastic(self, share: np.ndarray | float = 1.0) -> FrontFactors:
        """Factorise the matrix by LU while nothing slips; share: of the stiffness of every point."""
        return self.factorised(share * self.kn, self.slips.elastic(share * self.ks))

    def factorised(
        self, stiff_n: np.ndarray, tangential: list[np.ndarray], viscosity: np.ndarray | None = None
    ) -> FrontFactors:
        """Factorise Bnᵀ kN Bn + Btᵀ kT Bt − Btᵀ c Bn by LU; tangential: kT and −c (limit.slips:
        SlipStiffness.stiffness).

        viscosity: of the free degrees of freedom, on the diagonal. Factors of the call before are lost. Raises
        RuntimeError where it is singular.
        """
        self.factorisations += 1
        return self.matrix.factorised([stiff_n, *tangential], viscosity)

    def imbalance(self, normal: np.ndarray, shear: np.ndarray, load: float) -> np.ndarray:
        """Compute the unbalanced forces, (n_free,)."""
        return self.pull @ np.concatenate([normal, shear]) + self.dead + load * self.live

    def residual(self, state: State, before: State) -> float:
        """Largest unbalanced force, in own weights, of the forces that the joint law gives for the displacements."""
        self.draw_in(before.normal)
        if self.ties is not None:
            self.put_ties(self.ties.yielding(state.displacements, before.plastic), before.plastic)
        normal = np.maximum(-self.kn * (self.opened(state.displacements) + self.gaps), 0.0)
        trial = before.shear - self.ks_t * self.slid(state.displacements - before.displacements)
        shear = self.slips.limited(trial, self.friction * normal)
        unbalanced = self.imbalance(normal, shear, state.load)
        return float((np.abs(unbalanced) / self.own).max(initial=0.0))


class DrawnFriction:
    """Friction of points in space at c + β (r − c), c: centre of pressure of the joint (contact/corner_forces.py).

    Slides there are β times those of the points and 1 − β times their mean by normal forces, as these are linear in r.
    """

    def __init__(self, problem: Elastic, joints: Joints) -> None:
        self.problem, self.normal = problem, np.zeros(0)  # of no point: none are followed yet
        _, joint = np.unique(joints.owners, return_inverse=True)
        ties = np.arange(problem.n_ties)  # each one for itself
        self.joint = np.concatenate([joint, joint.max(initial=-1) + 1 + ties])
        self.share = np.concatenate([joints.torsion[joints.owners], np.ones(problem.n_ties)])
        n, matrix = problem.n_points, problem.matrix
        self.rows = matrix.rows.copy()
        self.motion = [problem.motion[k * n : (k + 1) * n] for k in range(problem.dimension)]

    def follow(self, normal: np.ndarray) -> None:
        """Update the motions of the problem, and the rows of its matrix, by these normal forces (n_points,)."""
        if normal is self.normal:
            return
        self.normal, problem = normal, self.problem
        pressed = np.bincount(self.joint, normal)[self.joint]
        counts = np.bincount(self.joint)[self.joint]
        parts = np.where(pressed > 0.0, normal / np.where(pressed > 0.0, pressed, 1.0), 1.0 / counts)
        n, points = problem.n_points, np.arange(problem.n_points)
        mean = csr_matrix((parts, (self.joint, points)))
        own, rest = diags(self.share), diags(1.0 - self.share)
        slides = [(own @ each + rest @ (mean @ each)[self.joint]).tocsr() for each in self.motion[1:]]
        problem.motion = vstack([self.motion[0], *slides]).tocsr()
        problem.pull = problem.motion.T.tocsr()
        along = self.rows[:, 1:].reshape(n, -1)
        drawn = self.share[:, None] * along + (1.0 - self.share)[:, None] * (mean @ along)[self.joint]
        problem.matrix.rows[:, 1:] = drawn.reshape(self.rows[:, 1:].shape)
