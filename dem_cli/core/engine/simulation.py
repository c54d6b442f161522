"""Simulation of a structure: the arrays, the compiled loop that fits them, its loads, states to save and restore."""

from __future__ import annotations

from collections.abc import Callable
from operator import is_
from typing import Any

import numpy as np

from dem_cli.core.contact.detect import block_shape
from dem_cli.core.contact.joints import JointArrays, JointGeometry, JointProperties, points_in_use
from dem_cli.core.contact.start import bodies_at_rest
from dem_cli.core.engine.fictitious_masses import fictitious_masses
from dem_cli.core.engine.kept_scene import guard_of
from dem_cli.core.engine.loads import ActingForces, loads_of
from dem_cli.core.engine.loops import LINEAR, QUADRATIC, RIGID, compiled_advance
from dem_cli.core.engine.placement.clearances import play_of_start
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.engine.state import Books, SavedState
from dem_cli.core.engine.threads.crew import called_by_all, threads_wanted
from dem_cli.core.engine.tracking import Gauge, JointTracking
from dem_cli.core.geometry.rotation import along_frames, rotation_vectors
from dem_cli.core.kernels import records as slot
from dem_cli.core.kernels.fixed_joints import FixedJoints
from dem_cli.core.kernels.jit import CompiledKernel, threads_may_share
from dem_cli.core.kernels.records import Bodies, Contacts, Joints
from dem_cli.core.laws.law import Law
from dem_cli.core.links.link import Springs
from dem_cli.core.links.matrices import elastic_energy_of_links, joined
from dem_cli.core.model.model import Model
from dem_cli.core.model.scales import depth, origin_of, smallest_edge
from dem_cli.core.records.ports import NOTHING_KEPT, Stages
from dem_cli.interrupts import look


