"""Convert [[tie]] and [[reinforcement]] from points in space to material points of blocks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dem_cli.case.wording import listing, show, unknown_name
from dem_cli.core.links.link import FIXED_POINT, Link, LinkEnds
from dem_cli.core.links.registry import LINKS
from dem_cli.core.model.model import Model
from dem_cli.core.model.places import blocks_at_all, undeformed
from dem_cli.errors import CaseError, CaseProblem, KeyPath
from dem_cli.masonry.assembly.drawn_bars import drawn_bar

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.core.links.drawn_bar import DrawnBar


class DrawnLinks(NamedTuple):
    """Ties or bars of a case, all of one kind, attached to the undeformed blocks."""

    link: Link
    tables: Sequence[Any]
    drawn: Sequence[Any]  # LinkEnds or DrawnBar, points from the centroids of their blocks

    def laid(self, centroids: np.ndarray) -> Any:
        """Create the arrays of the links for blocks with centroids (n_blocks, d) [m]."""
        return self.link.made(self.tables, self.drawn, centroids)


def drawn_links(case: Case, model: Model) -> list[DrawnLinks]:
    """Attach the ties and bars of a case to its blocks, by kind. Raises CaseError with every problem."""
    found, problems = [], list[CaseProblem]()
    for key in LINKS:
        if tables := getattr(case, key):
            drawn = DRAWN[key](case, tables, key, model, problems)
            found.append(DrawnLinks(LINKS[key], tables, [one for one in drawn if one is not None]))
    if problems:
        raise CaseError(problems)
    return found


def names_of(case: Case) -> tuple[str, ...]:
    """List the names of all ties and bars of a case, in the order of their arrays."""
    return tuple(
        table.id or f"{LINKS[key].word}-{i + 1}" for key in LINKS for i, table in enumerate(getattr(case, key))
    )


def _ties(
    case: Case, tables: Sequence[Any], key: str, model: Model, problems: list[CaseProblem]
) -> list[LinkEnds | None]:
    """Find blocks and attachment points of each tie; None where `problems` gets a message."""
    ends = np.array([table.ends for table in tables], float)  # (n, 2, d)
    inside = blocks_at_all(model, ends.reshape(-1, model.dimension))
    return [
        _ends(table, (key, i), model, ends[i], inside[2 * i : 2 * i + 2], problems) for i, table in enumerate(tables)
    ]


def _bars(
    case: Case, tables: Sequence[Any], key: str, model: Model, problems: list[CaseProblem]
) -> list[DrawnBar | None]:
    """Find the pieces in blocks of each bar; None where `problems` gets a message."""
    return [drawn_bar(case, table, (key, i), model, problems) for i, table in enumerate(tables)]


def _ends(
    table: Any,
    path: KeyPath,
    model: Model,
    points: np.ndarray,
    inside: Sequence[np.ndarray],
    problems: list[CaseProblem],
) -> LinkEnds | None:
    """Find blocks and attachment points of one tie; None where `problems` gets a message."""
    first = _holding(model, (*path, "block"), table.block, points[0], inside[0], (*path, "ends", 0), problems)
    second: int | None = FIXED_POINT
    if not table.anchored:
        second = _holding(model, (*path, "other"), table.other, points[1], inside[1], (*path, "ends", 1), problems)
    if first is None or second is None:
        return None
    message = None
    if first == second:
        message = f"both ends are held by block {show(model.block_ids[first])}: it cannot pull on anything"
    elif model.fixed[first] and (second == FIXED_POINT or model.fixed[second]):
        message = "both ends are held by supports: it cannot pull on anything"
    if message is not None:
        problems.append(CaseProblem((*path, "ends"), message))
        return None
    points[0] -= model.centroids[first]
    if second != FIXED_POINT:
        points[1] -= model.centroids[second]
    return LinkEnds((first, second), points)


def _holding(
    model: Model,
    path: KeyPath,
    name: str | None,
    point: np.ndarray,
    inside: np.ndarray,
    at: KeyPath,
    problems: list[CaseProblem],
) -> int | None:
    """Return the block that holds one end of a tie: the named one, or the one around the point."""
    ids, where = model.block_ids, show(tuple(point.tolist()))
    message = None
    if name is not None and name not in model.numbers:
        message, at = unknown_name("block", name, [*model.numbers]), path
    elif name is not None and model.numbers[name] not in inside:
        message = f"{where} is not in block {show(name)}{_others(ids, inside)}"
    elif name is None and not len(inside):
        low, high = (limit(undeformed(model), axis=0).round(6).tolist() for limit in (np.min, np.max))
        message = f"there is no block at {where}; the structure lies between {low} and {high}; a point outside of it "
        message += "may be the second end of a tie with anchored = true"
    elif name is None and len(inside) > 1:
        several, key = listing([ids[i] for i in inside]), path[-1]
        message = f"{where} lies on the edge of several blocks ({several}): say which by {key}"
    if message is not None:
        problems.append(CaseProblem(at, message))
        return None
    return model.numbers[name] if name is not None else int(inside[0])


def _others(ids: Sequence[str], inside: np.ndarray) -> str:
    return f"; it lies in {listing([ids[i] for i in inside])}" if len(inside) else "; it lies in no block"


DRAWN: dict[str, Callable[[Case, Sequence[Any], str, Model, list[CaseProblem]], Sequence[Any]]] = {
    "tie": _ties, "reinforcement": _bars
}  # fmt: skip
