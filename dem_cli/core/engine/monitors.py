"""Monitors: quantities followed through a run; the same formulas for one instant and for a stretch of time.

A sample holds position (with the angle, in space the rotation vector), velocity and acceleration of a block, all at
one instant and relative to the base: samples are (n, n_watched, 3, n_dof).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.core.arithmetic.products import norm, product
from dem_cli.core.engine.measures import PointPushes, point_pushes, reactions
from dem_cli.core.geometry.rotation import angles_of, beside, moments, rotation_vectors, swept, tangents_of, turning
from dem_cli.core.kernels import records as slot
from dem_cli.core.kernels.records import NO_LINKS, Gauges
from dem_cli.core.links.link import N_STATE, LinkReading
from dem_cli.core.links.matrices import reading_of
from dem_cli.core.model.model import Model
from dem_cli.core.model.places import block_at
from dem_cli.core.model.quadratic_modes import moved_by_modes
from dem_cli.core.model.scales import origin_of
from dem_cli.core.model.section_cuts import SectionCut, drift_ends, section_cut, section_forces

if TYPE_CHECKING:
    from dem_cli.core.contact.between import StartJoints
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.records.requests import MonitorRequest

GAUGES = {"displacement": slot.PLACE, "velocity": slot.SPEED, "rotation": slot.TURN}  # whose extremes are of all steps
_NOTHING_YET = (-np.inf, 0.0, np.inf, 0.0)  # a row of Gauges.found, and of `extremes`
OF_BASE = {"acceleration": 0, "velocity": 1, "displacement": 2}  # as records.history_rows.Samples.base


class Points(NamedTuple):
    """Material points, which move with their blocks. All of a case at once, as a stretch of time is short."""

    rows: np.ndarray  # of their blocks in the samples, (n_points,)
    starts: np.ndarray  # centroids of their blocks, undeformed, as the samples count [m], (n_points, d)
    arms: np.ndarray  # from these centroids, undeformed [m], (n_points, d)
    strained: np.ndarray  # the same of blocks as they deform, in their own axes [m], (n_points, d)


class PointMotion:
    """Motion of all points over a stretch of time."""

    def __init__(self, points: Points, samples: np.ndarray):
        self.points, self.samples, self.d = points, samples[:, points.rows], points.arms.shape[1]
        self.orientations = self.samples[:, :, 0, self.d :]
        self.arms = self.turned(points.strained)

    def turned(self, vectors: np.ndarray, which: np.ndarray | slice = slice(None)) -> np.ndarray:
        """Rotate vectors (k, d) with the blocks of points, (n, k, d)."""
        return turning(self.orientations[:, which])(vectors)

    @cached_property
    def displacement(self) -> np.ndarray:
        """Displacement from the undeformed places [m], (n, n_points, d)."""
        return self.samples[:, :, 0, : self.d] - self.points.starts + self.arms - self.points.arms

    @cached_property
    def velocity(self) -> np.ndarray:
        """Velocity v + ω × r, (n, n_points, d)."""
        motion = self.samples[:, :, 1]
        return motion[:, :, : self.d] + swept(motion[:, :, self.d :], self.arms)

    @cached_property
    def acceleration(self) -> np.ndarray:
        """Acceleration a + α × r + ω × (ω × r), (n, n_points, d)."""
        spins, change = self.samples[:, :, 1, self.d :], self.samples[:, :, 2]
        towards = swept(spins, swept(spins, self.arms))
        return change[:, :, : self.d] + swept(change[:, :, self.d :], self.arms) + towards


class JointMonitors(NamedTuple):
    """Pairs of points that lay opposite each other across joints: at its ends or corners for an opening, in the middle
    for a slip. They are measured in the undeformed frame of the joint, which turns with the first block.
    """

    first: np.ndarray  # points on the first block, (n_pairs,)
    second: np.ndarray  # and on the second
    apart: np.ndarray  # from the first to the second, undeformed [m], (n_pairs, d)
    axes: np.ndarray  # along which they are measured, undeformed: the normal, or a tangent for a slip, (n_pairs, d)
    begins: np.ndarray  # first pair of each of these monitors, (n,)
    columns: np.ndarray  # and its number among all, (n,)
    lengths: np.ndarray  # whether its pairs are the two components of a slip in space, (n,) bool

    def fill(self, out: np.ndarray, motion: PointMotion) -> None:
        """Write the largest of the pairs of each monitor, or the length of both [m], to its column of out (n,
        n_monitors)."""
        moved = motion.displacement
        distances = self.apart + moved[:, self.second] - moved[:, self.first]
        along = (distances * motion.turned(self.axes, self.first)).sum(axis=2)
        largest = np.maximum.reduceat(along, self.begins, axis=1)
        if self.lengths.any():
            largest = np.where(self.lengths, np.sqrt(np.add.reduceat(along**2, self.begins, axis=1)), largest)
        out[:, self.columns] = largest


class PointMonitor(NamedTuple):
    """Monitor of a vector at material points: its mean, the length or a component of that; or the rotation of
    blocks."""

    column: int
    points: list[int]
    weights: np.ndarray  # of the points in the mean, (n_points,)
    quantity: str
    component: str | None
    absolute: bool
    along: np.ndarray | None = None  # instead of a component: the direction in which it counts, unit, (d,)

    def fill(self, out: np.ndarray, motion: PointMotion, base: np.ndarray) -> None:
        """Write the values to the monitor's column of out (n, n_monitors)."""
        if self.quantity == "rotation":
            vectors = self._mean(motion.orientations)
            length = angles_of(vectors)
        else:
            vectors = self._mean(getattr(motion, self.quantity))
            vectors = vectors + base[:, OF_BASE[self.quantity]] if self.absolute else vectors
            length = np.linalg.norm(vectors, axis=1)
        if self.along is not None:
            out[:, self.column] = product(vectors, self.along)
        else:
            out[:, self.column] = length if self.component is None else vectors[:, "xyz".index(self.component)]

    def _mean(self, vectors: np.ndarray) -> np.ndarray:
        """Average vectors of all points (n, n_points, ...) over the points of the monitor, (n, ...)."""
        if len(self.points) == 1:
            return vectors[:, self.points[0]]
        return np.einsum("np...,p->n...", vectors[:, self.points], self.weights)


