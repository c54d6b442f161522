"""Joints with another number of contact points, geometry of the start, 2D."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING
from unittest.mock import patch

import numpy as np

from dem_cli.core.contact.joints import JointArrays, empty_contacts
from dem_cli.core.kernels.records import Contacts, FixedJoints

if TYPE_CHECKING:
    from dem_cli.core.engine.tracking import JointTracking


def shares(layout: str) -> np.ndarray:
    """Places along a joint, 0 … 1: "3" is both ends and the middle, "2 inside" the middles of two halves."""
    n = int(layout.split()[0])
    return (np.arange(n) + 0.5) / n if layout.endswith("inside") else np.linspace(0.0, 1.0, n)


def refined(joints: FixedJoints, contacts: Contacts, places: np.ndarray) -> tuple[FixedJoints, Contacts]:
    """The same joints with points at `places` along them, the same stiffness in all; unloaded contacts.

    Gaps are linear between the two ends, because both have the same frame.
    """
    n, m = len(joints.blocks), len(places)

    def between(ends: np.ndarray) -> np.ndarray:
        low, high = ends[0::2, None], ends[1::2, None]
        along = places.reshape(1, m, *[1] * (ends.ndim - 1))
        return np.ascontiguousarray(((1.0 - along) * low + along * high).reshape(n * m, *ends.shape[1:]))

    joints = joints._replace(
        starts=np.arange(0, n * m + 1, m),
        places=between(joints.places),
        kn=joints.kn[0::2].repeat(m) * (2.0 / m),
        ks=joints.ks[0::2].repeat(m) * (2.0 / m),
    )
    finer = empty_contacts(n, n * m, contacts.shear.shape[1] + 1, contacts.memory.shape[1])
    finer.gaps[:] = between(contacts.gaps)
    return joints, finer


@contextmanager
def points_per_joint(layout: str) -> Iterator[None]:
    """Runs inside have joints with these points (see `shares`); "2" is what they have anyway."""
    from dem_cli.analyses import pushover
    from dem_cli.core.engine import job
    from dem_cli.core.engine.simulation import Simulation

    places = shares(layout)

    class RefinedSimulation(Simulation):
        """A simulation whose first joints have other points."""

        def _track(self, n_memory: int, reach: float) -> JointTracking:
            tracking = super()._track(n_memory, reach)
            if layout != "2" and isinstance(tracking.joints, FixedJoints):
                joints, contacts = refined(tracking.joints, tracking.contacts, places)
                tracking.take(JointArrays(joints, tracking.geometry, contacts))
            return tracking

    # the mechanism is told by the two ends of a joint
    with patch.object(job, "Simulation", RefinedSimulation), patch.object(pushover, "describe", lambda *_: {}):
        yield
