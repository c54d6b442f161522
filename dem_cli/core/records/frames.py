"""Frames: the structure at one instant as a solver hands it to an observer, with its contacts, links and joints.

Plain arrays, no files.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dem_cli.core.geometry.rotation import tangents_of, turned_further, turning

NO_TANGENTS = np.zeros((0, 0))
NO_OUTLINES, NO_CORNERS, OUTLINE = np.zeros(0, np.int64), np.zeros((0, 3)), ("starts", "corners")
STATES = ("open", "sticking", "sliding")  # meaning of ContactRecord.state 0, 1, 2
STAGES = (
    "gravity",
    "loading",
    "collapse",
    "settlement",
    "associated",
    "non-associated",
    "shaking",
    "mode",
)  # meaning of Frame.stage and HistoryRow.stage, in their order
FRAME_ARRAYS = ("positions", "orientations", "velocities")  # fields of Frame that each block has a row of
OPTIONAL_ARRAYS = ("stresses", "first_moments")  # the same, where the structure has any


class ContactRecord(NamedTuple):
    """Contact points of one instant: places, forces and states. A joint owns several points (2D: its two ends)."""

    joint: np.ndarray  # joint that owns the point, (n,) int64; joints are renumbered at each detection
    blocks: np.ndarray  # the two blocks a, b, (n, 2) int64
    points: np.ndarray  # where it acts [m], (n, d)
    normals: np.ndarray  # unit, from a to b, (n, d)
    normal_force: np.ndarray  # compression positive [N], (n,)
    shear_force: np.ndarray  # on b along the tangents [N], (n, d − 1)
    gap: np.ndarray  # positive open [m], (n,)
    slip: np.ndarray  # accumulated slip path [m], (n,)
    state: np.ndarray  # index into STATES, (n,) int8
    # In space alone, (n, 3): the first tangent, unit; the second is normal × tangent. In the plane the tangent is the
    # normal turned by +90°, and this is empty.
    tangents: np.ndarray = NO_TANGENTS

    def stored(self) -> dict[str, np.ndarray]:
        """Fields by name, without what is empty in the plane."""
        return {name: values for name, values in self._asdict().items() if 0 not in values.shape[1:]}

    def forces(self) -> np.ndarray:
        """Force of each point on its second block [N], (n, d)."""
        total = self.normal_force[:, np.newaxis] * self.normals
        for along, shear in zip(tangents_of(self.normals, self.tangents), self.shear_force.T, strict=True):
            total = total + shear[:, np.newaxis] * along
        return total


class LinkPlaces(NamedTuple):
    """Ties and bars as lines through material points of blocks, one link after the other."""

    starts: np.ndarray  # first point of each link; the last number is their count, (n_links + 1,) int64
    blocks: np.ndarray  # block that takes each point along; −1: none, (n_points,) int64
    arms: np.ndarray  # from its centroid, undeformed; of no block from the origin [m], (n_points, d)

    def at(self, positions: np.ndarray, orientations: np.ndarray) -> np.ndarray:
        """Compute the places of the points where the blocks are now [m], (n_points, d); arguments as in Frame."""
        held, found = self.blocks >= 0, self.arms.copy()
        of = self.blocks[held]
        found[held] = positions[of] + turning(orientations[of])(self.arms[held])
        return found


class LinkRecord(NamedTuple):
    """Ties and bars at one instant."""

    places: LinkPlaces
    forces: np.ndarray  # axial force at each point, tension positive [N], (n_points,)

    def lines(self, frame: Frame) -> list[np.ndarray]:
        """Points of each link in a frame [m], (n, d) each."""
        points = self.places.at(frame.positions, frame.orientations)
        return [points[a:b] for a, b in zip(self.places.starts, self.places.starts[1:])]

    def on_blocks(self, positions: np.ndarray, orientations: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Compute the forces of ties and bars on the blocks of their points.

        Bars hand over what their force changes by from point to point. Returns blocks (n,), −1: none, points [m] and
        forces [N], (n, d) each; arguments as in Frame.
        """
        points, starts = self.places.at(positions, orientations), self.places.starts
        forces = np.zeros_like(points)
        for begin, end in zip(starts[:-1].tolist(), starts[1:].tolist()):
            here, blocks, axial = points[begin:end], self.places.blocks[begin:end], self.forces[begin:end]
            first, last = np.arange(end - begin - 1), np.arange(1, end - begin)
            if end - begin > 2:  # a bar crosses a joint from the node before it to that behind
                crosses = (blocks[1:] != blocks[:-1]).astype(np.int64)
                first, last = np.maximum(first - crosses, 0), np.minimum(last + crosses, end - begin - 1)
            along = here[last] - here[first]
            lengths = np.sqrt((along * along).sum(axis=1))
            pull = (0.5 * (axial[1:] + axial[:-1]) / np.where(lengths > 0.0, lengths, 1.0))[:, None] * along
            forces[begin : end - 1] += pull
            forces[begin + 1 : end] -= pull
        return self.places.blocks, points, forces

    def largest(self) -> np.ndarray:
        """Largest axial force of each link by amount, with its sign [N], (n_links,)."""
        parts = [self.forces[a:b] for a, b in zip(self.places.starts, self.places.starts[1:])]
        return np.array([part[np.abs(part).argmax()] for part in parts])


