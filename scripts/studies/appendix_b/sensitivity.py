"""How far the loads of Appendix B depend on what is lost (heights, square bricks, mortar), on rigid joints."""

from __future__ import annotations

from typing import Any

from bench.table import percent

from studies import storage
from studies.appendix_b.sweep import RIGID, changed, top_block
from studies.template import bracket, table

KG250 = 250.0 / (0.4 * 0.08)  # kg over plan and depth: over the height of a load this is its density


def five(top: float) -> dict[str, Any]:
    """Condition B with loads up to `top` [m], 250 kg together."""
    blocks = [top_block(0.08 * i, 0.08 * (i + 1), top, f"load-{i + 1}") for i in range(5)]
    return {"block": blocks, "materials.load.density": KG250 / (top - 0.595)}


def square(courses: int, number: int) -> dict[str, Any]:
    """Other square bricks."""
    return {"structure.0.block": [0.4 / number, 0.595 / courses], "structure.0.courses": courses,
            "structure.0.blocks_per_course": number}  # fmt: skip


RUNS: dict[str, dict[str, Any]] = {
    "test 5, loads at 0.627 m": five(0.659),
    "test 5, loads at 0.691 m": five(0.787),
    "test 5, no mortar under the loads": {"joints.mortar.friction": 0.6},
    "test 8, no mortar under the beam": {"joints.mortar.friction": 0.6},
    "test 4, half brick first": {"structure.0.first": "half"},
    "test 4, friction 0.55": {"joints.dry.friction": 0.55},
    "test 4, friction 0.65": {"joints.dry.friction": 0.65},
    "test 1, half brick first": {"structure.0.first": "half"},
    "square B, 157 bricks": square(15, 10),
    "square B, 225 bricks": square(18, 12),
    "square C, 157 bricks": square(15, 10),
}


def measure() -> dict[str, Any]:
    """All of them, without collapse, on rigid joints."""
    return {label: changed(label.split(",")[0], RIGID | what) for label, what in RUNS.items()}


def values(found: dict[str, Any]) -> dict[str, Any]:
    """What sensitivity.md.j2 shows."""
    rigid = storage.read("appendix_b")["softness"]["rigid"]
    lines = []
    for label, one in found.items():
        plain, load = (0.5 * sum(run["bracket"]) for run in (rigid[label.split(",")[0]], one))
        first = "–" if one["onset"] is None else f"{one['onset']:.4f}"
        lines.append(
            (label, f"{plain:.4f}", bracket(one["bracket"]), percent(load / plain - 1.0), first, one["mode"] or "–")
        )
    head = ("changed", "rigid joints as above", "dem", "change", "first motion", "mode")
    return {"changes": table(head, lines)}


PICTURES: dict[str, Any] = {}
