"""Creep: the displacement of the live load grows at a prescribed rate, and its multiplier is found as a reaction."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dem_cli.core.records.ports import stage

if TYPE_CHECKING:
    from dem_cli.core.engine.simulation import Simulation


class _Looks:
    """Progress of a creep: looks done, looks in balance in a row, and the loads that were seen."""

    def __init__(self) -> None:
        self.done, self.calm = 0, 0
        self.loads: list[float] = []


@stage
def creep_evenly(sim: Simulation, steps: int, looks: int) -> list[float]:
    """Creep at the prescribed rate, of so many steps to each look; returns the mean internal multiplier of each."""
    way = _Looks()
    sim.stages.resumed(way)
    while way.done < looks:
        sim.stages.offer(way)
        sim.advance(steps, sim.creep_mode)
        way.done += 1
        way.loads.append(sim.mean_load)
    return way.loads


@stage
def creep_to_rest(sim: Simulation, looks: int) -> bool:
    """End a creep at rate zero; returns whether it comes to an equilibrium."""
    relaxation, way = sim.settings.relaxation, _Looks()
    sim.stages.resumed(way)
    while way.done < looks:
        sim.stages.offer(way)
        sim.advance(relaxation.chunk, sim.creep_mode)
        way.done, way.calm = way.done + 1, way.calm + 1 if sim.unbalanced < relaxation.tolerance else 0
        if way.calm == relaxation.looks_at_rest:
            return True
    return False
