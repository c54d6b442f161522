"""Overturning domains: which amplitudes of an impulse overturn a structure, by its duration.

Overturning is not monotone in the amplitude. From below, amplitudes RATIO apart are tried up to the first at which the
structure falls; what is left between the last two is bisected. From there on amplitudes are tried up to BEYOND times
that, to see where it stands again.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from dem_cli.analyses.ensembles.shaken_run import RestedStructure
from dem_cli.analyses.ensembles.variants import Variant
from dem_cli.app.api import build_model
from dem_cli.core.motion.motion import Motion
from dem_cli.core.motion.pulses import impulse
from dem_cli.core.records.ports import Observer
from dem_cli.masonry.assembly.ground_motions import suites_of
from studies.bisection import bisect_ratio
from studies.places import CASES
from studies.rocking.single_block import solve
from studies.solution import from_tables

G = 9.81  # m/s2
LOWEST, HIGHEST, RATIO, BEYOND, TOLERANCE = 0.15, 6.0, 1.04, 1.1, 3e-3  # g, g, -, -, -
REBOUND = 0.5
Falls = Callable[[float, float], bool]  # of amplitude [g] and tp [s]
DAMPINGS: dict[str, dict[str, Any]] = {
    "0.35 of critical": {"contact_fraction": 0.35},
    "0.1 of critical": {"contact_fraction": 0.1},
    "critical": {"contact_fraction": 1.0},
    "housner": {"restitution": "housner"},
    "none": {"none": True},
}


def table_of(name: str) -> dict[str, Any]:
    """A case file as a table."""
    return tomllib.loads((CASES / "validation" / f"{name}.toml").read_text(encoding="utf-8"))


def changed(case: Mapping[str, Any], **tables: Any) -> dict[str, Any]:
    """A case with some tables replaced, or some keys in them; None takes a table away."""
    made = dict(case)
    for key, table in tables.items():
        if table is None:
            made.pop(key, None)
        elif isinstance(table, dict) and isinstance(made.get(key), dict) and key != "damping":
            made[key] = {**made[key], **table}
        else:
            made[key] = table
    return made


class Shaker:
    """A structure at rest, from which impulses of any amplitude and duration start.

    lasts: how long it is watched after an impulse, at most [s]; it ends earlier at rest
    """

    def __init__(
        self, case: Mapping[str, Any], damping: Mapping[str, Any], lasts: float, margin: float,
        monitor: Sequence[Any] | None = None,
    ) -> None:  # fmt: skip
        analysis = {"kind": "fragility", "intensities": [1.0], "coda": lasts, "margin": margin}
        made = changed(case, damping=dict(damping), monitor=monitor) | {"analysis": analysis}
        loaded = from_tables(made)
        model = build_model(loaded)
        self.rested = RestedStructure(Variant(loaded.case, model, 0), suites_of(loaded.case)[0], Observer())
        self.runs, self.seconds = 0, 0.0

    def falls(self, amplitude: float, tp: float) -> bool:
        """Whether +amplitude [g] for tp [s] and −amplitude/2 for 2 tp overturn it while it is watched."""
        return bool(self.run([Motion(impulse(amplitude * G, tp, REBOUND))]).collapsed)

    def run(self, motions: Sequence[Any]) -> Any:
        """What became of it under the sum of motions (analyses/ensembles/shaken_run.py: Run)."""
        run = self.rested.shaken(motions)
        assert run.ending, run.how
        self.runs, self.seconds = self.runs + 1, self.seconds + run.seconds
        return run


def scanned(falls: Falls, tp: float, lowest: float = LOWEST, beyond: float = BEYOND) -> dict[str, Any]:
    """The least amplitude that overturns [g], bisected, and the answers along the grid."""
    amplitudes = lowest * RATIO ** np.arange(int(np.log(HIGHEST / lowest) / np.log(RATIO)))
    answers: list[tuple[float, bool]] = []
    least = None
    for amplitude in amplitudes.tolist():
        if least is not None and amplitude > least * beyond:
            break
        answers.append((amplitude, falls(amplitude, tp)))
        if least is None and answers[-1][1]:
            if len(answers) == 1:
                raise ValueError(f"falls at the lowest amplitude tried already, {amplitude:g} g: begin lower")
            _, least = bisect_ratio(answers[-2][0], amplitude, TOLERANCE, lambda a: falls(a, tp))
    return {"tp": tp, "least": least, "answers": answers}


def way_of_falling(
    case: Mapping[str, Any], damping: Mapping[str, Any], amplitude: float, tp: float, margin: float
) -> dict[str, Any]:
    """To which side it falls: +1 is away from the side to which the first push turns it, so that joints closed between.

    Base to the right turns it to the left first.
    """
    motion = {"amplitude": amplitude * G, "duration": tp}
    analysis = {"duration": 3.0 * tp + 8.0, "after_collapse": 0.0, "margin": margin}
    found = solve(changed(case, damping=dict(damping), motion=motion, analysis=analysis, output={"frames": 0}))
    values = found.values[:, 0] - found.values[0, 0]
    return {"collapsed": found.overturned, "side": int(np.sign(values[-1])), "time": found.summary["collapse_time"]}
