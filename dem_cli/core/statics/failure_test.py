"""Failure test: motion at a constant load that proves failure, and rest that is not an equilibrium.

A failure is shown by power: the motion accelerates while the loads release more energy than friction and
joints take, both since the start and in the last doubling of time. The blocks that show it must have been
carried there by their own loads: pseudo-time lets a light block on stiff joints fall slowly, so that a knock
of its neighbours sends it flying for longer than any look.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.core.engine import measures
from dem_cli.core.engine.measures import free_falls
from dem_cli.core.engine.placement.clearances import beyond
from dem_cli.core.geometry.rotation import matrices, oriented_as, turned_since
from dem_cli.core.model.scales import levels

if TYPE_CHECKING:
    from dem_cli.core.engine.simulation import Simulation


class FailureProof(NamedTuple):
    """Proof of a failure by the motion of a block."""

    released: float  # share of the work of the loads that became motion or was damped
    growth: float  # of the displacement in the last doubling of time


class FailureTest:
    """Test for failure by the motion of blocks since a load became constant.

    scale    displacement that is elastic [m]
    plateau  the load is known to grow no more with displacement: high structures need not go further than low ones
    reach    how far an equilibrium at this load may be, in elastic displacements, where a path there is known
    """

    def __init__(self, sim: Simulation, scale: float, plateau: bool = False, reach: float = 0.0) -> None:
        proof = sim.settings.proof
        self.sim, self.start, self.begun = sim, sim.places(), sim.steps
        linked = measures.link_scale(sim)  # ties may take over only when blocks have gone as far as they stretch
        far, rests = proof.far, 0.0 if plateau else proof.beyond * reach * scale
        if not plateau:
            far = max(far, proof.far_per_depth * sim.depth**2, proof.closing if sim.integrates else 0.0)
        self.far = max(far * scale, proof.not_elastic * linked)
        if sim.kinematics == "large" and len(sim.free):  # on soft joints that would be a long way
            width = float(np.median(sim.widths[sim.free]))
            self.far = min(self.far, max(proof.not_elastic * max(scale, linked), proof.gross * width))
            rests = min(rests, proof.in_place * width)
        self.far = max(self.far, rests)
        self.play = np.maximum(sim.play.moved, sim.play.turned * sim.shape.radii)
        self.away = np.abs(self.start - sim.first_places).max(axis=1)
        self.moved: list[np.ndarray] = []  # largest displacement of each block at each look [m]
        self.energies = [measures.energy_sums(sim)]

    def look(self) -> FailureProof | None:
        """Look for the proof of failure, whenever the time grew by √2; None where there is none yet."""
        proof = self.sim.settings.proof
        moved = np.abs(self.sim.places() - self.start).max(axis=1)
        self.moved.append(moved)
        self.energies.append(measures.energy_sums(self.sim))
        looks = 2 * proof.doublings + 1  # two for each doubling of time
        if len(self.moved) < looks:
            return None
        own = moved <= 0.5 * free_falls(self.sim) * (self.sim.steps - self.begun) ** 2
        unexplained = moved
        if self.play.any():
            away = np.abs(self.sim.places() - self.sim.first_places).max(axis=1)
            unexplained = beyond(self.play, moved, self.away, away)
        block = int(np.where(own, unexplained, -np.inf).argmax())
        last = [float(looked[block]) for looked in self.moved[-looks::2]]
        if unexplained[block] <= self.far or not own[block] or min(last) <= 0.0:
            return None
        accelerated = min(after / before for before, after in zip(last[1:], last[2:])) > proof.accelerated
        steady = last[-1] > proof.steady**proof.doublings * last[0] and unexplained[block] > proof.steadily * self.far
        if not (accelerated or steady):
            return None
        for since in (self.energies[-3], self.energies[0]):
            given, taken = (now - then for now, then in zip(self.energies[-1], since))
            if given <= max(taken, 0.0):
                return None
        return FailureProof(1.0 - taken / given, last[-1] / last[-2])


def displaced(sim: Simulation, since: np.ndarray, scale: float) -> int | None:
    """Return the block that came to rest off its support at `since` (Simulation.places); None: there is none.

    A structure that comes to rest after that is another structure: something toppled, slid down or fell. How far blocks
    have moved says nothing by itself: a tall cantilever bends by its width and stands (`_carried_as_before`). Where
    geometry is that of the start nothing can come to rest elsewhere.
    """
    if sim.kinematics == "fixed":
        return None
    moved, turned = _beyond_play(sim, since)
    gross = _gross(sim, moved, turned) & (np.maximum(moved, turned) > sim.settings.proof.not_elastic * scale)
    if gross.any():
        gross &= ~_carried_as_before(sim, since, scale)
    return int(np.where(gross, moved + turned, 0.0).argmax()) if gross.any() else None


def moved_far(sim: Simulation, since: np.ndarray) -> tuple[int, float] | None:
    """Return the block that moved furthest since `since` (Simulation.places), and its displacement [m]. None:
    nothing moved so far that it deserves a word."""
    if sim.kinematics == "fixed":
        return None
    moved, turned = _beyond_play(sim, since)
    if not _gross(sim, moved, turned).any():
        return None
    distance = np.where(sim.model.fixed, 0.0, np.linalg.norm((sim.places() - since)[:, : sim.model.dimension], axis=1))
    block = int(distance.argmax())
    return block, float(distance[block])


def _beyond_play(sim: Simulation, since: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Largest motion of each block since `since`, of its centroid and turned times its radius [m], (n_blocks,) each.

    What closes gaps of the start is left out.
    """
    motion = np.abs(sim.places() - since)
    d = sim.model.dimension
    moved, turned = motion[:, :d].max(axis=1), motion[:, d:].max(axis=1)
    if sim.play.moved.any():
        before, now = np.abs(since - sim.first_places), np.abs(sim.places() - sim.first_places)
        moved = beyond(sim.play.moved, moved, before[:, :d].max(axis=1), now[:, :d].max(axis=1))
        turning = sim.play.turned * sim.shape.radii
        turned = beyond(turning, turned, before[:, d:].max(axis=1), now[:, d:].max(axis=1))
    return moved, turned


