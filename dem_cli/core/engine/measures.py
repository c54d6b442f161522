"""Measures of a simulation: energies, displacements, overlaps, frames and contact records of this instant."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dem_cli.core.contact.block_compliance import BlockCompliance
from dem_cli.core.contact.corner_forces import at_corners
from dem_cli.core.contact.joints import points_in_use
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.geometry.rotation import quaternions, rotation_vectors, turned_since, turning
from dem_cli.core.kernels import records as slot
from dem_cli.core.kernels.records import Bodies, Contacts, Joints, MovingJoints
from dem_cli.core.links.link import FIXED_POINT
from dem_cli.core.links.matrices import softest
from dem_cli.core.model import first_moments, uniform_strain
from dem_cli.core.model.following_loads import FollowingLoads
from dem_cli.core.records.frames import ContactRecord, Frame, LinkPlaces, LinkRecord
from dem_cli.core.records.history_rows import Energy

ROUND_OFF = 1e-9  # of forces that cancel on a block: what is left of them counts as zero
NET, ALL = 0, 1  # of Contacts.exchanged


class PointPushes(NamedTuple):
    """Forces of contact points at one instant, and where their joints were before anything moved."""

    blocks: np.ndarray  # both blocks, (n, 2) int64
    places: np.ndarray  # where they act [m], (n, d)
    middles: np.ndarray  # mean of the points of the same joint, as they lay in the undeformed first block [m], (n, d)
    on_second: np.ndarray  # force on the second block [N], (n, d)


class EnergySums(NamedTuple):
    """Work since the start [J]."""

    given: float  # by dead and live loads
    taken: float  # by friction and by the joints' springs


def displacements(sim: Simulation) -> np.ndarray:
    """Return the displacement of all centroids [m], (n_blocks, d)."""
    return sim.bodies.positions - sim.reference_positions


def rotations_since(sim: Simulation, before: Bodies) -> np.ndarray:
    """Return the rotation of all blocks since a saved state [rad], (n_blocks, r)."""
    return turned_since(sim.bodies.orientations, before.orientations)


def largest_displacement(sim: Simulation) -> float:
    """Largest displacement of a centroid [m]."""
    moved = displacements(sim).take(sim.free, axis=0)
    return float(np.sqrt((moved * moved).sum(axis=1)).max(initial=0.0))


def largest_elastic(sim: Simulation) -> float:
    """Return the largest displacement of a centroid by elastic joints alone, or before relief took it back [m]."""
    shown = displacements(sim) - sim.taken_back[:, : sim.model.dimension]
    return float(np.sqrt((shown[sim.free] ** 2).sum(axis=1)).max(initial=0.0))


def round_off(sim: Simulation) -> float:
    """Bound the unbalanced force that round-off of coordinates leaves on a block at rest, over its own weight.

    Places are known to 2e-16 of the largest coordinate L, so that a point that presses has a force known to kn times
    that: Σ kn · 2e-16 L over the points of the block. Zero where geometry is that of the start, whose gaps are summed.
    """
    if sim.kinematics == "fixed":
        return 0.0
    d, joints = sim.model.dimension, sim.joints
    pressing = np.where(sim.contacts.normal > 0.0, joints.kn, 0.0)
    stiffness = np.zeros(sim.model.n_blocks)
    for side in joints.blocks.T:
        stiffness += np.bincount(side[joints.owners], weights=pressing, minlength=len(stiffness))
    weights = np.sqrt((sim.loads.dead[:, :d] ** 2).sum(axis=1))
    weighs = (weights > 0.0) & ~sim.model.fixed
    last_digit = np.finfo(float).eps * float(np.abs(sim.bodies.corners).max(initial=0.0))
    return last_digit * float((stiffness[weighs] / weights[weighs]).max(initial=0.0))


def live_displacement(sim: Simulation) -> float:
    """Compute the work-conjugate displacement of the live load, q·u [J per unit multiplier].

    Of forces that follow their blocks: of the points that they go along with, along their directions as drawn.
    """
    if sim.following is not None:
        return _displacement_of_followers(sim, sim.following)
    d, rotations = sim.model.dimension, sim.model.rotations
    live, free = sim.loads.live, sim.free  # sums over free blocks: a far support changes no bit of them
    travel = (live[free, :d] * displacements(sim)[free]).sum()
    return float(travel + (live[free, rotations] * rotation_vectors(sim.bodies.orientations[free])).ravel().sum())


def _displacement_of_followers(sim: Simulation, following: FollowingLoads) -> float:
    """Compute q·u where loads follow their blocks; restrained motions are zero."""
    turned = rotation_vectors(sim.bodies.orientations)
    motion = np.column_stack([displacements(sim), turned])
    drawn = float((sim.model.live_loads * motion)[sim.free].sum())
    return sim.live_scale * (drawn + following.beyond(sim.bodies.orientations, turned))


def live_force(sim: Simulation) -> float:
    """Sum of the forces of the live load at an internal multiplier of 1 [N].

    Of couples alone, of forces at the far ends of their blocks with the same moments.
    """
    live = sim.loads.live[sim.free]
    force = float(np.sqrt((live[:, : sim.model.dimension] ** 2).sum(axis=1)).sum())
    moments = np.sqrt((live[:, sim.model.rotations] ** 2).sum(axis=1))
    at_ends = float((moments / sim.shape.radii[sim.free]).sum())
    return force if force > ROUND_OFF * at_ends else at_ends


def live_travel(sim: Simulation) -> float:
    """Displacement of the live load along itself since it was drawn: q·u over `live_force` [m]; 0 without one.

    Of couples alone: how far the far ends of their blocks turned.
    """
    force = live_force(sim) if sim.loads.live.any() else 0.0
    return live_displacement(sim) / force if force > 0.0 else 0.0


def dead_scale(sim: Simulation) -> float:
    """Elastic displacement of the softest joint, block or link under all dead loads [m]; none is larger by much."""
    joints = sim.joints
    total = np.sqrt((sim.loads.dead[sim.free, : sim.model.dimension] ** 2).sum(axis=1)).sum()
    if not len(joints.kn):
        return link_scale(sim) if sim.links else sim.smallest
    stiffness = np.add.reduceat(np.minimum(joints.kn, joints.ks), joints.starts[:-1])
    if sim.model.n_modes:
        stiffness = np.concatenate([stiffness, sim.shape.mode_stiffness[sim.free].ravel()])
    return max(float(total / stiffness[stiffness > 0.0].min()), link_scale(sim))


def link_scale(sim: Simulation) -> float:
    """Compute the elongation of the softest link under all present loads, at most a smallest edge [m]; 0: no links."""
    if not sim.links:
        return 0.0
    d, control, loads = sim.model.dimension, sim.control, sim.loads
    total = control[slot.DEAD_FACTOR] * loads.dead[sim.free, :d] + control[slot.LIVE_FACTOR] * loads.live[sim.free, :d]
    return min(float(np.sqrt((total**2).sum(axis=1)).sum() / softest(sim.links)), sim.smallest)


def largest_overlap(sim: Simulation) -> float:
    """Deepest penetration of a contact point [m]."""
    return float(max(0.0, -sim.contacts.gaps.min(initial=0.0)))


def reactions(sim: Simulation) -> np.ndarray:
    """Compute the reactions of supports and restraints, forces [N] and moments about centroids [N m], (n_blocks, d
    + r).

    To those with restraints along what these hold, against joints, links and loads; to fixed blocks against joints and
    links, without weight and loads of their own. Zero along all that is free.
    """
    model, columns = sim.model, slice(sim.model.rotations.stop)
    dead, live = sim.present_loads()
    applied = sim.control[slot.DEAD_FACTOR] * dead + sim.control[slot.LIVE_FACTOR] * sim.live_scale * live
    given = -(sim.bodies.forces[:, columns] + np.where(model.fixed[:, None], 0.0, applied))
    return np.where(model.held, given, 0.0)


def free_falls(sim: Simulation) -> np.ndarray:
    """Largest acceleration that its own loads alone can give each block [m per step²], (n_blocks,)."""
    loads, control, d = sim.loads, sim.control, sim.model.dimension
    force = control[slot.DEAD_FACTOR] * loads.dead[:, :d] + control[slot.LIVE_FACTOR] * loads.live[:, :d]
    light = loads.inverse_masses[:, : sim.model.rotations.stop].copy()
    light[:, sim.model.rotations] *= sim.shape.radii[:, None] ** 2
    return np.sqrt((force**2).sum(axis=1)) * light.max(axis=1)


def energy_sums(sim: Simulation) -> EnergySums:
    """Work of the loads since the start, and energy that friction and joints took [J]."""
    given = float(sim.ledger[slot.EXTERNAL])
    return EnergySums(given, float(sim.ledger[slot.FRICTION]) + sim.elastic_energy())


def energy(sim: Simulation) -> Energy:
    """Compute the energy balance since the start [J]; external: applied loads and base without gravity."""
    books, d, free = sim.books(), sim.model.dimension, sim.free
    weight, height = -sim.drawn_dead[free, d - 1], displacements(sim)[free, d - 1]
    if books.lag > 0.0:
        height = height - books.lag * sim.bodies.velocities[free, d - 1]
    gravity = float((weight * height).sum())
    return Energy(
        kinetic=books.kinetic,
        elastic=books.elastic + books.in_dampers,
        gravity=gravity,
        external=float(books.ledger[slot.EXTERNAL]) + gravity,
        friction=float(books.ledger[slot.FRICTION]),
        damping=float(books.ledger[slot.DAMPING] + books.ledger[slot.JOLT]),
        supports=float(books.ledger[slot.SUPPORT]),
        dashpots=float(books.ledger[slot.DASHPOT]),
        mass_damping=float(books.ledger[slot.MASS]),
        maxwell=float(books.ledger[slot.MAXWELL]) - books.in_dampers,
        reweighting=float(sim.contacts.exchanged[NET]),
    )


def closure(sim: Simulation, books: Energy | None = None) -> float:
    """Compute the error of the energy balance over its largest energy, or kinetic so far; 0 where it closes.

    books: `energy` of this instant, if that is known.
    """
    e = books or energy(sim)
    error = e.kinetic + e.elastic + e.gravity + taken(e) + e.reweighting - e.external - e.supports
    largest = _largest(sim, e)
    return float(error / largest) if largest > 0.0 else 0.0


def reweighting(sims: Sequence[Simulation]) -> dict[str, dict[str, float]]:
    """Return the summary key of energy changed by contact areas, of the simulation with the most [J]."""
    moved = [sim.contacts for sim in sims if sim.kinematics == "large" and sim.contacts.shear.shape[1] > 1]
    if not moved:
        return {}
    net, total = max((contacts.exchanged for contacts in moved), key=lambda found: found[ALL]).tolist()
    return {"reweighting": {"net": net, "sum": total}}


def reweighting_shares(sim: Simulation) -> tuple[float, float]:
    """Compute the share of energy that changed with the areas of contact points, net (minus: made) and the sum of
    all amounts.

    Over the largest kinetic energy of a time history, or its elastic one where it hardly moves; in pseudo-time over the
    largest energy in the ledger.
    """
    e = energy(sim)
    largest = max(sim.most_kinetic, e.elastic) if sim.most_kinetic > 0.0 else _largest(sim, e)
    net, total = sim.contacts.exchanged / largest if largest > 0.0 else np.zeros(2)
    return float(net), float(total)


def taken(e: Energy) -> float:
    """Compute the energy that friction and all kinds of damping dissipated [J]."""
    return e.friction + e.damping + e.dashpots + e.mass_damping + e.maxwell


def _largest(sim: Simulation, e: Energy) -> float:
    """Return the largest energy in the balance, or kinetic so far [J]."""
    return max(abs(e.external), abs(e.gravity), abs(e.supports), e.elastic, taken(e), sim.most_kinetic)


def contact_points(sim: Simulation, blocks: np.ndarray) -> np.ndarray:
    """Compute the positions of the contact points now [m], (n_points, d); blocks: the first one of each.

    Geometry of the start keeps its points where they were, however far its blocks go: in space these take them along.
    """
    if sim.kinematics == "large" or sim.joints.points.shape[1] == 2:
        return sim.joints.points
    bodies, arms = sim.bodies, sim.joints.points - (sim.model.centroids - sim.origin)[blocks]
    return bodies.positions[blocks] + turning(bodies.orientations[blocks])(arms)


def point_pushes(sim: Simulation) -> PointPushes:
    """Forces of all contact points now, in a motion those of its last step, where the kernels let them act."""
    on_second = sim.forces_on_second()  # before frames follow the blocks beyond the step
    sim.measured()
    joints, model = sim.joints, sim.model
    used, owner = points_in_use(joints), joints.owners
    first = joints.blocks[owner, 0]
    places = joints.points + sim.origin
    drawn = places
    if sim.kinematics == "large":
        arms = joints.points - sim.bodies.positions[first]
        drawn = model.centroids[first] + turning(-rotation_vectors(sim.bodies.orientations)[first])(arms)
    counts = np.maximum(np.bincount(owner[used], minlength=len(joints.blocks)), 1)
    middles = np.column_stack([np.bincount(owner[used], along, len(counts)) for along in drawn[used].T])
    return PointPushes(
        joints.blocks[owner][used], places[used], (middles / counts[:, None])[owner][used],
        on_second[used],
    )  # fmt: skip


class Touching(NamedTuple):
    """Contact points at one instant, which goes on being what it was while the simulation moves on."""

    joints: Joints  # frames, stiffness and torsion of their own
    contacts: Contacts
    points: np.ndarray  # where they are [m], (n_points, d)


def touching(sim: Simulation) -> Touching:
    """Copy the contact points of now, of which `contact_record` may be made later."""
    contacts, owner = sim.measured(), sim.joints.owners
    points, joints = contact_points(sim, sim.joints.blocks[owner, 0]) + sim.origin, sim.joints.kept()
    if isinstance(joints, MovingJoints):
        joints = joints._replace(frames=joints.frames.copy())
    return Touching(joints, contacts, points)


def contact_record(sim: Simulation, seen: Touching | None = None) -> ContactRecord:
    """Record all contact points of an instant that was seen, or of now."""
    joints, contacts, points = seen or touching(sim)
    d, owner, used = sim.model.dimension, joints.owners, points_in_use(joints)
    everywhere = bool(used.all())
    friction = np.sqrt((contacts.shear * contacts.shear).sum(axis=1))
    kn = joints.kn if everywhere else np.where(used, joints.kn, 1.0)
    limit = sim.law.shear_limit(joints.law[owner], contacts.normal, contacts.memory, kn)
    slides = friction >= limit * (1 - sim.settings.mechanism.slides)
    state = (1 + slides) * (contacts.normal != 0.0)  # index into STATES
    record = ContactRecord(
        joint=owner,
        blocks=joints.blocks[owner],
        points=points,
        normals=joints.frames[:, :d].copy(),
        normal_force=contacts.normal,
        shear_force=at_corners(joints, contacts.normal, contacts.shear),
        gap=contacts.gaps,
        slip=contacts.slip,
        state=state.astype(np.int8),
        tangents=joints.frames[:, d : d * (d - 1)].copy(),  # all but the last: none in the plane
    )
    return record if everywhere else ContactRecord(*(values[used] for values in record))


def shares_of_blocks(sim: Simulation, compliance: BlockCompliance | None) -> np.ndarray:
    """Compliance of the blocks on either side of each joint over that of the joint alone, kn h/E [-], (n_joints,)."""
    properties, joints = sim.properties, sim.joints
    if compliance is None:
        return np.zeros(len(joints.blocks))
    named = properties.between(sim.model, joints.blocks)
    return compliance.shares(properties.kn[named], sim.geometry.faces, named)


def frame(sim: Simulation, stage: str) -> Frame:
    """Take a snapshot of the simulation as a frame."""
    return frame_of(sim, moment(sim), stage)


class Moment(NamedTuple):
    """State of one instant for a frame, without its load: a part of the cost of the frame, where many are dropped."""

    steps: int
    displacement: float  # largest of a centroid [m]
    positions: np.ndarray  # fields as those of Frame
    orientations: np.ndarray
    velocities: np.ndarray
    contacts: Touching
    time: float  # [s]
    stresses: np.ndarray | None
    links: LinkRecord | None


def moment(sim: Simulation) -> Moment:
    """Record the present instant, for `frame_of`."""
    bodies = sim.bodies
    return Moment(
        sim.steps, largest_displacement(sim), bodies.positions + sim.origin, quaternions(bodies.orientations),
        sim.speeds.copy(), touching(sim), sim.time, block_stresses(sim), link_record(sim),
    )  # fmt: skip


def frame_of(sim: Simulation, seen: Moment, stage: str) -> Frame:
    """Make the frame of a moment that was recorded, with the load of now."""
    contacts = contact_record(sim, seen.contacts)
    return Frame(
        stage, seen.steps, sim.load * sim.live_scale, seen.displacement, seen.positions, seen.orientations,
        seen.velocities, contacts, seen.time, seen.stresses, seen.links, first_moments_of(sim, seen, contacts),
    )  # fmt: skip


def first_moments_of(sim: Simulation, seen: Moment, contacts: ContactRecord) -> np.ndarray | None:
    """Sum the first moments of loads at points, as they are now, and of ties and bars, as Frame.first_moments.

    Geometry of the start is in equilibrium with arms of the start: by how far those of contact points in the frame
    differ from them comes on top.
    """
    dead, live = sim.dead_share, float(sim.control[slot.LIVE_FACTOR]) * sim.live_scale
    found = first_moments.of_loads(sim.model, seen.orientations, dead, live)
    if found is None and seen.links is None:
        return None
    if sim.kinematics == "fixed":
        back = _moments_of_places(sim, seen, contacts)
        found = back if found is None else found + back
    if seen.links is None:
        return found
    blocks, points, forces = seen.links.on_blocks(seen.positions, seen.orientations)
    of, held = blocks[blocks >= 0], blocks >= 0
    of_links = first_moments.summed(sim.model.n_blocks, of, points[held] - seen.positions[of], forces[held])
    return of_links if found is None else found + of_links


def _moments_of_places(sim: Simulation, seen: Moment, contacts: ContactRecord) -> np.ndarray:
    """Sum contact forces ⊗ (arms of the start − arms in the frame) of each block [N m], (n_blocks, 3 or 6)."""
    joints, model, forces = seen.contacts.joints, sim.model, contacts.forces()
    shift = joints.points[points_in_use(joints)] + sim.origin - contacts.points
    first, second = (
        first_moments.summed(model.n_blocks, blocks, shift + (seen.positions - model.centroids)[blocks], forces)
        for blocks in contacts.blocks.T
    )
    return second - first


def link_record(sim: Simulation) -> LinkRecord | None:
    """Record ties and bars now; None: there are none."""
    if not sim.links:
        return None
    outlines = [link.outline() for link in sim.links]
    counts, blocks, arms, forces = (np.concatenate(parts) for parts in zip(*outlines, strict=True))
    arms = np.where(blocks[:, None] == FIXED_POINT, arms + sim.origin, arms)
    return LinkRecord(LinkPlaces(np.concatenate([[0], np.cumsum(counts)]), blocks, arms), forces)


def block_stresses(sim: Simulation) -> np.ndarray | None:
    """Stresses of blocks that deform, in their own axes [Pa], as Frame.stresses; None: all blocks are rigid."""
    model, shape = sim.model, sim.shape
    if not model.n_modes:
        return None
    volumes = model.shapes.volumes * model.thickness
    modes = sim.bodies.modes
    if len(model.imposed_strains):
        modes = modes.copy()
        modes[:, 0] -= sim.dead_share * model.imposed_strains * shape.radii
    found = uniform_strain.stresses(modes, shape.mode_stiffness, volumes, shape.radii)
    return uniform_strain.components(found)