class ReactionMonitor(NamedTuple):
    """Monitor of reactions on some blocks together: their force, or their moment about the common centroid."""

    column: int
    blocks: np.ndarray  # those of which something is held, (n,)
    quantity: str
    component: str | None

    def value(self, sim: Simulation) -> float:
        """Compute the reaction at this instant [N or N m]; of a vector in space without a component its length."""
        model, given = sim.model, reactions(sim)[self.blocks]
        forces, vector = given[:, : model.dimension], given[:, : model.dimension].sum(axis=0)
        if self.quantity == "reaction_moment":
            masses, places = model.masses[self.blocks], sim.bodies.positions[self.blocks]
            arms = places - product(masses, places) / masses.sum()
            vector = (given[:, model.rotations] + moments(arms, forces)).sum(axis=0)
        if self.component is not None:
            return float(vector["xyz".index(self.component)])
        return float(vector[0]) if len(vector) == 1 else float(norm(vector))


class CutMonitor(NamedTuple):
    """Monitor of a force or moment that the joints along a cut carry, in the equilibrium of all beyond it."""

    column: int
    cut: SectionCut
    quantity: str

    def value(self, sim: Simulation, given: PointPushes) -> float:
        """Compute the section force at this instant [N or N m]. Joints are found again where their material lay in
        the undeformed structure."""
        passed = self.cut.passes(sim.model.centroids, given.blocks, given.middles)
        beyond = self.cut.sides(sim.model.centroids)[given.blocks[:, 0]]
        forces = np.where(beyond[:, np.newaxis], given.on_second, -given.on_second)
        found = section_forces(self.cut, given.places[passed], forces[passed])
        return float(getattr(found, self.quantity))


