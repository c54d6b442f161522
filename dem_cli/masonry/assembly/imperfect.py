"""Apply geometric imperfections of [[imperfection]]: wrong sizes, lean, and blocks laid again."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.case.imperfection import drawn
from dem_cli.case.wording import show
from dem_cli.core.geometry import polygon
from dem_cli.core.geometry.rotation import turned
from dem_cli.core.model.blocks import Block
from dem_cli.core.model.model import Model
from dem_cli.errors import CaseError, CaseProblem
from dem_cli.masonry.assembly.laying import Interlocked, lay, neighbours, order_of

if TYPE_CHECKING:
    from dem_cli.case.imperfection import Error, Imperfection
    from dem_cli.case.schema import Case

LEVEL = ("wall", "column")  # kinds of structures whose blocks are upright, in courses
LARGE_ERROR = 0.1  # of a block's height or length: a larger error looks like a wrong unit
STEEP_CHANGE = 0.1  # a larger lean looks like degrees
LAYING_REACH = 0.5  # of the smallest side of a free block: neighbours that may come to touch


class Errors(NamedTuple):
    """Geometric imperfections of m blocks, of one table or summed over all."""

    blocks: np.ndarray  # numbers of the blocks, (m,)
    height: np.ndarray  # [m], (m,)
    length: np.ndarray  # [m], (m,)
    wedge: np.ndarray  # [m], (m,)
    shift: np.ndarray  # with what comes from a lean [m], (m, 2)


class Site(NamedTuple):
    """Blocks as drawn with their case and model, before imperfections are applied."""

    case: Case
    blocks: Sequence[Block]
    model: Model  # of the blocks as drawn
    corners: np.ndarray  # of all blocks as drawn [m], (n_vertices, 2)
    owner: np.ndarray  # block of every corner, (n_vertices,)
    structure: np.ndarray  # number of the structure of every block, −1 for blocks drawn by hand, (n_blocks,)
    turns: np.ndarray  # of that structure [rad], (n_blocks,)
    level: np.ndarray  # blocks that stand upright, (n_blocks,) bool


class ImperfectBlocks(NamedTuple):
    """Blocks with the imperfections of [[imperfection]] applied, and warnings about them."""

    blocks: list[Block]  # with errors, in the same order
    doubts: list[CaseProblem]  # what looks like a slip


def imperfect(case: Case, model: Model, blocks: Sequence[Block]) -> ImperfectBlocks:
    """Apply all imperfections of a case to its blocks. Raises CaseError where an error leaves nothing of a block.

    model: of the blocks as drawn, their order, names, corners and parts
    """
    site = _site(case, model, blocks)
    problems = [problem for i in range(len(case.imperfection)) for problem in _misplaced(site, i)]
    if problems:
        raise CaseError(problems)
    low, size = _boxes(site, site.corners)
    tables = [_errors(site, low, i) for i in range(len(case.imperfection))]
    problems = _nothing_left(site, size, tables)
    if problems:
        raise CaseError(problems)
    doubts = [doubt for i, errors in enumerate(tables) for doubt in _doubts(site, size, errors, i)]
    laid = [errors for errors, table in zip(tables, case.imperfection) if table.restack]
    left = [errors for errors, table in zip(tables, case.imperfection) if not table.restack]
    corners = site.corners
    if laid:
        corners = _laid(site, _misshapen(site, corners, _sum(site, laid)), tables)
    if left:
        corners = _misshapen(site, corners, _sum(site, left))
    parts = iter(np.split(corners, model.part_starts[1:-1]))
    return ImperfectBlocks([replace(block, parts=tuple(next(parts) for _ in block.parts)) for block in blocks], doubts)


def _site(case: Case, model: Model, blocks: Sequence[Block]) -> Site:
    structure = np.array([block.path[1] if block.path[0] == "structure" else -1 for block in blocks])
    turns = np.array([*(parameters.rotation for parameters in case.structure), 0.0])
    level = np.array([*(parameters.kind in LEVEL for parameters in case.structure), True])
    corners = np.concatenate([part for block in blocks for part in block.parts])
    return Site(case, blocks, model, corners, model.vertex_blocks, structure, turns[structure], level[structure])


def _chosen(site: Site, table: Imperfection) -> np.ndarray:
    """Return the numbers of the blocks that an [[imperfection]] table selects."""
    if table.block is not None or table.course is not None:  # none, where these are blocks of another structure
        return site.model.chosen(table.selected, False)
    chosen = ~site.model.fixed
    if table.structure is not None:
        chosen &= site.structure == [parameters.id for parameters in site.case.structure].index(table.structure)
    return np.flatnonzero(chosen)


def _misplaced(site: Site, i: int) -> list[CaseProblem]:
    """Report blocks of an [[imperfection]] table that it cannot be applied to, such as slanting ones."""
    table, chosen = site.case.imperfection[i], _chosen(site, site.case.imperfection[i])
    if table.lean != 0.0 and not site.case.structure:
        return [CaseProblem(("imperfection", i, "lean"), "there is no [[structure]] that could lean")]
    slanting = chosen[~site.level[chosen]]
    if not len(slanting):
        return []
    structure = site.case.structure[site.structure[slanting[0]]]
    what = f"structure '{structure.id}' is of kind '{structure.kind}'"
    message = f"{what}; only walls, columns and blocks drawn by hand have imperfections"
    for key in ("block", "structure"):
        if getattr(table, key) is not None:
            return [CaseProblem(("imperfection", i, key), message)]
    return [CaseProblem(("imperfection", i), f"{message}: say which 'structure' or 'block' is meant")]


def _errors(site: Site, low: np.ndarray, i: int) -> Errors:
    """Return the errors of table i, drawn at random where requested; `low`: lower left corners (n_blocks, 2)."""
    case, table = site.case, site.case.imperfection[i]
    blocks = _chosen(site, table)

    def values(error: Error, key: str) -> np.ndarray:
        if isinstance(error, float):
            return np.full(len(blocks), error)
        return np.array([drawn(error, case.seed, i, key, site.blocks[k].id) for k in blocks])

    shift = np.stack([values(table.shift[0], "shift x"), values(table.shift[1], "shift y")], axis=1)
    if table.lean != 0.0:
        shift[:, 0] += _lean(site, low, blocks, i)
    return Errors(blocks, values(table.height, "height"), values(table.length, "length"),
                  values(table.wedge, "wedge"), shift)  # fmt: skip


def _lean(site: Site, low: np.ndarray, blocks: np.ndarray, i: int) -> np.ndarray:
    """Return the horizontal shift of blocks of leaning structures [m], (m,): that of the foot of their courses."""
    shift = np.zeros(len(blocks))
    for s, structure in enumerate(site.case.structure):
        some = site.structure[blocks] == s
        heights = low[blocks[some], 1] - turned(np.array([structure.origin]), -structure.rotation)[0, 1]
        if structure.kind == "wall":  # pieces beside an opening belong to their course
            levels = structure.levels
            heights = levels[np.searchsorted(levels, heights + 1e-6 * np.diff(levels).min(), "right") - 1]
        shift[some] = heights * drawn(site.case.imperfection[i].lean, site.case.seed, i, "lean", structure.id)
    return shift


def _sum(site: Site, tables: Sequence[Errors]) -> Errors:
    """Sum the imperfections of several tables block by block."""
    blocks = np.unique(np.concatenate([errors.blocks for errors in tables]))
    total = Errors(blocks, *(np.zeros((len(blocks), *field.shape[1:])) for field in tables[0][1:]))
    for errors in tables:
        row = np.searchsorted(blocks, errors.blocks)
        for field, added in zip(total[1:], errors[1:]):
            field[row] += added
    return total


def _boxes(site: Site, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return lower left corners and sizes of the blocks' boxes in the axes of their structures, (n_blocks, 2)."""
    local = turned(corners, -site.turns[site.owner])
    first = np.searchsorted(site.owner, np.arange(len(site.blocks)))
    low, high = np.minimum.reduceat(local, first), np.maximum.reduceat(local, first)
    return low, high - low


