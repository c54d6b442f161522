"""Check selected blocks: fixed ones where supports move, one block where one is required."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from dem_cli.case.wording import listing, show
from dem_cli.core.model.model import Model
from dem_cli.errors import CaseProblem, KeyPath
from dem_cli.masonry.assembly import imposed_strains

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.case.selection import Selection

NOT_FIXED = "only a fixed block can be moved"
NOT_HELD = "only blocks that can move have motions to hold"
NOT_FREE = "only blocks that can move have a start"


def problems(case: Case, model: Model) -> Iterator[CaseProblem]:
    """Report tables whose selected blocks are fixed, free or several where they must not be."""
    for i, settlement in enumerate(case.settlement):
        yield from _of_kind(
            model, _key(("settlement", i), settlement), (settlement.selected, settlement.said), True, NOT_FIXED
        )
    yield from imposed_strains.problems(case, model)
    for i, restraint in enumerate(case.restraint):
        named = restraint.selected, restraint.said
        yield from _of_kind(model, _key(("restraint", i), restraint), named, False, NOT_HELD)
    for i, table in enumerate(case.initial):
        for k, name in enumerate(table.names):
            path = _key(("initial", i), table) if table.blocks is None else ("initial", i, "blocks", k)
            said = table.said if table.blocks is None else show(name)
            yield from _of_kind(model, path, (name, said), False, NOT_FREE)
    for i, motion in enumerate(case.motion):
        supports = [name for name, number in model.numbers.items() if model.fixed[number]]
        for k, name in enumerate(motion.blocks):
            why = f"{NOT_FIXED} (fixed: {listing(supports)})"
            yield from _of_kind(model, ("motion", i, "blocks", k), (name, show(name)), True, why)
    for i, monitor in enumerate(case.monitor):
        for k, name in enumerate(monitor.between or ()):
            yield from _only_one(model, ("monitor", i, "between", k), name)
    if case.damping is not None and case.damping.block is not None:
        yield from _only_one(model, ("damping", "block"), case.damping.block)


def _key(path: KeyPath, table: Selection) -> KeyPath:
    """Return the path of the key that selects blocks."""
    return (*path, "block" if table.block is not None else "structure")


def _of_kind(
    model: Model, path: KeyPath, named: tuple[str | None, str], fixed: bool, why: str
) -> Iterator[CaseProblem]:
    """Report free blocks where supports are required, or the other way round; named: in the model, and in messages."""
    name, said = named
    chosen = model.chosen(name, fixed)
    if (model.fixed[chosen] == fixed).all():
        return
    if name in model.numbers:
        what = f"block {said} is {'not ' if fixed else ''}fixed"
    else:
        what = f"none of the {len(chosen)} blocks of {said} is fixed" if fixed else f"every block of {said} is fixed"
    yield CaseProblem(path, f"{what}; {why}")


def _only_one(model: Model, path: KeyPath, name: str) -> Iterator[CaseProblem]:
    """Report a selection of several blocks where one is required."""
    chosen = model.chosen(name)
    if len(chosen) > 1:
        listed = listing([model.block_ids[i] for i in chosen])
        yield CaseProblem(path, f"{show(name)} stands for {len(chosen)} blocks; one is meant here ({listed})")
