"""Joint state of a simulation in few numbers, for summary.json: open joints, widest crack, largest stress."""

from __future__ import annotations

from typing import Any

import numpy as np

from dem_cli.core.contact.drawn_joints import OPEN, DrawnJoints
from dem_cli.core.engine import measures
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.links.matrices import each
from dem_cli.core.model.model import MOTIONS

SECTIONS = {"tie": "ties", "reinforcement": "bars"}  # kind of link: key of the summary
LAST_EQUILIBRIUM, END = "last equilibrium", "end"


def joint_state(sim: Simulation, instant: str) -> dict[str, Any]:
    """Return the state of the joints as they were drawn; instant: in words. With the two blocks of each largest
    value."""
    joints = DrawnJoints(sim.model)
    positions = sim.bodies.positions + sim.origin
    ids = sim.model.block_ids
    if not len(joints.places.area):
        return {"at": instant, "joints": 0, "open": 0} | _beside(sim)
    states = joints.at(positions, sim.bodies.orientations, measures.contact_record(sim)).states

    def largest(values: np.ndarray) -> dict[str, Any]:
        k = int(values.argmax())
        return {"value": float(values[k]), "between": [ids[block] for block in joints.places.blocks[k]]}

    found: dict[str, Any] = {"at": instant, "joints": len(states.state), "open": int((states.state == OPEN).sum())}
    return found | {
        "crack_width": largest(states.crack_width),
        "slip": largest(np.abs(states.slip)),
        "normal_stress": largest(states.normal_stress),
        "shear_stress": largest(np.abs(states.shear_stress)),
        **_beside(sim),
    }


def _beside(sim: Simulation) -> dict[str, Any]:
    """Return the forces of ties, bars and restraints, which act on blocks beside joints."""
    return _links(sim) | _restraints(sim)


def _restraints(sim: Simulation) -> dict[str, Any]:
    """Return the reactions of restraints on each block, forces [N] and moments [N m]; empty without any."""
    model = sim.model
    if not len(model.restrained):
        return {}
    given, names = measures.reactions(sim), MOTIONS[model.dimension]
    said = {
        model.block_ids[k]: {name: float(given[k, i]) for i, name in enumerate(names) if model.restrained[k, i]}
        for k in np.flatnonzero(model.restrained.any(axis=1)).tolist()
    }
    return {"restraints": said}


def _links(sim: Simulation) -> dict[str, Any]:
    """Return the answer of each link by its name, ties and bars apart; empty where there are none."""
    said: dict[str, dict[str, Any]] = {}
    for link, number, name in each(sim.links, sim.model.link_names):
        said.setdefault(SECTIONS[link.kind], {})[name] = link.answer(number)
    return said
