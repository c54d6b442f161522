"""Automatic stiffness, kn = "auto", with large displacements: share of its load that a structure loses by leaning
(P-Δ).

A lateral load λ turns the joint on level j by M/K, the weight W above it moves with that, and its moment comes on top
of the first. To first order a stack of blocks on joints of rotational stiffness K loses the share

    Δλ/λ = Σ (Wⱼ yⱼ)²/Kⱼ / (W₀ y₀),      Kⱼ = Σ k (x − x̄)² of all points on the level,

y being the height of the centroid of what is above the joint; n equal blocks of height h and weight W lose n³ h W/10 K,
and fall by their own weight at 0.78 of that scale, n³ h W/K = 7.84 (Greenhill 1881). Two points at the ends of a joint
of width c and area A have K = kn A c²/4: slender blocks, and profiles, whose sides are narrow, lose most.

Where closure is taken back whenever the structure rests (engine/rigid_joints.py), a load that is held is that of rigid
blocks whatever the stiffness; this share is then what the *next* load may cost of what it is more than the last one,
and needs only be far from buckling. Where it is not (joints that bond) the share itself has to be small.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.links.matrices import stiffest
from dem_cli.core.model.scales import levels, mean_weight, origin_of, smallest_edge, stiffness_scale, structures

if TYPE_CHECKING:
    from dem_cli.core.engine.settings import AutomaticStiffness
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.model.model import Model


def ratio_of(sim: Simulation) -> float:
    """Return the stiffness ratio kn·h/W of the "auto" joints of a simulation; 0: it has none."""
    return float(sim.properties.kn[sim.properties.rigid].max(initial=0.0) / stiffness_scale(sim.model))


def static_ratio(model: Model, kinematics: str, stiffness: AutomaticStiffness) -> float:
    """Return kn·h/W of "auto" joints of a static analysis; large displacements may need more (`needed_ratio`).

    Where it is that of the start, joints only have to be stiff: a weight sinks by h/(kn·h/W), and coordinates of a
    structure of size L tell 2e-16 L apart. Beside ties and bars they are stiff enough when these give way by far more:
    steps are those of the joints, and a tie whose frequency is a thousandth of theirs takes a thousand times as many to
    come to rest.
    """
    if kinematics != "fixed":
        return stiffness.statics
    free = ~model.fixed
    size = float(
        (np.abs(model.centroids[free] - origin_of(model)).max(axis=1) + model.shapes.radii[free]).max(initial=0.0)
    )
    if size == 0.0:
        return stiffness.fixed
    ratio = min(stiffness.fixed, stiffness.digits * smallest_edge(model) / (np.finfo(float).eps * size))
    if not model.links:
        return ratio
    weight = mean_weight(model.dead_loads[free], model.live_loads[free], model.dimension)
    beside = stiffness.beside_links * stiffest(model.links) * smallest_edge(model) / weight
    return min(ratio, max(stiffness.statics, beside))


def needed_ratio(sim: Simulation, resolution: float | None = None) -> float:
    """Return the kn·h/W on which a structure like this leans no further than settings say, at least its own.

    resolution: of the load, relative; None: no load is sought. Not stiffer than round-off allows: coordinates are known
    to 2e-16 of the size L of the structure, so that forces on a block with a smallest edge s balance to about
    kn·h/W 2e-16 L/s of its weight, no better.
    """
    stiffness, relief, tolerance = sim.settings.stiffness, sim.settings.relief, sim.settings.relaxation.tolerance
    allowed = stiffness.leaning
    if resolution is None:
        allowed = stiffness.leaning_at_once
    elif not sim.takes_back:
        allowed = relief.of_resolution * resolution
    size = float(np.abs(sim.bodies.corners).max(initial=sim.smallest))
    stiffest = stiffness.noise * tolerance * sim.smallest / (np.finfo(float).eps * size)
    ratio = ratio_of(sim)
    return max(ratio, min(ratio * leaning(sim) / allowed, stiffest))


def shown_closure(sim: Simulation, resolution: float | None = None) -> float:
    """Return the share of their closure that "auto" joints may show in an equilibrium; resolution: of a load,
    relative."""
    relief = sim.settings.relief
    if resolution is None or sim.leans == 0.0:
        return relief.shown
    return min(relief.shown, relief.of_resolution * resolution / sim.leans)


def leaning(sim: Simulation) -> float:
    """Estimate the share of its failure load that the most sensitive structure loses by leaning over "auto" joints
    (see above)."""
    model, blocks, y = sim.model, sim.joints.blocks, sim.model.dimension - 1
    if not (len(blocks) and sim.properties.rigid.any()):
        return 0.0
    stiffness, places = _rotational(sim, _overturning(sim))
    touches = stiffness > 0.0
    level = levels(blocks[touches], model.fixed)
    structure = structures(blocks[touches], model.fixed)
    free = np.where(model.fixed[blocks[:, 0]], blocks[:, 1], blocks[:, 0])
    climbs = touches & (level[blocks[:, 0]] != level[blocks[:, 1]]) & (level[free] >= 0)
    weights, heights = np.maximum(-sim.loads.dead[:, y], 0.0), sim.bodies.positions[:, y]
    shares = [0.0]
    for one in np.unique(structure[free[climbs]]):
        stands, joints = (structure == one) & (level > 0), climbs & (structure[free] == one)
        beds = Beds(level[blocks[joints]].min(axis=1), stiffness[joints], places[joints])
        shares.append(_share(level[stands], weights[stands], heights[stands], beds))
    return max(shares)


class Beds(NamedTuple):
    """Joints from one level of a structure to the next."""

    lower: np.ndarray  # level that they stand on, (n,)
    stiffness: np.ndarray  # rotational [N m], (n,)
    heights: np.ndarray  # [m], (n,)


def _overturning(sim: Simulation) -> np.ndarray | None:
    """Unit vector along the horizontal axis about which the live load overturns, (3,); None: any, or in the plane."""
    pushed = sim.loads.live[sim.free, : sim.model.dimension].sum(axis=0)
    level = float(np.hypot(*pushed[:2]))
    if len(pushed) < 3 or level <= 1e-9 * float(np.abs(sim.loads.live).max(initial=0.0)):
        return None
    return np.array([-pushed[1], pushed[0], 0.0]) / level


def _rotational(sim: Simulation, axis: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
    """Rotational stiffness [N m] and height [m] of each joint; 0: it touches at one point or none, infinite: given.

    axis: about which; None: in space the horizontal one about which it is least.
    """
    joints, y = sim.joints, sim.model.dimension - 1
    starts, owners = joints.starts[:-1], joints.owners
    kn = np.where(sim.contacts.gaps <= 0.0, joints.kn, 0.0)[:, None]
    whole = np.maximum(np.add.reduceat(kn, starts), np.finfo(float).tiny)
    middle = np.add.reduceat(kn * joints.points, starts) / whole
    arms = joints.points - middle[owners]
    stiffness = np.add.reduceat(kn[:, 0] * (arms**2).sum(axis=1), starts)
    if arms.shape[1] > 2:
        stiffness = stiffness - _along(kn[:, 0], arms, starts, axis)
        stiffness[stiffness <= 1e-9 * np.add.reduceat(kn[:, 0] * (arms**2).sum(axis=1), starts)] = 0.0
    given = ~sim.properties.rigid_between(sim.model, joints.blocks)
    return np.where(given & (stiffness > 0.0), np.inf, stiffness), middle[:, y]


def _along(kn: np.ndarray, arms: np.ndarray, starts: np.ndarray, axis: np.ndarray | None) -> np.ndarray:
    """Σ kn (arm along the axis)² of each joint in space [N m], which does not help about that axis; None: the most."""
    if axis is not None:
        return np.add.reduceat(kn * product(arms, axis) ** 2, starts)
    xx, yy, xy = (np.add.reduceat(kn * arms[:, i] * arms[:, j], starts) for i, j in ((0, 0), (1, 1), (0, 1)))
    return 0.5 * (xx + yy) + np.hypot(0.5 * (xx - yy), xy)


def _share(level: np.ndarray, weights: np.ndarray, heights: np.ndarray, beds: Beds) -> float:
    """Compute the share of load lost by one structure: level, weight [N] and height [m] of its blocks, (n,) each."""
    turned, overturning = 0.0, 0.0
    for lower in range(int(level.max(initial=0))):
        above, here = level > lower, beds.lower == lower
        weight, stiffness = float(weights[above].sum()), float(beds.stiffness[here].sum())
        if weight > 0.0 and stiffness > 0.0:
            arm = float((weights[above] * heights[above]).sum()) / weight - float(beds.heights[here].mean())
            moment = weight * max(arm, 0.0)
            turned, overturning = turned + moment**2 / stiffness, max(overturning, moment)
    return turned / overturning if overturning > 0.0 else 0.0
