"""All comparisons of docs/rocking.md."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from rockingtable import ensembles, free, others, pulses

FINE = {"output": {"rate": 2000.0}}
SOFT = 1e5  # kn h / W of "auto" joints in time histories
MARGINS = (0.5, 0.35, 0.25, 0.18, 0.125)
ENERGY = {"none": {"none": True}, "0.35 of critical": {"contact_fraction": 0.35}, "housner": {"restitution": "housner"}}
SEEDS = range(5)
BOUNCES = ((0.0, (0.5, 0.25, 0.1, 0.02)), (0.2, (0.5, 0.25, 0.1, 0.02)))  # ζ, margins


def everything(pairs: int, say: Callable[[str], None]) -> dict[str, Any]:
    """The table that the page is made of; `say` hears each row."""
    parts: dict[str, Callable[[], Iterator[Any]]] = {
        "free": lambda: (free.compared(aspect, **FINE) for aspect in free.ASPECTS),
        "free_soft": lambda: (free.compared(aspect, stiffness=SOFT, **FINE) for aspect in free.ASPECTS),
        "map": _map,
        "bounds": lambda: (row for ratio in pulses.RATIOS for row in pulses.compared(pulses.BLOCK, ratio)),
        "slides": lambda: (others.sliding(name, damping={"contact_fraction": 0.35}) for name in others.SLIDES),
        "stacks": lambda: (others.stack(name, output={"rate": 5000.0}) for name in others.STACKS),
        "bounces": _bounces,
        "energy": _energy,
        "pairs": lambda: iter(ensembles.compared(range(pairs))),
    }
    table: dict[str, Any] = {}
    for name, rows in parts.items():
        begun, table[name] = time.process_time(), []
        for row in rows():
            table[name].append(row)
            if name != "pairs":
                say(f"{name}: {row}")
        say(f"{name}: {len(table[name])} rows, {time.process_time() - begun:.1f} s of CPU")
    return table


def _map() -> Iterator[dict[str, Any]]:
    for fraction in free.FRACTIONS:
        damping = {"contact_fraction": fraction}
        yield {
            "fraction": fraction,
            "ratios": [free.restitution(aspect, damping, **FINE) for aspect in free.ASPECTS],
            "soft": [free.restitution(aspect, damping, stiffness=SOFT, **FINE) for aspect in free.ASPECTS],
        }


def _bounces() -> Iterator[dict[str, Any]]:
    for ratio, margins in BOUNCES:
        for margin in margins:
            how = {"output": {"rate": 50_000.0}, "analysis": {"margin": margin}}
            yield {"margin": margin} | others.bounce(ratio=ratio, **how)


def _energy() -> Iterator[dict[str, Any]]:
    with tempfile.TemporaryDirectory() as folder:
        for name, damping in ENERGY.items():
            for margin in MARGINS:
                runs = [others.column(Path(folder), margin, seed, damping=damping) for seed in SEEDS]
                yield {"damping": name, "margin": margin, "closures": runs}
