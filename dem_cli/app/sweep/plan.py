"""Plan the runs of a sweep: from the [sweep] of a case to the changes of each run.

A plan is the rows of [[sweep.run]] (or one empty row), each combined with every point of the grid (or with the
lists side by side), each of those with every point of the Latin hypercube. Keys come in the order of the file.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, product
from math import prod
from typing import Any, NamedTuple

from dem_cli.app.sweep.distributions import EVEN_KEYS, QUANTILES, drawn, even, latin_hypercube
from dem_cli.case.overrides import Override, key_path
from dem_cli.case.sweep import Sweep
from dem_cli.case.wording import listing, show, unknown_name
from dem_cli.errors import CaseError, CaseProblem, KeyPath, dotted
from dem_cli.input_limits import MOST_RUNS
from dem_cli.results.output.sweep_files import IDENTITY_COLUMNS

LABEL_KEY = "name"  # of a [[sweep.run]]: a label, no key of the case
RESERVED_NAMES = (LABEL_KEY, *IDENTITY_COLUMNS)  # of the table, which no axis of bundles is called
LEAVE_OUT = Override("sweep", ("sweep",), None)  # a run is one case


class KeyChange(NamedTuple):
    """Change of one key in one run: its column in the table, and its overrides."""

    key: str
    value: Any
    overrides: tuple[Override, ...]
    bundled: bool = False


class SweepRun(NamedTuple):
    """Run of a sweep with its changes in order."""

    changes: tuple[KeyChange, ...]
    sampled: bool  # whether anything of it was drawn

    @property
    def values(self) -> dict[str, Any]:
        """Values by key."""
        return {change.key: change.value for change in self.changes}

    @property
    def overrides(self) -> tuple[Override, ...]:
        """All changes of the case; bundles first, so that single keys may override them."""
        by_size = sorted(self.changes, key=lambda change: not change.bundled)
        return (*(override for change in by_size for override in change.overrides), LEAVE_OUT)


class SweepPlan(NamedTuple):
    """Plan of a sweep: all runs; `keys` are the columns that distinguish them."""

    keys: tuple[str, ...]
    runs: tuple[SweepRun, ...]


def plan_of(table: Sweep, seed: int) -> SweepPlan:
    """Plan the runs of a [sweep]. Raises CaseError, by key, for an impossible request.

    seed: of whatever is drawn.
    """
    axes, samples = _axes(table)
    for axis, names in table.bundle.items():
        if axis in RESERVED_NAMES:
            raise _wrong(("sweep", "bundle", axis), f"'{axis}' is a column of the table already; call it otherwise")
        axes.setdefault(axis, [_bundled(table, axis, name, ("sweep", "bundle", axis)) for name in names])
    if not axes and not samples and not table.run:
        message = "nothing to be changed: give it keys of the case, with their values"
        raise CaseError([CaseProblem(("sweep",), message, at_key=True)])
    _check_number(table, [len(values) for values in axes.values()])
    drawn_points = _drawn_points(samples, table.samples, seed)
    runs = []
    for row in [_row(table, number, row) for number, row in enumerate(table.run)] or [()]:
        said = {change.key for change in row}  # what a run says of a key counts
        points = list(_points({key: axes[key] for key in axes if key not in said}, table.zip))
        for point, sample in product(points, drawn_points):
            changes = (*row, *point, *(change for change in sample if change.key not in said))
            runs.append(SweepRun(changes, bool(sample)))
    _check_order(runs)
    keys = dict.fromkeys(change.key for run in runs for change in run.changes)
    return SweepPlan(tuple(sorted(keys, key=lambda key: key != LABEL_KEY)), tuple(runs))  # the label comes first


def show_value(value: Any) -> str:
    """Format a value as a cell of a table."""
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


Axes = dict[str, list[KeyChange]]


def _check_number(table: Sweep, lengths: Sequence[int]) -> None:
    """Raise CaseError where there would be too many runs. lengths: of the lists of values."""
    several = max(lengths, default=1) if table.zip else prod(lengths)
    count = max(len(table.run), 1) * (table.samples or 1) * several
    if count > MOST_RUNS:
        raise _wrong(("sweep",), f"asks for {count:,} runs; at most {MOST_RUNS:,}")


def _check_order(runs: Sequence[SweepRun]) -> None:
    """Raise CaseError where one change of a run overwrites another, which would make the table wrong."""
    seen = set()
    for run in runs:
        for bundled in (True, False):
            group = [o for change in run.changes if change.bundled is bundled for o in change.overrides]
            paths = tuple(override.path for override in group)
            if paths in seen:
                continue
            seen.add(paths)
            for earlier, later in combinations(group, 2):
                if earlier.path[: len(later.path)] == later.path:
                    here, before = dotted(later.path), dotted(earlier.path)
                    raise _wrong(later.place, f"{here} is changed here, and {before} before: that would be lost")


def _axes(table: Sweep) -> tuple[Axes, dict[str, tuple[KeyPath, Mapping[str, Any]]]]:
    """Return the values of the keys of the grid, and the distributions of the sampled ones."""
    axes: Axes = {}
    samples = {}
    found: dict[str, tuple[KeyPath, bool, Sequence[Any]]] = {}
    for path, form in _leaves(("sweep",), table.model_extra or {}):
        key = dotted(path[1:]) if len(path) > 2 else str(path[1])
        if key in found or key in samples:
            raise _wrong(path, f"{key} has its values already, further up")
        if isinstance(form, Mapping) and form.keys() & QUANTILES.keys():
            samples[key] = (path, form)
            continue
        values = even(path, form) if isinstance(form, Mapping) else form
        if not isinstance(values, (list, tuple)):
            raise _wrong(path, f"{show(values)} is not allowed; must be a list of values, {{ from, to, count }}, or "
                               f"one of {listing(QUANTILES)} with its two numbers")  # fmt: skip
        if not values:
            raise _wrong(path, "an empty list leaves nothing to run")
        found[key] = path, not isinstance(form, Mapping), values
    _check_number(table, [len(values) for _, _, values in found.values()])  # before a change is made for each
    for key, (path, listed, values) in found.items():
        axes[key] = [_change(table, key, value, (*path, i) if listed else path) for i, value in enumerate(values)]
    if samples and table.samples is None:
        key, (path, _) = next(iter(samples.items()))
        raise _wrong(path, "drawn values need their number, such as samples = 100 under [sweep]")
    if table.samples is not None and not samples:
        raise _wrong(("sweep", "samples"), f"nothing to be drawn; give a key one of {listing(QUANTILES)}")
    return axes, samples


def _leaves(path: KeyPath, value: Mapping[str, Any]) -> Iterator[tuple[KeyPath, Any]]:
    """Yield keys and values of nested tables: joints.dry.friction = [...] without quotes is a table of tables."""
    for key, item in value.items():
        if isinstance(item, Mapping) and not item.keys() & (QUANTILES.keys() | EVEN_KEYS):
            yield from _leaves((*path, key), item)
        else:
            yield (*path, key), item


def _row(table: Sweep, number: int, row: Mapping[str, Any]) -> tuple[KeyChange, ...]:
    """Return the changes of a [[sweep.run]]."""
    changes = []
    for path, value in _flat(("sweep", "run", number), row):
        key = dotted(path[3:]) if len(path) > 4 else str(path[3])
        changes.append(KeyChange(LABEL_KEY, value, ()) if key == LABEL_KEY else _change(table, key, value, path))
    return tuple(changes)


def _flat(path: KeyPath, value: Mapping[str, Any]) -> Iterator[tuple[KeyPath, Any]]:
    """Yield keys and single values of nested tables: a table that is no table of tables is a value."""
    for key, item in value.items():
        if isinstance(item, Mapping) and "." not in key and any(isinstance(v, Mapping) for v in item.values()):
            yield from _flat((*path, key), item)
        else:
            yield (*path, key), item


def _change(table: Sweep, key: str, value: Any, path: KeyPath) -> KeyChange:
    """Create the change of a key to a value; for an axis of bundles, all changes of that bundle."""
    if key in table.bundle:
        return _bundled(table, key, value, path)
    return KeyChange(key, _plain(value), (_override(key, value, path),))


def _bundled(table: Sweep, axis: str, name: Any, path: KeyPath) -> KeyChange:
    """Create all changes of a bundle."""
    bundles = table.bundle[axis]
    if not isinstance(name, str) or name not in bundles:
        raise _wrong(path, unknown_name("bundle", name, list(bundles)))
    place = ("sweep", "bundle", axis, name)
    changes = [_override(key, value, (*place, key)) for key, value in bundles[name].items()]
    return KeyChange(axis, name, tuple(changes), bundled=True)


def _override(key: str, value: Any, path: KeyPath) -> Override:
    """Create the override of one key. Raises CaseError for an invalid one; its path is checked with the case."""
    found = key_path(key)
    if not found:
        raise _wrong(path, f"'{key}' is not a key of a case, such as joints.dry.friction or structure.0.courses")
    if found[0] == "sweep":
        raise _wrong(path, "a sweep does not change itself")
    return Override(key, found, _plain(value), path)


def _points(axes: Axes, side_by_side: bool) -> Iterator[tuple[KeyChange, ...]]:
    """Yield all combinations, the last key changing fastest, or the lists in parallel."""
    if not side_by_side:
        yield from product(*axes.values())
        return
    lengths = {key: len(values) for key, values in axes.items()}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{key} has {length}" for key, length in lengths.items())
        raise _wrong(("sweep", "zip"), f"true needs lists of one length; {told}")
    yield from zip(*axes.values(), strict=True) if axes else ((),)


def _drawn_points(samples: Mapping[str, tuple[KeyPath, Mapping[str, Any]]], count: int | None,
                  seed: int) -> list[tuple[KeyChange, ...]]:  # fmt: skip
    """Return the points of the Latin hypercube; one empty point where nothing is sampled."""
    if not samples or count is None:
        return [()]
    unit = latin_hypercube(len(samples), count, seed)
    columns = []
    for i, (key, (path, form)) in enumerate(samples.items()):
        values = drawn(path, form, unit[:, i])
        columns.append([KeyChange(key, value, (_override(key, value, path),)) for value in values])
    return list(zip(*columns, strict=True))


def _plain(value: Any) -> Any:
    """Convert tuples to lists, as in TOML."""
    if isinstance(value, (float, int, str)):  # most of a million
        return value
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return {key: _plain(item) for key, item in value.items()} if isinstance(value, Mapping) else value


def _wrong(path: KeyPath, message: str) -> CaseError:
    return CaseError([CaseProblem(path, message)])
