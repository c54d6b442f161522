"""Rigid joints by augmented Lagrangian contact: elastic closure of "auto" joints is taken back where blocks rest.

The stiffness of an "auto" joint is a means and no property: it says how the solver finds forces, not how far a block
sinks. Where geometry moves, sinking is not harmless all the same: blocks lean over their joints, the weight gets a
lever, and the load is lost by that (P-Δ; engine/automatic_stiffness.py says how much). Joints that are so stiff that
nothing is lost make the way through gaps long and the last digits of coordinates felt. So the closure is taken back
instead, wherever the structure is at rest (Uzawa's iteration): a point keeps its force N at a gap g of next to none,

    N = kn (c − g),    c ← g + N/kn,

and the blocks go back by the elastic displacements u that they had, found at once from K u = Bᵀ kn d, d being the
closure of the points that press and K their stiffness, with next to none along the joints: what slid elastically goes
back as well. Open points keep the gap that springs gave them, c ← c + Δg, so that the same points press as in fixed
geometry: not what is more than springs do, nor where blocks have gaps beside them, which have to close. Forces stay;
what is left is the change of the levers, some per cent of the first, so that each round leaves a small share of the
lean of the one before: an equilibrium is one of rigid blocks, whatever kn.

Not where joints bond, whose forces hang on their gaps, nor where kn is given. Reference: Simo and Laursen 1992, An
augmented Lagrangian treatment of contact problems involving friction, Computers & Structures 42.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.arithmetic.sparse_systems import solved_symmetric
from dem_cli.core.contact.compatibility import compatibility
from dem_cli.core.engine.placement import moves

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from dem_cli.core.engine.simulation import Simulation


def relieved(sim: Simulation) -> bool:
    """Test whether rigid joints show no closure; else it is taken back, and the structure has to come to rest
    again."""
    points = rigid_points(sim)
    shown = unrelieved(sim, points)
    if shown <= sim.shown:
        return True
    take_back(sim, points)
    return unrelieved(sim, points) > sim.settings.relief.gain * shown


def rigid_points(sim: Simulation) -> np.ndarray:
    """Find the contact points that press and whose stiffness is not a property, but "auto"."""
    if not sim.takes_back:
        return np.zeros(0, int)
    rigid = sim.properties.rigid_between(sim.model, sim.joints.blocks)
    return np.flatnonzero(rigid[sim.joints.owners] & (sim.contacts.normal > 0.0))


def unrelieved(sim: Simulation, points: np.ndarray) -> float:
    """Compute the share of elastic closure that geometry shows at these points: root of the energies, about 0 to 1."""
    normal, kn = sim.contacts.normal[points], sim.joints.kn[points]
    whole = float((normal**2 / kn).sum())
    return float(np.sqrt((kn * sim.measured().gaps[points] ** 2).sum() / whole)) if whole > 0.0 else 0.0


def take_back(sim: Simulation, points: np.ndarray) -> None:
    """Move blocks at rest to where they were without the closure of these points.

    Forces stay to the last digit: what cannot go back at one point without closing another one stays for now.
    """
    before = sim.measured().gaps
    moves.shift(sim, motion_that_opens(sim, points, before))
    gaps = sim.measured().gaps
    closure = np.minimum(gaps, 0.0)  # of open points: they stay open
    if len(points) and not sim.play.moved.any():
        sprung = sim.contacts.closure + gaps - before  # by as much as springs opened them, no farther
        elastic = np.median(sim.contacts.normal[points] / sim.joints.kn[points])  # small faces close by far more
        closure = np.where(np.abs(sprung) <= sim.settings.relief.pushed * elastic, sprung, closure)
    closure[points] = gaps[points] + sim.contacts.normal[points] / sim.joints.kn[points]
    sim.contacts.closure[:] = closure
    sim.contacts.gaps[:] = gaps  # the next step goes on from here


def motion_that_opens(sim: Simulation, points: np.ndarray, gaps: np.ndarray) -> np.ndarray:
    """Compute displacements of all blocks that open pressing points by their overlap, (n_blocks, n_dof) [m, rad].

    A block that stands on two points close to each other would turn until both are open, by as much as their distance
    is small, and into its neighbours: points that would be pushed far into overlap are held where they just touch. Zero
    where there is no end of them.
    """
    d, joints, relief = sim.model.dimension, sim.joints, sim.settings.relief
    motion = compatibility(sim.model, joints)
    stiffness = np.column_stack([joints.kn, *[relief.sliding * joints.ks] * (d - 1)])
    stiffness[sim.contacts.normal <= 0.0] = 0.0
    wanted = np.zeros_like(stiffness)
    wanted[points, 0] = -gaps[points]
    room = np.where(sim.contacts.normal > 0.0, np.inf, gaps - sim.contacts.closure)  # until open points touch
    most = relief.pushed * float(np.abs(wanted).max(initial=0.0))
    for _ in range(relief.rounds):
        found = _least_squares(motion, stiffness, wanted, relief.singular)
        pushed = -(motion @ found).reshape(stiffness.shape)[:, 0] - room > most
        if not pushed.any():
            break
        room = np.where(pushed, np.inf, room)
        stiffness[pushed, 0], wanted[pushed, 0] = joints.kn[pushed], sim.contacts.closure[pushed] - gaps[pushed]
    else:
        found = np.zeros_like(found)
    moved = np.zeros_like(sim.bodies.velocities)
    columns = sim.model.rotations.stop
    moved[sim.free, :columns] = found.reshape(-1, columns)
    return moved


def _least_squares(motion: csr_matrix, stiffness: np.ndarray, wanted: np.ndarray, singular: float) -> np.ndarray:
    """Solve for displacements u of least Σ stiffness (motion u − wanted)², (n_columns,); both (n_points, d)."""
    from scipy.sparse import diags

    weighted = motion.T @ diags(stiffness.ravel())
    matrix = (weighted @ motion).tocsc()
    diagonal = matrix.diagonal()
    matrix += diags(singular * np.where(diagonal > 0.0, diagonal, diagonal.max(initial=0.0)))
    return solved_symmetric(matrix, weighted @ wanted.ravel())
