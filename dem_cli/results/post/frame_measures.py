"""Joint resultants, thrust lines and displacements of a frame, and a visible scale of displacements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dem_cli.core.geometry.rotation import angles_of, matrices, quaternions, rotation_vectors
from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import STATES, ContactRecord, Frame
from dem_cli.results.output.paraview.vertices import placed_vertices, rest_vertices

_VISIBLE = 0.06  # share of the size of the structure that a drawn displacement should reach
_TRUE_FROM = 0.02  # displacements of this share are shown as they are
_LARGEST_TURN = 0.35  # rad, of a drawn rotation


@dataclass(frozen=True)
class Resultants:
    """Resultant forces of a frame: one per pressed joint, for the thrust line."""

    points: np.ndarray  # centre of pressure [m], (n, d)
    forces: np.ndarray  # force on the second block [N], (n, d)
    blocks: np.ndarray  # the two blocks, (n, 2)


def resultants(contacts: ContactRecord) -> Resultants:
    """Compute the resultant of each joint at the force-weighted mean of its points."""
    pressed = (contacts.state != STATES.index("open")) & (contacts.normal_force > 0.0)
    joints, first, owner = np.unique(contacts.joint[pressed], return_index=True, return_inverse=True)
    weights = contacts.normal_force[pressed]
    totals = np.bincount(owner, weights, len(joints))
    forces = contacts.forces()[pressed]

    def gather(values: np.ndarray) -> np.ndarray:
        columns = [np.bincount(owner, column, len(joints)) for column in values.T]
        return np.stack(columns, axis=1)

    centres = gather(contacts.points[pressed] * weights[:, np.newaxis]) / totals[:, np.newaxis]
    return Resultants(centres, gather(forces), contacts.blocks[pressed][first])


def chains(model: Model, found: Resultants) -> list[np.ndarray]:
    """Order the joints along the thrust line; [] where it branches (walls).

    Arches and columns: every free block has at most two pressed joints.
    """
    at_block: dict[int, list[int]] = {}
    for joint, pair in enumerate(found.blocks):
        for block in pair:
            if not model.fixed[block]:
                at_block.setdefault(int(block), []).append(joint)
    if any(len(joints) > 2 for joints in at_block.values()):
        return []
    links: dict[int, list[int]] = {joint: [] for joint in range(len(found.blocks))}
    for joints in at_block.values():
        if len(joints) == 2:
            links[joints[0]].append(joints[1])
            links[joints[1]].append(joints[0])
    return [chain for chain in _walk(links) if len(chain) > 1]


def _walk(links: dict[int, list[int]]) -> list[np.ndarray]:
    """Follow the links from every loose end."""
    left, found = set(links), []
    for start in [joint for joint, others in links.items() if len(others) < 2]:
        chain, joint = [], start
        while joint in left:
            left.discard(joint)
            chain.append(joint)
            joint = next((other for other in links[joint] if other in left), -1)
        if chain:
            found.append(np.array(chain))
    return found


def block_reach(model: Model, pairs: np.ndarray) -> np.ndarray:
    """Return half the smaller extent of the smaller block at each joint [m]."""
    extents = np.full(model.n_blocks, np.inf)
    for part, block in enumerate(model.part_blocks):
        corners = model.vertices[model.part_starts[part] : model.part_starts[part + 1]]
        extents[block] = min(extents[block], np.ptp(corners, axis=0).min())
    return 0.5 * extents[pairs].min(axis=1)


def size(model: Model) -> float:
    """Return the diagonal of the box around the movable blocks [m]."""
    corners = rest_vertices(model)
    free = ~model.fixed[model.vertex_blocks]
    corners = corners[free] if free.any() else corners
    return float(np.linalg.norm(np.ptp(corners, axis=0)))


def largest_displacement(model: Model, frame: Frame) -> float:
    """Return the largest displacement of any corner of any block [m]."""
    moved = placed_vertices(model, frame.positions, frame.orientations)
    return float(np.linalg.norm(moved - rest_vertices(model), axis=1).max())


def visible_scale(model: Model, frame: Frame) -> float:
    """Return the scale of displacements: 1 where they are visible, else a round number that makes them so."""
    moved = largest_displacement(model, frame)
    whole = size(model)
    if moved >= _TRUE_FROM * whole or moved <= 0.0:
        return 1.0
    turn = float(np.abs(angles_of(frame.orientations)).max())
    factor = min(_VISIBLE * whole / moved, _LARGEST_TURN / turn if turn > 0 else np.inf)
    power = 10.0 ** np.floor(np.log10(factor))
    return max(1.0, float(power * max(step for step in (1, 2, 5) if step * power <= factor * (1 + 1e-9))))


def scaled(model: Model, frame: Frame, scale: float) -> Frame:
    """Scale the displacements, rotations and contact points of a frame."""
    positions = model.centroids + scale * (frame.positions - model.centroids)
    orientations = quaternions(scale * rotation_vectors(frame.orientations))
    contacts = frame.contacts
    owner = contacts.blocks[:, 0]
    before, after = (matrices(turns)[owner] for turns in (frame.orientations, orientations))
    arms = np.einsum("nji,nj->ni", before, contacts.points - frame.positions[owner])
    points = positions[owner] + np.einsum("nij,nj->ni", after, arms)
    return frame._replace(positions=positions, orientations=orientations, contacts=contacts._replace(points=points))
