"""Joints as they were drawn: opening, crack width, slip, stress and eccentricity of each at any instant, 2D.

A joint is a pair of edges that face each other in the undeformed structure. It is followed by the material points at
its two ends, however far the blocks have moved, so that it stays one joint when contact points come and go. What is
across and along it is said by block a, with which it turns. Forces are those of all contact points of its two blocks.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.contact.between import StartJoints
from dem_cli.geometry.rotation import across, turned
from dem_cli.model.model import Model
from dem_cli.output.record import STATES, ContactRecord, JointPlaces, JointStates

OPEN, STICKING, SLIDING = (STATES.index(name) for name in ("open", "sticking", "sliding"))


class JointInstant(NamedTuple):
    """All joints at one instant."""

    states: JointStates
    gaps: np.ndarray  # distance across the joint at its two ends, positive open [m], (n, 2)
    ends: np.ndarray  # where these are, half way between both blocks [m], (n, 2, d)


class DrawnJoints:
    """The joints of a structure as it was drawn; `at` follows them. `places` never change."""

    def __init__(self, model: Model):
        start = StartJoints(model)
        keys = _keys(start.blocks, model.n_blocks)
        order = np.argsort(keys, kind="stable")
        self.model, self.keys, blocks = model, keys[order], start.blocks[order]
        normals, on_first, on_second = start.sides(start.edges[order])
        self.arms = [on - model.centroids[blocks[:, i], np.newaxis] for i, on in enumerate((on_first, on_second))]
        self.apart = on_second - on_first
        lengths = start.lengths[order]
        areas = lengths * model.thickness[blocks].min(axis=1, initial=np.inf)
        self.places = JointPlaces(blocks, on_first, normals, lengths, areas)

    def at(self, positions: np.ndarray, orientations: np.ndarray, contacts: ContactRecord) -> JointInstant:
        """Where the blocks are (centroids [m], (n_blocks, d), and angles [rad], (n_blocks, 1)), under these forces."""
        blocks, normals, area = self.places.blocks, self.places.normals, self.places.area
        moved, angles = positions - self.model.centroids, orientations[:, 0]
        shifts = []
        for i, arms in enumerate(self.arms):
            swung = turned(arms, angles[blocks[:, i], np.newaxis]) - arms
            shifts.append(moved[blocks[:, i], np.newaxis] + swung)
        apart = self.apart + shifts[1] - shifts[0]
        ends = self.places.ends + shifts[0] + 0.5 * apart
        normals = turned(normals, angles[blocks[:, 0]])
        tangents = across(normals)
        gaps = (apart * normals[:, np.newaxis]).sum(axis=2)
        owners = self._owners(contacts, ends)
        forces, turning, state = self._forces(contacts, owners, ends, normals, tangents)
        pressed = forces[:, 0] != 0.0
        states = JointStates(
            opening=gaps.mean(axis=1),
            crack_width=np.maximum(gaps.max(axis=1, initial=0.0), 0.0),
            slip=(apart * tangents[:, np.newaxis]).sum(axis=2).mean(axis=1),
            normal_stress=forces[:, 0] / area,
            shear_stress=forces[:, 1] / area,
            eccentricity=np.divide(turning, forces[:, 0], out=np.zeros(len(area)), where=pressed),
            state=state,
        )
        return JointInstant(states, gaps, ends)

    def _owners(self, contacts: ContactRecord, ends: np.ndarray) -> np.ndarray:
        """Joint of each contact point, (n_points,): the nearest one of its blocks; −1: they had none."""
        keys = _keys(contacts.blocks, self.model.n_blocks)
        first, after = (np.searchsorted(self.keys, keys, side) for side in ("left", "right"))
        owners = np.where(after > first, first, -1)
        several = np.flatnonzero(after - first > 1)
        best = _distances(contacts.points[several], ends[owners[several]])
        for further in range(1, int((after - first).max(initial=1))):
            other = np.minimum(first[several] + further, after[several] - 1)
            distance = _distances(contacts.points[several], ends[other])
            owners[several] = np.where(distance < best, other, owners[several])
            best = np.minimum(distance, best)
        return owners

    def _forces(
        self, contacts: ContactRecord, owners: np.ndarray, ends: np.ndarray, normals: np.ndarray, tangents: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of each joint: normal and shear force [N], (n, 2); normal force times eccentricity [N m]; state."""
        n, there = len(normals), owners >= 0
        at, own = owners[there], np.flatnonzero(there)
        along = contacts.normals[own]
        force = contacts.normal_force[own, np.newaxis] * along + contacts.shear_force[own] * across(along)
        across_joint = (force * normals[at]).sum(axis=1)
        shear = (force * tangents[at]).sum(axis=1)
        arms = ((contacts.points[own] - ends.mean(axis=1)[at]) * tangents[at]).sum(axis=1)
        sums = [np.bincount(at, values, n) for values in (across_joint, shear, across_joint * arms)]
        closed = np.bincount(at, contacts.state[own] != OPEN, n) > 0
        slides = np.bincount(at, contacts.state[own] == SLIDING, n) > 0
        state = np.select([slides, closed], [SLIDING, STICKING], OPEN).astype(np.int8)
        return np.stack(sums[:2], axis=1), sums[2], state


def _keys(blocks: np.ndarray, n_blocks: int) -> np.ndarray:
    """One number for each pair of blocks, (n,)."""
    return blocks[:, 0] * n_blocks + blocks[:, 1]


def _distances(points: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Distance of each point (n, 2) from a line between two ends (n, 2, 2) [m], (n,)."""
    along = ends[:, 1] - ends[:, 0]
    share = ((points - ends[:, 0]) * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
    nearest = ends[:, 0] + np.clip(share, 0.0, 1.0)[:, np.newaxis] * along
    return np.hypot(*(points - nearest).T)
