"""Create the blocks drawn by hand, [[block]]: polygons, in 3D polyhedra by hull, by faces, in parts, or prisms."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from dem_cli.case.block_table import BlockPart
from dem_cli.core.geometry import polygon, polyhedron
from dem_cli.core.model.blocks import Block
from dem_cli.errors import CaseError, CaseProblem, KeyPath

if TYPE_CHECKING:
    from dem_cli.case.base import Pair
    from dem_cli.case.block_table import BlockTable

Pieces = Iterator[tuple[KeyPath, Callable[[], Any]]]  # key of a piece, and what makes its shape or raises ValueError


def drawn_block(table: BlockTable, i: int, dimension: int) -> Block:
    """Create the block of the i-th [[block]] table; raises CaseError with a problem for each bad piece."""
    parts, problems = [], []
    for key, make in PIECES[dimension](table):
        try:
            parts.append(make())
        except ValueError as error:
            problems.append(CaseProblem(("block", i, *key), str(error)))
    if problems:
        raise CaseError(problems)
    return Block(table.id, tuple(parts), table.material, table.thickness, table.fixed, path=("block", i))


def polygons(table: BlockTable) -> Pieces:
    """Yield the convex pieces of a block in the plane."""
    for key, corners, _ in corners_of(table):
        yield key, partial(polygon.in_order, corners)


def polyhedra(table: BlockTable) -> Pieces:
    """Yield the convex pieces of a block in space."""
    if table.polygon is not None and table.y is not None:
        yield ("polygon",), partial(_prism, table.polygon, table.y)
    for key, corners, faces in corners_of(table):
        if faces is None:
            yield key, partial(polyhedron.hull, corners)
        else:
            key = (*key[:-1], "faces") if key[-1] == "vertices" else (*key, "faces")
            yield key, partial(polyhedron.from_faces, corners, faces)


def _prism(corners: Sequence[Pair], y: Pair) -> polyhedron.Polyhedron:
    return polyhedron.prism(polygon.in_order(corners), *y)


def corners_of(table: BlockTable) -> Iterator[tuple[KeyPath, Any, Any]]:
    """Yield key, corners and given faces of each convex piece of a [[block]] table."""
    if table.vertices is not None:
        yield ("vertices",), table.vertices, table.faces
    for k, part in enumerate(table.parts or ()):
        given = (part.vertices, part.faces) if isinstance(part, BlockPart) else (part, None)
        yield ("parts", k), *given


PIECES: dict[int, Callable[[BlockTable], Pieces]] = {2: polygons, 3: polyhedra}