class Simulation:
    """Blocks, joints and loads that advance in time.

    kinematics  "fixed": geometry of the start, for failure loads; "large": geometry that moves
    live_scale  live loads are multiplied by it inside, so that a multiplier is of the order of one
    """

    LASTING = frozenset((
        "settings", "model", "law", "properties", "kinematics", "shape", "following", "stages", "threads", "_scene",
        "_loop", "_masses", "_stiff", "_gauge",
    ))  # fmt: skip

    def __init__(
        self,
        model: Model,
        law: Law,
        properties: JointProperties,
        kinematics: str = "fixed",
        live_scale: float = 1.0,
        tilting: bool = False,
        settings: Settings = DEFAULT,
    ):
        self.settings, relaxation = settings, settings.relaxation
        self.threads = threads_wanted()
        self.model, self.law, self.properties, self.kinematics = model, law, properties, kinematics
        self.stages: Stages = NOTHING_KEPT
        self.time = 0.0
        self._scene: tuple[Any, ...] = (None,)  # what the compiled loop is bound to
        self._loop: Callable[..., int] | None = None
        self._gauge: Gauge | None = None  # of the present joints
        self._stiff: tuple[Any, ...] = (None,)  # joints, and the stiffness of their points
        self._masses: dict[float, np.ndarray] = {}  # inverse ones of joints that stay as they are, by their safety
        self.live_scale, self.tilting, self.safety = live_scale, tilting, relaxation.creep_safety
        d, r = model.dimension, model.inertias.shape[1]
        self.like, self.like_rotation = (0.0,) * d, (0.0,) * r  # lengths of tuples in kernels
        self.shape = block_shape(model)
        self.origin = origin_of(model)
        self.bodies = bodies_at_rest(model, self.origin, kinematics == "large")
        self.links = tuple(link.started(self.origin) for link in model.links)
        self.smallest = smallest_edge(model)
        self.free = np.flatnonzero(~model.fixed)
        self.widths = model.shapes.widths
        self.loads = loads_of(model, live_scale, self.shape.radii, relaxation.narrowest_arm)
        self.acting = ActingForces(self.loads, model.masses, self.free, d, relaxation.live, relaxation.carried)
        self.following = model.following if kinematics == "large" else None
        self.drawn_dead = self.loads.dead.copy()  # before any of it follows
        self.control = np.zeros(slot.N_CONTROL)
        self.control[slot.DEAD_FACTOR] = 1.0
        self.control[slot.DAMP] = relaxation.local_damping
        self.control[slot.FIRE_START] = relaxation.fire_mix
        self.ledger = np.zeros(slot.N_LEDGER)
        self.ledger[slot.EXTERNAL] = elastic_energy_of_links(self.links)  # prestress was put in before
        self.steps = 0
        self.most_kinetic = 0.0  # kinetic energy that a time history was seen to have [J]
        self.reference_positions = self.bodies.positions.copy()
        self.tracking = self._track(law.n_memory(model.dimension) + self.n_damped, self.skin * self.smallest)
        self._take_joints()
        self.first_joints = len(self.joints.blocks)  # of the start
        self.first_points = int(points_in_use(self.joints).sum())
        self.first_gaps = self.contacts.gaps.copy()
        self.depth = depth(self.joints.blocks, model.fixed)
        self.play = play_of_start(self.tracking, self.bodies, settings.clearance)
        self.first_places = self.places()
        # Closure of "auto" joints is taken back at rest (engine/rigid_joints.py):
        self.takes_back = kinematics == "large" and not law.bonded and bool(properties.rigid.any())
        self.taken_back = np.zeros((model.n_blocks, model.dead_loads.shape[1]))  # all of it, since the start [m, rad]
        self.leans = 0.0  # share of its load that leaning over such joints would cost, if it is known
        self.shown = settings.relief.shown  # share of the closure of rigid joints that geometry may show at rest

    @property
    def n_damped(self) -> int:
        """Number of values that dampers store for each contact point."""
        return 0

    @property
    def skin(self) -> float:
        """Reach of detection, in smallest edges."""
        return self.settings.detection.skin

    def _track(self, n_memory: int, reach: float) -> JointTracking:
        """Find the joints of the blocks where they start."""
        moves = self.kinematics == "large"
        return JointTracking(
            self.model, self.bodies, self.properties, moves, n_memory, self.smallest, reach, self.settings.detection
        )

    # -- joints ------------------------------------------------------------------------------------

    @property
    def joints(self) -> Joints:
        """Present joints."""
        return self.tracking.joints

    @property
    def geometry(self) -> JointGeometry:
        """Geometry of the present joints."""
        return self.tracking.geometry

    @property
    def contacts(self) -> Contacts:
        """Contact points of the present joints."""
        return self.tracking.contacts

    @property
    def detections(self) -> int:
        """Number of contact detections so far."""
        return self.tracking.detections

    def detect(self) -> None:
        """Detect new faces after large motion; memory follows the contact points."""
        self.tracking.detect(self.bodies)
        self._take_joints()

    def follow_faces(self) -> None:
        """Detect new faces where that is due."""
        if self.kinematics == "large":
            if self.tracking.due(self.bodies):
                self.detect()
            self.control[slot.TRAVEL_LIMIT] = self.tracking.farthest

    def forces_on_second(self) -> np.ndarray:
        """Compute the forces of all contact points on the second block of their joint [N], (n_points, d)."""
        contacts = self.measured()
        return along_frames(self.joints.frames, np.column_stack([contacts.normal, contacts.shear]))

    def measured(self) -> Contacts:
        """Measure the gaps of this instant; frames, levers and points of the joints follow, nothing else."""
        if self._gauge is None or not self._gauge.fits(self.tracking):
            self._gauge = Gauge(self.tracking)
        return self._gauge.measured(self.tracking, self.bodies)

    def _take_joints(self) -> None:
        """Update tiles, masses and the length of a compiled call for new joints."""
        detection = self.settings.detection
        self.tiled = self._in_tiles()
        if self.tiled:
            self.tracking.tile(self.n_in_lanes, self.threads)
        self.longest = max(detection.shortest_call, detection.longest_call // max(1, len(self.joints.kn)))
        self.bodies.travel[:] = 0.0
        self.control[slot.TRAVEL_LIMIT] = self.tracking.farthest
        self._masses.clear()
        self.set_masses()

    def _in_tiles(self) -> bool:
        """Test whether joints are computed many at once in tiles; few are not worth another kernel."""
        if self.kinematics != "fixed" or self.model.n_modes or self.law.of_lanes is None:
            return False
        if self.integrates and self.model.dimension > 2:  # outlines have no form for lanes
            return False
        return len(self.joints.kn) >= self.settings.detection.tiled_from

    def set_masses(self) -> None:
        """Set fictitious masses for the present joints; the change of kinetic energy goes to damping."""
        before = self.kinetic_energy()
        if self.kinematics == "large":
            self.measured()
        if self.safety in self._masses:
            self.loads.inverse_masses[:] = self._masses[self.safety]
        else:
            fictitious_masses(
                self.model,
                self.joints,
                self.bodies,
                self.shape,
                self.safety,
                self.loads.inverse_masses,
                self.settings.relaxation.free_fall,
                self.link_springs(),
            )
        if self.kinematics == "fixed" and not self.links:
            self._masses[self.safety] = self.loads.inverse_masses.copy()
        self.ledger[slot.DAMPING] += before - self.kinetic_energy()

    # -- links -------------------------------------------------------------------------------------

    @property
    def kinds_of_links(self) -> tuple[str, ...]:
        """Kinds of links that the scene has (links/registry.py)."""
        return tuple(link.kind for link in self.links)

    def link_springs(self, along: bool = False) -> Springs | None:
        """Return the springs of links at the present places of blocks, with their lateral stiffness; None: no
        links.

        along: the former alone.
        """
        if not self.links:
            return None
        bodies = self.bodies if self.kinematics == "large" else None
        springs = [link.axial(bodies) for link in self.links]
        springs += [] if along else [link.across(bodies) for link in self.links]
        return joined(springs, self.bodies.velocities.shape[1])

    # -- stepping ----------------------------------------------------------------------------------

    def advance(self, n_steps: int, mode: int) -> None:
        """Advance n_steps of one mode (kernels.records), with detection when it is due. Raises KeyboardInterrupt."""
        left, load = n_steps, 0.0
        longest = min(self.longest, self.settings.relaxation.follow_every) if self.loads_follow else self.longest
        while left > 0:
            look()
            self.turn_loads()
            done = self._step(min(left, longest), mode)
            left -= done
            self.steps += done
            load += self.control[slot.MEAN_LOAD] * done
            self.follow_faces()
        self.control[slot.MEAN_LOAD] = load / max(n_steps, 1)

    @property
    def loads_follow(self) -> bool:
        """Test whether loads follow their blocks."""
        return self.following is not None

    def present_loads(self) -> tuple[np.ndarray, np.ndarray]:
        """Return dead and live loads of all blocks as they are now, about the centroids [N, N m], (n_blocks, d +
        r) each."""
        dead, live = self.model.dead_loads, self.model.live_loads
        if self.following is None:
            return dead, live
        change, turned = self.following.change, self.bodies.orientations
        return dead + change(turned, dead=True), live + change(turned, dead=False)

    def turn_loads(self) -> None:
        """Move loads that follow their blocks to where these are."""
        if self.loads_follow:
            dead, live = self.present_loads()
            self.loads.dead[:] = np.where(self.model.held, 0.0, dead)
            self.loads.live[:] = np.where(self.model.held, 0.0, live * self.live_scale)

    def __getstate__(self) -> dict[str, Any]:
        """Return the state of a copy, without the compiled code that this one is bound to."""
        return self.__dict__ | {"_scene": (None,), "_loop": None, "_stiff": (None,), "_gauge": None}

    def guard_of_kept(self) -> Callable[[Any], None]:
        """Return the check of a state that came back from a checkpoint (engine/kept_scene.py)."""
        return guard_of(self)

    def compile(self) -> None:
        """Compile or load the stepping loop; no step is done."""
        control = self.control.copy()
        self._step(0, slot.HOLD_LOAD)
        self.control[:] = control

    def _step(self, n_steps: int, mode: int) -> int:
        """Call the compiled loop; returns the steps done before joints had to be detected."""
        threads = self.threads if n_steps > 0 and threads_may_share() else 1
        members = self.tracking.assemble(self.n_in_lanes, threads) if self.tiled else 1
        scene = (
            self.bodies, self.shape, self.joints, self.geometry, self.contacts, self.links, self.loads, self.control,
            self.ledger, self.like, self.like_rotation,
        )  # fmt: skip
        if all(map(is_, scene, self._scene)):
            loop = self._loop = self._loop or self._compiled().bound()
        else:
            self._scene, self._loop, loop = scene, None, self._compiled()
        done: int = called_by_all(loop, (n_steps, mode, 1.0, *scene), members)
        return done

    def _compiled(self) -> CompiledKernel:
        model = self.model
        return compiled_advance(
            self.kinematics, self.law, self.properties.profiled, model.dimension, self.kinds_of_links,
            self.order_within_blocks, self.tiled, self.integrates,
        )  # fmt: skip

    @property
    def order_within_blocks(self) -> int:
        """Polynomial order of displacements within blocks, as engine/loops.py has them."""
        return QUADRATIC if len(self.model.mode_shapes) else LINEAR if self.model.n_modes else RIGID

    @property
    def n_in_lanes(self) -> int:
        """Number of values that tiles store for each joint: those that the law reads there, and whether its face
        is elastic."""
        return self.law.n_of_lanes + self.integrates

    @property
    def integrates(self) -> bool:
        """Test whether there are faces over which pressure is integrated."""
        return len(self.contacts.lumped) > 0

    @property
    def speeds(self) -> np.ndarray:
        """Velocities of the blocks without those of their modes, (n_blocks, d + r)."""
        return self.bodies.velocities[:, : self.model.rotations.stop]

    def accelerations(self, blocks: np.ndarray) -> np.ndarray:
        """Return accelerations in the last step, per unit of the solver's time, (n, d + r)."""
        columns = slice(self.model.rotations.stop)
        return self.bodies.unbalanced[blocks, columns] * self.loads.inverse_masses[blocks, columns]

    def rest(self) -> None:
        """Stop all free blocks; their kinetic energy goes to damping."""
        before = self.kinetic_energy()
        self.bodies.velocities[self.free] = 0.0
        self.ledger[slot.DAMPING] += before - self.kinetic_energy()

    def set_load(self, multiplier: float) -> None:
        """Set a constant load; with a tilting table the dead loads turn with it (multiplier = tan θ)."""
        cosine = 1.0 / np.sqrt(1.0 + multiplier**2) if self.tilting else 1.0
        self.control[slot.DEAD_FACTOR] = cosine
        self.control[slot.LIVE_FACTOR] = multiplier * cosine

    @property
    def load(self) -> float:
        """Internal load multiplier (times live_scale: the one users know)."""
        return self.over_share(self.control[slot.LIVE_FACTOR])

    def over_share(self, load: float) -> float:
        """Divide an internal multiplier by the share of the dead loads: infinite on a table that stands upright."""
        share = self.control[slot.DEAD_FACTOR]
        if share > 0.0:
            return load / share
        return float(np.copysign(np.inf, load)) if load else 0.0

    @property
    def mean_load(self) -> float:
        """Internal load multiplier, mean over the last call of `advance`, times the share of the dead loads."""
        return self.control[slot.MEAN_LOAD]

    @property
    def dead_share(self) -> float:
        """Share of the dead loads that is applied; a tilted table has less of all loads."""
        return self.control[slot.DEAD_FACTOR]

    @property
    def rate(self) -> float:
        """Prescribed rate of a creep [J per step]."""
        return self.control[slot.RATE]

    @property
    def creep_mode(self) -> int:
        """Solver mode of a creep (kernels.records)."""
        return slot.TILT_CREEP if self.tilting else slot.CREEP

    @property
    def guided_mode(self) -> int:
        """Solver mode of a relaxation at a prescribed displacement of the live load (kernels.records)."""
        return slot.TILT_GUIDED if self.tilting else slot.GUIDED

    @property
    def unbalanced(self) -> float:
        """Largest unbalanced force of a block in the last step, over its own weight, or where others than weights act
        over what does (engine/loads.py)."""
        live = float(self.control[slot.LIVE_FACTOR])
        if self.acting.count(live):
            return self.acting.largest_share(self.bodies, self.joints, self.contacts, live)
        return float(self.control[slot.UNBALANCED])

    def use(self, safety: float, damping: float | None = None, change: float = 0.0) -> None:
        """Set fictitious masses with another safety; damping against the velocity (None: local) and the change of
        force."""
        damping = self.settings.relaxation.local_damping if damping is None else damping
        self.control[slot.DAMP], self.control[slot.DAMP_CHANGE] = damping, change
        if safety != self.safety:
            self.safety = safety
            self.set_masses()

    def use_combined_damping(self) -> None:
        """Damp against the velocity and the change of force, under which a constant load settles or fails."""
        relaxation = self.settings.relaxation
        self.use(relaxation.combined_safety, relaxation.combined_damping, relaxation.combined_damping)

    def limit_speed(self, limit: float) -> None:
        """Limit the motion of a centroid or of a corner about it in a step [m]: blocks do not fall freely in
        pseudo-time."""
        self.loads.speed_limits[:] = limit
        self.loads.speed_limits[:, self.model.rotations] /= self.shape.radii[:, None]

    # -- what analyses write (where blocks are put: engine/placement/moves.py) --------------------------

    def set_dead_share(self, share: float) -> None:
        """Scale the dead loads by a share, while they are applied."""
        self.control[slot.DEAD_FACTOR] = share

    def prescribe_rate(self, rate: float) -> None:
        """Prescribe the rate of the live load's own displacement in a creep [J per step]."""
        self.control[slot.RATE] = rate

    def restart_relaxation(self) -> None:
        """Restart FIRE: the first share of velocity that turns towards the force, no step uphill yet."""
        self.control[slot.FIRE_MIX], self.control[slot.SINCE_UPHILL] = self.control[slot.FIRE_START], 0.0

    def move_supports(self, velocities: np.ndarray) -> None:
        """Set velocities of the fixed blocks [m, rad per step], of all blocks (n_blocks, n_dof); zero stops them."""
        self.bodies.velocities[self.model.fixed, : velocities.shape[1]] = velocities[self.model.fixed]

    def open_books(self, friction: float) -> None:
        """Open a new energy balance, in which elastic energy and friction work [J] were given from outside."""
        self.ledger[:] = 0.0
        self.ledger[slot.FRICTION] = friction
        self.ledger[slot.EXTERNAL] = friction + self.elastic_energy()
        self.ledger[slot.CONTACT] = -self.ledger[slot.EXTERNAL]
        self.contacts.exchanged[:] = 0.0

    def count_from(self, steps: int) -> None:
        """Set the number of steps that were done before this simulation took over."""
        self.steps = steps

    # -- state -------------------------------------------------------------------------------------

    def save(self) -> SavedState:
        """Copy everything that changes, for `restore`."""
        return SavedState(
            Bodies(*(a.copy() for a in self.bodies)),
            Contacts(*(a.copy() for a in self.contacts)),
            self.joints.kept(),
            self.geometry.kept(),
            self.control.copy(),
            self.ledger.copy(),
            self.loads.inverse_masses.copy(),
            self.safety,
            tuple(link.state.copy() for link in self.links),
            self.tracking.unpassed.copy(),
        )

    def restore(self, saved: SavedState) -> None:
        """Restore a saved state (steps go on counting)."""
        for target, source in zip(self.bodies, saved.bodies, strict=True):
            target[...] = source
        contacts = Contacts(*(a.copy() for a in saved.contacts))
        self.tracking.take(JointArrays(saved.joints.kept(), saved.geometry.kept(), contacts))
        self.control[:], self.ledger[:] = saved.control, saved.ledger
        self.tracking.unpassed, self.tracking.farthest = saved.unpassed.copy(), float(saved.control[slot.TRAVEL_LIMIT])
        self.loads.inverse_masses[:] = saved.inverse_masses
        self.safety = saved.safety
        for link, state in zip(self.links, saved.links, strict=True):
            link.state[:] = state
        self.turn_loads()

    # -- energy ------------------------------------------------------------------------------------

    def kinetic_energy(self) -> float:
        """Compute the kinetic energy of all blocks, with the masses that they have now [J]."""
        inverse = self.loads.inverse_masses
        moving = inverse > 0.0
        return 0.5 * float((self.bodies.velocities[moving] ** 2 / inverse[moving]).sum())

    def elastic_energy(self) -> float:
        """Compute the elastic energy of joints and links, and of blocks that deform [J]."""
        normal = self.tracking.arrays().pressed.sum()
        shear = ((self.contacts.shear**2).sum(axis=1) / self._stiffness()[1]).sum()
        inside = (self.shape.mode_stiffness * self.bodies.modes**2).sum() if self.model.n_modes else 0.0
        return 0.5 * float(normal + shear + inside) + elastic_energy_of_links(self.links)

    def _stiffness(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the stiffness of all contact points along normal and tangents, 1 without any; that of fixed
        joints is cached."""
        joints = self.joints
        if joints is not self._stiff[0]:
            found = tuple(np.where(stiffness > 0, stiffness, 1.0) for stiffness in (joints.kn, joints.ks))
            self._stiff = (joints if isinstance(joints, FixedJoints) else None, *found)
        return self._stiff[1:]

    def books(self) -> Books:
        """Return the energy balance as it stands."""
        return Books(self.ledger, self.kinetic_energy(), self.elastic_energy())

    def places(self) -> np.ndarray:
        """Return centroids and turned angles (times the radius of the block) [m], (n_blocks, d + r)."""
        turned = rotation_vectors(self.bodies.orientations)
        return np.column_stack([self.bodies.positions, turned * self.shape.radii[:, None]])
