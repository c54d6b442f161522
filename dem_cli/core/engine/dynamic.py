"""Dynamic simulation: real masses, ground motion, dampers; after the structure came to rest in pseudo-time."""

from __future__ import annotations

from collections.abc import Callable
from operator import is_
from typing import Any, Protocol

import numpy as np

from dem_cli.core.arithmetic import functions
from dem_cli.core.contact.compatibility import held_motions
from dem_cli.core.contact.joints import JointProperties
from dem_cli.core.engine.loops import compiled_shake
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.engine.state import NO_CARRIERS, Books, Carriers
from dem_cli.core.engine.viscous import Damping, strain_rates, turned_loads
from dem_cli.core.geometry.inertia import along_principal, gyration, mobilities
from dem_cli.core.geometry.rotation import along_frames
from dem_cli.core.kernels import records as slot
from dem_cli.core.kernels.dashpots import OPEN, STARTS, STICKS
from dem_cli.core.kernels.jit import CompiledKernel
from dem_cli.core.kernels.records import NO_GAUGES, Dampers, Gauges, Ground, Watch
from dem_cli.core.kernels.spatial_dashpots import GAINS
from dem_cli.core.laws.law import Law
from dem_cli.core.links.link import N_STATE
from dem_cli.core.model.model import Model
from dem_cli.interrupts import look


class Looker(Protocol):
    """Observer of a simulation while it is shaken."""

    due: int  # step of the motion, at the end of which is the next look

    def look(self) -> None:
        """Observe the end of a step; changes nothing."""


