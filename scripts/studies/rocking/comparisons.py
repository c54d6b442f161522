"""Parts of the study of rocking: rows of every comparison of docs/rocking.md."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from studies.rocking import defaults, ensembles, free_rocking, overturning, sliding

FINE = {"output": {"rate": 2000.0}}
PAIRS = 240  # of a block and a record
SOFT = 1e5  # kn h / W, as "auto" joints of time histories have at least
MARGINS = (0.5, 0.35, 0.25, 0.18, 0.125)
ENERGY = {"none": {"none": True}, "0.35 of critical": {"contact_fraction": 0.35}, "housner": {"restitution": "housner"}}
SEEDS = range(5)
BOUNCES = ((0.0, (0.5, 0.25, 0.1, 0.02)), (0.2, (0.5, 0.25, 0.1, 0.02)))  # ζ, margins


def _map() -> Iterator[dict[str, Any]]:
    for fraction in free_rocking.FRACTIONS:
        damping = {"contact_fraction": fraction}
        yield {
            "fraction": fraction,
            "ratios": [free_rocking.restitution(aspect, damping, **FINE) for aspect in free_rocking.ASPECTS],
            "soft": [
                free_rocking.restitution(aspect, damping, stiffness=SOFT, **FINE) for aspect in free_rocking.ASPECTS
            ],
        }


def _bounces() -> Iterator[dict[str, Any]]:
    for ratio, margins in BOUNCES:
        for margin in margins:
            how = {"output": {"rate": 50_000.0}, "analysis": {"margin": margin}}
            yield {"margin": margin} | sliding.bounce(ratio=ratio, **how)


def _energy() -> Iterator[dict[str, Any]]:
    with tempfile.TemporaryDirectory() as folder:
        for name, damping in ENERGY.items():
            for margin in MARGINS:
                runs = [sliding.column(Path(folder), margin, seed, damping=damping) for seed in SEEDS]
                yield {"damping": name, "margin": margin, "closures": runs}


PARTS: dict[str, Callable[[], Iterator[Any]]] = {
    "free": lambda: (free_rocking.compared(aspect, **FINE) for aspect in free_rocking.ASPECTS),
    "free_soft": lambda: (free_rocking.compared(aspect, stiffness=SOFT, **FINE) for aspect in free_rocking.ASPECTS),
    "map": _map,
    "bounds": lambda: (row for ratio in overturning.RATIOS for row in overturning.compared(overturning.BLOCK, ratio)),
    "slides": lambda: (sliding.sliding(name, damping={"contact_fraction": 0.35}) for name in sliding.SLIDES),
    "stacks": lambda: (sliding.stack(name, output={"rate": 5000.0}) for name in sliding.STACKS),
    "bounces": _bounces,
    "energy": _energy,
    "defaults": defaults.rows,
    "pairs": lambda: iter(ensembles.compared(range(PAIRS))),
}
