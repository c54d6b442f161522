"""Collapse criterion: test whether a shaken structure has collapsed, or its energy and numbers are invalid."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.core.dynamics.supports import lost_supports
from dem_cli.core.engine import measures
from dem_cli.core.engine.measures import closure
from dem_cli.core.geometry.rotation import leans_of
from dem_cli.errors import SolverError

if TYPE_CHECKING:
    from dem_cli.core.dynamics.time_step import TimeStep
    from dem_cli.core.engine.dynamic import DynamicSimulation
    from dem_cli.core.records.history_rows import Energy
    from dem_cli.core.records.requests import ShakingRequest


class CollapsedBlock(NamedTuple):
    """Block that collapsed first, with the time and how it fell."""

    block: str
    time: float  # [s]
    how: str


def fallen(sim: DynamicSimulation, analysis: ShakingRequest) -> CollapsedBlock | None:
    """Return the block that turned or sank farthest beyond the limits, or lost its support; None where none did."""
    for values, limits, word, unit in _measured(sim, analysis):
        over = values - limits
        if len(over) and over.max() > 0.0:
            k = int(over.argmax())
            return CollapsedBlock(sim.model.block_ids[sim.free[k]], sim.time, f"{word} {values[k]:.3g}{unit}")
    return None


def fallen_blocks(sim: DynamicSimulation, analysis: ShakingRequest) -> np.ndarray:
    """Numbers of all blocks that turned or sank beyond the limits or lost their support, ascending."""
    over = [values > limits for values, limits, _, _ in _measured(sim, analysis)]
    return sim.free[np.any(over, axis=0)]


def _measured(sim: DynamicSimulation, analysis: ShakingRequest) -> list[tuple[np.ndarray, np.ndarray, str, str]]:
    """Compute the measures of a fall of the free blocks: values, limits, the verb for a message and a unit."""
    free, d = sim.free, sim.model.dimension
    leans = np.degrees(leans_of(sim.bodies.orientations[free]))
    sank = sim.reference_positions[free, d - 1] - sim.bodies.positions[free, d - 1]
    drops = least = np.full(len(free), analysis.dropped or 0.0)
    if analysis.dropped is None:
        drops, least = sim.widths[free], sim.settings.history.sinks * sim.widths[free]
    return [
        (leans, np.full(len(free), analysis.fallen_deg), "turned by", "°"),
        (sank, drops, "sank by", " m"),
        (lost_supports(sim, least), least, "lost its support and sank by", " m"),
    ]


def check_energy(sim: DynamicSimulation, step: TimeStep, energy: Energy | None = None) -> None:
    """Raises SolverError where the motion creates energy. energy: the energy balance of this instant, if known."""
    energy = energy or measures.energy(sim)
    sim.note_kinetic_energy(energy.kinetic)
    error = closure(sim, energy)
    if abs(error) > sim.settings.history.blow_up and energy.kinetic > sim.noticeable_energy:
        block = sim.model.block_ids[_fastest(sim)]
        known = f"the step {step.step:.3g} s is {step.step / step.limit:.0%} of the limit of the joints of the start"
        advice = f"{known}, lower analysis.margin" if np.isfinite(step.limit) else "give a smaller analysis.time_step"
        raise SolverError(
            f"blew up at {sim.time:.4g} s: {error:.0%} of the energy came from nowhere, block '{block}' is the "
            f"fastest; {advice}"
        )


def check_finite(sim: DynamicSimulation) -> None:
    """Raises SolverError that names time and block where a number is not finite."""
    bad = ~np.isfinite(sim.bodies.velocities).all(axis=1)
    if bad.any():
        name = sim.model.block_ids[int(np.flatnonzero(bad)[0])]
        raise SolverError(f"the motion of block '{name}' is not a number at {sim.time:.4g} s: lower analysis.margin")


def _fastest(sim: DynamicSimulation) -> int:
    """Return the block with the largest velocity of a corner."""
    d, velocities = sim.model.dimension, sim.bodies.velocities
    speeds, spins = (np.linalg.norm(part, axis=1) for part in (velocities[:, :d], velocities[:, sim.model.rotations]))
    return int((speeds + sim.shape.radii * spins).argmax())
