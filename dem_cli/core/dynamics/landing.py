"""Landing of loose blocks: vibration frequency of a block without joints on any one of its faces.

What holds nothing limits no step, and a pebble that lands on a step made for large blocks makes energy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.arithmetic.small_matrices import diagonalised
from dem_cli.core.dynamics.frequencies import principal_directions
from dem_cli.core.geometry.parts import shapes_of

if TYPE_CHECKING:
    from dem_cli.core.contact.joints import JointProperties
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.model.model import Model


def landing(sim: Simulation) -> tuple[float, int]:
    """Highest frequency ω [rad/s] of the free blocks without a joint, each on one of its faces; and which block, or −1.

    On something that does not move, every corner of the face pressed: with its share of the area, and the stiffest
    joint that its material has; where it deforms, with half of it.
    """
    model = sim.model
    held = np.unique(sim.joints.blocks[sim.joints.owners[sim.joints.kn > 0.0]])
    loose = np.setdiff1d(np.flatnonzero(~model.fixed), held)
    of_face = model.part_blocks[model.topology.face_parts]
    faces = np.flatnonzero(np.isin(of_face, loose) & ~model.inner_faces)
    if not len(faces):
        return 0.0, -1
    found = diagonalised(_stiffness(model, sim.properties, faces))[0][:, -1]
    fastest = int(found.argmax())
    return float(np.sqrt(found[fastest])), int(of_face[faces[fastest]])


def _stiffness(model: Model, properties: JointProperties, faces: np.ndarray) -> np.ndarray:
    """Stiffness of blocks on these faces, over the roots of their masses [1/s2], (n_faces, n_dof, n_dof)."""
    topology, d = model.topology, model.dimension
    counts = np.diff(topology.face_starts)[faces]
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    inside = np.arange(counts.sum()) - np.repeat(starts, counts)
    corners = topology.face_corners[np.repeat(topology.face_starts[faces], counts) + inside]
    blocks = model.part_blocks[topology.face_parts[faces]]
    owners = np.repeat(blocks, counts)
    named = properties.by_material[model.block_material[blocks]]  # the joints that the material of each block has
    if len(model.courses) and properties.heads is not None:
        heads = properties.heads[named]
        named = np.concatenate([named, np.where(heads >= 0, heads, named)], axis=1)
    each = [properties.stiffness_of(joint, faces[:, None]) for joint in named.T]
    kn, ks = (np.max(of, axis=0) * _areas(model, faces) / counts for of in zip(*each, strict=True))
    kn, ks = np.repeat(kn, counts), np.repeat(ks, counts)
    normals = np.repeat(shapes_of(model.vertices).normals(model.vertices, topology)[faces], counts, axis=0)
    springs = ks[:, None, None] * np.eye(d) + ((kn - ks)[:, None] * normals)[:, :, None] * normals[:, None, :]
    roots = np.sqrt(np.column_stack([np.repeat(model.masses[:, None], d, axis=1), model.inertias]))[owners]
    turns = product(_by_rotations(model.vertices[corners]), principal_directions(model)[owners])
    motion = np.concatenate([np.broadcast_to(np.eye(d), springs.shape), turns], axis=2) / roots[:, None, :]
    return np.add.reduceat(product(product(motion.swapaxes(1, 2), springs), motion), starts)


def _by_rotations(arms: np.ndarray) -> np.ndarray:
    """Motion of places at the ends of arms (n, d) by unit rotations about each axis, (n, d, 1 or 3)."""
    if arms.shape[1] == 2:
        return np.stack([-arms[:, 1], arms[:, 0]], axis=1)[:, :, None]
    return np.cross(np.eye(3)[None], arms[:, None, :]).swapaxes(1, 2)


def _areas(model: Model, faces: np.ndarray) -> np.ndarray:
    """Return the areas of faces; in the plane of edges, times the thickness of their block [m²], (n,)."""
    if model.dimension == 3:
        return model.faces.areas[faces]
    start, end = model.vertices[model.topology.ends[faces]].swapaxes(0, 1)
    return np.linalg.norm(end - start, axis=1) * model.thickness[model.part_blocks[model.topology.face_parts[faces]]]
