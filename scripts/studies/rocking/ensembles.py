"""Seeded block–record pairs: shares overturned and distributions of peaks, dem beside the oracle.

Each pair is run by the oracle, by the oracle with the record scaled by 1.001 (how much a single record means), and by
dem. Tests: McNemar's (exact) for outcomes, Kolmogorov and Smirnov's for the distributions of peaks, signs for bias.
"""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from oracle.housner import rock
from oracle.pairs import Pair, pair, scaled
from scipy.stats import binomtest, ks_2samp

from studies.rocking.single_block import fallen_angle, one_block, record_file, solve

CHANGE, AFTER = 1.001, 5.0
FALLS = 2.0  # stands for a peak of a block that overturned, in α


def compared(seeds: Sequence[int], **how: Any) -> list[dict[str, Any]]:
    """Peaks |θ|/α of each pair: exact, exact with a slightly stronger record, dem."""
    with tempfile.TemporaryDirectory() as folder:
        return [_one(pair(seed), Path(folder), how) for seed in seeds]


def _one(one: Pair, folder: Path, how: dict[str, Any]) -> dict[str, Any]:
    duration = one.record.duration + AFTER
    runs = [
        rock(one.block, record, duration, bound=fallen_angle()) for record in (one.record, scaled(one.record, CHANGE))
    ]
    exact, changed = (FALLS if np.isfinite(r.overturned) else r.peak / one.block.alpha for r in runs)
    found = solve(one_block(one.block, record_file(folder, f"r{one.seed}", one.record), duration, **how))
    peak = FALLS if found.overturned else float(np.abs(found.values[:, 0]).max() / one.block.alpha)
    return {"seed": one.seed, "exact": exact, "changed": changed, "dem": peak}


def judged(rows: Sequence[dict[str, Any]], other: str = "dem") -> dict[str, Any]:
    """What the tests say about `other` against the oracle."""
    exact, found = (np.array([row[name] for row in rows]) for name in ("exact", other))
    fell, falls = exact >= FALLS, found >= FALLS
    only_exact, only_found = int((fell & ~falls).sum()), int((~fell & falls).sum())
    both = ~fell & ~falls & ((exact > 0.0) | (found > 0.0))
    differences = found[both] / exact[both] - 1.0
    higher = int((differences > 0.0).sum())
    return {
        "pairs": len(rows),
        "overturned": [int(fell.sum()), int(falls.sum())],
        "outcomes_changed": [only_exact, only_found],
        "mcnemar": _two_sided(only_exact, only_exact + only_found),
        "kolmogorov_smirnov": [float(v) for v in ks_2samp(exact, found)[:2]],
        "median_difference": float(np.median(differences)),
        "median_size": float(np.median(np.abs(differences))),
        "higher": [higher, int(both.sum())],
        "signs": _two_sided(higher, int(both.sum())),
    }


def _two_sided(successes: int, trials: int) -> float:
    return float(binomtest(successes, trials).pvalue) if trials else 1.0
