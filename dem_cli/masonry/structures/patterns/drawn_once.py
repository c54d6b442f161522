"""Cache drawn structures until their table or file changes, since commands draw the same stones several times."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import TypeVar

from dem_cli.case.base import StructureBase
from dem_cli.case.named_file import digest

MOST_KEPT = 4  # structures that were drawn

Table = TypeVar("Table", bound=StructureBase)
Drawn = TypeVar("Drawn")


def drawn_once(draw: Callable[[Table], Drawn]) -> Callable[[Table], Drawn]:
    """Wrap a function of a structure so that it draws equal ones once; the result is shared."""
    kept: dict[tuple[str, ...], Drawn] = {}

    @wraps(draw)
    def drawn(table: Table) -> Drawn:
        named = [getattr(each, "file", None) for each in (table, getattr(table, "outline", None))]
        key = (table.model_dump_json(), *(digest(file) for file in named if file))
        if key not in kept:
            found = draw(table)
            if len(kept) >= MOST_KEPT:
                kept.clear()
            kept[key] = found
        return kept[key]

    return drawn
