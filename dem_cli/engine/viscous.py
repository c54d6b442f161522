"""Damping in numbers: dashpots of joints, mass damping, Maxwell elements and local damping of a time history."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from dem_cli.kernels.records import Joints
from dem_cli.model.model import Model
from dem_cli.tables.damping import MaxwellElement


@dataclass(frozen=True)
class Damping:
    """What is lost, in numbers."""

    fraction: float = 0.0  # of critical, each joint at its own frequency
    stiffness: float = 0.0  # damping over stiffness of all joints [s]
    mass: float = 0.0  # [1/s]
    local: float = 0.0
    elements: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))  # as `element_numbers`
    words: str = "none"  # for users

    @property
    def in_joints(self) -> bool:
        """Whether joints have anything but springs."""
        return self.fraction > 0.0 or self.stiffness > 0.0 or len(self.elements) > 0

    @property
    def stiffening(self) -> float:
        """What Maxwell elements, whose springs lie beside those of the joints, multiply frequencies by."""
        return math.sqrt(1.0 + float(self.elements[:, 0].sum()))

    def viscosities(self, model: Model, joints: Joints) -> np.ndarray:
        """Damping over stiffness of each joint [s], (n_joints,): 2 ζ/ω, ω² = kn A/M with the reduced mass M."""
        found = np.full(len(joints.blocks), self.stiffness)
        if self.fraction > 0.0 and len(found):
            frequencies = joint_frequencies(model, joints)
            held = frequencies > 0.0  # in space a joint may have no point yet: what will be there is like the others
            frequencies[~held] = np.median(frequencies[held]) if held.any() else np.inf
            found += 2.0 * self.fraction / frequencies
        return found


def joint_frequencies(model: Model, joints: Joints) -> np.ndarray:
    """√(K/M) of each joint [rad/s]: K all its normal springs, M the reduced mass of its blocks, (n_joints,)."""
    inverse = np.where(model.fixed, 0.0, 1.0 / model.masses)[joints.blocks].sum(axis=1)
    return np.sqrt(np.add.reduceat(joints.kn, joints.starts[:-1]) * inverse)


def element_numbers(elements: tuple[MaxwellElement, ...]) -> np.ndarray:
    """Stiffness over that of the joint [-] and rate [1/s] of each, (n, 2).

    At its own frequency an element of stiffness share r loses r/2 of the joint's stiffness in quadrature: ratio r/4,
    over the joint's stiffness alone.
    """
    return np.array([[4.0 * e.ratio, 2.0 * math.pi * e.frequency] for e in elements]).reshape(-1, 2)
