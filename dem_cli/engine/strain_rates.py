"""Strains of blocks in a time history, in numbers: masses beside the mean spin, damping, and what a step makes of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.geometry.rotation import matrices
from dem_cli.kernels.records import StrainRates
from dem_cli.model.mode_masses import mass_matrices
from dem_cli.model.model import NO_MODES, Model

if TYPE_CHECKING:
    from dem_cli.engine.viscous import Damping


def strain_rates(model: Model, damping: Damping, dt: float) -> StrainRates:
    """Of all blocks, for steps of dt [s]; empty where all are rigid.

    Blocks are damped as joints are: in proportion to mass and stiffness, and each mode by a fraction of critical at
    its own frequency √(K/M). Damping is solved within the step, with all modes of a block, so that it limits no step.
    """
    r, m = model.inertias.shape[1], model.n_modes
    if not m:
        nothing = np.zeros((0, 0, 0))
        return StrainRates(nothing, nothing, NO_MODES, nothing, nothing, nothing, np.zeros(0), NO_MODES)
    whole = mass_matrices(model)
    turns = np.linalg.solve(whole[:, :r, :r], whole[:, :r, r:])
    masses = whole[:, r:, r:] - whole[:, r:, :r] @ turns
    stiffness = model.mode_stiffness
    diagonal = np.diagonal(masses, axis1=1, axis2=2)
    viscosity = damping.stiffness * stiffness + 2.0 * damping.fraction * np.sqrt(stiffness * diagonal)
    lost = 0.5 * dt * (damping.mass * masses + viscosity[:, :, None] * np.eye(m))
    inverse = np.linalg.inv(masses + lost)
    moving = (stiffness > 0.0)[:, :, None]
    parts = inverse @ (masses - lost), dt * inverse, np.linalg.inv(masses)
    keep, gain, mobilities = (np.ascontiguousarray(np.where(moving, part, 0.0)) for part in parts)
    bends = model.mode_shapes.reshape(len(model.mode_shapes), 72)
    radii = model.shapes.radii
    return StrainRates(np.ascontiguousarray(turns), masses, viscosity, keep, gain, mobilities, radii, bends)


def turned_loads(strained: StrainRates, loads: np.ndarray, orientations: np.ndarray) -> np.ndarray:
    """Loads on blocks (n_blocks, n_dof) whose velocities are mean spins: −Wᵀ τ more on their modes."""
    if not strained.turns.size:
        return loads
    r, m = strained.turns.shape[1:]
    torques = loads[:, -m - r : -m]
    if r == 3:
        torques = np.einsum("nji,nj->ni", matrices(orientations), torques)
    found = loads.copy()
    found[:, -m:] -= np.einsum("nrm,nr->nm", strained.turns, torques)
    return found
