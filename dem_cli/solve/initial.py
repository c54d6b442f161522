"""[[initial]]: blocks that start tilted, displaced or moving; 2D."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, Pair
from dem_cli.contact.detect import find_joints, world_corners
from dem_cli.contact.start import TOUCH
from dem_cli.errors import CaseError, CaseProblem
from dem_cli.model.assemble import assembly

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.solve.simulation import Simulation


INSIDE = 1e-3  # of the smallest edge: deeper than joints give when they close


class Initial(CaseModel):
    """[[initial]]: how blocks start, once the structure has come to rest."""

    block: str | None = Field(default=None, description="id of a block that can move", examples=["column-1"])
    blocks: Annotated[tuple[str, ...], Field(min_length=1)] | None = Field(
        default=None,
        description="instead of block: ids of several, which are moved as one",
        examples=[["column-7", "column-8"]],
    )
    tilt: float = Field(
        default=0.0,
        gt=-1.6,
        lt=1.6,
        description="turn about the corner on which they then stand, counter-clockwise [rad]",
        examples=[0.1],
    )
    displacement: Pair = Field(default=(0.0, 0.0), description="how far they are moved [m]", examples=[[0.01, 0.0]])
    velocity: tuple[float, float, float] = Field(
        default=(0.0, 0.0, 0.0),
        description="of each centroid [m/s], and of the turn, counter-clockwise [rad/s]",
        examples=[[0.1, 0.0, 0.0]],
    )

    @model_validator(mode="after")
    def _someone(self) -> Initial:
        if (self.block is None) == (self.blocks is None):
            found = "'block' and 'blocks' are" if self.block else "neither 'block' nor 'blocks' is"
            raise ValueError(f"{found} given; one of them says what moves")
        if not (self.tilt or any(self.displacement) or any(self.velocity)):
            raise ValueError("nothing moves; give tilt, displacement or velocity")
        return self

    @property
    def names(self) -> tuple[str, ...]:
        """Ids of all blocks that it moves."""
        return self.blocks if self.blocks is not None else (self.block or "",)


def set_initial(case: Case, sim: Simulation) -> None:
    """Moves the blocks of all [[initial]] tables, one after the other."""
    names, rest = assembly(case).block_map, sim.largest_overlap()
    for table in case.initial:
        chosen = np.array([names[name] for name in table.names])
        if table.tilt:
            _turn(sim, chosen, table.tilt, _pivot(sim, chosen, table.tilt))
        sim.bodies.positions[chosen] += table.displacement
        sim.bodies.velocities[chosen] = table.velocity
        _find_faces(sim)
    _check_apart(case, sim, rest)


def tilt(sim: Simulation, chosen: np.ndarray, angle: float) -> None:
    """Turns blocks as one about the corner on which they then stand, counter-clockwise [rad]."""
    _turn(sim, chosen, angle, _pivot(sim, chosen, angle))
    _find_faces(sim)


def _find_faces(sim: Simulation) -> None:
    """Corners and faces where the blocks are now."""
    bodies = sim.bodies
    bodies.corners[:] = world_corners(sim.shape, bodies.positions, bodies.orientations)
    bodies.travel[:] = np.inf  # wherever they are now, faces are found anew
    sim.detect()


def _check_apart(case: Case, sim: Simulation, rest: float) -> None:
    """Raises CaseError where a block that was moved is inside another, deeper than joints gave before [m]."""
    model, names = sim.model, assembly(case).block_map
    faces = find_joints(model, sim.bodies.corners, 0.0, sim.inner)
    for number in np.flatnonzero(faces.separation < -2.0 * rest - INSIDE * sim.smallest):
        pair = model.part_blocks[faces.parts[number]].tolist()
        tables = [i for i, t in enumerate(case.initial) if {names[name] for name in t.names} & set(pair)]
        if not tables:
            continue
        a, b = (model.block_ids[i] for i in pair)
        message = (
            f"puts blocks '{a}' and '{b}' {-faces.separation[number]:.3g} m into each other; move what is in the way "
            "as well (blocks = [...])"
        )
        raise CaseError([CaseProblem(("initial", tables[-1]), message)])


def _pivot(sim: Simulation, chosen: np.ndarray, tilt: float) -> np.ndarray:
    """Where the chosen blocks touch others, the leftmost point for a tilt to the left, else the rightmost (d,)."""
    record = sim.contact_record()
    ours = np.isin(record.blocks, chosen)
    between = (ours.sum(axis=1) == 1) & (record.gap <= TOUCH * sim.smallest)
    points = record.points[between] - sim.origin
    if not len(points):  # nothing holds them: about their lowest corner on that side
        mine = np.isin(sim.shape.corner_blocks, chosen)
        corners = sim.bodies.corners[mine]
        points = corners[corners[:, 1] <= corners[:, 1].min() + 1e-9]
    return points[(points[:, 0] * np.sign(tilt)).argmin()]


def _turn(sim: Simulation, chosen: np.ndarray, angle: float, about: np.ndarray) -> None:
    """Turns the chosen blocks as one."""
    cosine, sine = np.cos(angle), np.sin(angle)
    arms = sim.bodies.positions[chosen] - about
    sim.bodies.positions[chosen] = about + arms @ np.array([[cosine, sine], [-sine, cosine]])
    sim.bodies.orientations[chosen] += angle
