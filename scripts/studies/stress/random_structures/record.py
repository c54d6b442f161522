"""Record of one random structure: what it is, the range of its admissible loads, and what every method says."""

from __future__ import annotations

import math
import time
from typing import Any

from studies.stress.random_structures.admissible import LoadedBodies, associated_load, lowest_load
from studies.stress.random_structures.generator import structure
from studies.stress.random_structures.methods import answers, limit_answer


def record(seed: int, max_steps: int | None = None) -> dict[str, Any]:
    """All that is known of the structure of a seed, as JSON; max_steps: of starts that are told."""
    begun = time.process_time()
    tables = structure(seed)
    bodies = LoadedBodies.of(tables)
    load = associated_load(bodies)
    bounds = {
        "associated": None if math.isnan(load) or math.isinf(load) else load,
        "stands": not math.isnan(load),
        "lowest": lowest_load(bodies, load) if math.isfinite(load) else None,
    }
    about = {
        "seed": seed,
        "title": tables["title"],
        "blocks": int((~bodies.fixed).sum()),
        "friction": [joint["friction"] for joint in tables["joints"].values()],
        "pattern": tables["analysis"]["pattern"],
    }
    bounds["seconds"] = round(time.process_time() - begun, 2)
    return about | bounds | {"limit": limit_answer(tables), "answers": answers(tables, max_steps)}
