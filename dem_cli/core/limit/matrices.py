"""Equilibrium and compatibility of rigid blocks with the geometry of the start, as sparse matrices; 2D and 3D alike.

Numbering: contact point p has the d rows p·d … p·d + d − 1, its normal first, then its tangents.
Columns are the free degrees of freedom: block by block, translations first, then rotations; fixed blocks have none, and
those of motions that restraints hold are empty: no force acts on them, and nothing moves them.

    w = B u                          motion of b against a at every point: opening (positive), then slides
    Bᵀ r + dead + λ live = 0         equilibrium, r: normal force N (compression positive), then shear force T

The force on block b is N n + T t (n: unit normal from a to b, t: tangents; 2D: n turned by +90°), that on a
the opposite, as in kernels/contact_forces.py. Both are one statement: for any u that leaves the supports
alone, r · (B u) = −(dead + λ live) · u.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix, diags

from dem_cli.core.contact.compatibility import compatibility
from dem_cli.core.kernels.records import Bodies, Joints
from dem_cli.core.laws.envelope import Envelope, envelope
from dem_cli.core.links.matrices import elongations, joined
from dem_cli.core.links.tension_points import TensionPoints, tension_points
from dem_cli.core.model.model import Model
from dem_cli.core.model.scales import own_weights


class Links(NamedTuple):
    """Links of a structure as bounded axial forces; what prestress there was is no matter to a failure load."""

    elongation: csr_matrix  # of each per degree of freedom that is free, (n_links, n_free)
    limits: np.ndarray  # least and largest axial force, tension positive [N], (n_links, 2)

    points: TensionPoints | None  # the same as points of elastic links; None: there are none

    def __bool__(self) -> bool:
        return len(self.limits) > 0

    def as_points(self, dimension: int) -> tuple[csr_matrix, Envelope]:
        """Represent links as contact points without friction that hold tension: rows as of `compatibility`, and
        their strength."""
        n = len(self.limits)
        rows = np.arange(n) * dimension
        place = csr_matrix((np.ones(n), (rows, np.arange(n))), (n * dimension, n))
        least, most = self.limits.T
        return csr_matrix(place @ self.elongation), envelope(n, tension=most, compression=-least)


class LimitStructure(NamedTuple):
    """Structure for limit analysis: compatibility matrix, loads, and the scales that make their numbers comparable."""

    model: Model
    joints: Joints
    free: np.ndarray  # free degrees of freedom in the flattened (n_blocks, n_dof), (n_free,) int64
    compatibility: csr_matrix  # B, (n_points·d, n_free)
    dead: np.ndarray  # dead loads of the free degrees of freedom [N, N m], (n_free,)
    live: np.ndarray  # per unit of the user's multiplier [N, N m], (n_free,)
    scales: np.ndarray  # own weight of the block, times its radius for moments [N, N m], (n_free,)
    bonds: np.ndarray  # points of faces that lie on each other, which a bond can hold, (n_points,) bool
    links: Links  # ties and the like: axial forces that have limits

    @property
    def n_dof(self) -> int:
        """Degrees of freedom of a block."""
        return self.model.dead_loads.shape[1]

    def on_blocks(self, values: np.ndarray) -> np.ndarray:
        """Values at free degrees of freedom as an array of all blocks, zero elsewhere, (n_blocks, n_dof)."""
        whole = np.zeros(self.model.n_blocks * self.n_dof)
        whole[self.free] = np.where(self.model.held_columns, 0.0, values)
        return whole.reshape(-1, self.n_dof)

    def imbalance(self, reactions: np.ndarray, multiplier: float, axial: np.ndarray | None = None) -> np.ndarray:
        """Compute the unbalanced forces, over the own weight of the block (times its radius), (n_free,).

        reactions: N and T at every point [N], (n_points·d,); axial: forces of the links [N], (n_links,).
        """
        forces = self.compatibility.T @ reactions + self.dead + multiplier * self.live
        if axial is not None and self.links:
            forces = forces - self.links.elongation.T @ axial
        return forces / self.scales


def structure_of(
    model: Model, joints: Joints, bonds: np.ndarray | None = None, bodies: Bodies | None = None
) -> LimitStructure:
    """Matrices and loads of a model whose joints are those of the start (contact.start.joints_of_start).

    bonds: as LimitStructure.bonds; None: of all points. bodies: where the blocks are; None: where they start.
    """
    d, n_dof = model.dimension, model.dead_loads.shape[1]
    blocks = np.flatnonzero(~model.fixed)
    free = (blocks[:, None] * n_dof + np.arange(n_dof)).ravel()
    dead, live = model.dead_loads[blocks], model.live_loads[blocks]
    scales = np.repeat(own_weights(dead, live, d)[:, None], n_dof, axis=1) if len(blocks) else np.zeros((0, n_dof))
    scales[:, d:] *= model.shapes.radii[blocks, None]
    bonds = np.ones(len(joints.kn), bool) if bonds is None else bonds
    dead, live = (np.where(model.held[blocks], 0.0, loads) for loads in (dead, live))
    return LimitStructure(
        model, joints, free, compatibility(model, joints), dead.ravel().copy(), live.ravel().copy(), scales.ravel(),
        bonds, links_of(model, bodies),
    )  # fmt: skip


def links_of(model: Model, bodies: Bodies | None = None) -> Links:
    """Collect the links of a model with the bounds of their axial forces; bodies None: as they were drawn."""
    bounded = [link.bounded(bodies) for link in model.links]
    springs = joined((held for held, _ in bounded), model.dead_loads.shape[1])
    limits = np.concatenate([np.zeros((0, 2)), *(limits for _, limits in bounded)])
    elongation = csr_matrix(elongations(springs, model.fixed))
    if len(model.restrained):
        elongation = csr_matrix(elongation @ diags((~model.held_columns).astype(float)))
    return Links(elongation, limits, tension_points(model.links, model.fixed, model.held))
