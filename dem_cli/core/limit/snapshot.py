"""Collapse state as a frame: forces at all points, blocks moved along the mechanism."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.geometry.rotation import quaternions, swept, unturned
from dem_cli.core.limit.matrices import LimitStructure
from dem_cli.core.model.first_moments import of_loads
from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import STATES, ContactRecord, Frame

SHOWN_MOTION = 0.01  # mechanism of a frame: largest motion over the largest radius of a block that can move
PRESSED_SHARE = 1e-6  # of the largest normal force: what an interior point leaves at open points is smaller
MOVING_SHARE = 1e-3  # of the largest motion of any point


class Collapse(NamedTuple):
    """Collapse state of any analysis: load, forces and mechanism."""

    stage: str  # "associated" or "non-associated"
    load: float  # multiplier of the live loads
    normal: np.ndarray  # normal force of each point, compression positive [N], (n_points,)
    shear: np.ndarray  # shear force on b along the tangents [N], (n_points, d − 1)
    velocities: np.ndarray  # mechanism, in any unit, (n_blocks, n_dof)
    steps: int = 0  # of the solver


def frame(structure: LimitStructure, collapse: Collapse, tilting: bool = False) -> Frame:
    """Build the frame of a collapse state: its forces, and the structure moved a little along its mechanism.

    Largest motion of a block: SHOWN_MOTION of the largest radius; velocities are the mechanism as it is. tilting: the
    multiplier is tan θ of a table that turns, and forces are those under the turned weight.
    """
    model, d = structure.model, structure.model.dimension
    moved = _amplitude(model, collapse.velocities) * collapse.velocities
    factor = 1.0 / np.sqrt(1.0 + collapse.load**2) if tilting else 1.0
    return Frame(
        collapse.stage, collapse.steps, collapse.load,
        float(np.linalg.norm(moved[:, :d], axis=1).max(initial=0.0)),
        model.centroids + moved[:, :d], quaternions(moved[:, d:]), collapse.velocities.copy(),
        _contacts(structure, collapse, moved, factor),
        first_moments=of_loads(model, unturned(model.n_blocks, d), factor, factor * collapse.load),
    )  # fmt: skip


def _amplitude(model: Model, velocities: np.ndarray) -> float:
    """Time for which a mechanism is followed, so that its largest motion is SHOWN_MOTION of the largest radius."""
    d, radii = model.dimension, model.shapes.radii
    turning = np.linalg.norm(velocities[:, d:], axis=1) * radii
    fastest = float(np.maximum(np.linalg.norm(velocities[:, :d], axis=1), turning).max(initial=0.0))
    return SHOWN_MOTION * float(radii[~model.fixed].max()) / fastest if fastest > 0.0 else 0.0


def _contacts(structure: LimitStructure, collapse: Collapse, moved: np.ndarray, factor: float) -> ContactRecord:
    """Forces and motion of every point."""
    joints, d = structure.joints, structure.model.dimension
    owner = joints.owners
    motion = (structure.compatibility @ moved.ravel()[structure.free]).reshape(-1, d)
    slides = np.linalg.norm(motion[:, 1:], axis=1)
    fastest = float(np.linalg.norm(motion, axis=1).max(initial=0.0))
    pressed = collapse.normal > PRESSED_SHARE * collapse.normal.max(initial=0.0)
    kinds = [STATES.index(name) for name in ("open", "sliding", "sticking")]
    state = np.select([~pressed, slides > MOVING_SHARE * fastest], kinds[:2], kinds[2])
    return ContactRecord(
        joint=owner,
        blocks=joints.blocks[owner],
        points=joints.points + _carried(structure, moved, joints.blocks[owner, 0]),
        normals=joints.frames[:, :d].copy(),
        normal_force=factor * collapse.normal,
        shear_force=factor * collapse.shear,
        gap=motion[:, 0].copy(),
        slip=slides,
        state=state.astype(np.int8),
        tangents=joints.frames[:, d : d * (d - 1)].copy(),  # all but the last: none in the plane
    )


def _carried(structure: LimitStructure, moved: np.ndarray, blocks: np.ndarray) -> np.ndarray:
    """Compute the displacement of every point with its block [m], to first order, (n_points, d)."""
    d, arms = structure.model.dimension, structure.joints.points - structure.model.centroids[blocks]
    return moved[blocks, :d] + swept(moved[blocks, d:], arms)
