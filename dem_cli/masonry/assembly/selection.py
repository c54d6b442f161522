"""Resolve names of blocks in a case: ids, aliases, patterns, groups, structures and their courses.

Everything in a case that names blocks is looked up here, once; models keep what was found (`Model.selections`).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from dem_cli.case.cross_references import SELECTING
from dem_cli.case.selection import GroupMember, is_pattern, structure_words
from dem_cli.case.wording import listing, nearest, show, unknown_name
from dem_cli.core.model.blocks import Block
from dem_cli.errors import CaseProblem, KeyPath

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.case.selection import Courses, Selection


class NoSuchBlocks(ValueError):
    """Error for a name that matches no block; `keys`: below the table that is looked up."""

    def __init__(self, message: str, *keys: str | int):
        super().__init__(message)
        self.keys = keys


class BlockNames:
    """Index of every name by which a case can refer to blocks.

    case       with its structures and [groups]
    blocks     all of them
    aliases    other names of single blocks: {alias: id}
    centroids  of the blocks [m], (n_blocks, d)
    """

    def __init__(self, case: Case, blocks: Sequence[Block], aliases: Mapping[str, str], centroids: np.ndarray):
        self.case, self.blocks, self.centroids = case, blocks, centroids
        self.ids = [block.id for block in blocks]
        self.aliases = dict(aliases)
        names = {name: (name,) for name in self.ids}
        self.single = names | {alias: (name,) for alias, name in aliases.items() if alias not in names}

    @cached_property
    def of_structures(self) -> dict[str, list[Block]]:
        """Blocks of each structure by its id."""
        found: dict[str, list[Block]] = {table.id: [] for table in self.case.structure}
        for block in self.blocks:
            if block.path[:1] == ("structure",):
                found[self.case.structure[int(block.path[1])].id].append(block)
        return found

    @property
    def known(self) -> list[str]:
        """All names that may be given, groups first."""
        return [*self.case.groups, *self.single]

    def named(self, name: str, within: tuple[str, ...] = ()) -> tuple[str, ...]:
        """Return the ids of the blocks with a name: of a block, an alias, a group or a pattern. Raises NoSuchBlocks.

        within: groups that are looked up already, of which this is a part.
        """
        if name in self.single:
            return self.single[name]
        if name in self.case.groups:
            return self.group(name, within)
        if is_pattern(name):
            return self._like(name)
        raise NoSuchBlocks(unknown_name("block", name, self.known))

    def group(self, name: str, within: tuple[str, ...] = ()) -> tuple[str, ...]:
        """Return the ids of the blocks of a group, each once. Raises NoSuchBlocks, with the number of the member."""
        found: dict[str, None] = {}
        for k, member in enumerate(self.case.groups[name]):
            try:
                if isinstance(member, GroupMember):
                    ids = self.of_member(member)
                elif member in (*within, name):
                    raise NoSuchBlocks(f"group {show(member)} is part of itself")
                else:
                    ids = self.named(member, (*within, name))
            except NoSuchBlocks as error:
                raise NoSuchBlocks(str(error), k, *(error.keys if isinstance(member, GroupMember) else ())) from None
            found |= dict.fromkeys(ids)
        return tuple(found)

    def of_member(self, member: GroupMember) -> tuple[str, ...]:
        """Return the ids of the blocks that a table in a group selects. Raises NoSuchBlocks."""
        ids = self.ids if member.structure is None else self.of_structure(member.structure, member.course)
        if member.box is None:
            return tuple(ids)
        low, high = (f(np.array(member.box), axis=0) for f in (np.min, np.max))
        inside = ((self.centroids >= low) & (self.centroids <= high)).all(axis=1)
        names = {self.ids[i] for i in np.flatnonzero(inside)}
        found = tuple(name for name in ids if name in names)
        if not found:
            lows, highs = self.centroids.min(axis=0), self.centroids.max(axis=0)
            between = f"{lows.round(6).tolist()} and {highs.round(6).tolist()}"
            raise NoSuchBlocks(f"no block has its centroid in it; centroids lie between {between}", "box")
        return found

    def of_structure(self, structure: str, course: Courses = None) -> tuple[str, ...]:
        """Return the ids of the blocks of a structure, or of some of its courses. Raises NoSuchBlocks."""
        if structure not in self.of_structures:
            raise NoSuchBlocks(unknown_name("structure", structure, list(self.of_structures)), "structure")
        blocks = self.of_structures[structure]
        if course is None:
            return tuple(block.id for block in blocks)
        low, high = course if isinstance(course, tuple) else (course, course)
        found = tuple(block.id for block in blocks if low <= block.course <= high)
        top = max((block.course for block in blocks), default=0)
        if high > top or not found:
            has = f"has courses 1 to {top}" if top else "has no courses"
            raise NoSuchBlocks(f"{show(course)} is not allowed; structure {show(structure)} {has}", "course")
        return found

    def _like(self, pattern: str) -> tuple[str, ...]:
        """Return the ids of the blocks whose id or alias matches a pattern, in the order of the model."""
        signs = {"*": ".*", "?": "."}
        matching = re.compile("".join(signs.get(letter, re.escape(letter)) for letter in pattern)).fullmatch
        by_alias = {name for alias, name in self.aliases.items() if matching(alias)}
        found = tuple(name for name in self.ids if name in by_alias or matching(name))
        if not found:
            hint = nearest(pattern.replace("*", "").replace("?", ""), self.known)
            raise NoSuchBlocks(
                f"no block is called like {show(pattern)}{hint and ', ' + hint} (allowed: {listing(self.known)})"
            )
        return found


class Selections:
    """All block selections of a case: `found`, {name: ids of the blocks}, and `problems`."""

    def __init__(self, names: BlockNames):
        self.names, self.case = names, names.case
        self.found: dict[str, tuple[str, ...]] = {}
        self.problems: list[CaseProblem] = list(_odd_groups(names))  # some twice, where a group is used
        for key in SELECTING:
            for i, table in enumerate(getattr(self.case, key)):
                self._add_table((key, i), table)
        for i, initial in enumerate(self.case.initial):
            self._add_all(("initial", i, "blocks"), initial.blocks or ())
        for i, monitor in enumerate(self.case.monitor):
            self._add_all(("monitor", i, "between"), monitor.between or ())
        for i, motion in enumerate(self.case.motion):
            self._add_all(("motion", i, "blocks"), motion.blocks)
        if self.case.damping is not None and self.case.damping.block is not None:
            self._add_all(("damping",), {"block": self.case.damping.block})

    def several(self) -> tuple[tuple[str, tuple[str, ...]], ...]:
        """Selections that the model keeps, all but the names of single blocks."""
        return tuple((name, ids) for name, ids in self.found.items() if name not in self.names.single)

    def _add_table(self, path: KeyPath, table: Selection) -> None:
        if table.block is not None:
            self._add_all(path, {"block": table.block})
        elif table.structure is not None:
            try:
                found = self.names.of_structure(table.structure, table.course)
                self.found[structure_words(table.structure, table.course) or ""] = found
            except NoSuchBlocks as error:
                self.problems.append(CaseProblem((*path, *error.keys), str(error)))

    def _add_all(self, path: KeyPath, names: Sequence[str] | Mapping[str, str]) -> None:
        """Resolve names in a list or under keys, and record the problems."""
        for key, name in names.items() if isinstance(names, Mapping) else enumerate(names):
            try:
                self.found[name] = self.names.named(name)
            except NoSuchBlocks as error:
                place = (*path, key) if name not in self.case.groups else ("groups", name, *error.keys)
                self.problems.append(CaseProblem(place, str(error)))


def _odd_groups(names: BlockNames) -> Iterator[CaseProblem]:
    """Report groups with the name of a block, and members of groups that match nothing."""
    for name in names.case.groups:
        if name in names.single:
            message = f"{show(name)} is the name of a block already; give the group another"
            yield CaseProblem(("groups", name), message, at_key=True)
        elif is_pattern(name):
            yield CaseProblem(("groups", name), f"{show(name)} is not allowed; names have no * and ?", at_key=True)
        else:
            try:
                names.group(name)
            except NoSuchBlocks as error:
                yield CaseProblem(("groups", name, *error.keys), str(error))