def _nothing_left(site: Site, size: np.ndarray, tables: Sequence[Errors]) -> list[CaseProblem]:
    """Report the first table that takes the whole height or length of a block."""
    totals = np.zeros((3, len(size)))
    for i, errors in enumerate(tables):
        k = errors.blocks
        totals[:, k] += [errors.length, errors.height, errors.wedge]
        changes = np.stack([totals[0], totals[1] + np.minimum(totals[2], 0.0)], axis=1)
        wrong = (size + changes)[k] <= polygon.ROUND_OFF * size[k]
        for axis, name in enumerate(("length", "height")):
            if wrong[:, axis].any():
                worst = k[np.argmin(np.where(wrong[:, axis], changes[k, axis], np.inf))]
                key = "wedge" if axis and totals[2, worst] < totals[1, worst] else name
                found = f"{changes[worst, axis]:.4g} m leaves nothing of block '{site.blocks[worst].id}'"
                message = f"{found}, whose {name} is {size[worst, axis]:.4g} m"
                return [CaseProblem(("imperfection", i, key), message)]
    return []


def _doubts(site: Site, size: np.ndarray, errors: Errors, i: int) -> list[CaseProblem]:
    """Warn about errors that are large compared with the block, most often given in mm or degrees."""
    found = []
    for key, axis in (("height", 1), ("wedge", 1), ("length", 0)):
        values = getattr(errors, key)
        share = np.abs(values) / size[errors.blocks, axis]
        if share.max(initial=0.0) > LARGE_ERROR:
            k = int(np.argmax(share))
            of = f"the {'height' if axis else 'length'} of block '{site.blocks[errors.blocks[k]].id}'"
            message = f"{values[k]:.3g} m is {share[k]:.0%} of {of}; errors are given in m"
            found.append(CaseProblem(("imperfection", i, key), message))
    lean = site.case.imperfection[i].lean
    steepest = max(abs(number) for number in _numbers(lean))
    if steepest > STEEP_CHANGE:
        angle = math.degrees(math.atan(steepest))
        message = f"{show(steepest)} is {angle:.3g}° out of plumb; a lean is shift per height"
        found.append(CaseProblem(("imperfection", i, "lean"), message))
    return found


