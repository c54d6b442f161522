"""Energy that mass-proportional damping takes from blocks that rock, slide or fall (braked motion).

It resists velocities, whatever makes them: that of rigid blocks on joints that have opened as well as vibration. Who
asks for a ratio of critical means vibration, and a rocking block that lands late or falls half as far is a surprise.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.contact.drawn_joints import DrawnJoints
from dem_cli.core.engine import measures

if TYPE_CHECKING:
    from dem_cli.core.engine.dynamic import DynamicSimulation
    from dem_cli.core.records.history_rows import Energy
    from dem_cli.core.records.requests import DampingRequest


class BrakedMotion:
    """Energy that mass damping took while joints were open or had slipped, look by look."""

    LASTING = frozenset(("_joints",))

    def __init__(self, sim: DynamicSimulation):
        self.energy = 0.0  # [J]
        self._before, self._loose = 0.0, False
        self._joints = DrawnJoints(sim.model) if sim.damping.mass > 0.0 else None

    def look(self, sim: DynamicSimulation) -> None:
        """Add the energy that damping took since the last look, where joints were loose then or are now."""
        if self._joints is None:
            return
        loose, taken = self._loosened(self._joints, sim), measures.energy(sim).mass_damping
        if loose or self._loose:
            self.energy += taken - self._before
        self._before, self._loose = taken, loose

    def _loosened(self, joints: DrawnJoints, sim: DynamicSimulation) -> bool:
        """Test whether a joint opened or slipped by more than joints deform, or a block without joints moved so
        far."""
        least = sim.settings.history.noticeable * sim.smallest
        alone = sim.free[~np.isin(sim.free, joints.places.blocks)]
        ways = [np.abs(measures.displacements(sim)[alone])]
        if len(joints.places.area):
            states = joints.at(
                sim.bodies.positions + sim.origin, sim.bodies.orientations, measures.contact_record(sim)
            ).states
            ways += [states.crack_width, np.abs(states.slip)]
        return any(bool((way > least).any()) for way in ways)

    def share(self, sim: DynamicSimulation, books: Energy) -> float:
        """Return the share of the losses, or of the largest kinetic energy if that is more, that mass damping took
        [-]."""
        whole = max(measures.taken(books), sim.most_kinetic)
        return self.energy / whole if whole > 0.0 else 0.0


def braked_words(damping: DampingRequest, share: float, runs: str = "") -> str:
    """Write the warning that mass-proportional damping took so much energy; runs: of which, where there are many."""
    rayleigh = damping.rayleigh
    if rayleigh is None or not rayleigh.mass:
        remedy = "without damping.mass they move freely"
    elif rayleigh.two_frequencies:
        remedy = "rayleigh with one 'frequency' damps vibration alone"
    else:
        remedy = "rayleigh without its part of mass damps vibration alone"
    return (
        f"mass-proportional damping took {100.0 * share:.0f} % of the energy of blocks that rock, slide or fall{runs}: "
        f"they land late and move less far; {remedy}"
    )
