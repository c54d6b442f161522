"""Stiffness of "auto" joints in time histories: stiff enough that blocks rock as rigid ones, within a budget of
steps.

It belongs to the structure: the budget is one per √(height/g) of motion, the time in which a structure rocks, so that
the duration, the number of runs and the scale of a model change no joint.

What elastic joints change of rocking goes with one number: the angle ε [rad] by which blocks turn on them when their
weight acts sideways. For one block of b × h it is 2 ρ g (h/b)²/kn, which is also the rotation at which it lifts off
over the angle at which it falls, (p/ω)² of rocking and elastic frequency, and one over the factor of buckling under
its own weight. Columns of many drums, frames and pinnacles on walls have theirs: one linear solution finds it.
docs/rocking.md, Default settings, has the errors.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.core.arithmetic.functions import agreed
from dem_cli.core.arithmetic.small_matrices import diagonalised
from dem_cli.core.arithmetic.sparse_systems import solved_symmetric
from dem_cli.core.contact.start import bodies_at_rest, joints_of_start
from dem_cli.core.dynamics.frequencies import System, highest_of, springs_of
from dem_cli.core.engine.properties import joint_properties
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.engine.viscous import element_numbers
from dem_cli.core.kernels.records import NOTHING, Joints
from dem_cli.core.model.model import Model
from dem_cli.core.model.scales import mean_weight, origin_of, own_weights, smallest_edge

if TYPE_CHECKING:
    from dem_cli.core.records.requests import SolverRequest


class RockingStiffness(NamedTuple):
    """Stiffness chosen for "auto" joints, with the rotation and the work that decided it."""

    ratio: float  # kn·h/W
    turn: float  # ε, by which blocks turn under their weight sideways [rad]; 0 where nothing is "auto"
    work: float  # steps per second of motion times what each costs, in contact points
    automatic: bool  # False: all stiffnesses are given

    def softer(self, factor: float) -> RockingStiffness:
        """Return the stiffness reduced by a factor."""
        return RockingStiffness(self.ratio / factor, self.turn * factor, self.work / math.sqrt(factor), self.automatic)

    def applied(self, settings: Settings) -> Settings:
        """Return the settings with this stiffness of "auto" joints."""
        return replace(settings, stiffness=replace(settings.stiffness, dynamics=self.ratio))

    @property
    def doubt(self) -> str:
        """Write the warning for joints that had to stay too soft."""
        return (
            f"joints are softer than rocking asks for: blocks turn by {self.turn:.1g} rad when their weight acts "
            "sideways; stiffer joints would take too many steps, or digits"
        )


def rocking_stiffness(request: SolverRequest, model: Model, settings: Settings = DEFAULT) -> RockingStiffness:
    """Choose the softest joints on which blocks turn by no more than wanted. They are softer where these would
    take too many steps, but never softer than settings.stiffness.dynamics.
    """
    softest, rocking = settings.stiffness.dynamics, settings.rocking
    automatic = bool(joint_properties(request, model, softest).rigid.any())
    if not automatic or model.fixed.all():
        return RockingStiffness(softest, 0.0, 0.0, automatic)
    joints, mine = _joints(request, model, softest)
    if not len(joints.kn):
        return RockingStiffness(softest, 0.0, 0.0, True)
    turn = turn_sideways(model, rigid_but(joints, mine), settings)
    work, step = _work(request, model, joints, settings)
    most = rocking.work / _rocking_time(request, model)
    shortest = request.shaking.time_step or 0.0
    asked = (step / shortest) ** 2 if shortest else math.inf
    seen = rocking.round_off / _round_off(model, joints)
    affordable = min((most / work) ** 2, asked, seen) if work else 1.0
    factor = max(1.0, min(turn / rocking.turn, affordable))
    return RockingStiffness(factor * softest, turn / factor, work * math.sqrt(factor), True)


def turn_sideways(model: Model, joints: Joints, settings: Settings = DEFAULT) -> float:
    """Largest rotation of a block [rad] when all dead forces are turned to the side that turns it most; to first order,
    on springs.

    Joints act that gravity presses together, as if they could pull. Blocks that are held by too few points to be at
    rest do not count.
    """
    d = model.dimension
    found = springs_of(model, joints, settings=settings.frequency)
    dead = model.dead_loads[found.blocks]
    still = _solved(found, found.reduced(dead).ravel())
    points = len(joints.kn)
    normal = -np.sqrt(joints.kn) * (found.rows @ still).reshape(points, d)[:, 0]
    forces = np.add.reduceat(normal, joints.starts[:-1])
    pressed = forces > settings.rocking.pressed * mean_weight(dead, dead, d)
    found = springs_of(model, joints, pressed[joints.owners], settings.frequency)
    turns = np.zeros((len(dead), model.inertias.shape[1], d - 1))
    for axis in range(d - 1):
        sideways = np.zeros_like(dead)
        sideways[:, axis] = np.sqrt((dead[:, :d] ** 2).sum(axis=1))
        moved = found.motion(_solved(found, found.reduced(sideways).ravel()).reshape(dead.shape))
        turns[:, :, axis] = moved[:, model.rotations]
    # Of all horizontal directions that which turns a block most: the largest singular value.
    most = np.sqrt(diagonalised(np.einsum("brk,brl->bkl", turns, turns))[0][:, -1])
    return float(most[most < settings.rocking.mechanism].max(initial=0.0))


def _solved(found: System, forces: np.ndarray) -> np.ndarray:
    """L u under forces L⁻ᵀ f (frequencies.System); what nothing holds moves very far."""
    matrix = found.matrix
    shift = found.settings.zero * float(matrix.diagonal().max(initial=0.0)) or 1.0
    from scipy.sparse import eye_array

    return solved_symmetric(matrix + shift * eye_array(len(forces)), forces)


def _joints(request: SolverRequest, model: Model, ratio: float) -> tuple[Joints, np.ndarray]:
    """Joints of the start, and which of their points are of "auto" stiffness."""
    properties = joint_properties(request, model, ratio)
    rest = bodies_at_rest(model, origin_of(model))
    joints = joints_of_start(model, rest, properties, smallest_edge(model)).joints
    joints = joints._replace(integrated=NOTHING)  # those are not "auto", and count as next to rigid
    return joints, properties.rigid_between(model, joints.blocks)[joints.owners]


def rigid_but(joints: Joints, points: np.ndarray) -> Joints:
    """Make all points but these (n_points,) bool so stiff that they do not count."""
    if points.all():
        return joints
    factor = np.where(points, 1.0, 1e3 * max(1.0, float(joints.kn.max() / joints.kn[~points].min())))
    return joints._replace(kn=factor * joints.kn, ks=factor * joints.ks)


def _round_off(model: Model, joints: Joints) -> float:
    """Estimate the round-off of contact forces: last digit of a place times stiffness, over the weight; the
    largest."""
    free = ~model.fixed
    d = model.dimension
    places = model.vertices + (model.centroids - origin_of(model))[model.vertex_blocks]
    farthest = float(np.abs(places[free[model.vertex_blocks]]).max())
    weights = np.full(model.n_blocks, math.inf)
    weights[free] = own_weights(model.dead_loads[free], model.live_loads[free], d)
    lightest = weights[joints.blocks].min(axis=1)[joints.owners]
    return float(np.finfo(float).eps * farthest * (joints.kn / lightest).max())


def _rocking_time(request: SolverRequest, model: Model) -> float:
    """Return the rocking time √(height/g) of all that can move [s]; one second without gravity."""
    free = ~model.fixed[model.vertex_blocks]
    height = float(np.ptp((model.vertices + model.centroids[model.vertex_blocks])[free, -1]))
    return math.sqrt(height / request.gravity) if request.gravity > 0.0 else 1.0


def _work(request: SolverRequest, model: Model, joints: Joints, settings: Settings) -> tuple[float, float]:
    """Steps per second of motion times what each costs in contact points, and the step [s], by the joints of the
    start.
    """
    highest = agreed(highest_of(springs_of(model, joints, settings=settings.frequency)))
    if highest == 0.0:
        return 0.0, math.inf
    elements = element_numbers(request.damping.maxwell)
    step = request.shaking.margin * 2.0 / (highest * math.sqrt(1.0 + float(elements[:, 0].sum())))
    return (len(joints.kn) + settings.rocking.points_per_step) / step, step