def _numbers(error: Error) -> tuple[float, ...]:
    if isinstance(error, float):
        return (error,)
    return error if isinstance(error, tuple) else (error.mean, error.deviation)


def _misshapen(site: Site, corners: np.ndarray, errors: Errors) -> np.ndarray:
    """Stretch and shift the corners of blocks by their errors, (n_vertices, 2)."""
    low, size = _boxes(site, corners)
    row = np.full(len(site.blocks), -1)
    row[errors.blocks] = np.arange(len(errors.blocks))
    which = np.flatnonzero(row[site.owner] >= 0)
    k, block = row[site.owner[which]], site.owner[which]
    local = turned(corners[which], -site.turns[block])
    right, up = ((local - low[block]) / size[block]).T  # 0 at the left and the foot, 1 opposite
    local[:, 0] += errors.length[k] * (right - 0.5)
    local[:, 1] += up * (errors.height[k] + errors.wedge[k] * right)
    changed = corners.copy()
    changed[which] = turned(local + errors.shift[k], site.turns[block])
    return changed


def _laid(site: Site, corners: np.ndarray, tables: Sequence[Errors]) -> np.ndarray:
    """Lay the blocks again after their errors, in the axes of their structures; corners (n_vertices, 2)."""
    free = ~site.model.fixed & site.level
    sides = _boxes(site, site.corners)[1][~site.model.fixed]
    largest = max(float(np.abs(field).max(initial=0.0)) for t in tables for field in (t.height, t.length, t.wedge))
    pairs = neighbours(site.model, max(LAYING_REACH * float(sides.min(initial=1e300)), 4.0 * largest))
    for turn in np.unique(site.turns[free]):
        order = order_of(site.model, turned(site.corners, -turn), pairs)
        try:
            moves = lay(site.model, turned(corners, -turn), order, free & (site.turns == turn))
        except Interlocked as error:
            names = ", ".join(f"'{site.blocks[k].id}'" for k in error.blocks[:3])
            message = f"blocks {names} hold each other and cannot be laid one after the other; give restack = false"
            first = next(i for i, table in enumerate(site.case.imperfection) if table.restack)
            raise CaseError([CaseProblem(("imperfection", first), message)]) from None
        moved = (moves != 0.0).any(axis=1)[site.owner]
        corners = np.where(moved[:, None], corners + turned(moves, turn)[site.owner], corners)
    return corners
