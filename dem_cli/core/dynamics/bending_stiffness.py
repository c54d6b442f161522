"""Bending stiffness of soft joints in time histories: their points at the ends are too stiff, and where that matters.

Blocks land on the ends of their joints, as rigid ones do: points between them take part of the blow. But two points
resist bending three times as much as the area of a joint does. How much bending counts is the angle ε by which blocks
turn on their joints when their weight acts sideways (dynamics/rocking_stiffness.py).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.contact.start import bodies_at_rest, joints_of_start
from dem_cli.core.dynamics.rocking_stiffness import rigid_but, turn_sideways
from dem_cli.core.engine.properties import joint_properties
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.model.model import Model
from dem_cli.core.model.scales import origin_of, smallest_edge

if TYPE_CHECKING:
    from dem_cli.core.records.requests import SolverRequest

SOFTER = 10.0  # times that blocks turn further with points of bending, which are three times as soft, at the very most


def bending_doubts(request: SolverRequest, model: Model, settings: Settings = DEFAULT) -> list[str]:
    """Warn of joints whose stiffness is a property, and that have points at their ends although bending counts.

    None where it is given how many points they have, or where blocks hardly turn further with those of bending.
    """
    ratio = settings.stiffness.dynamics
    ends, bending = (joint_properties(request, model, ratio, lands=lands, integrates=False) for lands in (True, False))
    soft = np.array([one != other for one, other in zip(ends.layouts, bending.layouts, strict=True)])
    if not soft.any() or model.fixed.all():
        return []
    turns = []
    for properties in (ends, bending):
        joints = joints_of_start(
            model, bodies_at_rest(model, origin_of(model)), properties, smallest_edge(model)
        ).joints
        if not len(joints.kn):
            return []
        own = soft[properties.between(model, joints.blocks)][joints.owners]
        turns.append(turn_sideways(model, rigid_but(joints, own), settings))
        if SOFTER * turns[0] <= settings.rocking.doubtful:
            return []
    if turns[1] - turns[0] <= settings.rocking.doubtful:
        return []
    first, where = int(soft.argmax()), "its two ends" if model.dimension == 2 else "the corners of its area"
    name, points = ends.names[first], bending.plane[first].points
    return [
        f"joint '{name}' has its points at {where}, on which blocks land as rigid ones do, and bends too little: "
        f"blocks turn by {turns[0]:.2g} rad when their weight acts sideways, with points = {points} by {turns[1]:.2g}; "
        f"give points = {points} where vibrations count, points = 2 where blows do"
    ]
