"""Joints of fixed geometry, joint by joint: one frame, two arms to one place, points in the joint plane.

A contact point is but its place in the plane of its joint. What is asked for point by point (frames, levers, places in
space) is worked out from that.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.kernels.tiles.joint_tiles import NO_TILES, JointTiles

NOTHING, NO_JOINTS = np.zeros(0, np.int8), np.zeros(0, np.int64)
NO_SHARES = np.zeros(0)


class FixedJoints(NamedTuple):
    """Joints of fixed geometry; a joint owns points starts[j]:starts[j + 1]."""

    blocks: np.ndarray  # blocks a and b, (n_joints, 2)
    starts: np.ndarray  # first point of each joint, (n_joints + 1,)
    axes: np.ndarray  # unit normal from a to b, then in 3D both tangents, (n_joints, 2 or 9)
    anchors: np.ndarray  # where the places of a joint are counted from [m], (n_joints, d)
    arms: np.ndarray  # anchor from the centroids of a and of b [m], (n_joints, 2·d)
    places: np.ndarray  # of the points in the plane, along the tangents from the anchor [m], (n_points, d − 1)
    kn: np.ndarray  # normal stiffness of a point [N/m], (n_points,)
    ks: np.ndarray  # shear stiffness of a point [N/m], (n_points,)
    law: np.ndarray  # parameters of the joint law, (n_joints, n_parameters)
    torsion: np.ndarray = NO_SHARES  # in space: how far from the centre of pressure friction acts, over the distance of
    # its point (contact/corner_forces.py), 1: at the point itself, (n_joints,)
    tiles: JointTiles = NO_TILES  # of these joints, for laws that have a form for lanes
    integrated: np.ndarray = NOTHING  # this and the next four as MovingJoints has them
    after: np.ndarray = NO_JOINTS
    fans: np.ndarray = NO_SHARES
    faint: np.ndarray = NO_SHARES
    back: np.ndarray = NO_SHARES

    @property
    def owners(self) -> np.ndarray:
        """Joint of each point, (n_points,)."""
        return np.repeat(np.arange(len(self.blocks)), np.diff(self.starts))

    @property
    def directions(self) -> np.ndarray:
        """Unit normal and tangents of each joint, (n_joints, d, d)."""
        n, d = self.anchors.shape
        if d == 2:
            return np.stack([self.axes, np.stack([-self.axes[:, 1], self.axes[:, 0]], axis=1)], axis=1)
        return self.axes.reshape(n, d, d)

    @property
    def frames(self) -> np.ndarray:
        """Frames of every point, as `Joints.frames`, (n_points, d·d)."""
        d = self.anchors.shape[1]
        return self.directions.reshape(-1, d * d)[self.owners]

    @property
    def points(self) -> np.ndarray:
        """Places of the contact points [m], (n_points, d)."""
        return self.anchors[self.owners] + self._from_anchor()

    @property
    def levers(self) -> np.ndarray:
        """Levers of every point, as `Joints.levers`: arm × direction, about the centroids of a and of b, (n_points,
        2·d·r).
        """
        d, owners = self.anchors.shape[1], self.owners
        r = 1 if d == 2 else 3
        arms = self.arms.reshape(-1, 2, 1, d)[owners] + self._from_anchor()[:, None, None]
        along = self.directions[owners][:, None]
        levers = arms[..., 0] * along[..., 1] - arms[..., 1] * along[..., 0] if r == 1 else np.cross(arms, along)
        return levers.reshape(-1, 2 * d * r)

    def kept(self) -> FixedJoints:
        """Return the record itself: nothing of it changes."""
        return self

    def _from_anchor(self) -> np.ndarray:
        """Places of the points from the anchors, in space [m], (n_points, d)."""
        tangents = self.directions[self.owners, 1:]
        return (self.places[:, :, None] * tangents).sum(axis=1)
