"""Tables of failure loads in space."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bench.table import percent

from studies.template import table

EXACT = ("structure", "by hand", "load", "DEM", "error", "path", "associated", "steps")
COMPARED = ("structure", "blocks", "points", "DEM", "path", "error", "associated", "DEM says", "CPU [s]")
TWINS = ("case", "blocks", "plane", "in space", "difference", "brackets", "steps", "times the steps")


def values(found: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values that page.md.j2 shows."""
    hand, walls, twins, published = (found.get(name, []) for name in ("by_hand", "walls", "twins", "published"))
    errors = [abs(middle(row) / row["load"] - 1.0) for row in hand if "twisted" not in row["name"]]
    loads = [row for row in twins if difference(row) is not None]
    apart = [row["name"] for row in loads if abs(difference(row) or 0.0) > SAME]
    return {
        "by_hand": table(EXACT, map(exact_cells, hand)),
        "n_by_hand": len(hand),
        "largest": percent(max(errors, default=0.0)),
        "walls": table(COMPARED, map(compared_cells, walls)),
        "published": table((*COMPARED[:4], "prototype", *COMPARED[4:]), map(published_cells, published)),
        "twins": table(TWINS, map(twin_cells, twins)),
        "n_twins": len(twins),
        "n_loads": len(loads),
        "n_same": len(loads) - len(apart),
        "apart": ", ".join(f"`{name}`" for name in apart) or "none",
    }


SAME = 0.0015  # difference of twins, of the load


def middle(row: Mapping[str, Any]) -> float:
    """Of a bracket."""
    low, high = row["bracket"]
    return 0.5 * float(low + high)


def exact_cells(row: Mapping[str, Any]) -> list[str]:
    """A structure whose load is known."""
    error = percent(middle(row) / row["load"] - 1.0)
    return [row["name"], row["formula"], number(row["load"]), bracket(row["bracket"]), error,
            path(row), number(row["associated"]), f"{row['steps']:,}"]  # fmt: skip


def compared_cells(row: Mapping[str, Any]) -> list[str]:
    """A structure whose load several methods give."""
    error = percent(row["bracket"][0] / row["path"] - 1.0) if row["path"] else "–"
    said = row["range"]
    span = f"{number(said['lowest'])} to {number(said['highest'])}" if said else ""
    return [row["name"], str(row["blocks"]), f"{row['points']:,}", bracket(row["bracket"]), path(row), error,
            number(row["associated"]), span, f"{row['seconds']:.1f}"]  # fmt: skip


def published_cells(row: Mapping[str, Any]) -> list[str]:
    """The same, with what a prototype of the solver found."""
    cells = compared_cells(row)
    over = percent(middle(row) / row["prototype"] - 1.0)
    return [*cells[:4], f"{number(row['prototype'])} ({over})", *cells[4:]]


def twin_cells(row: Mapping[str, Any]) -> list[str]:
    """A plane case and its prisms."""
    plane, space = row["plane"], row["space"]
    apart = difference(row)
    shown = [bracket(one["bracket"]) if apart is not None else one["status"] for one in (plane, space)]
    same = "" if apart is None else "overlap" if overlap(plane["bracket"], space["bracket"]) else "apart"
    return [f"`{row['name']}`", str(plane["blocks"]), *shown, "–" if apart is None else percent(apart), same,
            f"{space['steps']:,}", f"{space['steps'] / plane['steps']:.2f}"]  # fmt: skip


def difference(row: Mapping[str, Any]) -> float | None:
    """Of the middles of both brackets, relative; None: no load."""
    brackets = [row[name]["bracket"] for name in ("plane", "space")]
    if any(one is None or None in one for one in brackets):
        return None
    plane, space = (sum(one) for one in brackets)
    return float(space / plane - 1.0)


def overlap(one: list[float], other: list[float]) -> bool:
    """Whether two brackets share a load."""
    return one[0] <= other[1] and other[0] <= one[1]


def bracket(found: list[float] | None) -> str:
    """Both ends."""
    return "–" if found is None or None in found else f"{number(found[0])}–{number(found[1])}"


def path(row: Mapping[str, Any]) -> str:
    """The load of the zero-dilation path, or how far it came."""
    if row["path"]:
        return number(row["path"])
    return f"≥ {number(row['path_at_least'])}" if row.get("path_at_least") else "–"


def number(value: float | None) -> str:
    """Five digits, or a dash."""
    return "–" if value is None else f"{value:.5g}"
