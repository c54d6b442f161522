"""A structure in motion: the arrays, the compiled loop that fits them, and what can be asked of them."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from dem_cli.contact.assemble import (
    LIKE,
    LIKE_ROTATION,
    Chains,
    JointProperties,
    build_joints,
    carry_memory,
    chains_of_start,
    measure_points,
)
from dem_cli.contact.detect import block_shape, find_joints, inner_edges
from dem_cli.contact.start import TOUCH, bodies_at_rest, bond_touching, close_touching, joints_of_start
from dem_cli.engine.clearances import WIDEST, Play, gap_play, open_gaps, play
from dem_cli.engine.fictitious_masses import fictitious_masses
from dem_cli.kernels import records as slot
from dem_cli.kernels.advance import make_advance
from dem_cli.kernels.contact_forces import make_contact_forces, of_bodies
from dem_cli.kernels.drift import drift_centroids, drift_corners
from dem_cli.kernels.planar_forces import make_planar_forces
from dem_cli.kernels.planar_profiles import make_profiled_forces
from dem_cli.kernels.records import Bodies, Contacts, Loads
from dem_cli.laws.law import Law
from dem_cli.model.model import Model
from dem_cli.model.scales import depth, origin_of, own_weights, smallest_edge
from dem_cli.output.record import ContactRecord, Energy, Frame

SKIN = 0.05  # detection reach as a share of the smallest edge
SLIVER = 1e-3  # of its radius: the least width that a block's moments are compared with
LONGEST_CALL = 20_000_000  # points × steps of one compiled call, about 0.2 s: Ctrl-C waits no longer
ALPHA = 0.4  # local damping near failure


@cache
def compiled_advance(kinematics: str, law: Law, profiled: bool = False):
    """The stepping loop for one kinematics, one law and one kind of joints; compiled at its first call."""
    if kinematics == "fixed":
        forces = make_contact_forces(law.function, integrates_gap=True, bonded=law.bonded)
        return make_advance(of_bodies(forces), drift_centroids)
    make = make_profiled_forces if profiled else make_planar_forces
    return make_advance(make(law.function, law.bonded), drift_corners)


class EnergySums(NamedTuple):
    """Work since the start [J]."""

    given: float  # by dead and live loads
    taken: float  # by friction and by the joints' springs


class Simulation:
    """Blocks, joints and loads that advance in time.

    kinematics  "fixed": geometry of the start, for failure loads; "large": geometry that moves
    live_scale  live loads are multiplied by it inside, so that a multiplier is of the order of one
    n_damped    numbers that the dampers of a time history remember of each point
    skin        reach of detection, in smallest edges
    """

    def __init__(
        self,
        model: Model,
        law: Law,
        properties: JointProperties,
        kinematics: str = "fixed",
        live_scale: float = 1.0,
        tilting: bool = False,
        safety: float = 0.85,
        n_damped: int = 0,
        skin: float = SKIN,
    ):
        self.model, self.law, self.properties, self.kinematics = model, law, properties, kinematics
        self.n_memory = law.n_memory(model.dimension) + n_damped
        self.skin, self.time = skin, 0.0
        self.live_scale, self.tilting, self.safety = live_scale, tilting, safety
        d, r = model.dimension, model.inertias.shape[1]
        n = model.n_blocks
        self.like, self.like_rotation = LIKE[d], LIKE_ROTATION[d]
        self.shape, self.inner = block_shape(model), inner_edges(model)
        self.origin = origin_of(model)
        self.bodies = bodies_at_rest(model, self.origin)
        self.smallest = smallest_edge(model)
        self.free = np.flatnonzero(~model.fixed)
        dead = model.dead_loads.copy()
        live = model.live_loads * live_scale
        dead[model.fixed] = 0.0
        live[model.fixed] = 0.0
        force_scales = np.empty((n, d + r))
        force_scales[:] = 1.0 / own_weights(dead, live, d)[:, None]
        self.widths = model.shapes.widths
        arms = np.clip(self.widths, SLIVER * self.shape.radii, self.shape.radii)  # small moments turn a needle over
        force_scales[:, d:] /= arms[:, None]
        self.loads = Loads(
            dead=np.ascontiguousarray(dead),
            live=np.ascontiguousarray(live),
            inverse_masses=np.zeros((n, d + r)),
            force_scales=force_scales,
            speed_limits=np.full((n, d + r), np.inf),
        )
        self.control = np.zeros(slot.N_CONTROL)
        self.control[slot.DEAD_FACTOR] = 1.0
        self.control[slot.DAMP] = ALPHA
        self.ledger = np.zeros(slot.N_LEDGER)
        self.steps = 0
        self.detections = 0
        self.most_kinetic = 0.0  # kinetic energy that a time history was seen to have [J]
        self.reference_positions = self.bodies.positions.copy()
        self._detect_first()
        self.first_joints, self.first_points = len(self.joints.blocks), len(self.joints.kn)  # of the start
        self.depth = depth(self.joints.blocks, model.fixed)
        self.play = self._play()
        self.first_places = self.save_places()

    # -- detection ---------------------------------------------------------------------------------

    def _detect_first(self) -> None:
        model, n_memory = self.model, self.n_memory
        self.chains: Chains | None = None
        if self.kinematics == "fixed":
            self.joints, self.contacts = joints_of_start(model, self.bodies, self.properties, self.smallest, n_memory)
        else:
            faces = find_joints(model, self.bodies.corners, self.skin * self.smallest, self.inner)
            if self.properties.profiled:
                self.chains = chains_of_start(model, faces, self.bodies, self.properties)
            self.joints, self.contacts = build_joints(model, faces, self.bodies, self.properties, n_memory, self.chains)
            close_touching(self.contacts, self.smallest)
            bond_touching(model, self.joints, self.contacts, self.properties)
        self._after_detection()

    def _play(self) -> Play:
        """How far blocks may move until profiles and gaps of the start have closed; those of fixed geometry do not."""
        found = play(self.model, self.joints, self.bodies.positions)
        if self.kinematics == "fixed":
            return found
        faces = find_joints(self.model, self.bodies.corners, WIDEST * self.smallest, self.inner)
        gaps = open_gaps(self.bodies.corners, faces.edges)
        gaps = gaps[(gaps > TOUCH * self.smallest) & (gaps <= WIDEST * self.smallest)]
        if not len(gaps):
            return found
        width = float(np.median(self.widths[self.free])) if len(self.free) else self.smallest
        more = gap_play(gaps, width, self.model.n_blocks)
        return Play(found.moved + more.moved, found.turned + more.turned)

    def detect(self) -> None:
        """New faces after large motion; memory follows the contact points."""
        old, memory = self.joints, self.contacts
        self.measured()  # the points of the old joints, for those that move on
        faces = find_joints(self.model, self.bodies.corners, self.skin * self.smallest, self.inner)
        joints, contacts = build_joints(self.model, faces, self.bodies, self.properties, self.n_memory, self.chains)
        carry_memory(old, memory, joints, contacts)
        if self.bodies.travel.max(initial=0.0) < 0.01 * self.skin * self.smallest:
            # Still the same faces though nothing moved: do not ask again at every step.
            asked = {tuple(row) for row in old.edges[memory.stale[:-1] == 1].tolist()}
            contacts.stale[:-1] |= np.array([tuple(row) in asked for row in joints.edges.tolist()], bool)
        self.joints, self.contacts = joints, contacts
        self._after_detection()

    def _after_detection(self) -> None:
        self.detections += 1
        self.longest = max(100, LONGEST_CALL // max(1, len(self.joints.kn)))
        self.bodies.travel[:] = 0.0
        self.control[slot.TRAVEL_LIMIT] = 0.5 * self.skin * self.smallest
        self.set_masses()

    def measured(self) -> Contacts:
        """Contacts with the gaps of this instant; frames, levers and points of the joints follow, nothing else."""
        contacts = Contacts(*(a.copy() for a in self.contacts))
        if self.kinematics == "large":
            measure_points(self.joints, contacts, self.bodies)
        return contacts

    def set_masses(self) -> None:
        """Fictitious masses for the present joints; the change of kinetic energy goes to damping."""
        before = self.kinetic_energy()
        self.measured()
        fictitious_masses(self.model, self.joints, self.bodies, self.shape, self.safety, self.loads.inverse_masses)
        self.ledger[slot.DAMPING] += before - self.kinetic_energy()

    # -- stepping ----------------------------------------------------------------------------------

    def advance(self, n_steps: int, mode: int) -> None:
        """n_steps steps of one mode (kernels.records), with detection when it is due."""
        run = compiled_advance(self.kinematics, self.law, self.properties.profiled)
        left, load = n_steps, 0.0
        while left > 0:
            done = run(
                min(left, self.longest), mode, 1.0, self.bodies, self.shape, self.joints, self.contacts, self.loads,
                self.control, self.ledger, self.like, self.like_rotation,
            )  # fmt: skip
            left -= done
            self.steps += done
            load += self.control[slot.MEAN_LOAD] * done
            if self.kinematics == "large" and self._detection_due():
                self.detect()
        self.control[slot.MEAN_LOAD] = load / max(n_steps, 1)

    def compile(self) -> None:
        """Compile or load the stepping loop; no step is done."""
        control = self.control.copy()
        compiled_advance(self.kinematics, self.law, self.properties.profiled)(
            0, slot.HOLD_LOAD, 1.0, self.bodies, self.shape, self.joints, self.contacts, self.loads,
            self.control, self.ledger, self.like, self.like_rotation,
        )  # fmt: skip
        self.control[:] = control

    def accelerations(self, block: int) -> np.ndarray:
        """Of the last step, per unit of the solver's time, (n_dof,)."""
        return self.bodies.unbalanced[block] * self.loads.inverse_masses[block]

    def largest_overlap(self) -> float:
        """Deepest penetration of a contact point [m]."""
        return float(max(0.0, -self.contacts.gaps.min(initial=0.0)))

    def _detection_due(self) -> bool:
        moved = self.bodies.travel.max(initial=0.0) > self.control[slot.TRAVEL_LIMIT]
        return bool(moved or self.contacts.stale[-1])

    def rest(self) -> None:
        """Stop all free blocks; their kinetic energy goes to damping."""
        before = self.kinetic_energy()
        self.bodies.velocities[self.free] = 0.0
        self.ledger[slot.DAMPING] += before - self.kinetic_energy()

    def set_load(self, multiplier: float) -> None:
        """Constant load; with a tilting table the dead loads turn with it (multiplier = tan θ)."""
        cosine = 1.0 / np.sqrt(1.0 + multiplier**2) if self.tilting else 1.0
        self.control[slot.DEAD_FACTOR] = cosine
        self.control[slot.LIVE_FACTOR] = multiplier * cosine

    @property
    def load(self) -> float:
        """Internal load multiplier (times live_scale: the one users know)."""
        return self.control[slot.LIVE_FACTOR] / self.control[slot.DEAD_FACTOR]

    @property
    def creep_mode(self) -> int:
        return slot.TILT_CREEP if self.tilting else slot.CREEP

    @property
    def unbalanced(self) -> float:
        """Largest unbalanced force of a block in the last step, over its own weight."""
        return float(self.control[slot.UNBALANCED])

    def use(self, safety: float, damping: float = ALPHA, change: float = 0.0) -> None:
        """Local and combined damping, and fictitious masses with another safety."""
        self.control[slot.DAMP], self.control[slot.DAMP_CHANGE] = damping, change
        if safety != self.safety:
            self.safety = safety
            self.set_masses()

    def limit_speed(self, limit: float) -> None:
        """Largest motion of a centroid or of a corner about it in a step [m]: pseudo-time is no time to fall freely."""
        self.loads.speed_limits[:] = limit
        self.loads.speed_limits[:, self.model.dimension :] /= self.shape.radii[:, None]

    # -- state -------------------------------------------------------------------------------------

    def save(self) -> tuple:
        """A copy of everything that changes, for `restore`."""
        return (
            Bodies(*(a.copy() for a in self.bodies)),
            Contacts(*(a.copy() for a in self.contacts)),
            self.joints,
            self.control.copy(),
            self.ledger.copy(),
            self.loads.inverse_masses.copy(),
            self.safety,
        )

    def restore(self, saved: tuple) -> None:
        """Back to a saved state (steps go on counting)."""
        bodies, contacts, joints, control, ledger, inverse_masses, self.safety = saved
        for target, source in zip(self.bodies, bodies, strict=True):
            target[...] = source
        self.contacts = Contacts(*(a.copy() for a in contacts))
        self.joints = joints
        self.control[:], self.ledger[:] = control, ledger
        self.loads.inverse_masses[:] = inverse_masses

    # -- measures ----------------------------------------------------------------------------------

    def kinetic_energy(self) -> float:
        inverse = self.loads.inverse_masses
        moving = inverse > 0.0
        return 0.5 * float((self.bodies.velocities[moving] ** 2 / inverse[moving]).sum())

    def elastic_energy(self) -> float:
        contacts, joints = self.contacts, self.joints
        normal = (contacts.normal**2 / np.where(joints.kn > 0, joints.kn, 1.0)).sum()
        shear = ((contacts.shear**2).sum(axis=1) / np.where(joints.ks > 0, joints.ks, 1.0)).sum()
        return 0.5 * float(normal + shear)

    def displacement(self) -> np.ndarray:
        """Displacement of all centroids [m], (n_blocks, d)."""
        return self.bodies.positions - self.reference_positions

    def save_places(self) -> np.ndarray:
        """Centroids and turned angles (times the radius of the block) [m], (n_blocks, d + r)."""
        return np.column_stack([self.bodies.positions, self.bodies.orientations * self.shape.radii[:, None]])

    def energy_sums(self) -> EnergySums:
        """What the loads gave since the start, and what friction and joints took [J]."""
        given = float(self.ledger[slot.EXTERNAL])
        return EnergySums(given, float(self.ledger[slot.FRICTION]) + self.elastic_energy())

    def live_displacement(self) -> float:
        """Work-conjugate displacement of the live load, q·u [J per unit multiplier]."""
        d = self.model.dimension
        live, free = self.loads.live, self.free  # sums over free blocks: a far support changes no bit of them
        travel = (live[free, :d] * self.displacement()[free]).sum()
        if d == 2:
            travel += (live[free, 2] * self.bodies.orientations[free, 0]).sum()
        return float(travel)

    def dead_scale(self) -> float:
        """What all dead loads would do to the softest joint [m]: no elastic displacement is larger by much."""
        joints = self.joints
        total = np.sqrt((self.loads.dead[self.free, : self.model.dimension] ** 2).sum(axis=1)).sum()
        if not len(joints.kn):
            return self.smallest
        stiffness = np.add.reduceat(np.minimum(joints.kn, joints.ks), joints.starts[:-1])
        return float(total / stiffness.min())

    def largest_displacement(self) -> float:
        """Largest displacement of a centroid [m]."""
        return float(np.sqrt((self.displacement()[self.free] ** 2).sum(axis=1)).max(initial=0.0))

    def energy(self) -> Energy:
        """The ledger since the start [J]; external counts applied loads without gravity."""
        d, free = self.model.dimension, self.free
        weight = -self.loads.dead[free, d - 1]
        gravity = float((weight * self.displacement()[free, d - 1]).sum())
        return Energy(
            kinetic=self.kinetic_energy(),
            elastic=self.elastic_energy(),
            gravity=gravity,
            external=float(self.ledger[slot.EXTERNAL]) + gravity,
            friction=float(self.ledger[slot.FRICTION]),
            damping=float(self.ledger[slot.DAMPING]),
            supports=float(self.ledger[slot.SUPPORT]),
            dashpots=float(self.ledger[slot.DASHPOT]),
            mass_damping=float(self.ledger[slot.MASS]),
            maxwell=float(self.ledger[slot.MAXWELL]),
        )

    def contact_record(self) -> ContactRecord:
        """All contact points now."""
        joints, contacts = self.joints, self.measured()
        owner = joints.owners
        friction = np.sqrt((contacts.shear**2).sum(axis=1))
        limit = self.law.shear_limit(joints.law[owner], contacts.normal, contacts.memory, joints.kn)
        state = np.where(contacts.normal == 0.0, 0, np.where(friction >= limit * (1 - 1e-6), 2, 1))
        return ContactRecord(
            joint=owner,
            blocks=joints.blocks[owner],
            points=joints.points + self.origin,
            normals=joints.frames[:, : self.model.dimension].copy(),
            normal_force=contacts.normal,
            shear_force=contacts.shear,
            gap=contacts.gaps,
            slip=contacts.slip,
            state=state.astype(np.int8),
        )

    def frame(self, stage: str) -> Frame:
        """A snapshot."""
        bodies = self.bodies
        return Frame(
            stage, self.steps, self.load * self.live_scale, self.largest_displacement(),
            bodies.positions + self.origin, bodies.orientations.copy(), bodies.velocities.copy(), self.contact_record(),
        )  # fmt: skip
