"""Contact geometry frozen at the start: valid while displacements are small against the blocks.

The gap is integrated from the closing velocity, which is exact for constant arms, so that the joint
stiffness drops out of a failure load.
"""

from __future__ import annotations

from dem_cli.kernels.jit import inline, overload
from dem_cli.kernels.vec import load_frame


def load_arm(arms, point, side, like):
    """arms[point, side] as a tuple."""
    return tuple(arms[point, side])


@overload(load_arm)
def _load_arm(arms, point, side, like):
    if len(like) == 2:
        return lambda arms, point, side, like: (arms[point, side, 0], arms[point, side, 1])
    return lambda arms, point, side, like: (arms[point, side, 0], arms[point, side, 1], arms[point, side, 2])


@inline
def prepare(joints, bodies, contacts, joint, like):
    """All points of a joint share its frame."""
    return True, load_frame(joints.frames, joint, like)


@inline
def place(joints, bodies, contacts, joint, point, shared, like):
    """Frozen frame and arms; the gap before this step's closing."""
    return (
        shared,
        load_arm(joints.arms, point, 0, like),
        load_arm(joints.arms, point, 1, like),
        contacts.gaps[point],
    )
