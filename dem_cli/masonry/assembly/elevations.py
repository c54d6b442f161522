"""Apply geometric imperfections to blocks in 3D, in the elevation of each structure before it is placed.

Its blocks are laid again among themselves; of blocks drawn by hand and of other structures they know nothing.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dem_cli.core.geometry.polyhedron import Polyhedron
from dem_cli.core.model.blocks import Block
from dem_cli.core.model.bodies import bodies_of
from dem_cli.core.model.model import Model
from dem_cli.errors import CaseError, CaseProblem
from dem_cli.masonry.assembly.imperfect import ImperfectBlocks, imperfect
from dem_cli.masonry.structures.placement import depth, full_id, spatial_places
from dem_cli.masonry.structures.registry import generated_blocks

if TYPE_CHECKING:
    from dem_cli.case.schema import Case


def imperfect_in_space(case: Case, model: Model, blocks: Sequence[Block]) -> ImperfectBlocks:
    """Apply [[imperfection]] to blocks in space. Raises CaseError, also for blocks drawn by hand."""
    upright = [_elevation(case, i) for i in range(len(case.structure))]
    problems = [*_of_drawn_blocks(case, model, blocks), *_of_solids(case, upright)]
    if problems:
        raise CaseError(problems)
    facing = tuple(table.model_copy(update={"origin": (0.0, 0.0), "rotation_deg": 0.0}) for table in case.structure)
    flat_case = case.model_copy(update={"structure": facing})
    changed: dict[str, tuple[Any, ...]] = {}
    doubts: dict[CaseProblem, None] = {}
    for table, flat in zip(case.structure, upright, strict=True):
        if not flat:
            continue
        found = imperfect(flat_case, _planar_model(case, flat)._replace(selections=model.selections), flat)
        parts, _ = spatial_places(found.blocks, table)
        changed |= {block.id: tuple(next(parts) for _ in block.parts) for block in found.blocks}
        doubts |= dict.fromkeys(found.doubts)
    return ImperfectBlocks(
        [replace(block, parts=changed[block.id]) if block.id in changed else block for block in blocks],
        list(doubts),
    )


def _of_drawn_blocks(case: Case, model: Model, blocks: Sequence[Block]) -> Iterator[CaseProblem]:
    """Report imperfections of blocks drawn by hand, which have no elevation."""
    drawn = [block.id for block in blocks if block.path[0] == "block" and not block.fixed]
    for i, table in enumerate(case.imperfection):
        if any(model.block_ids[k] in drawn for k in model.chosen(table.block)):
            message = "a block drawn by hand has no imperfections in 3D; draw it as it is"
            yield CaseProblem(("imperfection", i, "block"), message)
        elif drawn and table.block is None and table.structure is None:
            message = f"block '{drawn[0]}' is drawn by hand and has none in 3D: say which 'structure' is meant"
            yield CaseProblem(("imperfection", i), message)


def _of_solids(case: Case, upright: Sequence[Sequence[Block]]) -> Iterator[CaseProblem]:
    """Report imperfections of structures without an elevation: their list of blocks in `upright` is empty."""
    solid = [table.id for table, blocks in zip(case.structure, upright, strict=True) if not blocks]
    for i, table in enumerate(case.imperfection):
        if table.structure in solid:
            message = f"'{table.structure}' is not drawn in one upright plane; its blocks have no imperfections in 3D"
            yield CaseProblem(("imperfection", i, "structure"), message)
        elif solid and table.block is None and table.structure is None:
            message = f"structure '{solid[0]}' has none in 3D: say which 'structure' is meant"
            yield CaseProblem(("imperfection", i), message)


def _elevation(case: Case, i: int) -> list[Block]:
    """Generate the blocks of structure i in its elevation, by their full names.

    None where its blocks are solids, or lie behind each other.
    """
    table = case.structure[i]
    drawn = generated_blocks(table, case.seed)
    drawn = [block for block in drawn if not block.fixed or depth(block)[0] < 0.0 < depth(block)[1]]
    free = [block for block in drawn if not block.fixed]
    if any(isinstance(part, Polyhedron) for block in drawn for part in block.parts) or len(set(map(depth, free))) > 1:
        return []
    return [
        replace(block, id=full_id(table.id, block.id), material=block.material or table.material, path=("structure", i))
        for block in drawn
    ]


def _planar_model(case: Case, blocks: Sequence[Block]) -> Model:
    """Create a planar model of an elevation for its geometry alone, without materials and loads."""
    n = len(blocks)
    thickness = np.array([block.thickness for block in blocks])
    bodies = bodies_of(2, [block.parts for block in blocks], np.ones(n), thickness)
    return Model(
        **bodies._asdict(),
        block_ids=tuple(block.id for block in blocks),
        material_names=tuple(case.materials),
        block_material=np.zeros(n, np.int64),
        fixed=np.array([block.fixed for block in blocks]),
        thickness=thickness,
        dead_loads=np.zeros((n, 3)),
        live_loads=np.zeros((n, 3)),
    )
