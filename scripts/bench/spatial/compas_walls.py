"""Structures of boxes in compas_cra: rigid-block equilibrium (RBE), tilted until it needs tension.

RBE asks for forces on the corners of the joints, within an eight-sided pyramid around the cone of friction, that
balance the weights; it punishes tension. Its highest load is the associated one, not less: statics alone, no flow rule.
Gravity cannot be tilted, so the structure is turned the other way.
"""

from __future__ import annotations

import contextlib
import io
from typing import Any

import numpy as np

from bench.spatial.boxes import Boxes
from bench.tilting import LOWEST_LOAD, TWICE

NAME, PACKAGE = "compas_cra", "compas_cra"
TENSIONS = (1e-5, 1e-4)  # × largest compression: a structure that needs more does not stand
SMALLEST_JOINT = 1e-3  # × the smallest edge squared
# corners of a box by the sign of their places, and its faces seen from outside
SIGNS = np.array([(x, y, z) for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
FACES = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]


def setting(tension: float) -> str:
    """What a setting is called."""
    return f"RBE, tension below {tension:g}"


class RigidAssembly:
    """Blocks with their interfaces, which compas_cra finds once."""

    def __init__(self, boxes: Boxes, friction: float, direction: tuple[float, float]):
        from compas_cra.algorithms import assembly_interfaces_numpy
        from compas_cra.datastructures.cra_assembly import Block, CRA_Assembly

        self.friction, self.angle = friction, 0.0
        x, y = np.array(direction) / np.hypot(*direction)
        self.axis = [-float(y), float(x), 0.0]  # about which what pointed along `direction` turns down
        self.assembly = CRA_Assembly()
        for centre, size in zip(boxes.centres, boxes.sizes, strict=True):
            self.assembly.add_block(Block.from_vertices_and_faces((centre + 0.5 * size * SIGNS).tolist(), FACES))
        self.assembly.set_boundary_conditions(np.flatnonzero(boxes.fixed).tolist())
        smallest = SMALLEST_JOINT * boxes.smallest_edge**2
        with contextlib.redirect_stdout(io.StringIO()):  # it prints the size of every matrix
            assembly_interfaces_numpy(self.assembly, nmax=len(boxes.fixed), amin=smallest)

    def needed_tension(self, load: float) -> float:
        """Largest tension over the largest compression under gravity with a horizontal part of `load` times it."""
        from compas_cra.equilibrium import rbe_problem
        from compas_cra.nlp import solve_nlp

        angle = float(np.arctan(load))
        with contextlib.redirect_stdout(io.StringIO()):
            self.assembly.rotate_assembly([0.0, 0.0, 0.0], self.axis, angle - self.angle, is_rad=True)
            self.angle = angle
            problem, _ = rbe_problem(self.assembly, mu=self.friction)
            found: Any = solve_nlp(problem, backend="native")
        if not found.success:
            return float("inf")
        return float(found.x[1::4].max() / found.x[0::4].max())


def failure_load(
    boxes: Boxes, friction: float, direction: tuple[float, float], tension: float, resolution: float
) -> dict[str, Any]:
    """Highest load that RBE balances with less than that tension, the lowest above it, and the trials."""
    assembly = RigidAssembly(boxes, friction, direction)
    low, high, trials = 0.0, TWICE * friction, 0
    while high - low > resolution * max(low, LOWEST_LOAD):
        middle = 0.5 * (low + high)
        trials += 1
        if assembly.needed_tension(middle) < tension:
            low = middle
        else:
            high = middle
    return {"load": low, "bracket": [low, high], "trials": trials}