class JointPlaces(NamedTuple):
    """Joints as they were drawn: pairs of faces that face each other in the undeformed structure."""

    blocks: np.ndarray  # the two blocks a, b, (n, 2) int64
    ends: np.ndarray  # where it begins and ends, on a; in space its two corners furthest apart [m], (n, 2, d)
    normals: np.ndarray  # unit, from a to b, (n, d)
    length: np.ndarray  # between its ends [m], (n,)
    area: np.ndarray  # in the plane length times the smaller thickness [m²], (n,)
    # In space alone: joint j has the corners starts[j]:starts[j + 1] around its normal; one of a corner, two of an edge
    starts: np.ndarray = NO_OUTLINES  # (n + 1,) int64
    corners: np.ndarray = NO_CORNERS  # on a [m], (n_corners, 3)

    def stored(self) -> dict[str, np.ndarray]:
        """Fields by name, without what is empty in the plane."""
        return {name: values for name, values in self._asdict().items() if len(self.starts) or name not in OUTLINE}

    def middles(self) -> np.ndarray:
        """Middle of each joint on a: of its ends, in space the mean of its corners [m], (n, d)."""
        if not len(self.starts):
            return self.ends.mean(axis=1)
        return np.add.reduceat(self.corners, self.starts[:-1], axis=0) / np.diff(self.starts)[:, np.newaxis]


class JointStates(NamedTuple):
    """States of joints at one instant, (n,) each; across and along are said by a, with which a joint turns."""

    # In the plane slip, shear stress and eccentricity are along the normal turned by +90°; in space they are lengths.
    opening: np.ndarray  # mean distance across it, positive open [m]
    crack_width: np.ndarray  # what its wider end, or its widest corner, has opened since it was drawn; or 0 [m]
    slip: np.ndarray  # of the middle of b on a [m]
    normal_stress: np.ndarray  # normal force over area, compression positive [Pa]
    shear_stress: np.ndarray  # on b [Pa]
    eccentricity: np.ndarray  # of the normal force from the middle; 0 where there is none [m]
    state: np.ndarray  # index into STATES, int8: sliding where any point slides, open where none presses


