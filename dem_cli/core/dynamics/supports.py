"""Supports of blocks: faces that carried each block at the start, and blocks that have slid off or fallen past
them.

A block that slides on its support stands, and so does one that sinks with it. One that sank beside it has fallen,
however small the step down: its support is gone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.arithmetic import functions
from dem_cli.core.arithmetic.products import product
from dem_cli.core.contact.start import TOUCHING_GAP
from dem_cli.core.engine import measures
from dem_cli.core.engine.state import NO_CARRIERS, Carriers

if TYPE_CHECKING:
    from dem_cli.core.engine.dynamic import DynamicSimulation


def carriers_of(sim: DynamicSimulation) -> Carriers:
    """Faces that support each free block now: those that push it up; where nothing pushes, those below that touch.

    Blocks that nothing carries have no rows: they fly, or hang on links.
    """
    record, d = measures.contact_record(sim), sim.model.dimension
    if not len(record.joint):
        return NO_CARRIERS
    faces, up = sim.geometry.faces[record.joint], record.forces()[:, d - 1]
    touching = (record.gap <= TOUCHING_GAP * sim.smallest) & (record.normals[:, d - 1] != 0.0)
    below = np.where(touching, np.sign(record.normals[:, d - 1]), 0.0)
    weights = np.abs(sim.drawn_dead[:, d - 1])
    found = []
    for side, sign in ((1, 1.0), (0, -1.0)):  # forces and normals are those on the second block
        blocks = record.blocks[:, side]
        pushed = sign * up > sim.settings.history.carries * weights[blocks]
        found.append(
            np.column_stack([blocks, faces[:, 1 - side], pushed, sign * below > 0.0])[~sim.model.fixed[blocks]]
        )
    rows = np.concatenate(found)
    pushed = np.unique(rows[rows[:, 2] > 0, 0])
    kept = np.where(np.isin(rows[:, 0], pushed), rows[:, 2], rows[:, 3]) > 0
    pairs = np.unique(rows[kept, :2].astype(np.int64), axis=0)
    blocks, faces = pairs[:, 0], pairs[:, 1]
    above = [_above(sim, block, faces[blocks == block]) for block in np.unique(blocks)]
    return Carriers(blocks, faces, np.unique(blocks)[np.array(above, bool)] if above else np.zeros(0, np.int64))


def lost_supports(sim: DynamicSimulation, least: np.ndarray) -> np.ndarray:
    """Compute the depth by which free blocks sank that have lost their support [m], (n_free,); 0 of all others.

    least: how far a block sinks at least [m], (n_free,). One has lost its support that sank so far below what carried
    it and does not touch these faces any more, or stood above them and now leans on others, its centre beside them.
    """
    carriers, found = sim.carriers, np.zeros(len(sim.free))
    if not len(carriers.blocks):
        return found
    up = sim.model.dimension - 1
    sank = sim.reference_positions[:, up] - sim.bodies.positions[:, up]
    if not (sank[sim.free] > least).any():
        return found
    lowered = np.full(len(sank), np.inf)  # by which a block sank farther than all that carried it; inf: nothing did
    with_it = np.maximum(sank[_block_of(sim, carriers.faces)], 0.0)
    np.minimum.at(lowered, carriers.blocks, sank[carriers.blocks] - with_it)
    for k in np.flatnonzero((lowered[sim.free] > least) & np.isfinite(lowered[sim.free])):
        block = int(sim.free[k])
        faces = carriers.faces[carriers.blocks == block]
        touched = _touched(sim, block)
        here = np.isin(touched, faces) | _go_on(sim, touched, faces)
        beside = block in carriers.above and not here.all() and not _above(sim, block, touched[here])
        if beside or not here.any():
            found[k] = lowered[block]
    return found


def _block_of(sim: DynamicSimulation, faces: np.ndarray) -> np.ndarray:
    model = sim.model
    return model.part_blocks[model.topology.face_parts[faces]]


def _touched(sim: DynamicSimulation, block: int) -> np.ndarray:
    """Faces of others that a block is next to now, (n,)."""
    ours, meeting, joints = sim.joints.blocks == block, sim.geometry.faces, sim.joints
    near = sim.settings.history.touches * sim.smallest
    met = np.unique(joints.owners[(joints.kn > 0.0) & (sim.contacts.gaps <= near)])
    return np.concatenate([meeting[met, 1 - side][ours[met, side]] for side in (0, 1)])


def _go_on(sim: DynamicSimulation, touched: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Find faces (n,) that continue the plane of one of `faces`, as the next stone of a ramp does, (n,) bool."""
    near = sim.settings.history.touches * sim.smallest
    planes, others = ([_corners(sim, face) for face in some] for some in (faces, touched))
    return np.array([any(_off_plane(plane, other) <= near for plane in planes) for other in others], bool)


def _corners(sim: DynamicSimulation, face: int) -> np.ndarray:
    """Corners of a face where it is now [m], (n, d)."""
    topology = sim.model.topology
    return sim.bodies.corners[topology.face_corners[topology.face_starts[face] : topology.face_starts[face + 1]]]


def _off_plane(corners: np.ndarray, points: np.ndarray) -> float:
    """Compute the largest distance of points from the plane of a face by its corners, or in 2D from its line [m]."""
    rest, off = corners - corners[0], points - corners[0]
    for _ in range(corners.shape[1] - 1):
        along = rest[np.square(rest).sum(axis=1).argmax()]
        along = along / np.sqrt(np.square(along).sum())
        rest, off = (arms - product(arms, along)[:, np.newaxis] * along for arms in (rest, off))
    return float(np.sqrt(np.square(off).sum(axis=1)).max())


def _above(sim: DynamicSimulation, block: int, faces: np.ndarray) -> bool:
    """Test whether the centre of a block is above the area that these faces cover together in plan."""
    d = sim.model.dimension
    if not len(faces):
        return False
    corners = np.concatenate([_corners(sim, face) for face in faces])
    arms = corners[:, : d - 1] - sim.bodies.positions[block, : d - 1]
    if d == 2:
        return bool(arms.min() <= 0.0 <= arms.max())
    angles = np.sort(functions.arctan2(arms[:, 1], arms[:, 0]))
    return bool(np.diff(np.append(angles, angles[0] + 2.0 * np.pi)).max() <= np.pi)
