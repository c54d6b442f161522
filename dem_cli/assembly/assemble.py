"""Assembly: from a validated case to the arrays that the solvers see."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dem_cli.assembly.imperfect import imperfect
from dem_cli.case.base import KeyProblem
from dem_cli.case.cross_references import check_names
from dem_cli.errors import CaseError, CaseProblem, KeyPath, dotted
from dem_cli.geometry import polygon
from dem_cli.geometry.rotation import cross
from dem_cli.model.blocks import Block
from dem_cli.model.model import Model
from dem_cli.structures.placement import aliases, place
from dem_cli.structures.registry import GENERATORS

if TYPE_CHECKING:
    from dem_cli.case.block_table import BlockTable
    from dem_cli.case.schema import Case


class Assembly(NamedTuple):
    """A case in numbers, with the names needed to talk about it."""

    model: Model
    blocks: tuple[Block, ...]  # in the order of the model
    doubts: tuple[CaseProblem, ...] = ()  # what is allowed, but looks like a slip


class PointLoad(NamedTuple):
    """A [[load]] with its block found."""

    block: int
    force: np.ndarray  # [N], (2,)
    arm: np.ndarray  # from the centroid to the point of application [m], (2,)
    dead: bool


def assemble(case: Case) -> Model:
    """The model of a case alone; raises CaseError with every problem found on the way."""
    return assembly(case).model


def assembly(case: Case) -> Assembly:
    """Model, blocks and names of a case. Raises CaseError: impossible shapes, names twice, unknown blocks."""
    blocks, names = case_blocks(case)
    body = _bodies(case, blocks, names)
    problems = check_names(case, body.numbers, [block.fixed for block in blocks])
    if problems:
        raise CaseError(problems)
    doubts: list[CaseProblem] = []
    if case.imperfection:  # names and numbers are those of the blocks as drawn
        blocks, doubts = imperfect(case, body, blocks)
        body = _bodies(case, blocks, names)
    loads = _point_loads(case, body)
    return Assembly(_with_loads(case, body, loads), tuple(blocks), tuple(doubts))


def case_blocks(case: Case) -> tuple[list[Block], dict[str, str]]:
    """All blocks of a case, from the lowest up and from left to right, and the aliases {alias: block id}.

    Raises CaseError: impossible shapes, names twice, no blocks.
    """
    problems: list[CaseProblem] = []
    blocks: list[Block] = []
    local: dict[str, list[Block]] = {}
    for i, parameters in enumerate(case.structure):
        try:
            generated = GENERATORS[parameters.kind].build(parameters)
            _check_corners(generated)
        except ValueError as error:
            keys = error.keys if isinstance(error, KeyProblem) else ()
            problems.append(CaseProblem(("structure", i, *keys), str(error)))
            continue
        local[parameters.id] = generated
        blocks += place(generated, parameters, ("structure", i))
    for i, table in enumerate(case.block):
        try:
            blocks.append(_explicit(table, i))
        except CaseError as error:
            problems += error.problems
    problems += _repeated_names(blocks)
    if not blocks and not problems:
        problems.append(CaseProblem((), "there are no blocks; give a [[structure]] or a [[block]]"))
    if problems:
        raise CaseError(problems)
    return _sorted(blocks), aliases(local)


def _check_corners(blocks: Sequence[Block]) -> None:
    """Raises ValueError where a generated block has no area: fewer than three corners that are not the same point."""
    flat = [block.id for block in blocks if any(len(part) < 3 for part in block.parts)]
    if flat:
        more = f" (and {len(flat) - 1} more)" if len(flat) > 1 else ""
        raise ValueError(f"block '{flat[0]}'{more} has no area: its sides are too different in length")


def joint_table(case: Case) -> tuple[tuple[str, ...], np.ndarray]:
    """Names of the joints and which of them lies between two materials, (n_materials, n_materials) int64."""
    names = tuple(case.joints)
    table = [[names.index(case.joint_between(a, b)) for b in case.materials] for a in case.materials]
    return names, np.array(table, np.int64)


def _explicit(table: BlockTable, i: int) -> Block:
    """The block of the i-th [[block]]; raises CaseError with a problem for each bad piece."""
    pieces: list[tuple[KeyPath, Sequence[Any]]] = [(("parts", k), part) for k, part in enumerate(table.parts or ())]
    if table.vertices is not None:
        pieces = [(("vertices",), table.vertices)]
    parts, problems = [], []
    for key, corners in pieces:
        try:
            parts.append(polygon.in_order(corners))
        except ValueError as error:
            problems.append(CaseProblem(("block", i, *key), str(error)))
    if problems:
        raise CaseError(problems)
    return Block(table.id, tuple(parts), table.material, table.thickness, table.fixed, ("block", i))


def _repeated_names(blocks: Sequence[Block]) -> list[CaseProblem]:
    first: dict[str, Block] = {}
    problems = []
    for block in blocks:
        other = first.setdefault(block.id, block)
        if other is not block:
            message = f"the name '{block.id}' is taken by a block of {dotted(other.path)}; give another"
            problems.append(CaseProblem((*block.path, "id"), message))
            if block.path[0] == "structure":
                break  # all of its blocks would follow
    return problems


def _sorted(blocks: list[Block]) -> list[Block]:
    """From the lowest up, from left to right: neighbours get numbers close to each other."""
    lows = np.array([np.concatenate(block.parts).min(axis=0) for block in blocks])
    step = 1e-6 * (float(np.ptp(lows, axis=0).max()) or 1.0)  # against round-off within a course
    order = np.lexsort((lows[:, 0], np.rint(lows[:, 1] / step)))
    return [blocks[i] for i in order]


def _bodies(case: Case, blocks: Sequence[Block], names: Mapping[str, str]) -> Model:
    """The model with its masses, still without loads; names: aliases of blocks."""
    n = len(blocks)
    parts = [part for block in blocks for part in block.parts]
    part_blocks = np.repeat(np.arange(n), [len(block.parts) for block in blocks])
    part_starts = np.concatenate([[0], np.cumsum([len(part) for part in parts])])
    vertices = np.concatenate(parts)
    areas = polygon.compound(polygon.properties_of_all(vertices, part_starts), part_blocks, n)
    materials = list(case.materials)
    index = {name: k for k, name in enumerate(materials)}
    material = np.array([index[block.material] for block in blocks], np.int64)
    thickness = np.array([block.thickness for block in blocks])
    density = np.array([m.density for m in case.materials.values()])[material]
    vertex_blocks = np.repeat(part_blocks, np.diff(part_starts))
    return Model(
        dimension=2,
        block_ids=tuple(block.id for block in blocks),
        material_names=tuple(materials),
        block_material=material,
        fixed=np.array([block.fixed for block in blocks]),
        thickness=thickness,
        masses=density * thickness * areas.area,
        inertias=(density * thickness * areas.polar_moment)[:, None],
        centroids=areas.centroid,
        part_blocks=part_blocks.astype(np.int64),
        part_starts=part_starts.astype(np.int64),
        vertices=vertices - areas.centroid[vertex_blocks],
        dead_loads=np.zeros((n, 3)),
        live_loads=np.zeros((n, 3)),
        aliases=tuple(names.items()),
    )


def _point_loads(case: Case, model: Model) -> list[PointLoad]:
    loads = []
    for load in case.load:
        block = model.numbers[load.block]
        arm = np.zeros(2) if load.at is None else np.array(load.at) - model.centroids[block]
        loads.append(PointLoad(block, np.array(load.force), arm, load.kind == "dead"))
    return loads


def _with_loads(case: Case, model: Model, loads: Sequence[PointLoad]) -> Model:
    """Dead loads: weight and dead point loads. Live loads: by the pattern of the analysis, or zero."""
    dead = [load for load in loads if load.dead]
    pattern = getattr(case.analysis, "pattern", None)
    weight = np.zeros((model.n_blocks, 3))
    weight[:, 1] = -model.masses * case.gravity
    free = ~model.fixed[:, None]
    live = np.zeros((model.n_blocks, 3))
    if pattern == "mass":
        live[:, :2] = -weight[:, 1:2] * _direction(case)
    elif pattern == "tilt":
        turn = np.array([[0.0, -1.0], [1.0, 0.0]]) * np.sign(_direction(case)[0])
        live[:, :2] = weight[:, :2] @ turn.T
        live += _resultants(model.n_blocks, [load._replace(force=turn @ load.force) for load in dead])
    elif pattern == "live":
        live = _resultants(model.n_blocks, [load for load in loads if not load.dead])
    dead_loads = weight + _resultants(model.n_blocks, dead)
    return model._replace(dead_loads=dead_loads, live_loads=np.where(free, live, 0.0))


def _direction(case: Case) -> np.ndarray:
    """The direction of the analysis as a unit vector, (2,)."""
    direction = np.array(case.analysis.direction, float)
    length = np.hypot(*direction)
    if length == 0.0:
        problem = CaseProblem(("analysis", "direction"), "[0, 0] is not allowed; a direction has a length")
        raise CaseError([problem])
    if case.analysis.pattern == "tilt" and direction[0] == 0.0:
        message = "a table tilts towards +x or −x; the direction must have an x component"
        raise CaseError([CaseProblem(("analysis", "direction"), message)])
    return direction / length


def _resultants(n_blocks: int, loads: Sequence[PointLoad]) -> np.ndarray:
    """Forces and moments about the centroids, (n_blocks, 3) [N, N m]."""
    total = np.zeros((n_blocks, 3))
    for load in loads:
        total[load.block] += [*load.force, cross(load.arm, load.force)]
    return total
