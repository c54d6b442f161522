"""[[monitor]]: numbers followed through a run; the same formulas for one instant and for a stretch of time, 2D.

A sample holds position (with the angle), velocity and acceleration of a block, all at one instant and relative
to the base: samples are (n, n_watched, 3, n_dof).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.model.model import Model
from dem_cli.model.places import block_at
from dem_cli.model.scales import origin_of

if TYPE_CHECKING:
    from dem_cli.case.schema import Case, Monitor
    from dem_cli.contact.between import StartJoints
    from dem_cli.solve.simulation import Simulation

OF_BASE = {"acceleration": 0, "velocity": 1, "displacement": 2}  # as output.record.Samples.base


class MaterialPoint(NamedTuple):
    """A point that moves with a block; d = 2."""

    row: int  # of its block in the samples
    start: np.ndarray  # centroid of its block, undeformed, as the samples count [m], (d,)
    arm: np.ndarray  # from the centroid, undeformed [m], (d,)

    def displacement(self, samples: np.ndarray) -> np.ndarray:
        """From its undeformed place [m], (n, d)."""
        place = samples[:, self.row, 0]
        return place[:, :2] - self.start + turned(self.arm, place[:, 2]) - self.arm

    def velocity(self, samples: np.ndarray) -> np.ndarray:
        """v + ω × r, (n, d)."""
        place, motion = samples[:, self.row, 0], samples[:, self.row, 1]
        return motion[:, :2] + motion[:, 2:] * across(turned(self.arm, place[:, 2]))

    def acceleration(self, samples: np.ndarray) -> np.ndarray:
        """a + α × r − ω² r, (n, d)."""
        place, motion, change = (samples[:, self.row, i] for i in range(3))
        arm = turned(self.arm, place[:, 2])
        return change[:, :2] + change[:, 2:] * across(arm) - motion[:, 2:] ** 2 * arm


class PairOfPoints(NamedTuple):
    """Two material points that lay opposite each other across a joint."""

    first: MaterialPoint
    second: MaterialPoint
    apart: np.ndarray  # from the first to the second, undeformed [m], (d,)

    def distance(self, samples: np.ndarray) -> np.ndarray:
        """From the first to the second [m], (n, d)."""
        return self.apart + self.second.displacement(samples) - self.first.displacement(samples)


class JointMonitor(NamedTuple):
    """Opening or slip of a joint, in its undeformed frame, which turns with the first block."""

    quantity: str
    normal: np.ndarray  # from the first block to the second, undeformed, (d,)
    ends: tuple[PairOfPoints, PairOfPoints]
    middle: PairOfPoints

    def values(self, samples: np.ndarray, base: np.ndarray) -> np.ndarray:
        """Largest separation of the two ends, or displacement of the second block at the middle [m], (n,)."""
        normal = turned(self.normal, samples[:, self.middle.first.row, 0, 2])
        if self.quantity == "slip":
            return (self.middle.distance(samples) * across(normal)).sum(axis=1)
        return np.max([(pair.distance(samples) * normal).sum(axis=1) for pair in self.ends], axis=0)


class PointMonitor(NamedTuple):
    """A vector at a material point, its length or a component of it."""

    point: MaterialPoint
    quantity: str
    component: str | None
    absolute: bool

    def values(self, samples: np.ndarray, base: np.ndarray) -> np.ndarray:
        """(n,)"""
        vectors = getattr(self.point, self.quantity)(samples)
        if self.absolute:
            vectors = vectors + base[:, OF_BASE[self.quantity]]
        return np.hypot(*vectors.T) if self.component is None else vectors[:, "xy".index(self.component)]


class RotationMonitor(NamedTuple):
    """The angle of a block [rad]."""

    row: int

    def values(self, samples: np.ndarray, base: np.ndarray) -> np.ndarray:
        """(n,)"""
        return samples[:, self.row, 0, 2]


class Monitors:
    """Values of all monitors of a case, in the order of the case file.

    watched  numbers of the blocks that must be known for it, ascending
    """

    def __init__(self, case: Case, model: Model):
        self.tables, self.model = case.monitor, model
        blocks = self._blocks(case)
        self.watched = np.unique(np.array([b for pair in blocks for b in pair], np.int64))
        self.origin = origin_of(model)
        self._joints: StartJoints | None = None
        self._monitors = [self._monitor(*pair) for pair in zip(self.tables, blocks, strict=True)]

    def values(self, sim: Simulation) -> tuple[float, ...]:
        """At this instant; velocities per unit of the solver's time."""
        if not self.tables:
            return ()
        bodies, watched = sim.bodies, self.watched
        places = np.column_stack([bodies.positions[watched], bodies.orientations[watched]])
        sample = np.stack([places, bodies.velocities[watched], sim.accelerations(watched)], axis=1)
        still = np.zeros((1, 3, self.model.dimension))
        return tuple(self.series(sample[np.newaxis], still)[0].tolist())

    def series(self, samples: np.ndarray, base: np.ndarray) -> np.ndarray:
        """Over time, (n, n_monitors).

        samples: of the watched blocks, (n, n_watched, 3, n_dof); base: acceleration, velocity and displacement
        of the base at the same instants [m, s], (n, 3, d).
        """
        columns = [monitor.values(samples, base) for monitor in self._monitors]
        return np.stack(columns, axis=1) if columns else np.zeros((len(samples), 0))

    def _blocks(self, case: Case) -> list[tuple[int, ...]]:
        """Blocks of each monitor; that there are any is checked with the model."""
        from dem_cli.model.assemble import assembly

        names = assembly(case).block_map if any(monitor.point is None for monitor in self.tables) else {}
        found: list[tuple[int, ...]] = []
        for monitor in self.tables:
            if monitor.point is None:
                found.append(tuple(names[name] for name in monitor.between or (monitor.block,)))
            else:
                block = block_at(self.model, np.array(monitor.point))
                assert block is not None  # model.validate
                found.append((block,))
        return found

    def _monitor(self, table: Monitor, blocks: tuple[int, ...]) -> JointMonitor | PointMonitor | RotationMonitor:
        if table.between is not None:
            return self._joint(table.quantity, *blocks)
        if table.quantity == "rotation":
            return RotationMonitor(int(np.searchsorted(self.watched, blocks[0])))
        centroid = self.model.centroids[blocks[0]]
        arm = np.zeros(self.model.dimension) if table.point is None else np.array(table.point) - centroid
        return PointMonitor(self._point(blocks[0], arm), table.quantity, table.component, table.absolute)

    def _joint(self, quantity: str, first: int, second: int) -> JointMonitor:
        from dem_cli.contact.between import StartJoints

        self._joints = self._joints or StartJoints(self.model)
        ends = self._joints.ends(first, second)
        assert ends is not None  # model.validate
        centroids = self.model.centroids

        def pair(on_first: np.ndarray, on_second: np.ndarray) -> PairOfPoints:
            apart = centroids[second] + on_second - centroids[first] - on_first
            return PairOfPoints(self._point(first, on_first), self._point(second, on_second), apart)

        low, high = (pair(*places) for places in zip(ends.on_first, ends.on_second, strict=True))
        middle = pair(ends.on_first.mean(axis=0), ends.on_second.mean(axis=0))
        return JointMonitor(quantity, ends.normal, (low, high), middle)

    def _point(self, block: int, arm: np.ndarray) -> MaterialPoint:
        row = int(np.searchsorted(self.watched, block))
        return MaterialPoint(row, self.model.centroids[block] - self.origin, arm)


def turned(vector: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """A vector (2,) turned by every angle, (n, 2)."""
    cosines, sines = np.cos(angles), np.sin(angles)
    return np.stack([cosines * vector[0] - sines * vector[1], sines * vector[0] + cosines * vector[1]], axis=1)


def across(vectors: np.ndarray) -> np.ndarray:
    """Vectors turned by +90°, (n, 2): velocities of their tips at unit spin."""
    return np.stack([-vectors[:, 1], vectors[:, 0]], axis=1)