class DynamicSimulation(Simulation):
    """Dynamic simulation: first quasi-static as any other, from `begin` on in seconds.

    damping     what the joints and blocks lose (dynamics/damping.py)
    """

    LASTING = Simulation.LASTING | {"damping", "_shaken", "_shake"}

    def __init__(
        self, model: Model, law: Law, properties: JointProperties, damping: Damping, settings: Settings = DEFAULT
    ):
        self.damping = damping
        self.real, self.dt = False, 1.0
        self._shaken: tuple[Any, ...] = (None,)  # what the compiled loop of time histories is bound to
        self._shake: Callable[..., int] | None = None
        self.strained = strain_rates(model, damping, self.dt)
        self.masses = np.where(held_motions(model, model.n_modes > 0), 0.0, _masses(model))
        if len(model.principal_axes):  # inertia is a tensor, which turns with its block
            self.masses[:, model.rotations] = 0.0
        self.masses[:, model.rotations.stop :] = 0.0  # matrices, in StrainRates
        properties = properties._replace(integrated=None)  # blocks land on the points of their joints
        super().__init__(model, law, properties, "large", settings=settings)
        self.dead_loads = self.loads.dead.copy()  # before velocities have mean spins
        self.carriers = NO_CARRIERS  # what carried blocks when the motion began (dynamics/supports.py)
        self.takes_back = False  # springs that press at the start go on pressing

    def __getstate__(self) -> dict[str, Any]:
        """Return the state of a copy, without compiled code."""
        return super().__getstate__() | {"_shaken": (None,), "_shake": None}

    @property
    def n_damped(self) -> int:
        """Number of values that dashpots and Maxwell elements store for each contact point."""
        return self.model.dimension * (1 + len(self.damping.elements)) if self.damping.in_joints else 0

    @property
    def skin(self) -> float:
        """Reach of detection of blocks that rock far, in smallest edges."""
        return self.settings.detection.wide_skin

    # -- from pseudo-time to time ------------------------------------------------------------------

    def begin(self, dt: float) -> None:
        """Begin the motion in time: a step takes dt [s], masses are real, speed is free, the energy balance starts
        anew."""
        model = self.model
        self.rest()
        self.real, self.dt, self.time = True, dt, 0.0
        held = held_motions(model, model.n_modes > 0)
        self.loads.inverse_masses[:] = np.where(held, 0.0, 1.0 / _masses(model))
        self.strained = strain_rates(model, self.damping, dt)
        self._turn_dead_loads()
        self.loads.speed_limits[:] = np.inf
        self.control[slot.DAMP], self.control[slot.DAMP_CHANGE] = self.damping.local, 0.0
        self.control[slot.MASS_RATE] = self.damping.mass
        self._new_dampers(STARTS)
        self.ledger[:] = 0.0
        self.ledger[slot.EXTERNAL] = self.elastic_energy()  # what the springs hold was given before
        self.centred = self.ledger.copy()
        bodies, shape = self.bodies, self.shape
        bodies.means[:] = bodies.pulled[:] = 0.0
        bodies.mobilities[:] = mobilities(shape.inertias, shape.axes, bodies.turns)
        self.turns_of_means = bodies.turns.copy()
        self.contacts.exchanged[:] = 0.0

    def take_carriers(self, carriers: Carriers) -> None:
        """Store the faces that support the blocks when the motion begins."""
        self.carriers = carriers

    @property
    def loads_turn(self) -> bool:
        """Test whether blocks that deform have loads at points, which act on the modes differently after a turn."""
        d, modes = self.model.dimension, self.model.rotations.stop
        return self.model.n_modes > 0 and bool(
            self.dead_loads[:, d:modes].any() or self.dead_loads[:, modes + 1 :].any()
        )

    def _turn_dead_loads(self) -> None:
        """Turn the loads on modes of blocks with their rotations."""
        if self.model.n_modes:
            self.loads.dead[:] = turned_loads(self.strained, self.dead_loads, self.bodies.turns)

    def start_moving(self) -> None:
        """Move the velocities of time 0 back by half a step; their energy counts as given.

        The first step begins as long before time 0 as it ends after it: half of its work is not of the run.
        """
        kinetic, saved, before = self.kinetic_energy(), self.save(), self.bodies.velocities.copy()
        self._run(0, 1, self._still(1), no_watch(self))
        kicked = self.bodies.pulled.reshape(before.shape)
        change, elastic = (kicked - before)[self.free], self.elastic_energy()  # of springs at time 0
        self.restore(saved)
        self._new_dampers(STARTS)
        self.bodies.velocities[self.free] -= 0.5 * change
        saved, self.ledger[:] = self.save(), 0.0
        self._run(0, 1, self._still(1), no_watch(self))
        early = 0.5 * self.ledger
        early[slot.FRICTION] = 0.0  # is that of whole steps
        self.restore(saved)
        self._new_dampers(STARTS)
        self.ledger[slot.EXTERNAL] = elastic + kinetic
        self.ledger[:] -= early

    def set_masses(self) -> None:
        """Set fictitious masses, as long as masses are not real."""
        if not self.real:
            super().set_masses()

    def _take_joints(self) -> None:
        super()._take_joints()
        if self.real:
            self._new_dampers()

    def _new_dampers(self, closed: int = STICKS) -> None:
        """Build the dampers of the present joints; their memory is with the points. closed: state of those closed."""
        joints, contacts, d = self.joints, self.contacts, self.model.dimension
        n = len(joints.kn) if self.damping.in_joints else 0
        of_modes = (n, 2, d, self.model.n_modes) if self.model.n_modes else (0,)
        self.dampers = Dampers(
            first=self.law.n_memory(d),
            viscosity=self.damping.viscosities(self.model, joints),
            elements=self._decays(),
            rates=np.zeros((n, d)),
            gains=np.ones((n, GAINS[d])),
            packed=np.zeros(len(joints.blocks) + 1, dtype=np.int64),
            lasts=np.zeros(len(joints.blocks), dtype=np.int64),
            rooms=np.zeros(len(joints.blocks), dtype=np.int64),
            holders=np.zeros(n, dtype=np.int64),
            active=np.zeros(len(joints.blocks) + 1, dtype=np.int64),
            awake=np.zeros(len(joints.blocks), dtype=np.int64),
            met=np.zeros(len(joints.blocks), dtype=np.int8),
            stirred=np.zeros(self.model.n_blocks, dtype=np.int8),
            trifles=self._trifles(),
            slips=contacts.slip[:n].copy(),
            states=np.where(contacts.normal[:n] != 0.0, closed, OPEN).astype(np.int8),
            masses=self.masses,
            pushes=np.zeros_like(self.bodies.velocities),
            strained=self.strained,
            motions=np.zeros(of_modes),
            lifts=np.zeros(of_modes),
        )

    def _trifles(self) -> np.ndarray:
        """Compute impulses that no other joint of a block notices [N s], (n_blocks,)."""
        weights = 1.0 / self.loads.force_scales[:, 0]
        return np.where(self.model.fixed, np.inf, self.settings.history.trifle * weights * self.dt)

    def forces_on_second(self) -> np.ndarray:
        """Compute contact forces; in a motion those of the last step, with mean dashpot and Maxwell forces over it."""
        if not self.real:
            return super().forces_on_second()
        contacts, d = self.contacts, self.model.dimension
        forces = np.column_stack([contacts.normal, contacts.shear])
        if self.damping.in_joints:
            first, memory = self.dampers.first, contacts.memory
            forces += memory[:, first : first + d] / self.dt
            for element in range(len(self.damping.elements)):
                column = first + d * (element + 1)
                forces += memory[:, column : column + d]
        return along_frames(self.joints.frames, forces)

    def _decays(self) -> np.ndarray:
        """Compute the decay of Maxwell forces over a step at constant rates, and their gain, as Dampers.elements."""
        if not len(self.damping.elements):
            return np.zeros(0)
        share, rate = self.damping.elements.T
        gains = -share * functions.expm1(-rate * self.dt) / rate
        return np.ascontiguousarray(np.column_stack([functions.exp(-rate * self.dt), gains]))

    # -- stepping ----------------------------------------------------------------------------------

    def compile(self) -> None:
        """Compile or load both loops; no step is done."""
        super().compile()
        self._new_dampers()
        control = self.control.copy()
        self._run(0, 0, self._still(0), no_watch(self))
        self.control[:] = control

    def shake(
        self,
        ground: Ground,
        n_steps: int,
        watch: Watch,
        first: int = 0,
        looker: Looker | None = None,
        reader: Looker | None = None,
    ) -> None:
        """Advance n_steps over a stretch of ground motion, from its step `first`, with detection when it is due.

        The energy balance is closed in the middle of the last step, where places, velocities and forces are of one
        time; looks along the way change no bit. reader: who looks at the forces of a step, before faces are found anew;
        its steps are those of the stretch. Raises KeyboardInterrupt.
        """
        step, end = first, first + n_steps
        done = round(self.time / self.dt) - first  # steps before that of number 0
        while step < end:
            look()
            last = step == end - 1
            if last:
                before, self.turns_of_means = self.ledger.copy(), self.bodies.turns.copy()
            n = 1 if last else end - 1 - step
            if self.loads_turn:
                self._turn_dead_loads()
                n = min(n, self.settings.relaxation.follow_every)
            if looker is not None:
                n = min(n, max(looker.due - done - step, 1))
            if reader is not None:
                n = min(n, max(reader.due - step, 1))
            advanced = self._run(step, n, ground, watch)
            step += advanced
            if reader is not None and step >= reader.due:
                reader.look()
            if last:
                self.centred = 0.5 * (before + self.ledger)
                self.centred[slot.FRICTION] = self.ledger[slot.FRICTION]
            self.follow_faces()
            self.steps += advanced
            self.time = self.dt * (done + step)
            if looker is not None and done + step >= looker.due:
                looker.look()

    def watch(self, blocks: np.ndarray, every: int, n_samples: int, gauges: Gauges = NO_GAUGES) -> Watch:
        """Allocate so many samples of blocks and of all links, every so many steps; gauges are read in each."""
        samples = np.zeros((n_samples, len(blocks), 3, self.model.rotations.stop))
        n_links = sum(len(link.state) for link in self.links)
        return Watch(blocks, every, samples, np.zeros((n_samples, n_links, N_STATE)), gauges)

    def _still(self, n_steps: int) -> Ground:
        """Return a ground at rest."""
        d, n_dof = self.model.dimension, self.model.rotations.stop
        return Ground(np.zeros((n_steps, d)), np.zeros(0, np.int64), np.zeros((n_steps, 0, n_dof)))

    def _run(self, first: int, n_steps: int, ground: Ground, watch: Watch) -> int:
        scene = (
            self.bodies, self.shape, self.joints, self.geometry, self.contacts, self.links, self.loads, self.control,
            self.ledger, self.dampers,
        )  # fmt: skip
        if all(map(is_, scene, self._shaken)):
            run = self._shake = self._shake or self._compiled_shake().bound()
        else:
            self._shaken, self._shake, run = scene, None, self._compiled_shake()
        *moved, dampers = scene
        done: int = run(
            first, min(n_steps, self.longest), self.dt, *moved, ground, dampers, watch, self.like, self.like_rotation
        )
        return done

    def _compiled_shake(self) -> CompiledKernel:
        return compiled_shake(
            self.law, self.properties.profiled, self.damping.in_joints, self.model.dimension, self.kinds_of_links,
            self.order_within_blocks,
        )  # fmt: skip

    # -- energy ------------------------------------------------------------------------------------

    def kinetic_energy(self) -> float:
        """Compute the kinetic energy of all blocks, with the masses that they have now [J]."""
        return self._energy_of(self.bodies.velocities, self.bodies.turns) if self.real else super().kinetic_energy()

    def elastic_energy(self) -> float:
        """Compute the elastic energy of springs and blocks at one instant: modes are a step ahead of the joint
        forces [J]."""
        modes, found = self.bodies.modes, super().elastic_energy()
        if not (self.real and modes.size):
            return found
        rates, stiffness = self.bodies.velocities[:, self.model.rotations.stop :], self.shape.mode_stiffness
        return found + 0.5 * float((stiffness * ((modes - self.dt * rates) ** 2 - modes**2)).sum())

    def centred_kinetic_energy(self) -> float:
        """Compute the kinetic energy of the mean velocities of the last step [J]."""
        return self._energy_of(self.bodies.means.reshape(self.bodies.velocities.shape), self.turns_of_means)

    def _energy_of(self, velocities: np.ndarray, turns: np.ndarray) -> float:
        """Kinetic energy of blocks that are turned like this, with real masses: those along principal axes [J]."""
        rotations = self.model.rotations
        spins = along_principal(velocities[:, rotations], self.shape.axes, turns)
        rates = velocities[:, rotations.stop :]
        velocities = np.column_stack([velocities[:, : self.model.dimension], spins])
        inverse = self.loads.inverse_masses[:, : rotations.stop]
        moving = inverse > 0.0
        found = 0.5 * float((velocities[moving] ** 2 / inverse[moving]).sum())
        if rates.size:
            found += 0.5 * float(np.einsum("ni,nij,nj->", rates, self.strained.masses, rates))
        return found

    def note_kinetic_energy(self, energy: float | None = None) -> None:
        """Record the largest kinetic energy seen [J], which errors of energy are compared with.

        energy: that of this instant, if it is known.
        """
        self.most_kinetic = max(self.most_kinetic, self.centred_kinetic_energy() if energy is None else energy)

    def books(self) -> Books:
        """Return the energy balance since `begin`, one step back from the positions."""
        if not self.real:
            return super().books()
        kinetic, elastic = self.centred_kinetic_energy(), self.elastic_energy()
        return Books(self.centred, kinetic, elastic, self._held_by_elements(), self.dt)

    def _held_by_elements(self) -> float:
        """Energy in the springs of Maxwell elements [J]."""
        joints, d, held = self.joints, self.model.dimension, 0.0
        used = joints.kn > 0.0
        for e, (share, _) in enumerate(self.damping.elements):
            column = self.dampers.first + d * (e + 1)
            forces = self.contacts.memory[:, column : column + d]
            held += float((forces[used, 0] ** 2 / (share * joints.kn[used])).sum())
            held += float(((forces[used, 1:] ** 2).sum(axis=1) / (share * joints.ks[used])).sum())
        return 0.5 * held

    @property
    def noticeable_energy(self) -> float:
        """Energy that lifts the whole structure by a small share of its smallest edge [J]."""
        weights = np.abs(self.loads.dead[self.free, : self.model.dimension]).sum()
        return self.settings.history.noticeable * self.smallest * float(weights)

    def show_base(self, acceleration: float, gravity: float) -> None:
        """Set the load shown in records: acceleration of the base over gravity."""
        self.control[slot.LIVE_FACTOR] = acceleration / gravity if gravity > 0.0 else 0.0

    def accelerations(self, blocks: np.ndarray) -> np.ndarray:
        """Accelerations of blocks in the last step, relative to the base [m/s², rad/s²], (n, d + r).

        Until `begin` they are those of the way to rest.
        """
        if not self.real:
            return super().accelerations(blocks)
        bodies, shape, columns = self.bodies, self.shape, slice(self.model.rotations.stop)
        fields = (field.reshape(bodies.velocities.shape)[blocks, columns] for field in (bodies.means, bodies.pulled))
        means, kicked = fields
        found = 2.0 * (kicked - means) / self.dt
        if len(shape.axes):
            rotations = self.model.rotations
            turning = shape.inertias[blocks], shape.axes[blocks], self.turns_of_means[blocks]
            found[:, rotations] += gyration(means[:, rotations], *turning)
        return found


def _masses(model: Model) -> np.ndarray:
    """Masses and moments of inertia of all blocks [kg, kg m²], (n_blocks, n_dof); modes have that of their block."""
    d, m = model.dimension, model.n_modes
    masses = np.repeat(model.masses[:, None], d + m, axis=1)
    return np.column_stack([masses[:, :d], model.inertias, masses[:, d:]])


def no_watch(sim: Simulation) -> Watch:
    """Return empty room for samples, where nobody observes a stretch of any length."""
    return Watch(np.zeros(0, np.int64), 1, np.zeros((1, 0, 3, sim.model.rotations.stop)))