def _gross(sim: Simulation, moved: np.ndarray, turned: np.ndarray) -> np.ndarray:
    """Find free blocks that moved by much of their width, or turned by much, (n_blocks,) bool."""
    proof = sim.settings.proof
    return ((moved > proof.gross * sim.widths) | (turned > proof.turned * sim.shape.radii)) & ~sim.model.fixed


def _carried_as_before(sim: Simulation, since: np.ndarray, scale: float) -> np.ndarray:
    """Find blocks that are connected with supports by joints that are still the same ones, (n_blocks,) bool.

    In such a joint the places of both blocks that touch now were next to each other at `since`, and neither has turned
    much against the other.
    """
    proof, bodies, joints, d = sim.settings.proof, sim.bodies, sim.joints, sim.model.dimension
    before = oriented_as(bodies.orientations, since[:, d:] / sim.shape.radii[:, None])
    turns, start = matrices(bodies.orientations), matrices(before)
    acting = sim.contacts.normal != 0.0
    points, pairs = joints.points[acting], joints.blocks[joints.owners[acting]]
    own = points[:, None] - bodies.positions[pairs]  # arms now, then along the axes of each block, then as they were
    own = np.einsum("pskl,psk->psl", turns[pairs], own)
    places = since[:, :d][pairs] + np.einsum("pskl,psl->psk", start[pairs], own)
    apart = np.linalg.norm(places[:, 1] - places[:, 0], axis=1)
    rotations = turned_since(bodies.orientations, before)[pairs]
    turned = np.linalg.norm(rotations[:, 1] - rotations[:, 0], axis=1)
    width, radius = sim.widths[pairs].min(axis=1), sim.shape.radii[pairs].min(axis=1)
    other = (apart > proof.gross * width) | (turned > proof.turned)
    other &= np.maximum(apart, turned * radius) > proof.not_elastic * scale
    return levels(pairs[~other], sim.model.fixed) >= 0
