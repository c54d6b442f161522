"""Joints of the undeformed structure at any instant: opening, crack width, slip, stress and eccentricity of each.

A joint is a pair of faces that face each other in the undeformed structure. It is followed by the material points
around it (in the plane its two ends), however far the blocks have moved, so that it stays one joint when contact points
come and go. What is across and along it is said by block a, with which it turns. Forces are those of all contact points
of its two blocks.
"""

from __future__ import annotations

from copy import copy
from typing import NamedTuple

import numpy as np

from dem_cli.core.contact.between import StartJoints
from dem_cli.core.contact.joints import DrawnFaces
from dem_cli.core.geometry.outlines import away_from, furthest
from dem_cli.core.geometry.rotation import beside, tangents_of, turning
from dem_cli.core.model.copies import repeated
from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import STATES, ContactRecord, JointPlaces, JointStates

OPEN, STICKING, SLIDING = (STATES.index(name) for name in ("open", "sticking", "sliding"))


class JointInstant(NamedTuple):
    """State of all joints at one instant; in the plane each has two places, in space those of JointPlaces.starts."""

    states: JointStates
    gaps: np.ndarray  # distance across the joint at its places, positive open [m], (n, 2); in space (n_places,)
    ends: np.ndarray  # where these are, half way between both blocks [m], (n, 2, 2); in space (n_places, 3)


