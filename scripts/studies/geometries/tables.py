"""The table of both geometries, why they disagree, and what is wrong in a row."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bench.table import percent

from studies.geometries.measure import RESOLUTION, apart
from studies.template import table

Row = Mapping[str, Any]
HEAD = (
    "seed", "structure", "", "blocks", "μ", "fixed", "moving", "bound", "off, fixed", "off, moving", "bound there",
)  # fmt: skip
WHY = (
    "seed", "fixed", "moving", "apart", "from the path", "from limit analysis", "stiffer joints", "μ = 5, fixed",
    "μ = 5, moving", "why",
)  # fmt: skip
ABOVE = (
    "seed", "run", "load", "bound of the start", "moved by [mm]", "bound where it rests", "status",
    "stones a tenth as far off",
)  # fmt: skip
RUNS = {
    "drawn_fixed": "fixed", "drawn_moving": "moving", "off_fixed": "off, fixed", "off_moving": "off, moving"
}  # fmt: skip
FALLS = "does not stand"
HISTORY = "way of loading: in fixed geometry, too, the load of the moving one is in equilibrium"
OTHER_PATH = "way of loading: in fixed geometry another way leads to the load of the moving one"
SOFT = "joints that deform: on stiffer ones the loads are the same"
UNKNOWN = "**not explained**"


def values(found: Mapping[str, Row]) -> dict[str, Any]:
    """Return the values that page.md.j2 shows: tables, counts and minutes of CPU."""
    rows = {seed: row for seed, row in found.items() if seed != "machine"}
    differ = {seed: row for seed, row in rows.items() if apart(row["drawn_fixed"], row["drawn_moving"]) > RESOLUTION}
    both = [row for row in rows.values() if all(load(row[name]) for name in ("drawn_fixed", "drawn_moving"))]
    said = [seed for seed, row in differ.items() if says(row)]
    above = [(seed, name) for seed, row in rows.items() for name in RUNS if row[name].get("above_the_bound")]
    return {
        "rows": table(HEAD, (cells(seed, row) for seed, row in rows.items())),
        "n": len(rows),
        "both": len(both),
        "agree": len(both) - len(differ),
        "differ": len(differ),
        "said": len(said),
        "unexplained": sum(why(row) == UNKNOWN for row in differ.values()),
        "why": table(WHY, (explained(seed, row) for seed, row in differ.items())),
        "above": table(ABOVE, (over(seed, name, rows[seed]) for seed, name in above)),
        "above_count": len(above),
        "above_explained": sum(rows[seed][name]["above_the_bound"]["explained"] for seed, name in above),
        "silent": sum(len(problems(row)) for row in rows.values()),
        "falls": sum(row["off_fixed"]["status"].startswith(FALLS) for row in rows.values()),
        "loads": sum(bool(load(row[name])) for row in rows.values() for name in RUNS),
        "bounds": sum(bool(load(row[name]) and row[name].get("bound")) for row in rows.values() for name in RUNS),
        "unfinished": sum(row[name]["status"].startswith("not") for row in rows.values() for name in RUNS),
        "minutes": f"{sum(row['seconds'] for row in rows.values()) / 60.0:.0f}",
        "no_bound": reasons(rows),
    }


def reasons(rows: Mapping[str, Row]) -> str:
    """List runs with a load and no bound, each with the reason that it states."""
    missing = [
        f"* {seed}, {shown}: {row[name].get('no_bound', 'nothing is said')}"
        for seed, row in rows.items()
        for name, shown in RUNS.items()
        if load(row[name]) and not row[name].get("bound")
    ]
    return "\n".join(missing) or "* none"


def cells(seed: str, row: Row) -> list[str]:
    """Format a row of the table."""
    drawn, moved = row["drawn_fixed"], row["off_moving"]
    named = row["kind"] + (", tilted" if row["pattern"] == "tilt" else "")
    first = [seed, named, f"{row['dimension']}D", str(row["blocks"]), f"{row['friction']:g}"]
    bound = drawn.get("bound") or row["drawn_moving"].get("bound")
    above = moved.get("above_the_bound") or {}
    there = above.get("bound_where_it_rests") or moved.get("bound")
    return [
        *first, shown(drawn), shown(row["drawn_moving"]), number(bound), shown(row["off_fixed"]), shown(moved),
        number(there),
    ]  # fmt: skip


def shown(run: Row) -> str:
    """Format a load, with a star for a wide bracket, in parentheses where it did not converge."""
    if run["status"].startswith(FALLS):
        return "falls"
    if not load(run):
        return run["status"].split(":")[0]
    low, high = run["failure_load_bracket"]
    wide = high is None or high - low > 1.05 * RESOLUTION * low
    text = f"{low:.5g}" + ("\\*" if wide else "")
    return text if run["status"] == "ok" else f"({text})"


def number(value: float | None) -> str:
    """Format a number with five digits, or a dash."""
    return "–" if value is None else f"{value:.5g}"


def load(run: Row) -> float | None:
    """Return the load of the highest equilibrium."""
    return (run.get("failure_load_bracket") or [None])[0]


def says(row: Row) -> bool:
    """Test whether one of two runs warns that methods differ."""
    words = [text for name in ("drawn_fixed", "drawn_moving") for text in row[name].get("warnings", [])]
    return any("methods differ" in text for text in words)


def explained(seed: str, row: Row) -> list[str]:
    """Format a disagreement of both geometries."""
    fixed, moving = row["drawn_fixed"], row["drawn_moving"]
    others = [number(load(row[name])) for name in ("by_path", "by_limit", "stiffer", "rough_fixed", "rough_moving")]
    return [seed, number(load(fixed)), number(load(moving)), percent(apart(fixed, moving)), *others, why(row)]


def why(row: Row) -> str:
    """Name the cause of a disagreement by the runs that were made of it."""
    fixed, moving = load(row["drawn_fixed"]) or 0.0, load(row["drawn_moving"]) or 0.0
    path, limit, stiffer = (load(row[name]) or 0.0 for name in ("by_path", "by_limit", "stiffer"))
    if abs(path - moving) <= RESOLUTION * moving:
        return OTHER_PATH
    if moving > fixed and limit >= (1.0 - RESOLUTION) * moving:
        return HISTORY
    return SOFT if abs(stiffer - fixed) <= 2.0 * RESOLUTION * fixed else UNKNOWN


def over(seed: str, name: str, row: Row) -> list[str]:
    """Format a load above the bound of the start, or of where blocks rest."""
    run, less = row[name], row.get("less_off")
    above = run["above_the_bound"]
    start = "none stands" if above["bound"] == above["bound_where_it_rests"] else number(above["bound"])
    moved, there = f"{1e3 * above['displacement']:.2g}", number(above["bound_where_it_rests"])
    tenth = f"{number(load(less))}, bound {number(less.get('bound'))}" if less and name == "off_moving" else "–"
    return [seed, RUNS[name], number(load(run)), start, moved, there, run["status"], tenth]


def problems(row: Row) -> list[str]:
    """List loads above their bound without a warning."""
    return [
        f"{row['kind']}, {shown}: {load(row[name]):.5g} above {row[name]['bound']:.5g} without a word"
        for name, shown in RUNS.items()
        if load(row[name])
        and row[name].get("bound")
        and load(row[name]) > (1.0 + RESOLUTION) * row[name]["bound"]
        and not row[name].get("above_the_bound")
    ]