def extremes_of(times: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Find the highest of some values and its time, the lowest and its time [s], (n_monitors, 4); infinite where there
    are none. values: (n, n_monitors) at times (n,)."""
    if not len(times):
        return np.full((values.shape[1], 4), _NOTHING_YET)
    known = np.where(np.isfinite(values), values, 0.0)  # a run may end in nonsense
    high, low, each = known.argmax(axis=0), known.argmin(axis=0), np.arange(values.shape[1])
    return np.column_stack([known[high, each], times[high], known[low, each], times[low]])


class Monitors:
    """Monitors of a run, in the order of their requests.

    watched  numbers of the blocks that must be known for it, ascending
    """

    def __init__(self, requests: Sequence[MonitorRequest], model: Model):
        self.requests, self.model = requests, model
        blocks = self._blocks()
        self.watched = np.unique(np.array([b for pair in blocks for b in pair], np.int64))
        self.origin = origin_of(model)
        self._joints: StartJoints | None = None
        self._places: list[tuple[int, np.ndarray]] = []  # block and arm of every point
        self._at_points: list[PointMonitor] = []
        self._of_links: list[tuple[int, LinkReading]] = []  # monitor, and what it reads
        self._of_reactions: list[ReactionMonitor] = []
        self._of_cuts: list[CutMonitor] = []
        pairs: list[tuple] = []
        for column, (one, found) in enumerate(zip(requests, blocks, strict=True)):
            if one.link is not None:
                number = model.link_names.index(one.link)
                self._of_links.append((column, reading_of(model.links, number, one.quantity, one.at)))
            elif one.of_what_holds:
                blocks_held = model.held_among(one.selected)
                self._of_reactions.append(ReactionMonitor(column, blocks_held, one.quantity, one.component))
            elif one.cut is not None and one.height is None:
                self._of_cuts.append(CutMonitor(column, section_cut(one.cut), one.quantity))
            elif one.cut is not None:
                self._at_points.append(self._drift_monitor(column, one, found))
            elif one.between is None:
                self._at_points.append(self._point_monitor(column, one, found))
            else:
                pairs += self._pairs(column, one.quantity, *found)
        self._at_joints: JointMonitors | None = None
        if pairs:
            first, second, apart, axes, columns = map(np.array, zip(*pairs, strict=True))
            unique, begins = np.unique(columns, return_index=True)
            lengths = np.array([model.dimension > 2 and self.requests[k].quantity == "slip" for k in unique])
            self._at_joints = JointMonitors(first, second, apart, axes, begins, unique, lengths)
        self._points = self._all_points()

    def values(self, sim: Simulation) -> tuple[float, ...]:
        """Compute the values of all monitors at this instant; velocities per unit of the solver's time."""
        if not self.requests:
            return ()
        bodies, watched = sim.bodies, self.watched
        places = np.column_stack([bodies.positions[watched], rotation_vectors(bodies.orientations[watched])])
        sample = np.stack([places, sim.speeds[watched], sim.accelerations(watched)], axis=1)
        still = np.zeros((1, 3, self.model.dimension))
        links = np.concatenate([link.state for link in sim.links]) if sim.links else np.zeros((0, N_STATE))
        self._strain(sim)
        found = self.series(sample[np.newaxis], still, links[np.newaxis])[0]
        for monitor in self._of_reactions:
            found[monitor.column] = monitor.value(sim)
        found[self.columns_of_cuts] = self.in_cuts(sim)
        return tuple(found.tolist())

    @property
    def columns_of_cuts(self) -> list[int]:
        """Numbers of the monitors of forces in cuts."""
        return [cut.column for cut in self._of_cuts]

    def in_cuts(self, sim: Simulation) -> list[float]:
        """Compute forces in cuts now, in a motion those of its last step [N or N m], in the order of their columns."""
        if not self._of_cuts:
            return []
        given = point_pushes(sim)
        return [cut.value(sim, given) for cut in self._of_cuts]

    def _strain(self, sim: Simulation) -> None:
        """Move the points to where the strains of their blocks have them at this instant."""
        if not self.model.n_modes:
            return
        blocks, arms, shapes = self.watched[self._points.rows], self._points.arms, self.model.mode_shapes
        found = moved_by_modes(
            sim.bodies.modes[blocks], arms, self.model.shapes.radii[blocks], shapes[blocks] if len(shapes) else shapes
        )
        found[~arms.any(axis=1)] = 0.0  # centroids are those of the mass, which no mode moves
        self._points = self._points._replace(strained=arms + found)

    def series(
        self, samples: np.ndarray, base: np.ndarray, links: np.ndarray = NO_LINKS, gauged: bool = True
    ) -> np.ndarray:
        """Compute the values of all monitors over time, (n, n_monitors).

        samples: of the watched blocks, (n, n_watched, 3, n_dof); base: acceleration, velocity and displacement
        of the base at the same instants [m, s], (n, 3, d); links: state of all links, (n, n_links, 3). gauged: whether
        those are wanted whose extremes gauges have; else they stay 0.
        """
        out = np.zeros((len(samples), len(self.requests)))
        if self.requests:
            motion = PointMotion(self._points, samples)
            for monitor in self._at_points:
                if gauged or monitor.quantity not in GAUGES:
                    monitor.fill(out, motion, base)
            if self._at_joints is not None:
                self._at_joints.fill(out, motion)
            for column, (rows, what, weights) in self._of_links:
                out[:, column] = product(links[:, list(rows), what], np.array(weights))
        return out

    @cached_property
    def gauged(self) -> tuple[PointMonitor, ...]:
        """Monitors whose extremes are taken at every step of a time history: displacements, velocities, rotations."""
        return tuple(monitor for monitor in self._at_points if monitor.quantity in GAUGES)

    @cached_property
    def stepped(self) -> np.ndarray:
        """Numbers of the monitors that need samples of every step for their extremes: accelerations, openings, slips,
        and forces and lengths of links, ascending."""
        columns = {monitor.column for monitor in self._at_points if monitor.quantity not in GAUGES}
        columns |= set(self._at_joints.columns.tolist()) if self._at_joints is not None else set()
        return np.array(sorted(columns | {column for column, _ in self._of_links}), np.int64)

    @property
    def absolute(self) -> bool:
        """Test whether any of these is measured in space, with the motion of the base."""
        return any(monitor.absolute for monitor in self.gauged)

    def gauges(self, base: np.ndarray) -> Gauges:
        """Gauges of `gauged`, in their order, for one stretch. base: as Gauges.base."""
        found = np.full((len(self.gauged), 4), _NOTHING_YET)
        given = self._gauges._replace(base=base, found=found, tally=np.array([np.inf, 0.0]))
        return given._replace(arms=self._points.strained[self._gauged_points]) if self.model.n_modes else given

    @property
    def _gauged_points(self) -> list[int]:
        return [point for monitor in self.gauged for point in monitor.points]

    @cached_property
    def _gauges(self) -> Gauges:
        """Gauges as they are at the beginning of every stretch, but for the arms of points on blocks that deform."""
        d, gauged, places, points = self.model.dimension, self.gauged, self._points, self._gauged_points
        axes = np.zeros((len(gauged), d))
        for row, monitor in zip(axes, gauged):
            row[:] = 0.0 if monitor.along is None else monitor.along
        shift = slot.PLACE_IN_SPACE - slot.PLACE
        kinds = np.array([GAUGES[monitor.quantity] + shift * monitor.absolute for monitor in gauged], np.int64)
        components = np.array([self._component(monitor) for monitor in gauged], np.int64)
        firsts = np.array([monitor.points[0] for monitor in gauged], np.int64)
        alone = np.array([len(monitor.points) == 1 for monitor in gauged], bool) & (components >= 0)
        read = (slot.PLACE, slot.SPEED, slot.TURN) if d == 2 else (slot.PLACE, slot.SPEED)
        central = alone & ~places.arms[firsts].any(axis=1) & np.isin(kinds, read)
        return slot.NO_GAUGES._replace(
            kinds=kinds,
            components=components,
            axes=axes,
            starts=np.cumsum([0] + [len(monitor.points) for monitor in gauged], dtype=np.int64),
            blocks=self.watched[places.rows[points]],
            arms=places.strained[points],
            drawn=places.starts[points] + places.arms[points],
            weights=np.concatenate([monitor.weights for monitor in gauged]) if gauged else np.zeros(0),
            plain=np.where(central, kinds, -1),
            owners=self.watched[places.rows[firsts]],
            shifts=places.starts[firsts, np.maximum(components, 0)],
        )

    def extremes(self, gauges: Gauges, times: np.ndarray, values: np.ndarray, start: float, dt: float) -> np.ndarray:
        """Highest value and its time, lowest and its time [s] of all monitors over a stretch, (n_monitors, 4).

        Of `gauged` at every step, whose number 0 is at `start` [s]; of others those of their samples, at `times`. Where
        there are none: minus and plus infinity.
        """
        found = extremes_of(times, values)
        for monitor, row in zip(self.gauged, gauges.found):
            high, at, low, low_at = row
            if self._component(monitor) == -1:
                high, low = np.sqrt(max(high, 0.0)), np.sqrt(low)
            found[monitor.column] = high, start + dt * at, low, start + dt * low_at
        return found

    def _component(self, monitor: PointMonitor) -> int:
        """Return the component, coded as Gauges.components; a rotation in the plane is a number."""
        if monitor.quantity == "rotation" and self.model.dimension == 2:
            return 0
        if monitor.along is not None:
            return -2
        return -1 if monitor.component is None else "xyz".index(monitor.component)

    def _blocks(self) -> list[tuple[int, ...]]:
        """Blocks of each monitor; that there are any is checked with the model."""
        found = list[tuple[int, ...]]()
        for monitor in self.requests:
            if monitor.link is not None or monitor.of_what_holds:
                found.append(())
            elif monitor.cut is not None:
                ends = drift_ends(monitor.cut, monitor.height) if monitor.height is not None else []
                blocks = [block_at(self.model, end) for end in ends]
                found.append(tuple(block for block in blocks if block is not None))  # masonry/assembly/validate.py
            elif monitor.point is None:
                chosen = [self.model.chosen(name, False) for name in monitor.between or (monitor.selected,)]
                found.append(tuple(np.concatenate(chosen).tolist()))
            else:
                block = block_at(self.model, np.array(monitor.point))
                assert block is not None  # masonry/assembly/validate.py
                found.append((block,))
        return found

    def _point(self, block: int, arm: np.ndarray) -> int:
        """Add a point and return its number."""
        self._places.append((block, arm))
        return len(self._places) - 1

    def _point_monitor(self, column: int, one: MonitorRequest, blocks: Sequence[int]) -> PointMonitor:
        """Build the monitor of a point, or of the centroids of blocks, weighted by their masses."""
        arm = np.zeros(self.model.dimension)
        if one.point is not None:
            arm = np.array(one.point) - self.model.centroids[blocks[0]]
        masses = self.model.masses[list(blocks)]
        points = [self._point(block, arm) for block in blocks]
        return PointMonitor(column, points, masses / masses.sum(), one.quantity, one.component, one.absolute)

    def _drift_monitor(self, column: int, one: MonitorRequest, blocks: Sequence[int]) -> PointMonitor:
        """Build the monitor of the drift of a pier, from the points at both ends of its height."""
        assert one.cut is not None
        assert one.height is not None
        cut = section_cut(one.cut)
        ends = drift_ends(one.cut, one.height)
        arms = [end - self.model.centroids[block] for end, block in zip(ends, blocks, strict=True)]
        points = [self._point(block, arm) for block, arm in zip(blocks, arms, strict=True)]
        weights = np.array([-1.0, 1.0]) / one.height
        return PointMonitor(column, points, weights, "displacement", None, False, cut.axes[1])

    def _pairs(self, column: int, quantity: str, first: int, second: int) -> list[tuple]:
        """Return the point pairs of one joint monitor: first and second point, distance, axis and monitor number."""
        from dem_cli.core.contact.between import StartJoints

        self._joints = self._joints or StartJoints(self.model)
        ends = self._joints.ends(first, second)
        assert ends is not None  # masonry/assembly/validate.py
        places = [(*pair, ends.normal) for pair in zip(ends.on_first, ends.on_second, strict=True)]
        if quantity == "slip":
            normal = ends.normal[np.newaxis]
            places = [(*ends.middles(), tangent[0]) for tangent in tangents_of(normal, beside(normal))]
        rows = []
        for on_first, on_second, axis in places:
            apart = self.model.centroids[second] + on_second - self.model.centroids[first] - on_first
            rows.append((self._point(first, on_first), self._point(second, on_second), apart, axis, column))
        return rows

    def _all_points(self) -> Points:
        d = self.model.dimension
        blocks = np.array([block for block, _ in self._places], np.int64)
        arms = np.array([arm for _, arm in self._places]).reshape(-1, d)
        return Points(np.searchsorted(self.watched, blocks), self.model.centroids[blocks] - self.origin, arms, arms)