class Frame(NamedTuple):
    """Frame: the structure at one instant."""

    stage: str  # one of STAGES; of limit analysis and of a mode, positions are moved a little along it
    step: int  # solver steps so far
    load: float  # load multiplier
    displacement: float  # control displacement [m] (largest displacement of any block since the start)
    positions: np.ndarray  # centroids [m], (n_blocks, d)
    orientations: np.ndarray  # 2D: angle [rad], (n_blocks, 1); 3D: unit quaternion, (n_blocks, 4)
    velocities: np.ndarray  # per unit of the solver's time, (n_blocks, n_dof)
    contacts: ContactRecord
    time: float = 0.0  # since the start of a time history [s]; places and velocities are relative to its base
    # Stresses of blocks that deform, in their own axes, tension positive [Pa]: xx, yy, xy, in 3D xx, yy, zz,
    # yz, zx, xy, (n_blocks, 3 or 6); None: all blocks are rigid
    stresses: np.ndarray | None = None
    links: LinkRecord | None = None  # ties and bars; None: there are none
    # Symmetric parts of Σ f ⊗ x of loads at points, ties and bars about the centroids [N m]: xx, yy, xy, in 3D as
    # stresses, (n_blocks, 3 or 6); None: there are none
    first_moments: np.ndarray | None = None

    def moved(self, motion: np.ndarray) -> Frame:
        """Move and turn the blocks along the axes of the world [m, rad], (n_blocks, n_dof)."""
        d = self.positions.shape[1]
        turned = turned_further(self.orientations, motion[:, d:])
        return self._replace(positions=self.positions + motion[:, :d], orientations=turned)


class FrameStack(NamedTuple):
    """Frames of one structure as one instant of so many copies of it: block b of frame f has the row f · n_blocks + b.

    What is worked out of a hundred frames together takes hardly longer than that of one.
    """

    frames: tuple[Frame, ...]
    positions: np.ndarray  # as Frame has them, frame by frame, (n_frames · n_blocks, d)
    orientations: np.ndarray  # (n_frames · n_blocks, 1 or 4)
    velocities: np.ndarray  # (n_frames · n_blocks, n_dof)
    contacts: ContactRecord  # of all frames; blocks by their rows here
    stresses: np.ndarray | None  # (n_frames · n_blocks, 3 or 6)
    first_moments: np.ndarray | None  # (n_frames · n_blocks, 3 or 6)

    @property
    def n_points(self) -> np.ndarray:
        """Number of contact points of each frame, (n_frames,) int64."""
        return np.array([len(frame.contacts.joint) for frame in self.frames], np.int64)

    def own_contacts(self) -> ContactRecord:
        """Return all contact points, with the numbers that blocks have in the structure."""
        return self.contacts._replace(blocks=self.contacts.blocks % (len(self.positions) // len(self.frames)))

    def numbers(self, name: str, dtype: type = np.float64) -> np.ndarray:
        """Return one field of every frame by its name, (n_frames,); the stage by its place in STAGES."""
        if name == "stage":
            return np.array([STAGES.index(frame.stage) for frame in self.frames], dtype)
        return np.array([getattr(frame, name) for frame in self.frames], dtype)


def stacked(frames: Sequence[Frame]) -> FrameStack:
    """Stack frames of one structure, at least one."""
    n_blocks = len(frames[0].positions)
    positions, orientations, velocities = (
        np.concatenate([getattr(frame, name) for frame in frames]) for name in FRAME_ARRAYS
    )
    records = [frame.contacts for frame in frames]
    contacts = ContactRecord(*map(np.concatenate, zip(*records, strict=True)))
    counts = [len(record.joint) for record in records]
    through = contacts.blocks + np.repeat(n_blocks * np.arange(len(frames)), counts)[:, np.newaxis]
    contacts = contacts._replace(blocks=through)
    stresses, moments = (_joined([getattr(frame, name) for frame in frames]) for name in OPTIONAL_ARRAYS)
    return FrameStack(tuple(frames), positions, orientations, velocities, contacts, stresses, moments)


def _joined(parts: Sequence[np.ndarray | None]) -> np.ndarray | None:
    """Concatenate arrays of frames; None where these have none."""
    found = [part for part in parts if part is not None]
    return np.concatenate(found) if found else None
