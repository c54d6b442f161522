"""Dimensions of a case: which tables, keys and values are known in the plane alone or in space alone; one table.

What reads a case refuses what is not known in its dimension; `dem explain`, `dem schema` and docs/case.md say it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple, TypeVar

from dem_cli.case.base import CaseModel
from dem_cli.case.vector import VectorLength
from dem_cli.case.wording import kind_of, show
from dem_cli.errors import CaseProblem, KeyPath

NAME = "NAME"  # stands for a name of the user's choice in a key path
Table = TypeVar("Table", bound=CaseModel)


class Scope(NamedTuple):
    """Key of a case file that is allowed in one dimension only."""

    key: str  # path as `dem explain` has it, numbers of tables left out
    dimension: int
    why: str  # what is said where it is given in the other one
    values: tuple[Any, ...] = ()  # of these values alone; (): whatever it is
    beside: tuple[str, Any] | None = None  # only beside this key of the same table with this value

    @property
    def name(self) -> str:
        """Name of the key without its table."""
        return self.key.rpartition(".")[2]

    def holds(self, value: Any, table: Any) -> bool:
        """Test whether the restriction to one dimension applies to this value in its table."""
        if self.beside is not None and (not isinstance(table, dict) or table.get(self.beside[0]) != self.beside[1]):
            return False
        return not self.values or any(type(value) is type(one) and value == one for one in self.values)

    def message(self, value: Any) -> str:
        """Return the error message for a value that is not allowed in the other dimension."""
        if not self.values:
            return self.why
        return f"{show(value)} is not allowed; {self.why}"


SCOPES = (
    Scope(
        "joints.NAME.points", 3, "must be an integer from 2 to 9 or 'section' in 2D", ("vertices", "vertices+centre")
    ),
    Scope("monitor.component", 3, "a rotation has none in 2D", ("x", "y", "z"), beside=("quantity", "rotation")),
    Scope("monitor.component", 3, "a moment has none in 2D", ("x", "y", "z"), beside=("quantity", "reaction_moment")),
    Scope("monitor.component", 3, "must be 'x' or 'y' in 2D", ("z",)),
    Scope(
        "monitor.quantity",
        3,
        "a line in 2D has 'normal_force', 'shear_force' and 'moment'",
        ("shear_force_across", "moment_across", "torsion"),
    ),
    Scope("initial.axis", 3, "blocks tilt in their plane in 2D: give dimension = 3"),
    Scope("block.thickness", 2, "not used in 3D: corners have three coordinates, and a polygon goes from y[0] to y[1]"),
    Scope("block.faces", 3, "faces are those of a block in 3D: give dimension = 3"),
    Scope("block.parts.faces", 3, "faces are those of a block in 3D: give dimension = 3"),
    Scope("block.polygon", 3, "a polygon with y is a prism in 3D: give dimension = 3, or vertices"),
    Scope("block.y", 3, "a polygon with y is a prism in 3D: give dimension = 3, or thickness"),
    Scope("structure.up", 3, "a drawing in 2D lies in the plane of the case: give dimension = 3 for a mesh"),
    Scope("structure.leaves", 3, "a wall has leaves across its thickness in 3D: give dimension = 3"),
    Scope("structure.through_stones", 3, "a wall has leaves across its thickness in 3D: give dimension = 3"),
    Scope("structure.core", 3, "a wall has a core across its thickness in 3D: give dimension = 3"),
    Scope("pressure.face", 3, "must be '+x', '-x', '+y' (up), '-y', 'top', 'bottom' or 'all' in 2D", ("+z", "-z")),
    Scope("structure.sides", 3, "a structure has sides in 3D: give dimension = 3"),
    Scope("structure.rows", 3, "a bridge has stones across it in 3D: give dimension = 3", beside=("kind", "bridge")),
    Scope("structure.spandrels.thickness", 3, "a bridge has two spandrel walls in 3D: give dimension = 3"),
    Scope("structure.fill", 3, "fill lies between two spandrel walls in 3D: give dimension = 3"),
)


def dimension_of(data: dict[str, Any]) -> int:
    """Return the dimension, 2 or 3, of a case that is not validated yet."""
    return 3 if data.get("dimension") == 3 and data["dimension"] is not True else 2


def problems(data: dict[str, Any]) -> Iterator[CaseProblem]:
    """Report keys and values of a case that its dimension does not allow."""
    for scope, path, table in _foreign(data):
        value = table[scope.name]
        if value not in ([], {}, None) and scope.holds(value, table):  # no tables say no more than leaving them out
            yield CaseProblem(path, scope.message(value), at_key=not scope.values)


def leave_out(data: dict[str, Any]) -> None:
    """Remove from a complete case, in place, the defaults that its dimension does not allow."""
    for scope, _, table in list(_foreign(data)):
        if not scope.values:
            del table[scope.name]


def _foreign(data: dict[str, Any]) -> Iterator[tuple[Scope, KeyPath, dict[str, Any]]]:
    """Find the keys in plain data that only the other dimension allows, with path and table."""
    here: dict[str, list[tuple[str, Scope]]] = {}
    for scope in SCOPES:
        if scope.dimension != dimension_of(data):
            here.setdefault(scope.key.rpartition(".")[0], []).append((scope.name, scope))
    for parent, scopes in here.items():
        for path, table in _tables(data, parent.split(".") if parent else (), ()):
            for name, scope in scopes:
                if name in table:
                    yield scope, (*path, name), table


def _tables(value: Any, steps: Sequence[str], path: KeyPath) -> Iterator[tuple[KeyPath, dict[str, Any]]]:
    """Find every table at a key path of plain data."""
    if isinstance(value, (list, tuple)):
        for i, item in enumerate(value):
            yield from _tables(item, steps, (*path, i))
    elif isinstance(value, dict) and not steps:
        yield path, value
    elif isinstance(value, dict):
        for name in list(value) if steps[0] == NAME else steps[:1]:
            if name in value:
                yield from _tables(value[name], steps[1:], (*path, name))


def known_in(path: Sequence[str], value: Any = None) -> int | None:
    """Return the only dimension in which a key path, or one value of it, is allowed; None: both."""
    key = ".".join(path)
    for scope in SCOPES:
        whole = not scope.values and scope.beside is None
        if scope.key == key and (whole or (value is not None and value in scope.values)):
            return scope.dimension
    return None


def in_space(table: Table) -> Table:
    """Complete the default vectors of a 3D case to as many components as the given ones have."""
    changes = {}
    for name, field in type(table).model_fields.items():
        value = getattr(table, name)
        if isinstance(value, (float, tuple)) and value != () and name not in table.model_fields_set:
            kind = kind_of(field.annotation, field.metadata)
            length = next((limit for limit in kind.limits if isinstance(limit, VectorLength)), None)
            padded: Any = length.padded(value) if length is not None and length.is_planar(value) else value
        elif isinstance(value, tuple):
            padded = tuple(in_space(item) if isinstance(item, CaseModel) else item for item in value)
        elif isinstance(value, dict):
            padded = {key: in_space(item) if isinstance(item, CaseModel) else item for key, item in value.items()}
        else:
            padded = in_space(value) if isinstance(value, CaseModel) else value
        if padded is not value and padded != value:
            changes[name] = padded
    if not changes:
        return table
    return type(table).model_construct(_fields_set=set(table.model_fields_set), **{**dict(table), **changes})
