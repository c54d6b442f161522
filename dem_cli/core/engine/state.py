"""State of a simulation: what is saved and restored, and the energy ledger of one instant."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.contact.joints import JointGeometry
from dem_cli.core.kernels.records import Bodies, Contacts, Joints

NONE_MEET = np.zeros(0, bool)


class Carriers(NamedTuple):
    """Supports of the free blocks at the start of a time history: pairs of a block and a face of another one."""

    blocks: np.ndarray  # the block that is carried, ascending, (n,) int64
    faces: np.ndarray  # and a face (model.topology) that carries it, (n,) int64
    above: np.ndarray  # numbers of the blocks whose centre was above what their faces cover together in plan, (m,)


NO_CARRIERS = Carriers(np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros(0, np.int64))


class SavedState(NamedTuple):
    """Saved state of a simulation: everything that changes, at one instant, which `restore` goes back to."""

    bodies: Bodies
    contacts: Contacts
    joints: Joints
    geometry: JointGeometry
    control: np.ndarray  # as kernels.records
    ledger: np.ndarray  # as kernels.records
    inverse_masses: np.ndarray  # as Loads.inverse_masses
    safety: float  # of the fictitious masses
    links: tuple[np.ndarray, ...] = ()  # state of the links of each kind
    unpassed: np.ndarray = NONE_MEET  # as JointTracking.unpassed, (n_meetings,)


class Books(NamedTuple):
    """Energy balance of one instant, and what belongs to it [J]."""

    ledger: np.ndarray  # as kernels.records
    kinetic: float
    elastic: float  # in the springs of the joints and of links
    in_dampers: float = 0.0  # in the springs of Maxwell elements
    lag: float = 0.0  # how far the positions are ahead of it [s]
