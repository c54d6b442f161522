"""Viscous damping in numbers: dashpots, mass damping, Maxwell elements, local damping; strains of blocks."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.arithmetic.small_matrices import inverse, solved
from dem_cli.core.kernels.records import Joints, StrainRates
from dem_cli.core.model.mode_masses import mass_matrices
from dem_cli.core.model.model import NO_MODES, Model
from dem_cli.core.model.uniform_strain import rotations_of, turned_mode_loads
from dem_cli.core.records.requests import MaxwellRequest


@dataclass(frozen=True)
class Damping:
    """Damping coefficients: of joints, of masses, local, and of Maxwell elements."""

    fraction: float = 0.0  # of critical, each joint at its own frequency
    stiffness: float = 0.0  # damping over stiffness of all joints [s]
    mass: float = 0.0  # [1/s]
    local: float = 0.0
    elements: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))  # as `element_numbers`
    words: str = "none"  # for users

    @property
    def in_joints(self) -> bool:
        """Test whether joints have anything but springs."""
        return self.fraction > 0.0 or self.stiffness > 0.0 or len(self.elements) > 0

    @property
    def stiffening(self) -> float:
        """Factor by which Maxwell elements, whose springs lie beside those of the joints, raise frequencies."""
        return math.sqrt(1.0 + float(self.elements[:, 0].sum()))

    def viscosities(self, model: Model, joints: Joints) -> np.ndarray:
        """Return damping over stiffness of each joint [s], (n_joints,): 2 ζ/ω, ω² = kn A/M with the reduced mass M."""
        found = np.full(len(joints.blocks), self.stiffness)
        if self.fraction > 0.0 and len(found):
            frequencies = joint_frequencies(model, joints)
            held = frequencies > 0.0  # in space a joint may have no point yet: what will be there is like the others
            frequencies[~held] = np.median(frequencies[held]) if held.any() else np.inf
            found += 2.0 * self.fraction / frequencies
        return found


def joint_frequencies(model: Model, joints: Joints) -> np.ndarray:
    """Compute √(K/M) of each joint [rad/s]: K all its normal springs, M the reduced mass of its blocks,
    (n_joints,)."""
    lightness = np.where(model.fixed, 0.0, 1.0 / model.masses)[joints.blocks].sum(axis=1)
    return np.sqrt(np.add.reduceat(joints.kn, joints.starts[:-1]) * lightness)


def element_numbers(elements: tuple[MaxwellRequest, ...]) -> np.ndarray:
    """Return stiffness over that of the joint [-] and rate [1/s] of each Maxwell element, (n, 2).

    At its own frequency an element of stiffness share r loses r/2 of the joint's stiffness in quadrature: ratio r/4,
    over the joint's stiffness alone.
    """
    return np.array([[4.0 * e.ratio, 2.0 * math.pi * e.frequency] for e in elements]).reshape(-1, 2)


def strain_rates(model: Model, damping: Damping, dt: float) -> StrainRates:
    """Build the damped mass and stiffness of strain rates of all blocks, for steps of dt [s]; empty where all are
    rigid.

    Blocks are damped as joints are: in proportion to mass and stiffness, and each mode by a fraction of critical at
    its own frequency √(K/M). Damping is solved within the step, with all modes of a block, so that it limits no step.
    """
    r, m = model.inertias.shape[1], model.n_modes
    if not m:
        nothing = np.zeros((0, 0, 0))
        return StrainRates(nothing, nothing, NO_MODES, nothing, nothing, nothing, np.zeros(0), NO_MODES)
    whole = mass_matrices(model)
    turns = solved(whole[:, :r, :r], whole[:, :r, r:])
    masses = whole[:, r:, r:] - product(whole[:, r:, :r], turns)
    stiffness = model.mode_stiffness
    diagonal = np.diagonal(masses, axis1=1, axis2=2)
    viscosity = damping.stiffness * stiffness + 2.0 * damping.fraction * np.sqrt(stiffness * diagonal)
    lost = 0.5 * dt * (damping.mass * masses + viscosity[:, :, None] * np.eye(m))
    mobile = inverse(masses + lost)
    moving = (stiffness > 0.0)[:, :, None]
    parts = product(mobile, masses - lost), dt * mobile, mobile  # impulses of dashpots are of the same step
    keep, gain, mobilities = (np.ascontiguousarray(np.where(moving, part, 0.0)) for part in parts)
    bends = model.mode_shapes.reshape(len(model.mode_shapes), 72)
    radii = model.shapes.radii
    return StrainRates(np.ascontiguousarray(turns), masses, viscosity, keep, gain, mobilities, radii, bends)


def turned_loads(strained: StrainRates, loads: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Compute loads on blocks (n_blocks, n_dof) that have turned by now, where velocities are mean spins.

    Forces and levers stay as they are drawn, which the block sees from elsewhere; −Wᵀ τ more on its modes. turns: as
    kernels.records.Bodies.
    """
    if not strained.turns.size:
        return loads
    r, m = strained.turns.shape[1:]
    rotations, torques = rotations_of(turns), loads[:, -m - r : -m]
    if r == 3:
        torques = np.einsum("nji,nj->ni", rotations, torques)
    found = loads.copy()
    found[:, -m:] = turned_mode_loads(loads[:, -m:], rotations) - np.einsum("nrm,nr->nm", strained.turns, torques)
    return found
