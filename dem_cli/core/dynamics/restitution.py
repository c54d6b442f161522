"""Restitution of a rocking block on landing: Housner's ratio, and the dashpot that gives a wanted one.

With dashpots that do not pull, the ratio r of angular velocities after and before landing falls with the damping
towards that of Housner's rigid block, from above. A wanted r is sought by rocking the block, alone on its joint, as
the run does. In space a block rocks about the side of its joint over which it falls first, and lands on what lies
furthest from it: a side again, or a corner, about which it goes on turning parallel to the first.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.core.arithmetic import functions
from dem_cli.core.arithmetic.products import product
from dem_cli.core.contact.gaps import STEEPEST
from dem_cli.core.contact.joints import JointArrays
from dem_cli.core.dynamics.frequencies import principal_directions
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.kernels.records import Watch
from dem_cli.core.model.model import Model
from dem_cli.core.model.scales import origin_of
from dem_cli.errors import CaseError, CaseProblem

if TYPE_CHECKING:
    from dem_cli.core.records.requests import DampingRequest, SolverRequest


class RockingBlock(NamedTuple):
    """Block on the joint that it rocks on."""

    block: int
    support: int  # the block below
    frequency: float  # √(K/M), K the normal stiffness of the joint and M the mass of the block [rad/s]
    foot: np.ndarray  # points of the joint, from its centroid [m], (n, d)

    def rocks(self) -> Rocking:
        """Return the pivot points of the block and the axis of its turn."""
        return ROCKING[self.foot.shape[1]](self.foot)


class Rocking(NamedTuple):
    """Pivot points and axis of a rocking block."""

    ends: np.ndarray  # where it turns, from its centroid and across the axis of its turn [m], (2, d)
    axis: np.ndarray  # of the turn by which it stands on the first of these, unit, (r,)


def reference_block(model: Model, start: JointArrays, asked: DampingRequest) -> RockingBlock:
    """Choose the block whose restitution is meant: by its name, else the heaviest free one with a foot on a
    support.

    start: joints of the undeformed structure. Raises CaseError where there is none: a block on a corner or an edge
    turns about that alone, and does not rock.
    """
    joints = start.joints
    if asked.block is not None:
        chosen = int(model.chosen(asked.block)[0])
        found = _on_its_joint(model, start, chosen)
        if found is None:
            raise CaseError([CaseProblem(("damping", "block"), f"block '{asked.block}' rests on nothing")])
        if not _is_broad(found.foot):
            what = (
                f"block '{asked.block}' rests on a corner, an edge or an upright face: it does not rock; name another"
            )
            raise CaseError([CaseProblem(("damping", "block"), what)])
        return found
    held = model.fixed[joints.blocks].sum(axis=1) == 1
    carried = joints.blocks[held][~model.fixed[joints.blocks[held]]]
    for block in dict.fromkeys(carried[np.argsort(-model.masses[carried], kind="stable")].tolist()):
        found = _on_its_joint(model, start, block)
        if found is not None and _is_broad(found.foot):
            return found
    what = "no block rests on a support" + (" with more than a corner or an edge" if len(carried) else "")
    raise CaseError([CaseProblem(("damping", "restitution"), f"{what}; name one (damping.block)")])


def _on_its_joint(model: Model, start: JointArrays, chosen: int) -> RockingBlock | None:
    """Return a block on the lowest of its joints; None where it has no joint."""
    joints, gaps = start.joints, start.contacts.gaps
    mine = np.flatnonzero((joints.blocks == chosen).any(axis=1))
    if not len(mine):
        return None
    up = model.dimension - 1
    heights = [joints.points[joints.starts[j] : joints.starts[j + 1], up].mean() for j in mine]
    joint = int(mine[int(np.argmin(heights))])
    points = slice(joints.starts[joint], joints.starts[joint + 1])
    a, b = joints.blocks[joint].tolist()
    support = b if a == chosen else a
    stiffness = float(joints.kn[points].sum())
    foot = joints.points[points] + origin_of(model) - model.centroids[chosen]
    widest = float(np.hypot.reduce(foot - foot[gaps[points].argmin()], axis=1).max())
    foot = foot[gaps[points] <= gaps[points].min() + STEEPEST * widest]  # others are ends of a face that leans away
    return RockingBlock(chosen, support, float(np.sqrt(stiffness / model.masses[chosen])), foot)


def _is_broad(foot: np.ndarray) -> bool:
    """Test whether a foot seen from above is more than a point, in space more than a line; foot: (n, d) [m]."""
    seen = foot[:, :-1] - foot[0, :-1]
    lengths = np.hypot.reduce(seen, axis=1)
    broad = float(lengths.max())
    if seen.shape[1] == 2 and broad > 0.0:
        x, y = seen[int(lengths.argmax())] / broad
        broad = float(np.abs(seen[:, 1] * x - seen[:, 0] * y).max())
    return broad > BROAD * float(np.hypot.reduce(foot, axis=1).max())


def _in_plane(foot: np.ndarray) -> Rocking:
    """Return the rocking from one end of a joint to the other."""
    return Rocking(foot[[0, -1]], np.ones(1))


def _in_space(foot: np.ndarray) -> Rocking:
    """Return the rocking about the side over which the block falls first, to what is furthest from it; foot: (n,
    3)."""
    from scipy.spatial import ConvexHull

    outline = foot[ConvexHull(foot[:, :2]).vertices]  # counter-clockwise: outside is on the right of a side
    sides = np.roll(outline, -1, axis=0) - outline
    along = sides / np.linalg.norm(sides, axis=1)[:, None]
    across = outline - (outline * along).sum(axis=1)[:, None] * along
    outwards = np.column_stack([along[:, 1], -along[:, 0]])
    leaning = functions.arctan2((across[:, :2] * outwards).sum(axis=1), -across[:, 2])
    first = int(np.flatnonzero(leaning <= leaning.min() + EQUAL)[0])
    axis = along[first]
    others = outline - product(outline, axis)[:, None] * axis
    last = others[product(others[:, :2], outwards[first]).argmin()]
    return Rocking(np.array([across[first], last]), axis)


BROAD = 1e-6  # of the distance from the centroid to a foot: below, that is a corner or an edge
EQUAL = 1e-9  # rad: sides over which a block falls as soon; the first of them is taken
ROCKING = {2: _in_plane, 3: _in_space}


def housner(model: Model, reference: RockingBlock) -> float:
    """Compute Housner's ratio of angular velocities of a rigid block that turns from one end of its joint to the
    other without slip or bounce. It is (I + m r·r') / (I + m r'²), of moments about the new end (Housner 1963; 1 −
    1.5 sin²α for a rectangle).
    """
    (old, new), axis = reference.rocks()
    mass, along = model.masses[reference.block], product(axis, principal_directions(model)[reference.block])
    inertia = (along**2 * model.inertias[reference.block]).sum()
    return float((inertia + product(mass * old, new)) / (inertia + product(mass * new, new)))


def fraction_of(
    request: SolverRequest, model: Model, start: JointArrays, settings: Settings = DEFAULT
) -> tuple[float, str]:
    """Compute the fraction of critical damping that gives the wanted restitution, and a description of it. Raises
    CaseError out of reach."""
    restitution = settings.restitution
    reference = reference_block(model, start, request.damping)
    rigid, name = housner(model, reference), model.block_ids[reference.block]
    wanted = request.damping.restitution
    assert wanted is not None  # as damping_of asks
    if isinstance(wanted, str):
        return restitution.housner_fraction, f"restitution of Housner, {rigid:.4g} for block '{name}'"
    lowest = rocked(request, model, reference, restitution.most, settings)
    highest = rocked(request, model, reference, restitution.least, settings)
    if not lowest < wanted < highest:
        message = (
            f"{wanted:g} is not allowed for block '{name}': dashpots that do not pull give {lowest:.4f} to "
            f"{highest:.4f} (Housner: {rigid:.4f}); or name another block (damping.block)"
        )
        raise CaseError([CaseProblem(("damping", "restitution"), message)])

    from scipy.optimize import brentq  # 0.2 s

    def error(logarithm: float) -> float:
        return rocked(request, model, reference, float(functions.exp(logarithm)), settings) - wanted

    least, most = functions.log(restitution.least), functions.log(restitution.most)
    found = float(functions.exp(brentq(error, least, most, xtol=restitution.accurate, rtol=1e-6)))
    return found, f"restitution {wanted:g} of block '{name}', {found:.3g} of critical"


def rocked(
    request: SolverRequest, model: Model, reference: RockingBlock, fraction: float, settings: Settings = DEFAULT
) -> float:
    """Measure the ratio of angular velocities when the block lands, from the heights before and after it."""
    from dem_cli.core.dynamics.ground import GroundMotion
    from dem_cli.core.dynamics.initial_state import tilt
    from dem_cli.core.dynamics.time_step import time_step
    from dem_cli.core.engine.budget import Budget
    from dem_cli.core.engine.dynamic import DynamicSimulation
    from dem_cli.core.engine.properties import joint_properties, law_of
    from dem_cli.core.engine.viscous import Damping
    from dem_cli.core.statics.equilibrium import stand

    restitution = settings.restitution
    pair = model.only([reference.support, reference.block], fixed=np.array([True, False]))
    properties = joint_properties(request, model, settings.stiffness.dynamics)
    sim = DynamicSimulation(pair, law_of(request), properties, Damping(fraction=fraction), settings)
    stand(sim, Budget(restitution.most_steps))
    rest = float(sim.bodies.positions[1, pair.dimension - 1])
    dt = time_step(sim, request.shaking.margin).step
    sim.begin(dt)
    ends, axis = reference.rocks()
    slender = functions.arctan2(np.linalg.norm(ends[:, :-1], axis=1).min(), np.abs(ends[:, -1]).max())
    angle = float(restitution.tilt * slender)
    tilt(sim, np.array([1]), angle * axis)
    sim.start_moving()
    start = float(sim.bodies.positions[1, pair.dimension - 1]) - rest
    ground = GroundMotion([], pair)
    radius = float(np.sqrt((ends**2).sum(axis=1)).max())
    longest = restitution.longest * np.sqrt(radius / max(request.gravity, 1e-9))
    n, highest = max(1, int(restitution.look * longest / dt)), 0.0
    watch = Watch(np.array([1]), 1, np.zeros((n, 1, 3, sim.bodies.velocities.shape[1])))
    while sim.time < longest:
        sim.shake(ground.stretch(sim.time, n, dt), n, watch)
        place, speed = watch.samples[:, 0, 0], watch.samples[:, 0, 1]
        turn, spin = product(place[:, pair.rotations], axis), product(speed[:, pair.rotations], axis)
        beyond = turn < -restitution.landed * angle
        highest = max(highest, float((place[beyond, pair.dimension - 1] - rest).max(initial=0.0)))
        if (beyond & (spin > 0.0)).any():
            break
    return float(np.sqrt(highest / start))