class DrawnJoints:
    """Joints of the undeformed structure; `at` follows them. `places` never change."""

    def __init__(self, model: Model):
        faces = StartJoints(model).faces
        order = np.argsort(_keys(faces.blocks, model.n_blocks), kind="stable")
        self._follow(faces.taken(order), model.centroids)
        self.places = joint_places(self.faces)

    def _follow(self, faces: DrawnFaces, centroids: np.ndarray) -> None:
        """Store the joints to follow, sorted by their keys; centroids of their blocks as drawn [m], (n_blocks, d)."""
        self.faces, self.centroids = faces, centroids
        self.keys = _keys(faces.blocks, len(centroids))
        self.owners = np.repeat(np.arange(len(faces.areas)), np.diff(self.faces.starts))
        on = (self.faces.on_first, self.faces.on_second)
        self.blocks = [self.faces.blocks[self.owners, i] for i in (0, 1)]  # of each place
        self.arms = [on[i] - centroids[self.blocks[i]] for i in (0, 1)]
        self.apart = on[1] - on[0]
        self.drawn = np.maximum((self.apart * self.faces.normals[self.owners]).sum(axis=1), 0.0)  # open as drawn [m]

    def _copies(self, count: int) -> DrawnJoints:
        """Repeat the joints for so many copies of the structure, whose blocks and joints are numbered through."""
        found = copy(self)
        found._follow(self.faces.copies(count, len(self.centroids)), repeated(self.centroids, count))
        return found

    def at(self, positions: np.ndarray, orientations: np.ndarray, contacts: ContactRecord) -> JointInstant:
        """Compute the state of joints whose blocks have moved to these centroids [m], (n_blocks, d), and turned, under
        contact forces.

        Of several instants as records.frames.FrameStack has them: the joints of each lie behind those before.
        """
        if len(positions) > len(self.centroids):
            return self._copies(len(positions) // len(self.centroids)).at(positions, orientations, contacts)
        faces, owners, n = self.faces, self.owners, len(self.faces.areas)
        moved, shifts = positions - self.centroids, []
        for block, arms in zip(self.blocks, self.arms, strict=True):
            shifts.append(moved[block] + (turning(orientations[block])(arms) - arms))
        apart = self.apart + shifts[1] - shifts[0]
        ends = faces.on_first + shifts[0] + 0.5 * apart
        normals = turning(orientations[faces.blocks[:, 0]])(faces.normals)
        tangents = tangents_of(normals, beside(normals))
        gaps = (apart * normals[owners]).sum(axis=1)
        slides = [self._means((apart * along[owners]).sum(axis=1)) for along in tangents]
        pressure, shear, offset, state = self._forces(contacts, ends, normals, tangents)
        states = JointStates(
            opening=self._means(gaps),
            crack_width=np.maximum(np.maximum.reduceat(gaps - self.drawn, faces.starts[:-1]) if n else gaps, 0.0),
            slip=_measured(slides),
            normal_stress=pressure / faces.areas,
            shear_stress=shear / faces.areas,
            eccentricity=np.divide(offset, pressure, out=np.zeros(n), where=pressure != 0.0),
            state=state,
        )
        two = not len(self.places.starts)
        return JointInstant(states, gaps.reshape(n, 2) if two else gaps, ends.reshape(n, 2, -1) if two else ends)

    def _means(self, values: np.ndarray) -> np.ndarray:
        """Compute means over the area of each joint, of values at its places."""
        return np.bincount(self.owners, self.faces.shares * values, len(self.faces.areas))

    def _owners(self, contacts: ContactRecord, ends: np.ndarray, normals: np.ndarray) -> np.ndarray:
        """Find the joint of each contact point, (n_points,): the nearest one of its blocks; −1 where they had none."""
        keys = _keys(contacts.blocks, len(self.centroids))
        first, after = (np.searchsorted(self.keys, keys, side) for side in ("left", "right"))
        owners = np.where(after > first, first, -1)
        several = np.flatnonzero(after - first > 1)
        points, starts = contacts.points[several], self.faces.starts
        best = away_from(points, owners[several], ends, starts, normals)
        for further in range(1, int((after - first).max(initial=1))):
            other = np.minimum(first[several] + further, after[several] - 1)
            distance = away_from(points, other, ends, starts, normals)
            owners[several] = np.where(distance < best, other, owners[several])
            best = np.minimum(distance, best)
        return owners

    def _forces(
        self, contacts: ContactRecord, ends: np.ndarray, normals: np.ndarray, tangents: list[np.ndarray]
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Sum for each joint: normal force, shear force [N], normal force times eccentricity [N m]; and its state."""
        n, owners = len(normals), self._owners(contacts, ends, normals)
        own = np.flatnonzero(owners >= 0)
        at, force = owners[own], contacts.forces()[own]
        middles = np.stack([self._means(along) for along in ends.T], axis=1)
        arms, across_joint = contacts.points[own] - middles[at], (force * normals[at]).sum(axis=1)
        shears = [np.bincount(at, (force * along[at]).sum(axis=1), n) for along in tangents]
        offsets = [np.bincount(at, across_joint * (arms * along[at]).sum(axis=1), n) for along in tangents]
        closed = np.bincount(at, contacts.state[own] != OPEN, n) > 0
        slides = np.bincount(at, contacts.state[own] == SLIDING, n) > 0
        state = np.select([slides, closed], [SLIDING, STICKING], OPEN).astype(np.int8)
        return np.bincount(at, across_joint, n), _measured(shears), _measured(offsets), state


def joint_places(faces: DrawnFaces) -> JointPlaces:
    """Collect the places of joints as they were drawn, for the results."""
    if faces.normals.shape[1] == 2:
        ends = faces.on_first.reshape(-1, 2, 2)
        return JointPlaces(faces.blocks, ends, faces.normals, faces.lengths, faces.areas)
    ends = faces.on_first[furthest(faces.on_first, faces.starts)]
    outlines = {"starts": faces.starts, "corners": faces.on_first}
    return JointPlaces(faces.blocks, ends, faces.normals, faces.lengths, faces.areas, **outlines)


def _measured(components: list[np.ndarray]) -> np.ndarray:
    """Return one component with its sign, the length of two."""
    return components[0] if len(components) == 1 else np.hypot(*components)


def _keys(blocks: np.ndarray, n_blocks: int) -> np.ndarray:
    """Number each pair of blocks, (n,)."""
    return blocks[:, 0] * n_blocks + blocks[:, 1]
