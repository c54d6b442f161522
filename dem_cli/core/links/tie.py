"""Ties and anchors ([[tie]]): rods and cables between points of two blocks, or of a block and a fixed point.

    N = k (ΔL + N0/k − p),   0 ≤ N ≤ Ny   (−Ny ≤ N where the rod also takes compression)

k = EA/L or given, ΔL the elongation since it was drawn, N0 its prestress, p what has yielded, which stays. A tie that
is slack carries nothing. It goes from point to point straight, wherever its blocks move, and rubs on nothing between.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from dem_cli.core.kernels.contact_point import push_apart
from dem_cli.core.kernels.jit import inline, named
from dem_cli.core.kernels.joint_plane import moment, sweep
from dem_cli.core.kernels.vec import axpy, dot, load, norm, scale
from dem_cli.core.links.link import (
    FORCE,
    N_STATE,
    PLASTIC,
    STRETCH,
    Link,
    LinkEnds,
    LinkReading,
    Outline,
    Springs,
)
from dem_cli.core.links.material_points import turned_arm
from dem_cli.core.links.spans import Spans, spans
from dem_cli.declarations import KeyProblem, Name, NonNegative, Parameters, Positive, SpaceVector, parameter, show


class Tie(Parameters):
    """[[tie]]: a rod or cable between points of two blocks, or from a block to a fixed point.

    Its ends are points of the structure as it was drawn; blocks take them along.
    """

    id: Name | None = parameter(default=None, description="name; default: tie-1, tie-2 ...", examples=["north"])
    ends: tuple[SpaceVector, SpaceVector] = parameter(
        description="where it begins and ends, in or on its blocks as they were drawn [m]",
        examples=[[[0.1, 2.0], [3.9, 2.0]]],
    )
    block: str | None = parameter(
        default=None,
        description="id of the block that holds its first end; default: the one in which that lies",
        examples=["left-3"],
    )
    other: str | None = parameter(
        default=None,
        description="id of the block that holds its second end; default: the one in which that lies",
        examples=["right-3"],
    )
    anchored: bool = parameter(
        default=False,
        description="true: the second end is a fixed point, such as rock, which moves with the base alone",
        examples=[True],
    )
    area: Positive | None = parameter(default=None, description="cross-section [m2]", examples=[3.14e-4])
    young: Positive | None = parameter(default=None, description="Young's modulus, with area [Pa]", examples=[2.0e11])
    stiffness: Positive | None = parameter(
        default=None, description="instead of area and young: force per elongation [N/m]", examples=[1e7]
    )
    prestress: NonNegative = parameter(default=0.0, description="its force as it was drawn, before any load [N]")
    yield_force: Positive | None = parameter(
        default=None, description="largest force, perfectly plastic [N]; default: no limit", examples=[5e4]
    )
    yield_stress: Positive | None = parameter(
        default=None, description="instead of yield_force, with area: largest stress [Pa]", examples=[2.35e8]
    )
    compression: bool = parameter(
        default=False, description="true: a rod that also takes compression, up to the same limit", examples=[True]
    )

    def check(self) -> None:
        """Check that a tie has one stiffness, one limit, two ends, and a prestress below the limit."""
        super().check()
        if self.stiffness is None and (self.area is None or self.young is None):
            missing = "area" if self.area is None else "young"
            raise KeyProblem("missing; a tie has area and young, or stiffness", missing)
        if self.stiffness is not None and self.young is not None:
            raise KeyProblem("'stiffness' and 'young' are both given; give one of them", "young")
        if self.yield_stress is not None and self.yield_force is not None:
            raise KeyProblem("'yield_force' and 'yield_stress' are both given; give one of them", "yield_stress")
        if self.yield_stress is not None and self.area is None:
            raise KeyProblem("not used without area", "yield_stress")
        if self.stiffness is not None and self.area is not None and self.yield_stress is None:
            raise KeyProblem("not used with stiffness, unless yield_stress is given", "area")
        if self.anchored and self.other is not None:
            raise KeyProblem("not used with anchored = true, whose second end is a fixed point", "other")
        if self.prestress > self.largest:
            said = "yield_force" if self.yield_stress is None else "yield_stress × area"
            message = f"{show(self.prestress)} is not allowed; must be at most {said} ({self.largest:g} N)"
            raise KeyProblem(message, "prestress")
        if math.dist(*self.ends) == 0.0:
            raise KeyProblem(f"{show(self.ends)} is not allowed; both ends are the same point", "ends")

    @property
    def largest(self) -> float:
        """Largest force of the tie [N]."""
        if self.yield_stress is not None and self.area is not None:
            return self.yield_stress * self.area
        return math.inf if self.yield_force is None else self.yield_force

    def stiffness_over(self, length: float) -> float:
        """Compute force per elongation [N/m] of a tie of this length."""
        if self.stiffness is not None:
            return self.stiffness
        assert self.area is not None
        assert self.young is not None
        return self.area * self.young / length


class Ties(NamedTuple):
    """All ties of a model, as the stepping loop sees them."""

    blocks: np.ndarray  # the second one may be FIXED_POINT, (n, 2) int64
    arms: np.ndarray  # of both ends from the centroids, undeformed; of a fixed point its place [m], (n, 2·d)
    axes: np.ndarray  # unit, from the first end to the second, at the start, (n, d)
    starts: np.ndarray  # centroids of both blocks at the start; 0 of a fixed point [m], (n, 2·d)
    lengths: np.ndarray  # at the start [m], (n,)
    stiffness: np.ndarray  # [N/m], (n,)
    prestress: np.ndarray  # [N], (n,)
    limits: np.ndarray  # least and largest axial force [N], (n, 2)
    state: np.ndarray  # plastic elongation [m], elongation [m], axial force, tension positive [N], (n, 3)

    @property
    def kind(self) -> str:
        """Name of this kind of link in the registry."""
        return TIE.key

    @property
    def spans(self) -> Spans:
        """Spans of ties from end to end."""
        return Spans(self.blocks, self.arms, self.axes, self.starts, self.lengths)

    @property
    def n_drawn(self) -> int:
        """Number of ties that were drawn."""
        return len(self.blocks)

    def started(self, origin: np.ndarray) -> Ties:
        """Copy the ties for a simulation that counts places from `origin`, with the forces of the start."""
        state = np.zeros((len(self.blocks), N_STATE))
        state[:, FORCE] = self.prestress
        return self._replace(**self.spans.started(origin)._asdict(), state=state)

    def axial(self, bodies: Any = None) -> Springs:
        """Return springs along the ties where the blocks are now; None, and with fixed geometry: as they were drawn."""
        axes, _, arms = self.spans.lines(bodies)
        return Springs(self.blocks, self.spans.motion(axes, arms), self.stiffness)

    def acting(self) -> np.ndarray:
        """Test which ties carry a force now, (n,) bool."""
        return self.state[:, FORCE] != 0.0

    def across(self, bodies: Any = None) -> Springs:
        """Return springs across the ties: a taut tie of force N that turns holds back with N/L at its ends, and with
        the moment N times the arm of each.
        """
        _, lengths, arms = self.spans.lines(bodies)
        taut = np.maximum(np.maximum(self.prestress, self.state[:, FORCE]), 0.0)
        inverse = 1.0 / lengths
        for side in (0, 1):
            far = np.sqrt((arms[:, side] ** 2).sum(axis=1))
            inverse = inverse + np.divide(1.0, far, out=np.zeros_like(far), where=far > 1e-9 * lengths)
        sides = self.spans.sideways(bodies)
        return Springs(
            np.concatenate([self.blocks] * len(sides)),
            np.concatenate(list(sides)),
            np.concatenate([taut * inverse] * len(sides)),
        )

    def turning(self, bodies: Any) -> np.ndarray:
        """Compute the geometric stiffness of the present tie forces (`Spans.turning`)."""
        return self.spans.turning(self.state[:, FORCE], bodies)

    def bounded(self, bodies: Any = None) -> tuple[Springs, np.ndarray]:
        """Return ties for limit analysis, with the least and largest force of each [N]; bodies None: as drawn."""
        return self.axial(bodies), self.limits

    def preload(self) -> np.ndarray:
        """Return the prestress of the ties [N], (n,)."""
        return self.prestress

    def yields(self) -> bool:
        """Test whether the force of any tie has a largest value."""
        return bool(np.isfinite(self.limits[:, 1]).any())

    def softest(self) -> float:
        """Compute the least stiffness of any tie [N/m]."""
        return float(self.stiffness.min(initial=np.inf))

    def energy(self) -> float:
        """Compute the elastic energy in the springs of all ties [J]."""
        return 0.5 * float((self.state[:, FORCE] ** 2 / self.stiffness).sum())

    def follow(self, motion: np.ndarray, bodies: Any) -> None:
        """Update elongations and forces of ties after small displacements of all blocks, (n_blocks, n_dof), which grow
        evenly.
        """
        springs, (least, most) = self.axial(bodies), self.limits.T
        self.state[:, STRETCH] += (springs.motion * motion[springs.blocks]).sum(axis=(1, 2))
        force = springs.stiffness * (self.state[:, STRETCH] - self.state[:, PLASTIC]) + self.prestress
        beyond = np.maximum(force - most, 0.0) + np.where(least < 0.0, np.minimum(force - least, 0.0), 0.0)
        self.state[:, PLASTIC] += beyond / springs.stiffness
        self.state[:, FORCE] = np.clip(force, least, most)

    def length(self, number: int) -> float:
        """Return the length of one tie as it was drawn [m]."""
        return float(self.lengths[number])

    def reading(self, number: int, quantity: str, at: float) -> LinkReading:
        """Return force or elongation of one tie for a monitor; `at` does not matter."""
        return LinkReading((number,), FORCE if quantity == "force" else STRETCH, (1.0,))

    def answer(self, number: int) -> dict[str, Any]:
        """Summarise one tie: force, elongation and whether it yielded."""
        plastic, stretch, force = self.state[number].tolist()
        return {"force": force, "elongation": stretch, "yielded": plastic != 0.0}

    def outline(self) -> Outline:
        """Return ties as lines from end to end."""
        n, d = self.axes.shape
        forces = np.repeat(self.state[:, FORCE], 2)
        return Outline(np.full(n, 2), self.blocks.ravel(), self.arms.reshape(2 * n, d), forces)

    def words(self, number: int, ids: Sequence[str]) -> str:
        """Describe one tie in a line of text; ids: of the blocks, that of a fixed point last."""
        (a, b), (least, most), held = self.blocks[number], self.limits[number], float(self.state[number, FORCE])
        limit = f"up to {most:.4g} N" if np.isfinite(most) else "without limit"
        both = "tension and compression" if least < 0.0 else "tension"
        start = f", prestress {held:.4g} N" if held else ""
        held_by = f"'{ids[a]}' to " + (f"'{ids[b]}'" if b >= 0 else ids[b])
        length, stiffness = self.lengths[number], self.stiffness[number]
        return f"{held_by}, {length:.4g} m, {stiffness:.4g} N/m, {both} {limit}{start}"


def ties(tables: Sequence[Tie], ends: Sequence[LinkEnds], centroids: np.ndarray) -> Ties:
    """Build the ties of a model whose blocks lie where they are; ends, centroids: as for `spans`."""
    found = spans(ends, centroids)
    most = np.array([table.largest for table in tables])
    least = np.array([-table.largest if table.compression else 0.0 for table in tables])
    prestress = np.array([table.prestress for table in tables])
    state = np.zeros((len(tables), N_STATE))
    state[:, FORCE] = prestress
    stiffness = [table.stiffness_over(length) for table, length in zip(tables, found.lengths.tolist(), strict=True)]
    return Ties(*found, np.array(stiffness), prestress, np.column_stack([least, most]), state)


def make_tie_forces(moves: bool) -> Callable:
    """Make the loop over ties; moves: along the line through their ends now, else along that of the start."""

    @inline
    def tie_forces(ties, bodies, like, like_rotation):
        """Add the forces of all ties on their blocks to `forces`; returns the work lost by yielding [J]."""
        blocks, arms, starts, axes, state = ties.blocks, ties.arms, ties.starts, ties.axes, ties.state
        positions, orientations, forces = bodies.positions, bodies.orientations, bodies.forces
        d = len(like)
        lost = 0.0
        for number in range(blocks.shape[0]):
            tie = np.uint64(number)
            a, held = np.uint64(blocks[tie, 0]), blocks[tie, 1] < 0
            b = a if held else np.uint64(blocks[tie, 1])
            arm_a, arm_b = load(arms, tie, 0, like), load(arms, tie, d, like)
            zero = scale(0.0, arm_a)
            if moves:
                arm_a = turned_arm(bodies.turns, a, arm_a)
                arm_b = arm_b if held else turned_arm(bodies.turns, b, arm_b)
                tip_b = arm_b if held else axpy(1.0, arm_b, load(positions, b, 0, like))
                between = axpy(-1.0, axpy(1.0, arm_a, load(positions, a, 0, like)), tip_b)
                length = norm(between)
                axis = scale(1.0 / length, between)
                stretch = length - ties.lengths[tie]
            else:
                axis = load(axes, tie, 0, like)
                moved_a = axpy(-1.0, load(starts, tie, 0, like), load(positions, a, 0, like))
                moved_a = axpy(1.0, sweep(load(orientations, a, 0, like_rotation), arm_a), moved_a)
                moved_b = axpy(-1.0, load(starts, tie, d, like), load(positions, b, 0, like))
                moved_b = axpy(1.0, sweep(load(orientations, b, 0, like_rotation), arm_b), moved_b)
                moved_b = zero if held else moved_b
                stretch = dot(axis, axpy(-1.0, moved_a, moved_b))
            stiffness, before, plastic = ties.stiffness[tie], state[tie, FORCE], state[tie, PLASTIC]
            force = stiffness * (stretch - plastic) + ties.prestress[tie]
            least, most = ties.limits[tie, 0], ties.limits[tie, 1]
            if force > most or (force < least and least < 0.0):
                limit = most if force > most else least
                yielded = (force - limit) / stiffness
                state[tie, PLASTIC] = plastic + yielded
                lost += 0.5 * (before + limit) * yielded  # mean of the forces really applied
                force = limit
            elif force < least:
                force = least  # slack
            state[tie, STRETCH], state[tie, FORCE] = stretch, force
            pull = scale(-force, axis)  # on b
            if held:
                for k in range(d):
                    forces[a, k] -= pull[k]
                torque = moment(arm_a, pull)
                for k in range(len(like_rotation)):
                    forces[a, d + k] -= torque[k]
            elif force != 0.0:
                push_apart(forces, a, b, pull, moment(arm_a, pull), moment(arm_b, pull))
        return lost

    return named(tie_forces, "moving" if moves else "still")


TIE = Link(
    key="tie", word="tie", parameters=Tie, made=ties, forces={moves: make_tie_forces(moves) for moves in (False, True)}
)
