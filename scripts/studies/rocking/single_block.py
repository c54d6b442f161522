"""Cases of one or two blocks on a base, run without files; responses as arrays."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from oracle.base_motion import Record
from oracle.housner import Block

from dem_cli.case.reader import LoadedCase
from dem_cli.core.engine.settings import DEFAULT, Settings
from studies import solution
from studies.polygons import rectangle
from studies.solution import from_file, from_tables

DENSITY, GRAVITY = 2000.0, 9.81
STIFFNESS = 1e6  # kn h / W of a contact face: kn = STIFFNESS ρ g
ROUGH = 10.0  # friction of blocks that must not slide
FALLEN = 60.0  # [°]: so far turned, a block has overturned here and in the oracle


class Response(NamedTuple):
    """What the monitors of a run saw; `summary` as the run left it."""

    times: np.ndarray  # [s], (n,)
    values: np.ndarray  # (n, n_monitors)
    summary: dict[str, Any]

    @property
    def overturned(self) -> bool:
        return bool(self.summary["collapsed"])

    def at(self, time: float, column: int = 0) -> float:
        return float(np.interp(time, self.times, self.values[:, column]))

    def zeros(self, column: int = 0) -> np.ndarray:
        """Times at which a value changes its sign, by straight lines."""
        y = self.values[:, column]
        at = np.flatnonzero(y[:-1] * y[1:] < 0.0)
        return self.times[at] + (self.times[at + 1] - self.times[at]) * y[at] / (y[at] - y[at + 1])

    def extremes(self, column: int = 0) -> tuple[np.ndarray, np.ndarray]:
        """Times and sizes of the largest |value| between two changes of sign, by parabolas through three samples."""
        y, dt = self.values[:, column], self.times[1] - self.times[0]
        ends = np.searchsorted(self.times, self.zeros(column))
        times, sizes = [], []
        for first, last in zip(ends[:-1], ends[1:]):
            k = int(first + np.abs(y[first:last]).argmax())
            if 0 < k < len(y) - 1:
                bend, slope = y[k + 1] - 2.0 * y[k] + y[k - 1], 0.5 * (y[k + 1] - y[k - 1])
                part = -slope / bend if bend else 0.0
                times.append(self.times[k] + part * dt)
                sizes.append(abs(y[k] + 0.5 * slope * part))
        return np.array(times), np.array(sizes)


def solve(case: dict[str, Any], *overrides: str, settings: Settings = DEFAULT) -> Response:
    """Runs a case that is a table."""
    return response(from_tables(case, *overrides), settings)


def solve_file(path: Path, *overrides: str) -> Response:
    """Runs a case file; nothing is written."""
    return response(from_file(path, *overrides))


def response(loaded: LoadedCase, settings: Settings = DEFAULT) -> Response:
    """Runs a case that was read."""
    _, summary, seen = solution.solve(loaded, settings)
    return Response(seen.times, seen.values, summary)


def one_block(
    block: Block,
    motion: dict[str, Any] | None = None,
    duration: float = 10.0,
    damping: dict[str, Any] | None = None,
    tilt: float = 0.0,
    friction: float = ROUGH,
    stiffness: float = STIFFNESS,
    quantities: Sequence[dict[str, Any]] = ({"quantity": "rotation"},),
    **more: Any,
) -> dict[str, Any]:
    """A block on a wide base; turns are counter-clockwise."""
    reach = 4.0 * block.radius
    half = 0.5 * block.width
    case: dict[str, Any] = {
        "gravity": block.gravity,
        "materials": {"stone": {"density": DENSITY}},
        "joints": {"dry": {"friction": friction, "kn": stiffness * DENSITY * block.gravity}},
        "block": [
            {"id": "base", "vertices": rectangle(-reach, -0.25 * block.height, reach, 0.0), "fixed": True},
            {"id": "block", "vertices": rectangle(-half, 0.0, half, block.height)},
        ],
        "analysis": {  # no coda: oracles look at the duration as well
            "kind": "time-history",
            "duration": duration,
            "fallen_deg": FALLEN,
            "after_collapse": 0.0,
            "coda": 0.0,
        },
        "damping": damping or {"restitution": "housner"},
        "monitor": [{"block": "block", **quantity} for quantity in quantities],
        "output": {"frames": 0},
    }
    if motion is not None:
        case["motion"] = motion
    if tilt:
        case["initial"] = [{"block": "block", "tilt": tilt}]
    for key, table in more.items():
        case[key] = {**case[key], **table} if isinstance(case.get(key), dict) else table
    return case


def pulse_table(amplitude: float, frequency: float) -> dict[str, Any]:
    return {"kind": "pulse", "shape": "sine", "amplitude": amplitude, "frequency": frequency}


def record_file(folder: Path, name: str, record: Record) -> dict[str, Any]:
    """Writes a record as a user would have it; the table that reads it."""
    path = folder / f"{name}.csv"
    rows = zip(record.breaks.tolist(), record.values.tolist())
    path.write_text("time,acceleration\n" + "".join(f"{t!r},{a!r}\n" for t, a in rows), encoding="utf-8")
    return {"kind": "record", "file": str(path), "unit": "m/s2"}


def fallen_angle() -> float:
    return math.radians(FALLEN)
