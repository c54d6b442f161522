"""Single walls that turn as rigid bodies, Tables A-2 and A-3."""

from __future__ import annotations

from typing import Any

from bench.table import percent

from studies.church.cases import PRINTED, WALLS, wall
from studies.church.mechanism import solved
from studies.template import bracket, table

WALL_KEPT = ("command", "status", "bracket", "associated", "seconds")

USED = {
    "church_wall_a": "thickness, by (t − 0.2)/h", "church_wall_b": "width of its column", "church_wall_c": "the same",
    "church_wall_d": "thickness, by t/h", "church_buttress": "thickness, by t/h",
    "church_wall_d_before": "height, by t/h",
}  # fmt: skip


def measure() -> dict[str, Any]:
    """All six."""
    return {
        name: solved(f"dem run cases/validation/{name}.toml", wall(name, resolution=0.002), WALL_KEPT)
        for name in PRINTED
    }


def values(found: dict[str, Any]) -> dict[str, str]:
    """What walls.md.j2 shows."""
    rows = []
    for name, one in found.items():
        whole, letter, printed = PRINTED[name]
        where = "A-2" if whole == "church_a" else "A-3"
        error = percent(one["bracket"][0] / printed - 1.0)
        rows.append((where, WALLS[letter], f"{printed:g}", bracket(one["bracket"]), error, USED[name]))
    return {"walls": table(("table", "wall", "thesis", "dem", "error", "what was inferred from it"), rows)}


PICTURES: dict[str, Any] = {}
