"""Tables of blocks that move in space."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from bench.table import percent

from studies.template import table

BOOKS = ("book", "re-weighting, net", "all amounts", "steps", "CPU [s]")
SINGLE = ("case", "figure", "exact", "dem", "error", *BOOKS)
TWINS = ("case", "quantity", "exact", "plane", "in space", "difference", "allowed", *BOOKS)

LAWS = ("law", "peak", "plane [mm]", "in space [mm]", "difference", "plane, other step", "book of the plane", *BOOKS)


def values(found: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values that page.md.j2 shows."""
    shown = {name: table(SINGLE, map(cells, found.get(name, []))) for name in ("rocking", "sliding", "flight")}
    rows = [(case, each) for case in found.get("twins", []) for each in case["quantities"]]
    told = [each for _, each in rows if each["allowed"] is not None or isinstance(each["plane"], bool)]
    return shown | {
        "structures": table((*SINGLE, "blocks"), map(built_cells, found.get("structures", []))),
        "twins": table(TWINS, [twin_cells(case, each) for case, each in rows]),
        "laws": table(LAWS, [law_cells(c, each) for c in found.get("laws", []) for each in c["quantities"]]),
        "n_twins": len(found.get("twins", [])),
        "n_same": sum(same(each) for each in told),
        "n_quantities": len(told),
    }


def cells(row: Mapping[str, Any]) -> list[str]:
    """A block beside what is exact."""
    exact = "–" if row["exact"] is None else number(row["exact"])
    return [row["name"], row["figure"], exact, number(row["found"]), off(row["found"], row["exact"]), *books(row)]


def built_cells(row: Mapping[str, Any]) -> list[str]:
    """A structure."""
    return [*cells(row), str(row["blocks"])]


def twin_cells(case: Mapping[str, Any], row: Mapping[str, Any]) -> list[str]:
    """A quantity of a case of the plane and of its twin."""
    allowed = "–" if row["allowed"] is None else f"±{row['allowed']:.2g}"
    shown = [told(row[name]) for name in ("reference", "plane", "space")]
    return [f"`{case['name']}`", row["quantity"], *shown, off(row["space"], row["plane"]), allowed,
            *books(case["space"])]  # fmt: skip


def law_cells(case: Mapping[str, Any], row: Mapping[str, Any]) -> list[str]:
    """A peak of a shaken column and of its twin; differences are shares of the larger peak."""
    plane, space, other = (float(values) for values in (row["plane"], row["space"], case["other"][row["quantity"]]))
    largest = max(abs(each["plane"]) for each in case["quantities"])
    shown = [number(1e3 * value) for value in (plane, space)]
    apart = [percent((value - plane) / largest) for value in (space, other)]
    end = row["quantity"].rpartition(".")[2]
    return [case["name"], end, *shown, *apart, small(case["plane"]["book"]), *books(case["space"])]


def same(row: Mapping[str, Any]) -> bool:
    """Whether the twin is as near to the plane as the case allows to its reference."""
    plane, space = row["plane"], row["space"]
    if isinstance(plane, (bool, str)) or plane is None or space is None:
        return bool(plane == space)
    return bool(abs(space - plane) <= (row["allowed"] or 0.0))


def books(row: Mapping[str, Any]) -> Sequence[str]:
    """Book of energy and cost."""
    shares = [small(row[name]) for name in ("book", "net", "moved")]
    return [*shares, f"{row['steps']:,}", f"{row['seconds']:.1f}"]


def off(found: Any, exact: Any) -> str:
    """Relative error."""
    numbers = [isinstance(x, (int, float)) and not isinstance(x, bool) for x in (found, exact)]
    if not all(numbers) or not exact or math.isnan(found):
        return "–"
    return percent(found / exact - 1.0)


def told(value: Any) -> str:
    """A number, a truth or a word."""
    if isinstance(value, (list, tuple)):
        return " to ".join(number(each) for each in value)
    return str(value).lower() if value is None or isinstance(value, (bool, str)) else number(value)


def number(value: float) -> str:
    """Six digits."""
    return f"{value:.6g}"


def small(value: float | None) -> str:
    """A share of the kinetic energy."""
    return "–" if value is None else f"{value:.1e}".replace("e-0", "e-")
