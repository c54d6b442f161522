"""Charts of `dem plot`: choice of columns and runs, and their names."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dem_cli.errors import DemError, UsageError

if TYPE_CHECKING:
    from dem_cli.results.output.reader import Results
    from dem_cli.results.post.chart import ChartOptions
    from dem_cli.results.post.labels import Quantity
    from dem_cli.results.post.sweep_table import SweepTable

LONGEST_CELL = 60  # letters of a cell of a listing


@cache
def describe(key: str) -> tuple[str, str]:
    """Return meaning and unit of a key of the case file, where all kinds of table agree on it."""
    from dem_cli.app.api import make_case_model
    from dem_cli.case.explain import find

    try:
        found = [entry.key for entry in find(make_case_model(), key) if entry.key is not None]
    except UsageError:
        return "", ""
    meanings, units = ({one.meaning for one in found}, {one.units[0] if one.units else "" for one in found})
    return (meanings.pop() if len(meanings) == 1 else "", units.pop() if len(units) == 1 else "")


class ColumnChoice(NamedTuple):
    """Columns of a chart as the user names them."""

    x: str | None = None
    ys: Sequence[str] = ()
    by: Sequence[str] = ()  # keys of the case: a curve for each of their values
    where: Sequence[str] = ()  # KEY=VALUE: of a sweep, only runs that have this value
    as_map: bool = False  # of a sweep: a heat map over two keys


def of_runs(folders: Sequence[Path], choice: ColumnChoice, target: Path, options: ChartOptions) -> None:
    """Draw a curve for each run. Raises UsageError."""
    from dem_cli.results.output.reader import read
    from dem_cli.results.post.curves import FamilyMember, draw_curves
    from dem_cli.results.post.labels import of_key
    from dem_cli.results.post.sweep_table import shown

    results = [read(folder) for folder in folders]
    x, ys = _columns(results[0], choice)
    by, family = choice.by, ""
    names = _names(folders)
    members = [FamilyMember(name, name, run) for name, run in zip(names, results)]
    if by:
        family = ", ".join(of_key(key, describe).label() for key in by)
        values = [tuple(_case_value(folder, key) for key in by) for folder in folders]
        members = [
            FamilyMember(", ".join(map(shown, row)), row[0] if len(by) == 1 else row, run)
            for row, run in zip(values, results)
        ]
    titles = list(dict.fromkeys(str(run.summary.get("title", "")) for run in results))
    draw_curves(members, x, ys, target, options, titles[0] if len(titles) == 1 else "", family)


def _columns(results: Results, choice: ColumnChoice) -> tuple[str, list[str]]:
    """Return the requested columns, or the usual ones."""
    from dem_cli.results.post.run_columns import usual

    found = usual(results)
    if not choice.ys and found is None:
        raise UsageError(f"a run of kind {results.kind!r} has no usual curve: choose with -x and -y (see --list)")
    at, upwards = found or ("step", [])
    return choice.x or at, list(choice.ys) or upwards


def _names(folders: Sequence[Path]) -> list[str]:
    """Return distinct names of folders: their last names, or more of their paths."""
    paths = [folder.resolve() for folder in folders]
    for depth in range(1, max(len(path.parts) for path in paths) + 1):
        names = ["/".join(path.parts[-depth:]) for path in paths]
        if len(set(names)) == len(names):
            return names
    raise UsageError("the same folder is given twice")


def _case_value(folder: Path, key: str) -> Any:
    """Return the value of a key in the effective case of a run. Raises UsageError."""
    from dem_cli.app import api
    from dem_cli.case.overrides import key_path, value_at
    from dem_cli.results.output.store import CASE

    try:
        found = value_at(api.load_case(folder / CASE).case, key_path(key))
    except DemError as error:
        raise UsageError(f"--by {key}: the case of {folder} cannot be read ({str(error).splitlines()[0]})") from None
    if found is None:
        raise UsageError(f"--by {key}: the case of {folder} has no such key")
    return found if isinstance(found, (int, float, str, bool)) else str(found)


def of_sweep(folder: Path, choice: ColumnChoice, target: Path, options: ChartOptions) -> None:
    """Draw columns of the table of a sweep, or of its runs where the table lacks them. Raises UsageError."""
    from dem_cli.results.post.labels import nearest
    from dem_cli.results.post.maps import draw_map
    from dem_cli.results.post.sweep_chart import draw_sweep
    from dem_cli.results.post.sweep_table import read_sweep

    table = read_sweep(folder).only(dict(map(_condition, choice.where)))
    x, by = choice.x, choice.by
    inside = [name for name in (x, *choice.ys) if name and nearest(name, table.names) is None]
    if inside and not choice.as_map and _has_runs(table, inside):
        _runs_of_sweep(table, choice, target, options)
        return
    quantities = _quantities(table)
    ys = [table.exact(y) for y in choice.ys] or [table.answer()]
    ranked = table.ranked()
    if choice.as_map or _needs_map(table, x, ys, ranked):
        keys = [table.exact(key) for key in (x, *by) if key]
        keys = (keys + [key for key in ranked if key not in keys])[:2]
        if len(keys) < 2:
            raise UsageError("--map needs two keys with more than one value each")
        draw_map(table, keys[0], keys[1], ys[0], target, options, quantities)
        return
    if x is None and not ranked:
        raise UsageError(f"{folder}: no key has more than one value; choose a column with -x")
    across = table.exact(x) if x else ranked[0]
    families = [table.exact(key) for key in by] or [key for key in ranked if key != across and across in table.keys]
    draw_sweep(table, across, ys, families, target, options, quantities)


def _needs_map(table: SweepTable, x: str | None, ys: Sequence[str], ranked: Sequence[str]) -> bool:
    """Test whether a textual answer over two keys needs a map, since lines would overlap."""
    from dem_cli.results.post.sweep_table import is_answer_in_words

    return x is None and len(ys) == 1 and len(ranked) == 2 and is_answer_in_words(table.columns[ys[0]])


def _condition(text: str) -> tuple[str, Any]:
    from dem_cli.results.post.sweep_table import value

    name, sign, said = text.partition("=")
    if not sign:
        raise UsageError(f"--where {text}: must be KEY=VALUE")
    return name.strip(), value(said.strip().strip("\"'"))


def _quantities(table: SweepTable) -> dict[str, Quantity]:
    """Return words and units of all columns."""
    from dem_cli.results.post.labels import of_key, of_output

    said = {name: values for name, values in table.columns.items() if name.endswith(".unit")}
    units = {name: next((v for v in values if v), "") for name, values in said.items()}
    return {name: of_key(name, describe) if name in table.keys else of_output(name, units) for name in table.names}


def _kept(table: SweepTable) -> Iterator[tuple[int, Path]]:
    """Yield the rows whose runs kept their results, with their folders."""
    from dem_cli.results.output.store import RESULTS
    from dem_cli.results.output.sweep_files import RUNS

    for i, run in enumerate(table.columns["run"]):
        folder = table.folder / RUNS / run
        if run and (folder / RESULTS).is_file():
            yield i, folder


def _has_runs(table: SweepTable, names: Sequence[str]) -> bool:
    """Test whether the kept runs of a sweep have these columns."""
    from dem_cli.results.output.reader import read
    from dem_cli.results.post.labels import nearest
    from dem_cli.results.post.run_columns import tables

    first = next(_kept(table), None)
    if first is None:
        return False
    there = [name for one in tables(read(first[1])) for name in one.quantities]
    return all(nearest(name, there) is not None for name in names)


def _runs_of_sweep(table: SweepTable, choice: ColumnChoice, target: Path, options: ChartOptions) -> None:
    """Draw a curve for each kept run, coloured by a swept key."""
    from dem_cli.results.output.reader import read
    from dem_cli.results.post.chart import MOST_NAMES
    from dem_cli.results.post.curves import FamilyMember, draw_curves
    from dem_cli.results.post.sweep_table import shown

    quantities = _quantities(table)
    keys = [table.exact(key) for key in choice.by] or table.ranked()
    rows = [(tuple(table.columns[key][i] for key in keys), read(folder)) for i, folder in _kept(table)]
    x, ys = _columns(rows[0][1], choice)
    if len({row for row, _ in rows}) > MOST_NAMES:  # too many to be named: coloured by the first key
        keys, rows = keys[:1], [(row[:1], run) for row, run in rows]
    members = [FamilyMember(", ".join(map(shown, row)), row[0] if len(keys) == 1 else row, run) for row, run in rows]
    family = ", ".join(quantities[key].label() for key in keys)
    draw_curves(members, x, ys, target, options, table.title, family)


def listing(folders: Sequence[Path], sweep: bool) -> list[str]:
    """List the columns, a line each: name, unit, and meaning."""
    from dem_cli.results.output.reader import read
    from dem_cli.results.post.run_columns import tables
    from dem_cli.results.post.sweep_table import distinct, numeric, read_sweep, shown

    groups: list[tuple[str, list[tuple[str, ...]]]] = []
    if sweep:
        table = read_sweep(folders[0])
        quantities = _quantities(table)
        rows: list[tuple[str, ...]] = []
        for name in table.names:
            values = distinct(table.columns[name])
            if values and not name.endswith(".unit"):
                between = f"{shown(values[0])} to {shown(values[-1])}" if numeric(values) else shown(values[0])
                spread = ("swept: " if name in table.keys else "") + (between if len(values) > 1 else shown(values[0]))
                rows.append((name, quantities[name].unit, quantities[name].words, spread))
        groups.append((f"{table.count} runs", rows))
        folders = [folder for _, folder in _kept(table)][:1]
    for one in tables(read(folders[0])) if folders else ():
        rows = [(name, q.unit, q.words if q.words != name else "") for name, q in one.quantities.items()]
        groups.append((f"{one.title} of each run" if sweep else one.title, rows))
    return list(_laid_out(groups))


def _laid_out(groups: Sequence[tuple[str, Sequence[tuple[str, ...]]]]) -> Iterator[str]:
    for title, rows in groups:
        if rows:
            yield title
            widths = [min(LONGEST_CELL, max(len(row[i]) for row in rows)) for i in range(len(rows[0]))]
            for row in rows:
                row = tuple(cell if len(cell) <= LONGEST_CELL else cell[: LONGEST_CELL - 1] + "…" for cell in row)
                yield "  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip()
