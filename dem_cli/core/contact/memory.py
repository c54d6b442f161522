"""Memory of contact points across a detection, carried over by key: joint and feature."""

from __future__ import annotations

import numpy as np

from dem_cli.core.contact.geometry import AnyMovingNarrowPhase
from dem_cli.core.contact.joints import JointArrays, JointProperties, points_of
from dem_cli.core.contact.keys import same_rows


def carry_memory(narrow: AnyMovingNarrowPhase, old: JointArrays, new: JointArrays, properties: JointProperties) -> None:
    """Copy memory and stiffness of the points of `old` to the same points of `new`.

    A point is the same when its key is. Where a corner turned over to its other face, the point of the same two blocks
    that is nearest takes over. properties: their law gives normal forces of new points by their overlap. Where it is
    bonded, and on elastic faces, points go on from the gap that their forces belong to, that of the step before: else
    the next step would find other forces at the same gap, and count their change as lost.
    """
    match = same_rows(old.geometry.keys, new.geometry.keys)
    points = _same_points(old, new, match)
    target = np.flatnonzero(points >= 0)
    _copy(narrow, old, new, target, points[target])
    narrow.take_over(old, new, match, points >= 0)
    lost = _loaded(old)
    lost[match[match >= 0]] = False
    orphans = np.flatnonzero(lost)
    newborn = np.flatnonzero(match < 0)
    if len(orphans) and len(newborn):
        _adopt(narrow, old, new, orphans, newborn)
    new.contacts.exchanged[:] = old.contacts.exchanged
    goes_on = target if properties.bonded else target[new.whole[target]]
    new.contacts.gaps[goes_on] = old.contacts.gaps[points[goes_on]]
    narrow.book(old, new, points >= 0, properties.pressed)


def _same_points(old: JointArrays, new: JointArrays, match: np.ndarray) -> np.ndarray:
    """Find the old point that each new one is, −1: none, (n_points,). match: of joints, as `same_rows`."""
    before, now = old.joints.owners, match[new.joints.owners]
    features = new.geometry.features
    here, there = np.flatnonzero((now >= 0) & (features >= 0)), np.flatnonzero(old.geometry.features >= 0)
    found = same_rows(
        np.column_stack([before[there], old.geometry.features[there]]), np.column_stack([now[here], features[here]])
    )
    points = np.full(len(features), -1)
    points[here] = np.where(found >= 0, there[found], -1) if len(there) else -1
    return points


def _loaded(of: JointArrays) -> np.ndarray:
    if not len(of.joints.blocks):
        return np.zeros(0, bool)
    return np.maximum.reduceat(np.abs(of.contacts.normal), of.joints.starts[:-1]) > 0.0


def _copy(
    narrow: AnyMovingNarrowPhase, old: JointArrays, new: JointArrays, target: np.ndarray, source: np.ndarray
) -> None:
    narrow.carry(old, new, target, source)
    for name in ("slip", "memory", "closure"):
        getattr(new.contacts, name)[target] = getattr(old.contacts, name)[source]


def _adopt(
    narrow: AnyMovingNarrowPhase, old: JointArrays, new: JointArrays, orphans: np.ndarray, newborn: np.ndarray
) -> None:
    """Move the memory of loaded joints whose faces changed to the nearest point of a new joint of the same blocks."""
    joints, contacts, memory = new.joints, new.contacts, old.contacts
    for i in orphans:
        heirs = np.array([j for j in newborn if (joints.blocks[j] == old.joints.blocks[i]).all()], int)
        if not len(heirs):
            continue
        candidates = points_of(joints.starts, heirs)
        for source in range(old.joints.starts[i], old.joints.starts[i + 1]):
            if memory.normal[source] != 0.0:
                distance = ((joints.points[candidates] - old.joints.points[source]) ** 2).sum(axis=1)
                heir = candidates[[distance.argmin()]]
                _copy(narrow, old, new, heir, np.array([source]))
                carries = memory.normal[source] / old.joints.kn[source] - memory.closure[source]
                deeper = max(-contacts.gaps[heir[0]] - carries, 0.0)
                joint = int(np.searchsorted(joints.starts, heir[0], side="right")) - 1
                narrow.sink(new.geometry, joint, deeper)
