"""Contents of an exported case: exact blocks as drawn, and the loads on them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.core.geometry import polyhedron
from dem_cli.core.model.blocks import Block

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.core.model.model import Model


NOT_CARRIED = (
    "settlement",
    "motion",
    "imperfection",
    "strain",
    "tie",
    "restraint",
)  # tables that no other program gets


class ExportedBlock(NamedTuple):
    """Block of an exported case in space; a planar block becomes an upright prism around y = 0."""

    name: str
    material: str
    fixed: bool
    parts: tuple[polyhedron.Polyhedron, ...]


class ExportedCase:
    """Case prepared for export: solids in space, forces, and what no export carries."""

    def __init__(self, case: Case, model: Model, blocks: Sequence[Block], name: str):
        self.case, self.model, self.blocks, self.name = case, model, blocks, name

    @cached_property
    def solids(self) -> list[ExportedBlock]:
        """All blocks in space, in the order of the model."""
        return [ExportedBlock(block.id, block.material, block.fixed, self._in_space(block)) for block in self.blocks]

    def _in_space(self, block: Block) -> tuple[polyhedron.Polyhedron, ...]:
        if self.case.dimension == 3:
            return block.parts
        half = block.thickness / 2.0
        return tuple(polyhedron.prism(part, -half, half) for part in block.parts)

    @cached_property
    def forces(self) -> tuple[np.ndarray, np.ndarray]:
        """Dead and live forces and moments about the centroids beside self-weight, (n_blocks, n_dof) each."""
        model, d = self.model, self.case.dimension
        dead = model.dead_loads.copy()
        dead[:, d - 1] += model.masses * self.case.gravity
        dead[np.abs(dead) <= 1e-9 * np.abs(model.dead_loads).max(initial=0.0)] = 0.0
        return dead, np.zeros_like(dead) if self.leans else model.live_loads.copy()

    @property
    def left_out(self) -> list[str]:
        """List what no export carries: tables, joints within stones and in heads, friction of each joint."""
        tables = [f"[[{key}]]" for key in NOT_CARRIED if getattr(self.case, key, None)]
        joints = dict.fromkeys(block.crack for block in self.blocks if block.crack)
        return [
            *tables,
            *(f"joint '{name}' within stones: pieces have that of their materials" for name in joints),
            *(f"joint '{name}': heads are like beds" for name, one in self.case.joints.items() if one.head),
            *(
                f"joint '{name}': friction is its mean everywhere"
                for name, one in self.case.joints.items()
                if getattr(one, "variation", 0.0)
            ),
        ]

    @property
    def deforms(self) -> bool:
        """Tell whether blocks of any material deform."""
        return any(
            material.young is not None and material.deformation != "none" for material in self.case.materials.values()
        )

    @property
    def leans(self) -> bool:
        """Tell whether the live load is a share of the weight along a direction."""
        return getattr(self.case.analysis, "pattern", None) == "mass"

    @property
    def lean(self) -> np.ndarray:
        """Direction of the acceleration that the load multiplier adds to gravity, unit or zero, (d,)."""
        if not self.leans:
            return np.zeros(self.case.dimension)
        direction = np.array(self.case.analysis.direction, float)
        return direction / np.linalg.norm(direction)


def triangles(solid: polyhedron.Polyhedron) -> np.ndarray:
    """Triangulate the faces of a convex polyhedron, counter-clockwise seen from outside, (n, 3)."""
    return np.array([(loop[0], a, b) for loop in solid.faces for a, b in zip(loop[1:-1], loop[2:])])


def number(value: float) -> str:
    """Format a number exactly, so that it is read back to the last bit."""
    return repr(float(value) + 0.0)  # no negative zero


def triple(point: np.ndarray, between: str = " ") -> str:
    """Format coordinates exactly, so that they are read back to the last bit."""
    return between.join(number(value) for value in point)
