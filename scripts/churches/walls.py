"""Single walls that turn as rigid bodies, Tables A-2 and A-3."""

from __future__ import annotations

from typing import Any

from churches.cases import PRINTED, WALLS, wall
from churches.runs import solve
from dem_cli.bench.table import lines_of, percent

USED = {
    "church_wall_a": "thickness, by (t − 0.2)/h", "church_wall_b": "width of its column", "church_wall_c": "the same",
    "church_wall_d": "thickness, by t/h", "church_buttress": "thickness, by t/h",
    "church_wall_d_before": "height, by t/h",
}  # fmt: skip


def measure() -> dict[str, Any]:
    """All six."""
    found = {name: solve(f"dem run cases/validation/{name}.toml", wall(name, resolution=0.002)) for name in PRINTED}
    return {name: {key: one[key] for key in ("command", "status", "bracket", "associated", "seconds")}
            for name, one in found.items()}  # fmt: skip


def page(found: dict[str, Any]) -> list[str]:
    """This part of church.md."""
    rows = []
    for name, one in found.items():
        whole, letter, printed = PRINTED[name]
        table = "A-2" if whole == "church_a" else "A-3"
        low, high = one["bracket"]
        error = percent(low / printed - 1.0)
        rows.append((table, WALLS[letter], f"{printed:g}", f"{low:.4f} to {high:.4f}", error, USED[name]))
    return [
        "## Single walls, Tables A-2 and A-3", "",
        "Walls without roofs, of several blocks, which turn as one. Each printed load was used to infer one length, so",
        "this shows only that the geometry is what it is said to be.", "",
        *lines_of(("table", "wall", "thesis", "dem", "error", "what was inferred from it"), rows), "",
        "Table A-3 has 0.032 for a nave wall B before 1954, between the two of today; here they are as today.", "",
    ]  # fmt: skip


PICTURES: dict[str, Any] = {}
