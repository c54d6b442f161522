"""Cut the path of a bar of [[reinforcement]] into its pieces in the blocks that it crosses."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.case.wording import show
from dem_cli.core.arithmetic.products import product
from dem_cli.core.geometry.parts import shapes_of
from dem_cli.core.links.drawn_bar import FINE, BarPiece, DrawnBar
from dem_cli.core.model.model import Model
from dem_cli.core.model.places import undeformed
from dem_cli.errors import CaseProblem, KeyPath
from dem_cli.input_limits import MOST_ELEMENTS

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.core.links.drawn_bar import Reinforcement

SLIPS = 1e-8  # stiffness of a bond to that of its bar, below which it is lost in round-off
TOUCHES = 1e-9  # of the largest part: what a line has in a part is round-off


class BarStretch(NamedTuple):
    """Stretch of a bar inside one block, from its beginning to its end along the bar [m]."""

    block: int
    begin: float
    end: float


def drawn_bar(
    case: Case, table: Reinforcement, path: KeyPath, model: Model, problems: list[CaseProblem]
) -> DrawnBar | None:
    """Find the pieces of a bar in the undeformed blocks; None where `problems` gets a message."""
    profile = case.bars[table.bar]
    element = FINE / profile.decay if table.element is None else table.element
    corners = np.array(table.path, float)
    if wrong := _unlike_bond(table.bar, profile.decay, element, corners):
        problems.append(CaseProblem((*path, "bar"), wrong))
        return None
    found = list[tuple[BarStretch, np.ndarray, np.ndarray]]()
    upto = 0.0
    for i, (start, stop) in enumerate(zip(corners[:-1], corners[1:])):
        length = float(np.sqrt(((stop - start) ** 2).sum()))
        along = (stop - start) / length
        stretches = _in_blocks(model, start, along, length)
        wrong = _beside(model, stretches) or _outside(stretches, start, along, length, element)
        if wrong is not None:
            problems.append(CaseProblem((*path, "path", i), wrong))
            return None
        found += [(stretch, start, along) for stretch in stretches]
        upto += length
    if len({stretch.block for stretch, _, _ in found}) == 1:
        only = show(model.block_ids[found[0][0].block])
        problems.append(CaseProblem((*path, "path"), f"it lies in block {only} alone: it crosses no joint"))
        return None
    pieces = []
    for stretch, start, along in found:
        ends = np.array([start + stretch.begin * along, start + stretch.end * along])
        pieces.append(BarPiece(stretch.block, ends - model.centroids[stretch.block]))
    return DrawnBar(profile, element, ("start" in table.anchored, "end" in table.anchored), tuple(pieces))


def _unlike_bond(name: str, decay: float, element: float, corners: np.ndarray) -> str | None:
    """Return a message for a bar far stiffer than its bond, or with far too many elements; None: neither.

    decay: of bond forces along the bar [1/m]; element: length of its elements [m]; corners: of its path [m], (n, d).
    """
    length = float(np.sqrt((np.diff(corners, axis=0) ** 2).sum(axis=1)).sum())
    soft = (decay * length) ** 2  # stiffness of the bond of all of it, to its own
    if soft < SLIPS:
        return f"bar {show(name)} is {1.0 / soft:.3g} times as stiff as its bond; at most {1.0 / SLIPS:g} times"
    if length > MOST_ELEMENTS * element:
        return (
            f"elements of {element:.3g} m are too short for a bar of {length:.4g} m; at most {MOST_ELEMENTS:,} are made"
        )
    return None


def _in_blocks(model: Model, start: np.ndarray, along: np.ndarray, length: float) -> list[BarStretch]:
    """Intersect a straight bar with the blocks; returns its stretches in the order along the bar."""
    vertices, topology = undeformed(model), model.topology
    normals = shapes_of(vertices).normals(vertices, topology)
    ahead = ((vertices[topology.face_corners[topology.face_starts[:-1]]] - start) * normals).sum(axis=1)
    towards = product(normals, along)
    size = model.parts.sizes.max()
    parallel = np.abs(towards) < TOUCHES
    with np.errstate(divide="ignore", invalid="ignore"):
        meets = ahead / towards
    outside = parallel & (ahead < -TOUCHES * size)
    enters = np.where(outside, np.inf, np.where(parallel | (towards > 0.0), -np.inf, meets))
    leaves = np.where(outside, -np.inf, np.where(parallel | (towards < 0.0), np.inf, meets))
    starts = topology.part_faces[:-1]
    begins = np.maximum(np.maximum.reduceat(enters, starts), 0.0)
    ends = np.minimum(np.minimum.reduceat(leaves, starts), length)
    inside = np.flatnonzero(ends - begins > TOUCHES * size)
    found = sorted(BarStretch(int(model.part_blocks[k]), float(begins[k]), float(ends[k])) for k in inside)
    merged = list[BarStretch]()
    for one in found:  # parts of one block, one behind another or one over another
        if merged and merged[-1].block == one.block and one.begin <= merged[-1].end + TOUCHES * size:
            merged[-1] = merged[-1]._replace(end=max(merged[-1].end, one.end))
        else:
            merged.append(one)
    return sorted(merged, key=lambda stretch: stretch.begin)


def _beside(model: Model, stretches: list[BarStretch]) -> str | None:
    """Return a message where a bar lies in two blocks at once, so that it runs along their joint; None if nowhere."""
    for one, other in zip(stretches, stretches[1:]):
        if one.end - other.begin > TOUCHES * model.parts.sizes.max():
            ids = " and ".join(show(model.block_ids[stretch.block]) for stretch in (one, other))
            return f"the bar runs along the joint of {ids}, over {one.end - other.begin:.3g} m: draw it inside of one"
    return None


def _outside(
    stretches: list[BarStretch], start: np.ndarray, along: np.ndarray, length: float, element: float
) -> str | None:
    """Return a message where a bar leaves the blocks, open joints up to one element wide aside; None if nowhere."""
    edges = [0.0, *(edge for stretch in stretches for edge in stretch[1:]), length]
    for i, (begin, end) in enumerate(zip(edges[::2], edges[1::2])):
        inner = 0 < i < len(stretches)
        if end - begin > (element if inner else math.sqrt(TOUCHES) * length):
            places = " to ".join(show(tuple(np.round(start + at * along, 9).tolist())) for at in (begin, end))
            return f"from {places} there is no block; a bar lies in blocks: shorten its path, or give a [[tie]]"
    return None
